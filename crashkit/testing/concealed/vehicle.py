"""Random vehicles: bodies in a row, joints that can stop them, and the instruments that watch."""

import copy

import numpy as np
from attrs import define

from crashkit.testing.concealed.sensors import Instrument, Sensor
from crashkit.testing.concealed.world import World, WorldJoint

PUBLIC = ("elastic_stiffness", "crush_force", "densification_deformation", "densification_stiffness", "unloading_stiffness")

_OBSTACLES = ("barrier", "wall", "block")
_ROWS = (
    ("powertrain", "body", "rear", "trailer"),
    ("engine", "cabin", "chassis", "load_floor"),
    ("bumper_beam", "front_frame", "cell", "tail"),
    ("impactor", "carriage", "frame", "ballast"),
)
_FRONTS = ("front", "bumper", "crash_box", "nose", "absorber")
_RAILS = ("side_members", "rails", "sills", "longitudinals")
_MOUNTS = ("mounts", "bushings", "brackets", "coupling")


@define
class Scene:
    """A vehicle before a set of tests, with every secret that was put into it.

    Arguments:
        obstacle: name of the body that is hit.
        bodies: names of the public moving bodies, from the front.
        world: bodies and joints as they really are; `public_joints` are those that the model has.
        instruments: by the name of their group.
        speeds: m s-1, three runs and the hold-out.
        duration: s.
    """

    obstacle: str
    bodies: list[str]
    world: World
    public_joints: list[str]
    instruments: dict[str, Instrument]
    speeds: list[float]
    duration: float

    def copy(self) -> "Scene":
        """A copy that can be changed on its own."""
        return copy.deepcopy(self)

    def mass(self, body: str) -> float:
        """True mass of a moving body, kg."""
        return 1.0 / self.world.bodies[body]["mobility"]


def draw_scene(rng: np.random.Generator, number: int | None = None, wall: bool | None = None, complete: bool = False) -> Scene:
    """A random vehicle with `number` bodies, a wall load cell or not, and (`complete`) no instrument missing."""
    number = int(rng.choice([1, 2, 3, 4], p=[0.15, 0.45, 0.3, 0.1])) if number is None else number
    obstacle, bodies = str(rng.choice(_OBSTACLES)), list(_ROWS[rng.integers(len(_ROWS))][:number])
    crush, middle = rng.uniform(0.35, 0.65), rng.uniform(9.0, 14.0)
    world = World(_bodies(rng, obstacle, bodies, crush), {})
    _join(rng, world, obstacle, bodies, crush, middle**2 / (2.0 * crush))
    speeds = [
        round(middle * factor * 2.0) / 2.0
        for factor in (rng.uniform(0.65, 0.75), 1.0, rng.uniform(1.2, 1.3), rng.uniform(1.4, 1.5))
    ]
    instruments = _instruments(rng, obstacle, bodies, wall, complete)
    return Scene(obstacle, bodies, world, list(world.joints), instruments, speeds, round(rng.uniform(0.13, 0.18), 2))


def _bodies(rng: np.random.Generator, obstacle: str, bodies: list[str], crush: float) -> dict[str, dict[str, float]]:
    total, share = np.exp(rng.uniform(np.log(200.0), np.log(2400.0))), rng.uniform(0.3, 1.0, len(bodies))
    share[-1] += 0.7
    masses = np.round(total * share / share.sum(), -1 if total > 500 else 0)
    places = np.round(-np.cumsum([rng.uniform(1.6, 2.2) * crush, *rng.uniform(0.6, 1.2, len(bodies) - 1)]), 2)
    table = {obstacle: {"position": 0.0, "moving": 0.0}}
    return table | {
        body: {"position": float(place), "mobility": 1.0 / float(mass)}
        for body, place, mass in zip(bodies, places, masses, strict=True)
    }


def _join(rng: np.random.Generator, world: World, obstacle: str, bodies: list[str], crush: float, deceleration: float) -> None:
    """From the rear to the front: each joint carries its share of what is behind it."""
    load = {body: deceleration / world.bodies[body]["mobility"] for body in bodies}
    rails, mounts = list(rng.permutation(_RAILS)), list(rng.permutation(_MOUNTS))
    joints = {}
    for index in range(len(bodies) - 1, -1, -1):
        body = bodies[index]
        ahead = bodies[index - 1] if index else obstacle
        rail = index > 0 and rng.random() < 0.6
        mount = index > 0 and (not rail or rng.random() < 0.75)
        mount_share = float(rng.uniform(0.15, 0.4)) if rail and mount else float(mount)
        if mount:
            load[ahead] += mount_share * load[body]
            joints[str(mounts.pop())] = WorldJoint(ahead, body, _mount(rng, mount_share * load[body]))
        if rail:
            joints[str(rails.pop())] = WorldJoint(obstacle, body, _crusher(rng, (1.0 - mount_share) * load[body], crush))
    joints[str(rng.choice(_FRONTS))] = WorldJoint(obstacle, bodies[0], _crusher(rng, load[bodies[0]], crush))
    world.joints.update(reversed(joints.items()))


def _crusher(rng: np.random.Generator, force: float, crush: float) -> dict[str, float]:
    return _plateau(rng, force, rng.uniform(0.03, 0.12), crush * rng.uniform(0.6, 1.0))


def _mount(rng: np.random.Generator, force: float) -> dict[str, float]:
    fields = _plateau(rng, force, rng.uniform(0.02, 0.06), rng.uniform(0.1, 0.2))
    if rng.random() < 0.15:
        del fields["unloading_stiffness"]  # an elastic mount
    return fields


def _plateau(rng: np.random.Generator, force: float, elastic: float, densification: float) -> dict[str, float]:
    force *= rng.uniform(0.85, 1.15)
    stiffness = force / elastic
    return {
        "elastic_stiffness": stiffness,
        "crush_force": force,
        "densification_deformation": densification,
        "densification_stiffness": stiffness * rng.uniform(0.4, 1.2),
        "unloading_stiffness": stiffness * rng.uniform(3.0, 8.0),
    }


def _instruments(
    rng: np.random.Generator, obstacle: str, bodies: list[str], wall: bool | None, complete: bool
) -> dict[str, Instrument]:
    film = Instrument("film", float(rng.choice([500.0, 1000.0, 2000.0], p=[0.15, 0.7, 0.15])))
    rate = float(rng.choice([5000.0, 10000.0, 20000.0], p=[0.15, 0.7, 0.15]))
    accelerometer = Instrument("accelerometer", rate, cfc=int(rng.choice([0, 60, 180, 600], p=[0.5, 0.1, 0.25, 0.15])))
    reading, shaking = rng.uniform(0.5e-3, 2e-3), rng.uniform(2.5, 7.0)
    for body in bodies:
        film.sensors[f"{body}_target"] = _marker(rng, body, reading)
        accelerometer.sensors[f"{body}_acc"] = Sensor(body, shaking)
        if rng.random() < 0.1:
            accelerometer.sensors[f"{body}_acc_2"] = Sensor(body, shaking)
    if len(bodies) > 1 and not complete and rng.random() < 0.3:
        _lose_one(rng, film, accelerometer)
    instruments = {"film": film, "accelerometer": accelerometer}
    if rng.random() < 0.45 if wall is None else wall:
        # The noise is a share of the peak force, known only when the runs are: `case` scales it.
        instruments["wall"] = Instrument(
            "load_cell", rate, {"wall": Sensor(obstacle, rng.uniform(0.01, 0.02))}, accelerometer.cfc
        )
    for instrument in instruments.values():
        instrument.std_given = bool(rng.random() < 0.85)
    return instruments


def _marker(rng: np.random.Generator, body: str, noise: float) -> Sensor:
    marker = Sensor(body, noise, hidden=rng.uniform(0.0, 0.04))
    if rng.random() < 0.2:
        start = rng.uniform(0.01, 0.12)
        marker.block = (start, start + rng.uniform(0.004, 0.015))
    return marker


def _lose_one(rng: np.random.Generator, film: Instrument, accelerometer: Instrument) -> None:
    """One body is seen by one kind of instrument only."""
    sensors = film.sensors if rng.random() < 0.5 else accelerometer.sensors
    body = rng.choice([sensor.body for sensor in sensors.values()])
    for name in [name for name, sensor in sensors.items() if sensor.body == body]:
        del sensors[name]
