"""The models that are measured: the paper's, a car of three bodies in one axis, the car of its figure 3 in the plane."""

from pathlib import Path

import numpy as np
from attrs import frozen

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.toml import read_model
from crashkit.testing.toys import one_degree, two_degrees
from crashkit_spring_laws import CrushPlateau

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples" / "figure-3"
LAWS = {CrushPlateau.name: CrushPlateau}
ALPHA, DELTA, GAMMA, BETA, UNLOADING, RATE = (
    "elastic_stiffness",
    "crush_force",
    "densification_deformation",
    "densification_stiffness",
    "unloading_stiffness",
    "rate_coefficient",
)


@frozen
class Case:
    """A model, and how it is run.

    Arguments:
        name: of the case.
        model: in one axis or in the plane.
        end: s.
        step: s, longest step of the integration; what is recorded is as far apart.
        paths: ten parameters, of the model of one degree six, to which derivatives are taken: slopes, thresholds, masses.
    """

    name: str
    model: Model
    end: float
    step: float
    paths: tuple[str, ...]

    @property
    def times(self) -> np.ndarray:
        """The times that are recorded."""
        return np.linspace(0.0, self.end, 1 + round(self.end / self.step))


def cases() -> list[Case]:
    """All of them, the smallest first."""
    first = tuple(f"joint.first.{name}" for name in (ALPHA, DELTA, GAMMA, BETA))
    second = tuple(f"joint.second.{name}" for name in (ALPHA, DELTA, GAMMA, BETA))
    return [
        Case("one degree", one_degree(), 0.4, 1e-3, (*first, "body.front.mass", "body.front.velocity")),
        Case("two degrees", two_degrees(), 0.4, 1e-3, (*first, *second, "body.rear.mass", "body.front.velocity")),
        Case("three-body car", three_body_car(), 0.12, 1e-4, _of_car("bumper", "rail", "compartment", "engine")),
        *(_plane(name) for name in ("orthogonal", "oblique")),
    ]


def three_body_car() -> Model:
    """Crossmember, engine and compartment in a row; six springs that buckle, unload and reload along slopes of their own."""
    bodies = (
        Body("barrier", (0.0,), (0.0,), fixed=True),
        _body("crossmember", 60.0, -0.2),
        _body("engine", 290.0, -0.8),
        _body("compartment", 900.0, -2.0),
    )
    joints = (
        _joint("bumper", "barrier", "crossmember", 1.5e6, 6.0e4, 0.12, 2.0e6),
        _joint("rail", "crossmember", "compartment", 1.6e6, 1.1e5, 0.6, 1.2e6),
        _joint("radiator", "crossmember", "engine", 4.0e5, 2.0e4, 0.2, 1.5e6, clearance=0.08),
        _joint("mount", "engine", "compartment", 5.0e5, 5.0e4, 0.1, 3.0e6, tension=1.0),
        _joint("subframe", "crossmember", "engine", 8.0e5, 4.0e4, 0.3, 1.5e6, tension=1.0),
        _joint("firewall", "engine", "compartment", 1.5e6, 8.0e4, 0.15, 3.0e6, clearance=0.12),
    )
    return Model("three-body car", ("x",), bodies, joints)


def _plane(name: str) -> Case:
    """Four bodies and 14 springs."""
    model = read_model(EXAMPLES / f"{name}.toml", LAWS)
    return Case(f"figure 3, {name}", model, 0.08, 1e-4, _of_car("bumper_left", "rail_left", "compartment", "engine"))


def _of_car(bumper: str, rail: str, heavy: str, light: str) -> tuple[str, ...]:
    """Ten parameters that the motion sees."""
    of_joints = [f"joint.{joint}.{name}" for joint in (bumper, rail) for name in (ALPHA, DELTA, UNLOADING, RATE)]
    return (*of_joints, f"joint.{bumper}.{GAMMA}", f"body.{light}.mass")


def _body(name: str, mass: float, position: float) -> Body:
    return Body(name, (position,), (15.6,), Parameter(mass))


def _joint(
    name: str,
    first: str,
    second: str,
    stiffness: float,
    force: float,
    end: float,
    dense: float,
    clearance: float = 0.0,
    tension: float = 0.0,
) -> Joint:
    values = {
        ALPHA: stiffness,
        DELTA: force,
        GAMMA: end,
        BETA: dense,
        UNLOADING: 4.0 * stiffness,
        RATE: 0.02,
        "clearance": clearance,
        "tension": tension,
    }
    return Joint(name, (first, second), CrushPlateau.name, {key: Parameter(value) for key, value in values.items()})
