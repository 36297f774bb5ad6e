"""What an error of one sensor can explain at most: what a model that never saw that sensor leaves of the others."""

from collections.abc import Sequence
from functools import partial
from typing import Any

from crashkit.campaign import spread
from crashkit.diagnose.claims import Start
from crashkit.diagnose.fitting.search import begin
from crashkit.misfit import Misfit
from crashkit.protocols import Identifier, Proposal

STEPS = 5
"""Of the fit without a sensor, which begins at the best one with it."""
Sensor = tuple[str, str]
"""Names of the instrument and of the sensor."""


def sensor_of(proposal: Proposal) -> Sensor | None:
    """The only sensor that a proposal is about."""
    location = proposal.location
    return (str(location["instrument"]), str(location["sensor"])) if "sensor" in location else None


def that_may_reach(identifier: Identifier[Any], base: Misfit, starts: Sequence[Start], cost: float) -> list[Start]:
    """Those of some claims about single sensors that may lower the cost, half of chi squared, to this.

    Arguments:
        base: the best fit without any claim.
    """
    accused = [(sensor, start) for start in starts if (sensor := sensor_of(start[0])) is not None]
    sensors = list(dict.fromkeys(sensor for sensor, _ in accused))
    least = dict(zip(sensors, spread(partial(_least, identifier, base), sensors), strict=True))
    return [start for sensor, start in accused if least[sensor] <= cost]


def _least(identifier: Identifier[Any], base: Misfit, sensor: Sensor) -> float:
    """The cost where a sensor leaves nothing but its noise, whatever its error, and is no constraint.

    A noise that nobody states may be as small as one likes: it was estimated by what the model leaves there.
    """
    stated = [one for one in base.channels if (one.instrument, one.sensor) == sensor and one.noise.trusted]
    others = begin(identifier, base.without_sensor(*sensor)).advance(STEPS).state.cost
    return float(others + 0.5 * sum(channel.independent_samples for channel in stated))
