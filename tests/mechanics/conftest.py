"""Models small enough to be solved by other means, and one engine for them all."""

from collections.abc import Callable, Mapping

import pytest

from crashkit.mechanics import Engine, LawFunction, Simulator, compile_engine
from crashkit.model import Body, Joint, Model, Parameter
from crashkit_spring_laws import SPRING_LAWS

SIZES = {"piecewise_affine": (3, 3), "smooth_table": (4,), "rate_table": (4,)}
PLATEAU = {
    "elastic_stiffness": 1.2,
    "crush_force": 0.24,
    "densification_deformation": 0.6,
    "densification_stiffness": 1.2,
}
"""The paper's first spring."""


@pytest.fixture(scope="session")
def laws():
    return {law.name: law for law in SPRING_LAWS}


@pytest.fixture(scope="session")
def engine(laws) -> Engine:
    return compile_engine(LawFunction(law, SIZES.get(name, ())) for name, law in laws.items())


@pytest.fixture(scope="session")
def simulator(laws, engine) -> Callable[[Model], Simulator]:
    return lambda model: Simulator(model, laws, engine)


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


def _parameter(value):
    if isinstance(value, Parameter):
        return value
    if isinstance(value, list):
        return tuple(Parameter(entry) for entry in value)
    return Parameter(value)
