"""The tables behind a diagnosis."""

import numpy as np
import pytest
import xarray as xr

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.show.action import action_of
from crashkit.misfit.units import units_of
from crashkit.model import Parameter
from crashkit.model.edit import with_instrument_error


def test_the_offset_of_a_load_cell_is_a_force(workshop, model, recorded, misfit):
    """And that of an accelerometer an acceleration, though both are called bias."""
    run = recorded(model)
    felt = run["accelerometer"].to_dataset(inherit=False)
    cell = felt.rename(acceleration="force", acceleration_std="force_std").assign_attrs(observer="load_cell")
    run = run.assign(plate=xr.DataTree(cell))
    for instrument in ("accelerometer", "plate"):
        model = with_instrument_error(model, instrument, "front_sensor", "bias", Parameter(0.0))
    units = units_of(model, workshop.laws, misfit(model, run=run).groups)
    assert units["instrument.plate.front_sensor.bias"] == "N"
    assert units["instrument.accelerometer.front_sensor.bias"] == "m s-2"


def test_a_force_on_a_body_that_has_a_mount_is_shown(workshop, model, simulated, recorded, misfit):
    """Friction on the ground, 2 kN: the joint to the wall has no part in it."""
    run = recorded(model)
    friction = next(iter(workshop.hypotheses["ground_friction"]().propose(model, [simulated(model)], [run])))
    rubbed = friction.model.with_values({"joint.front_ground_friction.friction_force": 2e3})
    equipped, without = workshop.equipped([rubbed]), misfit(model, run=run)
    final = equipped.misfit(without, rubbed)
    rival = Rival(friction, begin(equipped.identifier, final), drop=0.0, evidence=0.0)
    (shown,) = action_of(equipped, final, without, rival, ()).values()
    assert float(np.abs(shown["modelled_force"]).max()) == pytest.approx(2e3, rel=0.01)


def test_an_obstacle_that_gives_way_has_no_force_to_be_shown(workshop, model, simulated, recorded, misfit):
    """Though friction, found before, has brought another fixed body: nothing tells how the obstacle moves."""
    run = recorded(model)
    proposed = [
        workshop.hypotheses[name]().propose(model, [simulated(model)], [run])
        for name in ("ground_friction", "obstacle_motion")
    ]
    rubbed, moved = (proposals[0] for proposals in proposed)
    given = misfit(model, run=run)
    without = workshop.equipped([rubbed.model]).misfit(given, rubbed.model)
    rival = Rival(moved, begin(workshop.identifier, given), drop=0.0, evidence=0.0)
    assert action_of(workshop, without, without, rival, ()) == {}
