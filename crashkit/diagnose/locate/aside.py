"""Sensor or structure: accelerometers that contradict the film of their body are set aside before any spring is accused.

With them a search would bend every claim about the structure to their errors, and each form of their errors to what the model
lacks. The instruments that agree decide on the structure; what is wrong with the others is seen in its light.
"""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from attrs import evolve, frozen

from crashkit.diagnose.claims import sensors_read
from crashkit.diagnose.locate.consistency import SIGNIFICANT, by_run, check_instruments
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

CLOCK = "clock_offset"
ALIKE = 0.2
"""Share of an offset by which bodies may differ on it: short pulses and filters falsify it by a tenth."""
ON_TIME = 0.5
"""Share of an offset that a clock may at most have, to be told from one that has all of it."""
LEFT = 2.0
"""What a clock may leave of a contradiction, in units of noise: filters are in no check."""
TOLD, APART = 1.1, 1.3
"""What an error may leave of a contradiction that it explains, in units of noise, and how much more every other one leaves."""
PHYSICS = {"gain": "gain_error", "bias": "bias"}
"""Of the errors that are told by kinematics alone."""


@frozen
class Suspect:
    """The accelerometers of a body that its film contradicts.

    Attributes:
        body: that carries them.
        instrument: the accelerometer's name in the recordings.
        sensors: those of its sensors that the body carries.
        told: the physics of their error, where kinematics alone say that; empty where they do not.
    """

    body: str
    instrument: str
    sensors: tuple[str, ...]
    told: str = ""

    def concerns(self, proposal: Proposal) -> bool:
        """Whether a proposal says what such a sensor reads, as if its body turns or its clock is wrong, and that as kinematics
        or its channels say.

        What a law of the structure is off by, an error in another form would seem to explain better.
        """
        if self.told not in ("", proposal.physics) and proposal.odds <= 1.0:
            return False
        place = proposal.location
        is_here = place.get("sensor") in self.sensors or place.get("body") == self.body
        return bool(sensors_read(proposal)) and (is_here or place.get("instrument") == self.instrument)

    def besides(self, finding: Proposal) -> "Suspect | None":
        """What is still accused when something was found: another sensor of the body may be wrong too."""
        if not self.concerns(finding):
            return self
        others = tuple(sensor for sensor in self.sensors if sensor != finding.location.get("sensor"))
        return evolve(self, sensors=others) if "sensor" in finding.location and others else None


def suspects(misfit: Misfit, checks: xr.Dataset) -> tuple[Suspect, ...]:
    """The accelerometers that contradict a film by kinematics alone.

    Arguments:
        checks: what `check_instruments` says of the misfit's recordings.
    """
    accused = _worst(checks).where(lambda row: row["sigma"] > SIGNIFICANT, drop=True)
    pairs = zip(accused["body"].values.tolist(), accused["accelerometer"].values.tolist(), strict=True)
    return tuple(_suspect(misfit, checks, body, accelerometer) for body, accelerometer in pairs)


def are_at_odds(misfit: Misfit) -> bool:
    """Whether some instruments of a misfit contradict each other by kinematics alone."""
    checks = check_instruments(by_run(misfit))
    return bool(late_clocks(checks) or suspects(misfit, checks))


def late_clocks(checks: xr.Dataset) -> dict[str, float]:
    """By how much, in s, one of two instruments must be late; none unless that explains all that they say of most bodies. The
    one that a third instrument agrees with is not late."""
    worst = _worst(checks)
    late = worst.where((worst["sigma"] > SIGNIFICANT) & (worst["error"] == CLOCK), drop=True)
    if not late.sizes["check"]:
        return {}
    plainest = late.isel(check=int((late["sigma"] / late["left"]).values.argmax()))
    film, accelerometer, offset = (plainest[name].item() for name in ("film", "accelerometer", "estimate"))
    of_clocks = checks.where(checks["error"] == CLOCK, drop=True)
    is_of_film, is_of_accelerometer = of_clocks["film"] == film, of_clocks["accelerometer"] == accelerometer
    clocks = of_clocks.where(is_of_film & is_of_accelerometer, drop=True)
    apart = np.abs(clocks["estimate"] - offset) > np.maximum(SIGNIFICANT * clocks["std"], ALIKE * abs(offset))
    agree = ~apart & (clocks["left"] <= LEFT)
    if agree.mean() <= 0.5:
        return {}
    both = {film: -offset, accelerometer: offset}
    by_others = {film: is_of_film & ~is_of_accelerometer, accelerometer: is_of_accelerometer & ~is_of_film}
    right = {one for one, checked in by_others.items() if _are_on_time(of_clocks.where(checked, drop=True), offset)}
    return both if len(right) == 2 else {one: late for one, late in both.items() if one not in right}


def _are_on_time(clocks: xr.Dataset, offset: float) -> bool:
    """Whether there are such checks of clocks, and none can have more than a part of that offset."""
    most = np.abs(clocks["estimate"]) + SIGNIFICANT * clocks["std"]
    return bool(clocks.sizes["check"] and (most < ON_TIME * abs(offset)).all())


def _worst(checks: xr.Dataset) -> xr.Dataset:
    """Of each body and accelerometer, the error that would explain best what contradicts a film."""
    checks = checks.sortby("sigma")
    pairs = zip(checks["body"].values.tolist(), checks["accelerometer"].values.tolist(), strict=True)
    last = {pair: number for number, pair in enumerate(pairs)}
    return checks.isel(check=list(last.values()))


def on_time(recordings: Mapping[str, xr.DataTree], instrument: str, late: float) -> dict[str, xr.DataTree]:
    """The recordings with that instrument's time stamps put right; what it recorded before the start is left out."""
    return {run: _on_time(recording, instrument, late) for run, recording in recordings.items()}


def _on_time(recording: xr.DataTree, instrument: str, late: float) -> xr.DataTree:
    if instrument not in recording.children:
        return recording
    group = recording.children[instrument].to_dataset(inherit=False)
    group = group.assign_coords(time=group["time"] - late)
    return recording.assign({instrument: xr.DataTree(group.isel(time=(group["time"] >= 0.0).values))})


def _suspect(misfit: Misfit, checks: xr.Dataset, body: str, instrument: str) -> Suspect:
    group = next(group.dataset for group in misfit.groups if group.name == instrument)
    carried = group["sensor"].values[group["sensor_body"].values == body]
    own = checks.where((checks["body"] == body) & (checks["accelerometer"] == instrument), drop=True)
    return Suspect(body, instrument, tuple(carried.tolist()), _told(own))


def _told(checks: xr.Dataset) -> str:
    """The physics of the one error that explains all of a contradiction, of these checks of one body; empty if none does."""
    best, *others = sorted(zip(checks["left"].values.tolist(), checks["error"].values.tolist(), strict=True))
    is_told = best[0] < TOLD and all(left > APART * best[0] for left, _ in others)
    return PHYSICS.get(best[1], "") if is_told else ""


def without(recordings: Mapping[str, xr.DataTree], set_aside: tuple[Suspect, ...]) -> dict[str, xr.DataTree]:
    """The recordings of all other sensors."""
    return {run: _without(recording, set_aside) for run, recording in recordings.items()}


def _without(recording: xr.DataTree, set_aside: tuple[Suspect, ...]) -> xr.DataTree:
    for suspect in set_aside:
        instrument = recording.children[suspect.instrument].to_dataset(inherit=False)
        rest = instrument.isel(sensor=~instrument["sensor"].isin(suspect.sensors))
        recording = recording.assign({suspect.instrument: xr.DataTree(rest)})
        if not rest.sizes["sensor"]:
            recording = recording.drop_nodes(suspect.instrument)
    return recording
