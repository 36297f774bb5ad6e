"""The state form against the engine: the same accelerations along its motion, and its derivatives against differences."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.api import load_model
from crashkit.errors import CrashkitError
from crashkit.mechanics import Simulator
from crashkit.mechanics.state_form import StateForm, state_form
from crashkit.model import GivenForce, Parameter
from crashkit.model.edit import with_factor
from crashkit.registry import load
from crashkit.testing import toys

ROUNDING = 1e-9


@pytest.fixture(scope="module")
def laws():
    return load().spring_laws


def simulated(model, laws, duration=0.4, count=401):
    return Simulator(model, laws).run(np.linspace(0.0, duration, count))


def known_thresholds(model):
    """The model with its thresholds and masses fixed."""
    held = {p: q for p, q in model.free_parameters().items() if "deformation" in p or "mass" in p}
    return model.with_parameters({path: evolve(parameter, fixed=True) for path, parameter in held.items()})


def test_along_a_simulated_motion_the_accelerations_are_those_simulated(laws):
    model = toys.two_degrees(1.5, toys.REAR_MASS_INVERTED)
    motion = simulated(model, laws)
    form = state_form(model, laws, motion)
    np.testing.assert_allclose(form["acceleration"], motion["acceleration"], atol=ROUNDING)


def test_with_known_thresholds_and_masses_the_equations_are_linear_in_all_parameters(laws):
    model = known_thresholds(toys.two_degrees(1.5, toys.REAR_MASS_INVERTED))
    motion = simulated(model, laws)
    form = state_form(model, laws, motion)
    assert form["linear"].values.all()
    np.testing.assert_allclose(form["given"], 0.0, atol=ROUNDING)
    measured = motion["acceleration"].values.reshape(-1)
    solved = np.linalg.lstsq(form["matrix"].values.reshape(len(measured), -1), measured)[0]
    truth = [parameter.value for parameter in model.free_parameters().values()]
    assert solved == pytest.approx(truth, rel=1e-9)


def test_a_threshold_multiplies_a_slope_and_is_not_linear(laws):
    model = toys.one_degree(1.5)
    linear = state_form(model, laws, simulated(model, laws))["linear"]
    told = dict(zip(linear["parameter"].values, linear.values, strict=True))
    assert told == {
        "joint.first.elastic_stiffness": True,
        "joint.first.crush_force": True,
        "joint.first.densification_deformation": False,
        "joint.first.densification_stiffness": False,
    }


def test_the_joints_share_one_sequence_of_intervals(laws):
    model = toys.two_degrees(1.5, toys.REAR_MASS_INVERTED)
    form = state_form(model, laws, simulated(model, laws))
    number = form["interval_number"].values
    assert number[0] == 0 and set(np.diff(number)) <= {0, 1} and number[-1] == form.sizes["interval"] - 1
    changes = (form["branch"].diff("time") != 0).any("joint").sum()
    assert int(changes) == form.sizes["interval"] - 1
    assert set(form["crossing"].values[2:]) == {"first", "second"}
    for row in range(form.sizes["interval"]):
        span = form["time"].values[number == row]
        assert (span[0], span[-1]) == (form["start"].values[row], form["end"].values[row])


def everything_free(model):
    """The model with its masses, inertias and free lengths to be identified too."""
    freed = {path: Parameter(p.value, p.lower, p.upper) for path, p in model.parameters().items() if "body" in path}
    return model.with_parameters(freed)


def rated(model):
    """The model with a free length, and a force that rises with the rate."""
    joint = evolve(model.joints[0], free_length=Parameter(toys.LENGTH + 0.05))
    longer = evolve(model, joints=(joint, *model.joints[1:]))
    return with_factor(longer, joint.name, "rate_linear", {"rate_slope": Parameter(0.01)})


def remembering(model):
    """The model with a force that fades in its first joint and bristles in the second: laws with a memory."""
    first, second = model.joints
    fading = {"fresh_share": Parameter(0.8), "relaxation_time": Parameter(0.02), "holds": Parameter(1.0, fixed=True)}
    bristles = {"friction_force": Parameter(3e4), "bristle_length": Parameter(0.02)}
    first = evolve(first, law=f"{first.law} ~ quasi_linear", parameters={**first.parameters, **fading})
    second = evolve(second, law="dahl", parameters=bristles)
    return evolve(model, joints=(first, second))


MODELS = {
    "line": lambda checkout: everything_free(rated(toys.two_degrees(1.5))),
    "memory": lambda checkout: everything_free(remembering(rated(toys.two_degrees(1.5)))),
    "plane": lambda checkout: everything_free(load_model(checkout / "docs/examples/obstacles/movable_barrier.toml")),
    "faces": lambda checkout: everything_free(load_model(checkout / "docs/examples/figure-3/oblique.toml")),
    "space": lambda checkout: everything_free(load_model(checkout / "docs/examples/drop/corner_drop.toml")),
}


@pytest.fixture(scope="module", params=MODELS)
def model(request):
    return MODELS[request.param](request.config.rootpath)


def test_in_any_axes_the_accelerations_are_those_simulated(model, laws):
    motion = simulated(model, laws, 0.03, 601)
    form = state_form(model, laws, motion)
    for name in ("acceleration", "angular_acceleration"):
        if name in motion:
            size = float(abs(motion[name]).max())
            # The largest deformation is known to the sampling of the motion only.
            np.testing.assert_allclose(form[name], motion[name], atol=1e-3 * size)


def test_its_derivatives_are_those_of_differences(model, laws):
    form = StateForm(model, laws, simulated(model, laws, 0.03, 13))
    values = {path: parameter.value for path, parameter in model.parameters().items()}
    modes = form.modes(values)
    _, matrix = form.at(values, modes)
    for column, path in enumerate(form.paths):
        step = 1e-5 * max(abs(values[path]), 1e-3)
        ahead, behind = (form.at({**values, path: values[path] + side * step}, modes)[0] for side in (1.0, -1.0))
        difference = (ahead - behind) / (2.0 * step)
        np.testing.assert_allclose(matrix[..., column], difference, rtol=1e-5, atol=1e-7 * np.abs(difference).max() + 1e-12)


def test_motions_end_to_end_are_each_told_as_alone(model, laws):
    """Where time goes back, another one begins: without memory, and with no deformation before."""
    long, short = simulated(model, laws, 0.03, 61), simulated(model, laws, 0.02, 21)
    both = xr.concat([long, short], "time", data_vars="minimal")
    forms = [StateForm(model, laws, motion) for motion in (both, long, short)]
    values = {path: parameter.value for path, parameter in model.parameters().items()}
    modes = [form.modes(values) for form in forms]
    together, first, second = (form.at(values, taken) for form, taken in zip(forms, modes, strict=True))
    for one, *alone in zip(together, first, second, strict=True):
        np.testing.assert_allclose(one, np.concatenate(alone), rtol=1e-12)


def test_a_given_force_accelerates_too(laws):
    model = toys.one_degree()
    pushed = evolve(model.bodies[1], force=GivenForce((0.0, 0.2), ((0.0,), (5000.0,))))
    model = evolve(model, bodies=(model.bodies[0], pushed), gravity=(-9.81,))
    motion = simulated(model, laws)
    np.testing.assert_allclose(state_form(model, laws, motion)["acceleration"], motion["acceleration"], atol=1e-6)


def test_what_no_force_moves_is_not_accelerated(laws):
    form = state_form(toys.one_degree(), laws, simulated(toys.one_degree(), laws))
    assert not form["acceleration"].sel(body="wall").values.any()
    assert not form["matrix"].sel(body="wall").values.any()


def test_a_law_that_is_not_installed_is_named(laws):
    model = toys.one_degree()
    other = evolve(model, joints=(evolve(model.joints[0], law="rubber"),))
    with pytest.raises(CrashkitError, match=r'^joint first: expected one of the installed laws.* found "rubber"'):
        state_form(other, laws, simulated(model, laws))
