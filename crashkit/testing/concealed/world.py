"""The world that the recordings come from: masses on a line, followed with fixed steps of the classical Runge-Kutta method.

It shares nothing with the engine: no code, no law, no scheme. Kinks are passed over with a step far below every time scale,
and not looked for.
"""

import math
from typing import Any

import numpy as np
from attrs import define, field, frozen

from crashkit.testing.concealed.kernel import follow
from crashkit.testing.concealed.kinds import NUMBERS, Kind

STEP = 1e-5
"""s, also between two stored states."""
MOST_CORNERS = 6


@frozen
class Term:
    """One term of a joint's force; `driver` is the joint whose deformation it depends on, where that is another one."""

    kind: Kind
    numbers: tuple[float, ...]
    driver: str = ""


@define
class Body:
    """A point mass on the line.

    Arguments:
        position: m at t = 0.
        mass: kg; infinite for what never moves.
        moves: whether it has the speed of the test at t = 0.
    """

    position: float
    mass: float = math.inf
    moves: bool = True


@define
class Joint:
    """What acts between two bodies.

    Arguments:
        front, back: names of the bodies.
        law: name of the spring law in the given model; "" for what that model does not have.
        parameters: of that law, as in the model file.
        terms: the secrets.
        one_way: whether the whole force never pulls.
    """

    front: str
    back: str
    law: str = ""
    parameters: dict[str, Any] = field(factory=dict)
    terms: list[Term] = field(factory=list)
    one_way: bool = False

    def corners(self) -> np.ndarray:
        """(corner, 2): deformation (m) and force (N) of the curve of first loading."""
        if self.law == "crush_plateau":
            force = self.parameters["crush_force"]
            elastic = force / self.parameters["elastic_stiffness"]
            return np.array([[elastic, force], [max(elastic, self.parameters["densification_deformation"]), force]])
        if self.law == "piecewise_affine":
            return np.column_stack([self.parameters["deformation"], self.parameters["force"]])
        return np.zeros((0, 2))

    def slope(self) -> float:
        """N/m after the last corner."""
        return float(self.parameters.get("densification_stiffness", self.parameters.get("final_stiffness", 0.0)))

    def level(self) -> float:
        """A typical force of the curve, N."""
        return float(self.corners()[:, 1].mean())

    def elastic_limit(self) -> float:
        """m, the first corner."""
        return float(self.corners()[0, 0])


@define
class World:
    """Bodies and joints by name."""

    bodies: dict[str, Body]
    joints: dict[str, Joint]

    def length(self, joint: Joint) -> float:
        """Undeformed length of a joint, m; negative where its back is behind its front."""
        return self.bodies[joint.back].position - self.bodies[joint.front].position


@frozen
class Motion:
    """What really happened in one run of a world: time (time,) s; by body position m, velocity m s-1, acceleration m s-2; by
    joint deformation m, force N, compression positive."""

    world: World
    time: np.ndarray
    position: dict[str, np.ndarray]
    velocity: dict[str, np.ndarray]
    acceleration: dict[str, np.ndarray]
    deformation: dict[str, np.ndarray]
    force: dict[str, np.ndarray]

    def contact(self, body: str) -> np.ndarray:
        """N, (time,): what a body receives from the joints that it is the front of."""
        total = np.zeros(len(self.time))
        for name, joint in self.world.joints.items():
            if joint.front == body:
                total -= np.sign(self.world.length(joint)) * self.force[name]
        return total


_JOINT = np.dtype(
    [
        ("front", "i8"),
        ("back", "i8"),
        ("first_term", "i8"),
        ("last_term", "i8"),
        ("corners", "i8"),
        ("one_way", "i8"),
        ("side", "f8"),
        ("length", "f8"),
        ("slope", "f8"),
        ("unloading", "f8"),
    ]
)
_TERM = np.dtype([("kind", "i8"), ("driver", "i8"), ("numbers", "f8", (NUMBERS,))])


def run(world: World, speed: float, duration: float, step: float = STEP) -> Motion:
    """Let the moving bodies arrive with `speed` (m s-1) at t = 0 and follow them for `duration` (s)."""
    joints, corners, terms = _tables(world)
    bodies = list(world.bodies.values())
    position = np.array([body.position for body in bodies])
    mobility = np.array([1.0 / body.mass for body in bodies])
    velocity = np.array([speed * body.moves for body in bodies])
    steps = int(round(duration / step)) + 1
    motion, force = follow(joints, corners, terms, mobility, position, velocity, steps, step)
    x, v, a = (dict(zip(world.bodies, part.T, strict=True)) for part in motion)
    deformation = {
        name: row["length"] - row["side"] * (x[joint.back] - x[joint.front])
        for row, (name, joint) in zip(joints, world.joints.items(), strict=True)
    }
    return Motion(world, np.arange(steps) * step, x, v, a, deformation, dict(zip(world.joints, force.T, strict=True)))


def _tables(world: World) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    joints = np.zeros(len(world.joints), _JOINT)
    corners = np.zeros((len(world.joints), MOST_CORNERS, 2))
    terms = np.zeros(sum(len(joint.terms) for joint in world.joints.values()), _TERM)
    index = {name: number for number, name in enumerate(world.bodies)}
    used = 0
    for number, joint in enumerate(world.joints.values()):
        curve, length = joint.corners(), world.length(joint)
        corners[number, : len(curve)] = curve
        for term in joint.terms:
            terms[used]["kind"], terms[used]["numbers"][: len(term.numbers)] = term.kind, term.numbers
            terms[used]["driver"] = list(world.joints).index(term.driver) if term.driver else number
            used += 1
        ends = (index[joint.front], index[joint.back], used - len(joint.terms), used, len(curve), joint.one_way)
        unloading = joint.parameters.get("unloading_stiffness", 0.0)
        joints[number] = (*ends, math.copysign(1.0, length), abs(length), joint.slope(), unloading)
    return joints, corners, terms
