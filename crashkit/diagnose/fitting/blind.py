"""What an error of one sensor can explain at most: what a model that never saw that sensor leaves of the others."""

from collections.abc import Sequence
from functools import partial
from typing import Any

from crashkit.campaign import spread
from crashkit.diagnose.fitting.contest import Start
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


def that_may_explain(identifier: Identifier[Any], base: Misfit, starts: Sequence[Start], drop: float) -> list[Start]:
    """Those of some claims about single sensors that may lower the cost by so much.

    Arguments:
        base: the best fit without any claim.
        starts: all of claims about a single sensor.
        drop: in cost, half of chi squared.
    """
    sensors = list(dict.fromkeys(sensor for proposal, _ in starts if (sensor := sensor_of(proposal))))
    most = dict(zip(sensors, spread(partial(_most, identifier, base), sensors), strict=True))
    return [(proposal, values) for proposal, values in starts if most.get(sensor_of(proposal) or ("", ""), drop) >= drop]


def _most(identifier: Identifier[Any], base: Misfit, sensor: Sensor) -> float:
    """By how much the cost drops where the sensor leaves nothing but its noise, whatever its error, and is no constraint.

    A noise that nobody states may be as small as one likes: it was estimated by what the model leaves there.
    """
    stated = [one for one in base.channels if (one.instrument, one.sensor) == sensor and one.noise.trusted]
    noise = 0.5 * sum(channel.independent_samples for channel in stated)
    before, after = (begin(identifier, one) for one in (base, base.without_sensor(*sensor)))
    return float(before.state.cost - after.advance(STEPS).state.cost - noise)
