"""The errors of an instrument, as parameters that can be identified like those of a joint."""

from collections.abc import Mapping

from attrs import frozen

from crashkit.model.parameter import Parameter


@frozen
class InstrumentErrors:
    """Error parameters of one sensor or marker, or (`sensor` empty) of a whole instrument group of the recordings.

    Arguments:
        instrument: name of the recordings' group.
        sensor: name of the sensor or marker; "" for what the whole instrument shares.
        parameters: by the names that the Observer declares in `errors`.
    """

    instrument: str
    sensor: str
    parameters: Mapping[str, Parameter]
