"""What a finding adds in the direction of its joint, and what the recordings ask for there, where there are several axes."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.show.action import action_of
from crashkit.mechanics import Simulator
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import with_joint
from crashkit.protocols import Proposal
from crashkit.testing import toys

UP, INCLINED = (0.0, 1.0), (-0.6, 0.8)


def dropped(normal):
    """A box that falls along the normal of a pad, under gravity."""
    place, speed = (tuple((size * np.array(normal)).tolist()) for size in (0.5, -8.0))
    box = Body("box", place, speed, Parameter(200.0, fixed=True), inertia=(Parameter(20.0, fixed=True),))
    ground = Body("ground", (0.0, 0.0), (0.0, 0.0), fixed=True)
    return with_joint(Model("drop", ("x", "y"), (ground, box), (), gravity=(0.0, -9.81)), stop("pad", 2e5, 0.0, normal))


def stop(name, stiffness, begins, normal):
    numbers = {"stiffness": Parameter(stiffness), "stop_deformation": Parameter(begins, fixed=True)}
    return Joint(name, ("ground", "box"), "linear_stop", numbers, points=((0.0, 0.0), (0.0, 0.0)), normal=normal)


@pytest.fixture
def shown(workshop):
    """Of a pad that bottoms out, to instruments that record some axes."""

    def show(normal, axes) -> xr.Dataset:
        model = dropped(normal)
        true = with_joint(model, stop("bottom", 6e5, 0.1, normal))
        equipped = evolve(workshop, engine=None).equipped([true])
        motion = Simulator(true, equipped.laws, equipped.engine).run(np.linspace(0.0, 0.06, 301))
        run = toys.recording(motion.sel(axis=["x", "y"]))
        seen = {name: run[name].to_dataset(inherit=False).sel(axis=list(axes)) for name in ("film", "accelerometer")}
        without = equipped.first_misfit(model, {"run": run.assign({name: xr.DataTree(one) for name, one in seen.items()})})
        final = equipped.misfit(without, true)
        proposal = Proposal("bottoming", "line", {"joint": "pad"}, true, ("joint.bottom.stiffness",), {})
        return action_of(equipped, final, without, Rival(proposal, begin(equipped.identifier, final), 0.0, 0.0), ())["run"]

    return show


@pytest.mark.parametrize("normal", [UP, INCLINED])
def test_the_recordings_ask_for_what_is_missing_in_the_direction_of_the_joint(shown, normal):
    action = shown(normal, "xy")
    modelled, deformation = action["modelled_force"].values, action["deformation"].values
    assert modelled.max() > 3e4
    assert deformation.max() == pytest.approx(0.1 + modelled.max() / 6e5, rel=0.01)
    assert action["missing_force"].values == pytest.approx(modelled, abs=0.01 * modelled.max())


def test_what_no_instrument_saw_is_not_told(shown):
    action = shown(UP, "x")
    assert np.isnan(action["missing_force"]).all()
    assert float(action["modelled_force"].max()) > 3e4
