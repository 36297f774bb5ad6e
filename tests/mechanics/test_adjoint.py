"""The adjoint: the transpose of the forward sensitivities, in every geometry and to every kind of parameter."""

import numpy as np
import pytest
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit.mechanics import Simulator
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.protocols import ParameterSpec, SpringLaw

TIMES = np.linspace(0.0, 0.08, 33)


def every_path(model, axes):
    index = [""] if axes == 1 else [f"[{i}]" for i in range(axes)]
    spin = {1: [], 2: [""], 3: ["[0]", "[1]", "[2]"]}[axes]
    yield from (path for path, entry in model.parameters().items() if entry.value)
    for body in ("wall", "front", "rear"):
        yield from (f"body.{body}.{name}{i}" for name in ("position", "velocity") for i in index)
        yield from (f"body.{body}.{name}{i}" for name in ("rotation", "angular_velocity") for i in spin)
    yield from (f"joint.{joint}.points[{end}]{i}" for joint in ("face", "line", "stop") for end in (0, 1) for i in index)


def random_weights(random, sensitivity):
    """Such that no quantity outweighs the others."""
    scale = float(np.abs(sensitivity).max()) + 1.0
    return xr.DataArray(random.normal(size=sensitivity.shape[:-1]) / scale, dims=sensitivity.dims[:-1])


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_it_is_the_transpose_of_the_sensitivities(simulator, car, axes):
    model = car(axes)
    own, paths = simulator(model), list(every_path(model, axes))
    motion = own.run(TIMES, sensitivities=paths)
    random = np.random.default_rng(axes)
    names = [str(name).removesuffix("_sensitivity") for name in motion if str(name).endswith("_sensitivity")]
    weights = xr.Dataset({name: random_weights(random, motion[f"{name}_sensitivity"]) for name in names})
    expected = sum((weights[name] * motion[f"{name}_sensitivity"]).sum(weights[name].dims) for name in names)
    found = own.adjoint(TIMES, weights, parameters=paths)
    assert found["parameter"].values.tolist() == paths
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12 * np.abs(expected).max())


def test_the_gradient_of_a_misfit_agrees_with_differences(simulator, car):
    """Of the sum of squares of the front's displacement, to all of the model's free parameters."""
    own = simulator(car(1))
    motion = own.run(TIMES)
    gradient = own.adjoint(TIMES, motion[["position"]] * 2.0)
    for path in ("joint.face.crush_force", "joint.line.elastic_stiffness", "joint.stop.stop_deformation", "body.rear.mass"):
        value = own.model.parameters()[path].value
        above, below = (float((own.run(TIMES, {path: value * (1.0 + h)})["position"] ** 2).sum()) for h in (1e-5, -1e-5))
        assert float(gradient.sel(parameter=path)) == pytest.approx((above - below) / (2e-5 * value), rel=1e-6), path


def test_a_quantity_that_a_motion_does_not_have(simulator, car):
    own = simulator(car(1))
    weights = own.run(TIMES)[["position"]].rename(position="colour")
    with pytest.raises(CrashkitError, match="expected weights of deformation.*, found colour"):
        own.adjoint(TIMES, weights)


class Broken(SpringLaw):
    """Loses all its force."""

    name = "broken"
    jumps = True
    parameters = (ParameterSpec("limit", "m", "where it breaks"),)

    @staticmethod
    def force(d: float, ddot: float, d_max: float, limit: float) -> float:
        """The force."""
        return 0.0 if d_max > limit else 1e5 * d


def test_a_law_that_jumps_is_refused():
    bodies = (Body("wall", (0.0,), (0.0,), fixed=True), Body("mass", (-1.0,), (5.0,), Parameter(100.0)))
    model = Model("jump", ("x",), bodies, (Joint("j", ("wall", "mass"), "broken", {"limit": Parameter(0.1)}),))
    simulator = Simulator(model, {"broken": Broken})
    with pytest.raises(CrashkitError, match="expected laws whose force does not jump, found broken: use sensitivities"):
        simulator.adjoint(TIMES, simulator.run(TIMES)[["position"]])
