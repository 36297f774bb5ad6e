"""Observer: an instrument, forward (what it would record) and inverse (what it tells of the motion)."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.data.schema import GroupSchema
from crashkit.protocols.parameter import ParameterSpec

SensorErrors = Mapping[str, Mapping[str, float]]
"""Error parameters by sensor name, "" for the whole instrument: {"engine_acc": {"gain": 1.02}, "": {"clock_offset": 1e-4}}."""


class Observer(ABC):
    """A forward and inverse pair between a motion and one instrument group of a recording.

    Attributes:
        name: the value of a group's attribute `observer`.
        schema: the variables that such a group holds.
        quantity: the recorded variable that simulation and test are compared in, for example "acceleration";
            `<quantity>_std` is its standard deviation where known.
        channel: its dimension of channels, "marker" or "sensor".
        errors: the instrument's own error parameters; at their `null` the instrument is perfect.
        instrument_errors: names of those errors that the whole instrument shares (its clock).
    """

    name: ClassVar[str]
    schema: ClassVar[GroupSchema]
    quantity: ClassVar[str]
    channel: ClassVar[str]
    errors: ClassVar[tuple[ParameterSpec, ...]] = ()
    instrument_errors: ClassVar[tuple[str, ...]] = ()

    @abstractmethod
    def predict(self, motion: xr.Dataset, instrument: xr.Dataset, errors: SensorErrors | None = None) -> xr.Dataset:
        """What the instrument would record of this motion, at the instrument's own time stamps.

        The result holds `<quantity>` with the dims it has in `instrument`. If `motion` carries sensitivities
        (`position_sensitivity` with a last dim `parameter`, and so on), it also holds `<quantity>_sensitivity` with a last
        dim `parameter`, and always `<quantity>_error_sensitivity` with a last dim `error` (coordinate: the names of
        `errors`), the derivative to each channel's own error parameters. Times outside the motion give NaN.
        """

    @abstractmethod
    def reconstruct(self, instrument: xr.Dataset) -> xr.Dataset:
        """What the recording alone says of the motion: the variables of a motion that it can give, by body.

        Raises CrashkitError where the instrument cannot know, saying what is missing.
        """


@frozen(eq=False)
class Reading:
    """What an instrument without errors reads where each channel shows one number of the motion and nothing else.

    z(t) = offset + quantity(t; body, axis), filtered where the instrument states a `channel_frequency_class`; before t = 0 the
    motion is uniform.

    Arguments:
        quantity: of the motion, `position`, `velocity`, `acceleration` or `contact_force`.
        bodies, axes: names, one for each channel in the order of the recorded quantity without its time.
        offset: what is added, (channel,).
    """

    quantity: str
    bodies: tuple[str, ...]
    axes: tuple[str, ...]
    offset: np.ndarray


@frozen(eq=False)
class TurningReading:
    """What such an instrument reads at points of bodies that turn in the plane.

    Of a position that of the point, in the laboratory's frame; of an acceleration that of the point, along the axes of the
    laboratory, or of its body. Filtered likewise; before t = 0 the motion is uniform, and nothing is felt.

    Arguments:
        quantity: `position` or `acceleration`.
        bodies, channels: names, and the axis of each channel in the order of the recorded quantity without its time.
        axes: of the instrument.
        points: of the channels in the frames of their bodies, (channel, axis) m.
        own_axes: whether the channels' axes turn with the body.
    """

    quantity: str
    bodies: tuple[str, ...]
    channels: tuple[str, ...]
    axes: tuple[str, ...]
    points: np.ndarray
    own_axes: bool = False


@frozen(eq=False)
class Shown:
    """What the channels of an instrument would read without errors and filter.

    Arguments:
        times: s, (node,) increasing from 0 to beyond the last time stamp.
        value: (node, channel).
        slope: its derivatives to the parameters of a model, (node, channel, parameter), if they are asked for.
        rate, rate_slope: the same of its rate; of positions only.
    """

    times: np.ndarray
    value: np.ndarray
    slope: np.ndarray | None = None
    rate: np.ndarray | None = None
    rate_slope: np.ndarray | None = None


@frozen(eq=False)
class Misread:
    """What an instrument with errors records.

    Arguments:
        value: (time, sensor, axis).
        slope: its derivatives to the parameters of a model, (time, sensor, axis, parameter), if they are asked for.
        by_error: its derivatives to errors of its own, (time, sensor, axis, error).
    """

    value: np.ndarray
    slope: np.ndarray | None
    by_error: np.ndarray


class PlainObserver(Observer):
    """An observer whose instruments may show single numbers of the motion, so that a search need not build a Dataset.

    Attributes:
        place_errors: names of those errors that say where a sensor sits; what it reads there on a body that turns only
            `predict` knows.
    """

    place_errors: ClassVar[tuple[str, ...]] = ()

    @abstractmethod
    def reading(self, instrument: xr.Dataset, turning: bool) -> Reading | TurningReading | None:
        """What it reads, where that is all there is to it; None where only `predict` knows.

        Arguments:
            instrument: group of a recording.
            turning: whether bodies may turn.
        """

    @abstractmethod
    def misread(self, shown: Shown, instrument: xr.Dataset, errors: SensorErrors, wanted: Sequence[str]) -> Misread:
        """What is recorded of what the channels would read, as `predict` says.

        On a line, or with channels along every axis of the model and no `place_errors`.

        Arguments:
            shown: as `reading` says.
            instrument: group of a recording.
            errors: as `predict` takes them.
            wanted: names of errors whose derivatives are asked for.
        """
