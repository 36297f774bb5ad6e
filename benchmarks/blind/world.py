"""The world that the recordings come from: masses on a line, followed with fixed steps of the classical Runge-Kutta method.

It shares nothing with the engine of crashkit: no code, no law, no scheme. Kinks are passed over with a step far below every
time scale, and not looked for.
"""

import copy
import math
from typing import Any

import numba
import numpy as np
from attrs import define, field, frozen

from benchmarks.blind.forces import NUMBERS, Kind, link_force

STEP = 1e-5
"""s, also between two stored states."""
MOST_CORNERS = 6


@frozen
class Term:
    """One term of a link's force."""

    kind: Kind
    numbers: tuple[float, ...]


@define
class Body:
    """A point mass on the line.

    Arguments:
        place: m at t = 0.
        mass: kg; infinite for what never moves.
        moves: whether it has the speed of the test at t = 0.
    """

    place: float
    mass: float = math.inf
    moves: bool = True


@define
class Link:
    """What acts between two bodies.

    Arguments:
        front, back: names of the bodies.
        law: name of the spring law in the public model; "" for what that model does not have.
        numbers: of that law, as in the model file.
        terms: the secrets.
        one_way: whether the whole force never pulls.
    """

    front: str
    back: str
    law: str = ""
    numbers: dict[str, Any] = field(factory=dict)
    terms: list[Term] = field(factory=list)
    one_way: bool = False

    def corners(self) -> np.ndarray:
        """(corner, 2): deformation (m) and force (N) of the curve of first loading."""
        if self.law == "crush_plateau":
            force = self.numbers["crush_force"]
            elastic = force / self.numbers["elastic_stiffness"]
            return np.array([[elastic, force], [max(elastic, self.numbers["densification_deformation"]), force]])
        if self.law == "piecewise_affine":
            return np.column_stack([self.numbers["deformation"], self.numbers["force"]])
        return np.zeros((0, 2))

    def slope(self) -> float:
        """N/m after the last corner."""
        return float(self.numbers.get("densification_stiffness", self.numbers.get("final_stiffness", 0.0)))

    def level(self) -> float:
        """A typical force of the curve, N."""
        return float(self.corners()[:, 1].mean())

    def elastic_limit(self) -> float:
        """m, the first corner."""
        return float(self.corners()[0, 0])


@define
class World:
    """Bodies and links by name."""

    bodies: dict[str, Body]
    links: dict[str, Link]

    def copy(self) -> "World":
        """A copy that can be changed on its own."""
        return copy.deepcopy(self)


@frozen
class Trace:
    """What really happened in one run: time (time,) s; by body position m, velocity m s-1, acceleration m s-2; by link
    deformation m, force N, compression positive."""

    time: np.ndarray
    position: dict[str, np.ndarray]
    velocity: dict[str, np.ndarray]
    acceleration: dict[str, np.ndarray]
    deformation: dict[str, np.ndarray]
    force: dict[str, np.ndarray]


_LINK = np.dtype(
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
_TERM = np.dtype([("kind", "i8"), ("numbers", "f8", (NUMBERS,))])


def run(world: World, speed: float, duration: float, step: float = STEP) -> Trace:
    """Let the moving bodies arrive with `speed` (m s-1) at t = 0 and follow them for `duration` (s)."""
    links, corners, terms = _tables(world)
    bodies = list(world.bodies.values())
    place = np.array([body.place for body in bodies])
    mobility = np.array([1.0 / body.mass for body in bodies])
    start = np.array([speed * body.moves for body in bodies])
    steps = int(round(duration / step)) + 1
    motion, force = _follow(links, corners, terms, mobility, place, start, steps, step)
    position, velocity, acceleration = (dict(zip(world.bodies, part.T, strict=True)) for part in motion)
    deformation = {
        name: row["length"] - row["side"] * (position[link.back] - position[link.front])
        for row, (name, link) in zip(links, world.links.items(), strict=True)
    }
    return Trace(
        np.arange(steps) * step, position, velocity, acceleration, deformation, dict(zip(world.links, force.T, strict=True))
    )


def _tables(world: World) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    links = np.zeros(len(world.links), _LINK)
    corners = np.zeros((len(world.links), MOST_CORNERS, 2))
    terms = np.zeros(sum(len(link.terms) for link in world.links.values()), _TERM)
    index = {name: number for number, name in enumerate(world.bodies)}
    used = 0
    for number, link in enumerate(world.links.values()):
        curve, away = link.corners(), world.bodies[link.back].place - world.bodies[link.front].place
        corners[number, : len(curve)] = curve
        for term in link.terms:
            terms[used]["kind"], terms[used]["numbers"][: len(term.numbers)] = term.kind, term.numbers
            used += 1
        ends = (index[link.front], index[link.back], used - len(link.terms), used, len(curve), link.one_way)
        unloading = link.numbers.get("unloading_stiffness", 0.0)
        links[number] = (*ends, math.copysign(1.0, away), abs(away), link.slope(), unloading)
    return links, corners, terms


@numba.njit(cache=True)
def _rates(
    links: Any,
    corners: np.ndarray,
    terms: Any,
    mobility: np.ndarray,
    x: np.ndarray,
    v: np.ndarray,
    hidden: np.ndarray,
    d_max: np.ndarray,
    time: float,
    acceleration: np.ndarray,
    change: np.ndarray,
    force: np.ndarray,
) -> None:
    """Accelerations, rates of the hidden states and forces at one instant."""
    acceleration[:] = 0.0
    for j in range(len(links)):
        link = links[j]
        d = link.length - link.side * (x[link.back] - x[link.front])
        rate = -link.side * (v[link.back] - v[link.front])
        curve = corners[j, : link.corners]
        force[j] = link_force(link, curve, terms, hidden, change, d, rate, max(d_max[j], d), time)
        acceleration[link.front] -= link.side * force[j]
        acceleration[link.back] += link.side * force[j]
    for i in range(len(mobility)):
        acceleration[i] *= mobility[i]


@numba.njit(cache=True)
def _follow(
    links: Any,
    corners: np.ndarray,
    terms: Any,
    mobility: np.ndarray,
    place: np.ndarray,
    start: np.ndarray,
    steps: int,
    h: float,
) -> tuple[np.ndarray, np.ndarray]:
    """(3, time, body): positions, velocities, accelerations; (time, link): forces."""
    bodies, states = len(mobility), len(terms)
    motion, forces = np.empty((3, steps, bodies)), np.empty((steps, len(links)))
    x, v, z, d_max = place.copy(), start.copy(), np.zeros(states), np.zeros(len(links))
    a, dz, unused = np.zeros((4, bodies)), np.zeros((4, states)), np.zeros(len(links))
    xs, vs, zs = np.empty((3, bodies)), np.empty((3, bodies)), np.empty((3, states))
    for n in range(steps):
        time = n * h
        _rates(links, corners, terms, mobility, x, v, z, d_max, time, a[0], dz[0], forces[n])
        motion[0, n], motion[1, n], motion[2, n] = x, v, a[0]
        for stage in range(3):
            part = h if stage == 2 else 0.5 * h
            for i in range(bodies):
                xs[stage, i] = x[i] + part * (v[i] if stage == 0 else vs[stage - 1, i])
                vs[stage, i] = v[i] + part * a[stage, i]
            for i in range(states):
                zs[stage, i] = z[i] + part * dz[stage, i]
            y = xs[stage], vs[stage], zs[stage]
            _rates(links, corners, terms, mobility, *y, d_max, time + part, a[stage + 1], dz[stage + 1], unused)
        for i in range(bodies):
            x[i] += h / 6.0 * (v[i] + 2.0 * vs[0, i] + 2.0 * vs[1, i] + vs[2, i])
            v[i] += h / 6.0 * (a[0, i] + 2.0 * a[1, i] + 2.0 * a[2, i] + a[3, i])
        for i in range(states):
            z[i] += h / 6.0 * (dz[0, i] + 2.0 * dz[1, i] + 2.0 * dz[2, i] + dz[3, i])
        for j in range(len(links)):
            link = links[j]
            d_max[j] = max(d_max[j], link.length - link.side * (x[link.back] - x[link.front]))
    return motion, forces
