"""Random vehicles: one to four bodies in a chain or branched, what can stop them, and the instruments that watch."""

import copy
from functools import partial

import numpy as np
from attrs import define

from benchmarks.blind.instruments import MARGIN, Instrument, Sensor, read
from benchmarks.blind.world import STEP, Body, Link, Trace, World, run

TAIL = MARGIN + 0.015
"""s followed beyond the recording, for filters and clocks."""

_NAMES = {
    "car": (("engine", "cabin", "boot", "trailer"), ("cradle", "floor", "tank", "bed"), ("beam", "cell", "axle", "tail")),
    "drop": (("foot", "frame", "tray", "lid"), ("sole", "shell", "board", "pack"), ("bell", "stem", "arm", "head")),
}
_OBSTACLES = {"car": ("wall", "barrier", "pole"), "drop": ("floor_plate", "anvil", "table")}
_LINKS = ("spar", "strut", "rail", "box", "pad", "bush", "bracket", "rib", "sleeve", "foam", "column", "cone")


@define
class Scene:
    """A vehicle before a set of tests, with every secret that was put into it.

    Arguments:
        obstacle: name of the body that is hit.
        bodies: names of the public moving bodies.
        world: bodies and links as they really are.
        instruments: by the name of their group.
        speeds: m s-1 of the runs, the held-out one last.
        duration: s.
    """

    obstacle: str
    bodies: list[str]
    world: World
    instruments: dict[str, Instrument]
    speeds: list[float]
    duration: float

    def copy(self) -> "Scene":
        """A copy that can be changed on its own."""
        return copy.deepcopy(self)

    @property
    def public(self) -> list[str]:
        """Names of the links that the model has."""
        return [name for name, link in self.world.links.items() if link.law]

    def traces(self, runs: slice = slice(0, -1), step: float = STEP) -> list[Trace]:
        """What happens in some of the runs; by default in those that are fitted."""
        return [run(self.world, speed, self.duration + TAIL, step) for speed in self.speeds[runs]]

    def contact(self, trace: Trace) -> np.ndarray:
        """N, what the obstacle receives from all but the ground that it stands on."""
        total = np.zeros(len(trace.time))
        for name, link in self.world.links.items():
            if link.front == self.obstacle:
                total -= np.sign(self.world.bodies[link.back].place - self.world.bodies[link.front].place) * trace.force[name]
        return total

    def signals(self, traces: list[Trace]) -> np.ndarray:
        """Every sample without noise, in units of the noise before the filter.

        A filter passes the same share of a slow signal's and of the noise's independent samples, so a sum of squares of
        these counts independent samples only.
        """
        columns = [
            read(instrument, sensor, trace, contact, self.duration, None) / sensor.noise
            for trace, contact in ((trace, self.contact(trace)) for trace in traces)
            for instrument in self.instruments.values()
            for sensor in instrument.sensors.values()
        ]
        return np.concatenate(columns)


@define
class Scale:
    """Orders of magnitude of a kind of test: total mass kg, speed m s-1, crush m, film Hz and m."""

    mass: tuple[float, float]
    speed: tuple[float, float]
    crush: tuple[float, float]
    film: tuple[float, ...]
    reading: tuple[float, float]


_SCALES = {
    "car": Scale((250.0, 2500.0), (8.0, 15.0), (0.3, 0.7), (500.0, 1000.0, 2000.0), (0.5e-3, 2e-3)),
    "drop": Scale((2.0, 80.0), (3.0, 7.0), (0.03, 0.12), (2000.0, 4000.0), (0.1e-3, 0.3e-3)),
}


def draw_scene(rng: np.random.Generator, wall: bool = False, complete: bool = False) -> Scene:
    """A random vehicle; `wall`: with a load cell for certain; `complete`: film and accelerometers on every body."""
    kind = "car" if rng.random() < 0.75 else "drop"
    scale, number = _SCALES[kind], int(rng.choice([1, 2, 3, 4], p=[0.2, 0.4, 0.28, 0.12]))
    crush, middle = rng.uniform(*scale.crush), rng.uniform(*scale.speed)
    obstacle, bodies = str(rng.choice(_OBSTACLES[kind])), list(_NAMES[kind][rng.integers(3)][:number])
    world = World({obstacle: Body(0.0, moves=False)}, {})
    parents = [obstacle]
    for index, body in enumerate(bodies):
        parents += (
            [bodies[index - 1] if index and rng.random() < 0.7 else str(rng.choice(list(world.bodies)))] if index else []
        )
        place = world.bodies[parents[index]].place - rng.uniform(1.6, 2.4) * crush
        world.bodies[body] = Body(round(place, 3), float(f"{_mass(rng, scale, number):.3g}"))
    _join(rng, world, bodies, parents, crush, middle**2 / (2.0 * crush))
    factors = (rng.uniform(0.6, 0.75), 1.0, rng.uniform(1.2, 1.3), rng.uniform(1.38, 1.5))
    speeds = [round(middle * factor, 1) for factor in factors]
    if not complete:
        del speeds[: int(rng.choice([0, 1, 2], p=[0.8, 0.12, 0.08]))]
    duration = round(float(rng.uniform(1.7, 2.4)) * 2.0 * crush / middle, 3)
    instruments = _instruments(rng, scale, world, obstacle, bodies, middle**2 / (2.0 * crush), wall, complete)
    return Scene(obstacle, bodies, world, instruments, speeds, duration)


def _mass(rng: np.random.Generator, scale: Scale, number: int) -> float:
    total = np.exp(rng.uniform(*np.log(scale.mass)))
    return float(total / number * np.exp(rng.uniform(-0.7, 0.7)))


def _join(
    rng: np.random.Generator, world: World, bodies: list[str], parents: list[str], crush: float, deceleration: float
) -> None:
    """From the rear to the front: each link carries its share of what is behind it."""
    obstacle, names = parents[0], [str(name) for name in rng.permutation(_LINKS)]
    load = {body: world.bodies[body].mass * deceleration for body in bodies}
    links = {}
    for body, parent in reversed(list(zip(bodies, parents, strict=True))):
        share = 1.0
        if parent != obstacle:
            share = float(rng.uniform(0.2, 0.5)) if rng.random() < 0.4 else 1.0
            load[parent] += share * load[body]
            links[names.pop()] = _link(rng, parent, body, share * load[body], crush * rng.uniform(0.15, 0.4))
        if parent == obstacle or share < 1.0:
            rest = 1.0 if parent == obstacle else 1.0 - share
            links[names.pop()] = _link(rng, obstacle, body, rest * load[body], crush)
    world.links.update(reversed(links.items()))


def _link(rng: np.random.Generator, front: str, back: str, force: float, crush: float) -> Link:
    force *= rng.uniform(0.85, 1.15)
    elastic, stiff = crush * rng.uniform(0.08, 0.25), rng.uniform(3.0, 8.0)
    make = partial(Link, front, back)
    if rng.random() < 0.75:
        numbers = {
            "elastic_stiffness": force / elastic,
            "crush_force": force,
            "densification_deformation": crush * rng.uniform(0.6, 1.0),
            "densification_stiffness": force / elastic * rng.uniform(0.4, 1.2),
            "unloading_stiffness": force / elastic * stiff,
        }
        return make("crush_plateau", numbers)
    places = [elastic, *(crush * np.sort(rng.uniform(0.3, 1.0, int(rng.integers(1, 3)))))]
    forces = [force * rng.uniform(0.6, 0.9), *(force * np.sort(rng.uniform(0.8, 1.4, len(places) - 1)))]
    final = force / elastic * rng.uniform(0.2, 0.8)
    steepest = max(forces[0] / elastic, final)
    return make(
        "piecewise_affine",
        {
            "deformation": [float(f"{place:.4g}") for place in places],
            "force": [float(value) for value in forces],
            "final_stiffness": final,
            "unloading_stiffness": steepest * stiff,
        },
    )


def _instruments(
    rng: np.random.Generator,
    scale: Scale,
    world: World,
    obstacle: str,
    bodies: list[str],
    deceleration: float,
    wall: bool,
    complete: bool,
) -> dict[str, Instrument]:
    film = Instrument("film", float(rng.choice(scale.film)))
    rate = float(rng.choice([5000.0, 10000.0, 20000.0], p=[0.2, 0.65, 0.15]))
    accelerometer = Instrument(
        "accelerometer", rate, cfc=int(rng.choice([0, 60, 180, 600, 1000], p=[0.45, 0.1, 0.25, 0.15, 0.05]))
    )
    if rate == 5000.0 and accelerometer.cfc == 1000:
        accelerometer.cfc = 0  # its corner lies beyond what that rate can hold
    reading, shaking = rng.uniform(*scale.reading), deceleration * np.exp(rng.uniform(np.log(0.01), np.log(0.08)))
    for body in bodies:
        film.sensors[f"{body}_dot"] = _marker(rng, body, reading)
        accelerometer.sensors[f"{body}_a"] = Sensor(body, shaking)
        if rng.random() < 0.15:
            accelerometer.sensors[f"{body}_b"] = Sensor(body, shaking)
    instruments = {"film": film, "accelerometer": accelerometer}
    if wall or rng.random() < 0.45:
        total = deceleration * sum(world.bodies[body].mass for body in bodies)
        instruments["load_cell"] = Instrument(
            "load_cell", rate, {"plate": Sensor(obstacle, total * rng.uniform(0.01, 0.04))}, accelerometer.cfc
        )
    if not complete:
        _lose(rng, instruments, bodies)
    for instrument in instruments.values():
        instrument.std_given = bool(rng.random() < 0.8)
    return instruments


def _marker(rng: np.random.Generator, body: str, noise: float) -> Sensor:
    marker = Sensor(body, noise, hidden=rng.uniform(0.0, 0.05))
    if rng.random() < 0.2:
        start = rng.uniform(0.005, 0.08)
        marker.block = (start, start + rng.uniform(0.003, 0.015))
    return marker


def _lose(rng: np.random.Generator, instruments: dict[str, Instrument], bodies: list[str]) -> None:
    """Film only, accelerometers only, or a body that one of them or neither sees; mostly nothing is lost."""
    lost = str(rng.choice(["nothing", "film", "accelerometer", "one", "body"], p=[0.64, 0.08, 0.08, 0.12, 0.08]))
    if lost in instruments:
        del instruments[lost]
    if len(bodies) > 1 and lost in ("one", "body"):
        body = str(rng.choice(bodies))
        groups = ["film", "accelerometer"] if lost == "body" else [str(rng.choice(["film", "accelerometer"]))]
        for group in groups:
            sensors = instruments[group].sensors
            for name in [name for name, sensor in sensors.items() if sensor.body == body]:
                del sensors[name]
