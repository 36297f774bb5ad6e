"""Models small enough to be solved by other means, and one engine for them all."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest
import xarray as xr

from crashkit.mechanics import Engine, LawFunction, Simulator, compile_engine
from crashkit.model import Body, GivenForce, GivenMotion, Joint, Model, Parameter
from crashkit_spring_laws import SPRING_LAWS

SIZES = {"piecewise_affine": (3, 3), "measured_curve": (4, 4)}
SEVERAL_AXES = ("crush_plateau", "viscous", "linear_stop", "tension_spring", "rate_linear", "brittle", "maxwell")
IN_LISTS = ("driven_curve",)
PLATEAU = {
    "elastic_stiffness": 1.2,
    "crush_force": 0.24,
    "densification_deformation": 0.6,
    "densification_stiffness": 1.2,
}
"""The paper's first spring."""
CRUSH = {
    "elastic_stiffness": 1e6,
    "crush_force": 5e4,
    "densification_deformation": 0.15,
    "densification_stiffness": 5e5,
    "unloading_stiffness": 3e6,
    "rate_coefficient": 0.01,
}
STOP = {"stiffness": 8e5, "stop_deformation": 0.05}


@pytest.fixture(scope="session")
def laws():
    return {law.name: law for law in SPRING_LAWS}


@pytest.fixture(scope="session")
def engine(laws) -> Engine:
    return compile_engine(
        function
        for name, law in laws.items()
        if not law.opaque
        for function in _functions(law, SIZES.get(name, tuple(4 for spec in law.parameters if spec.vector)))
    )


@pytest.fixture(scope="session")
def engines(laws, engine) -> Mapping[int, Engine]:
    """One for each number of axes: to compile it is what takes the time."""
    functions = [function for name in SEVERAL_AXES for function in _functions(laws[name], ())]
    functions += [function for name in IN_LISTS for function in _functions(laws[name], (4,))]
    return {1: engine, 2: compile_engine(functions, 2), 3: compile_engine(functions, 3)}


@pytest.fixture(scope="session")
def simulator(laws, engines) -> Callable[[Model], Simulator]:
    return lambda model: Simulator(model, laws, engines[len(model.axes)])


@pytest.fixture(scope="session")
def plateau() -> dict[str, float]:
    return dict(PLATEAU)


@pytest.fixture(scope="session")
def joint():
    def make(name: str, bodies: tuple[str, str], law: str, parameters: Mapping, **others) -> Joint:
        entries = {key: _parameter(value) for key, value in parameters.items()}
        return Joint(name, bodies, law, entries, **others)

    return make


@pytest.fixture(scope="session")
def against_wall(joint):
    """A mass that runs into a wall at x = 0 from x = -1, its spring at its free length unless told otherwise."""

    def make(law: str, parameters: Mapping, mass=1.0, speed=1.0, **others) -> Model:
        bodies = (Body("wall", (0.0,), (0.0,), fixed=True), Body("mass", (-1.0,), (speed,), Parameter(mass)))
        return Model("against the wall", ("x",), bodies, (joint("spring", ("wall", "mass"), law, parameters, **others),))

    return make


@pytest.fixture(scope="session")
def check_adjoint() -> Callable[..., None]:
    """Its gradient of a sum of all quantities, at random weights, is what the sensitivities give."""
    return _check_adjoint


def _check_adjoint(simulator, times, paths, step=1e-4, close=1e-12):
    motion = simulator.run(times, sensitivities=paths, step=step)
    random = np.random.default_rng(len(paths))
    names = [str(name).removesuffix("_sensitivity") for name in motion if str(name).endswith("_sensitivity")]
    weights = xr.Dataset({name: _random_weights(random, motion[f"{name}_sensitivity"]) for name in names})
    expected = sum((weights[name] * motion[f"{name}_sensitivity"]).sum(weights[name].dims) for name in names)
    found = simulator.adjoint(times, weights, parameters=paths, step=step)
    assert found["parameter"].values.tolist() == list(paths)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=close * np.abs(expected).max())


def _random_weights(random, sensitivity):
    """Such that no quantity outweighs the others."""
    scale = float(np.abs(sensitivity).max()) + 1.0
    return xr.DataArray(random.normal(size=sensitivity.shape[:-1]) / scale, dims=sensitivity.dims[:-1])


def _functions(law, sizes):
    parts = ("force", "memory_rate") if law.memory else ("force",)
    return [LawFunction(law, sizes, part) for part in parts]


def _parameter(value):
    if isinstance(value, Parameter):
        return value
    if isinstance(value, list):
        return tuple(Parameter(entry) for entry in value)
    return Parameter(value)


@pytest.fixture(scope="session")
def car() -> Callable[[int], Model]:
    """A model that has everything, in so many axes."""
    return _car


def _numbers(values):
    return {name: Parameter(value) for name, value in values.items()}


def _car(axes):
    """Two bodies against a wall, lines and a face, a table of two laws, gravity, a given force and an imposed motion."""

    def vector(*values):
        return (*values, 0.02, -0.03)[:axes]

    inertia = {1: (), 2: (20.0,), 3: (20.0, 25.0, 30.0)}[axes]
    other = {1: (), 2: (60.0,), 3: (60.0, 80.0, 90.0, 2.0, -3.0, 1.0)}[axes]
    zero = (0.0,) * axes
    force = GivenForce((0.0, 0.05), (zero, vector(2e4)))
    samples = tuple(np.linspace(0.0, 0.08, 9))
    shaking = GivenMotion(samples, tuple(vector(-2.4 + 0.01 * np.sin(50.0 * t)) for t in samples))
    bodies = (
        Body("wall", zero, zero, fixed=True),
        Body("front", vector(-0.6), vector(12.0), Parameter(200.0), inertia=tuple(map(Parameter, inertia))),
        Body("rear", vector(-1.5), vector(12.0), Parameter(600.0), inertia=tuple(map(Parameter, other)), force=force),
        Body("shaker", zero, zero, motion=shaking),
    )
    points = (vector(0.0), vector(0.1)), (vector(-0.2), vector(0.2))
    normal = (-1.0, *(0.0,) * (axes - 1)) if axes > 1 else None
    joints = (
        Joint("face", ("wall", "front"), "crush_plateau", _numbers(CRUSH), points=points[0], normal=normal),
        Joint("line", ("front", "rear"), "crush_plateau", _numbers(CRUSH), points=points[1]),
        Joint("stop", ("front", "rear"), "linear_stop", _numbers(STOP), factors=("rate_linear",), points=points[0]),
        Joint("tow", ("rear", "shaker"), "tension_spring", _numbers({"stiffness": 1e5}), free_length=Parameter(0.95)),
    )
    joints[2].parameters.update(_numbers({"rate_slope": 0.02}))
    return Model("adjoint", ("x", "y", "z")[:axes], bodies, joints, gravity=vector(0.5))
