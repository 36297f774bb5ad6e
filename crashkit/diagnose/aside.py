"""Sensor or structure: accelerometers that contradict the film of their body are set aside before any spring is accused.

With them a search would bend every claim about the structure to their errors, and each form of their errors to what the model
lacks. The instruments that agree decide on the structure; what is wrong with the others is seen in its light.
"""

from collections.abc import Mapping

import xarray as xr
from attrs import frozen

from crashkit.diagnose.consistency import SIGNIFICANT, by_run, check_instruments
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Proposal

CLOCK = "clock_offset"


@frozen
class Suspect:
    """The accelerometers of a body that its film contradicts.

    Attributes:
        body: that carries them.
        instrument: the accelerometer's name in the recordings.
        sensors: those of its sensors that the body carries.
    """

    body: str
    instrument: str
    sensors: tuple[str, ...]

    def concerns(self, proposal: Proposal, model: Model) -> bool:
        """Whether a proposal says no more than what such a sensor reads."""
        place = proposal.location
        of_readings = (proposal.model.bodies, proposal.model.joints) == (model.bodies, model.joints)
        return of_readings and (place.get("sensor") in self.sensors or place.get("body") == self.body)


def suspects(misfit: Misfit) -> tuple[Suspect, ...]:
    """The accelerometers that contradict a film by kinematics alone; not where the clock of either explains it best."""
    checks = check_instruments(by_run(misfit)).to_dataframe()
    worst = checks.sort_values("sigma").groupby(["body", "accelerometer"]).tail(1)
    accused = worst[(worst["sigma"] > SIGNIFICANT) & (worst["error"] != CLOCK)]
    return tuple(_suspect(misfit, str(row.body), str(row.accelerometer)) for row in accused.itertuples())


def _suspect(misfit: Misfit, body: str, instrument: str) -> Suspect:
    group = next(group.dataset for group in misfit.groups if group.name == instrument)
    carried = group["sensor"].values[group["sensor_body"].values == body]
    return Suspect(body, instrument, tuple(carried.tolist()))


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
