"""Random vehicles: one to four bodies in a chain or branched, and the joints that can stop them."""

import numpy as np
from attrs import frozen

from crashkit.testing.concealed.equipment import draw_instruments
from crashkit.testing.concealed.scene import Scene
from crashkit.testing.concealed.world import Body, Joint, World

_BODIES = {
    "car": (("engine", "cabin", "boot", "trailer"), ("cradle", "floor", "tank", "bed"), ("beam", "cell", "axle", "tail")),
    "drop": (("foot", "frame", "tray", "lid"), ("sole", "shell", "board", "pack"), ("bell", "stem", "arm", "head")),
}
_OBSTACLES = {"car": ("wall", "barrier", "pole"), "drop": ("floor_plate", "anvil", "table")}
_JOINTS = ("spar", "strut", "rail", "box", "pad", "bush", "bracket", "rib", "sleeve", "foam", "column", "cone")


@frozen
class Scale:
    """Orders of magnitude of a kind of test: total mass kg, speed m s-1, crush m; rates of a film Hz, its reading error m."""

    mass: tuple[float, float]
    speed: tuple[float, float]
    crush: tuple[float, float]
    film: tuple[float, ...]
    reading: tuple[float, float]


_SCALES = {
    "car": Scale((250.0, 2500.0), (8.0, 15.0), (0.3, 0.7), (500.0, 1000.0, 2000.0), (0.5e-3, 2e-3)),
    "drop": Scale((2.0, 80.0), (3.0, 7.0), (0.03, 0.12), (2000.0, 4000.0), (0.1e-3, 0.3e-3)),
}


def draw_scene(rng: np.random.Generator, wall: bool = False, complete: bool = False, plain: bool = False) -> Scene:
    """A random vehicle.

    Arguments:
        rng: chance.
        wall: with a load cell for certain.
        complete: three runs to fit, film and accelerometers on every body.
        plain: complete, with one body and a joint that follows `crush_plateau`.
    """
    kind = "car" if rng.random() < 0.75 else "drop"
    scale, number = _SCALES[kind], int(rng.choice([1, 2, 3, 4], p=[0.2, 0.4, 0.28, 0.12]))
    if plain:
        number, complete = 1, True
    crush, speed = rng.uniform(*scale.crush), rng.uniform(*scale.speed)
    deceleration = speed**2 / (2.0 * crush)
    obstacle, bodies = str(rng.choice(_OBSTACLES[kind])), list(_BODIES[kind][rng.integers(3)][:number])
    world = World({obstacle: Body(0.0, moves=False)}, {})
    parents = _place(rng, world, bodies, scale, crush)
    _join(rng, world, bodies, parents, crush, deceleration, plain)
    factors = (rng.uniform(0.6, 0.75), 1.0, rng.uniform(1.2, 1.3), rng.uniform(1.38, 1.5))
    speeds = [round(speed * factor, 1) for factor in factors]
    if not complete:
        del speeds[: int(rng.choice([0, 1, 2], p=[0.8, 0.12, 0.08]))]
    duration = round(float(rng.uniform(1.7, 2.4)) * 2.0 * crush / speed, 3)
    masses = {body: world.bodies[body].mass for body in bodies}
    instruments = draw_instruments(rng, scale.film, scale.reading, obstacle, masses, deceleration, wall, complete)
    return Scene(obstacle, bodies, world, instruments, speeds, duration)


def _place(rng: np.random.Generator, world: World, bodies: list[str], scale: Scale, crush: float) -> list[str]:
    """Put each body behind its parent, which is returned: the one before it, any other, or the obstacle."""
    parents: list[str] = []
    for index, body in enumerate(bodies):
        if index and rng.random() < 0.7:
            parents.append(bodies[index - 1])
        else:
            parents.append(str(rng.choice(list(world.bodies))) if index else next(iter(world.bodies)))
        position = world.bodies[parents[index]].position - rng.uniform(1.6, 2.4) * crush
        total = np.exp(rng.uniform(*np.log(scale.mass)))
        mass = float(total / len(bodies) * np.exp(rng.uniform(-0.7, 0.7)))
        world.bodies[body] = Body(round(position, 3), float(f"{mass:.3g}"))
    return parents


def _join(
    rng: np.random.Generator,
    world: World,
    bodies: list[str],
    parents: list[str],
    crush: float,
    deceleration: float,
    plain: bool,
) -> None:
    """From the rear to the front: each joint carries its share of what is behind it."""
    obstacle, names = parents[0], [str(name) for name in rng.permutation(_JOINTS)]
    load = {body: world.bodies[body].mass * deceleration for body in bodies}
    joints = {}
    for body, parent in reversed(list(zip(bodies, parents, strict=True))):
        share = 1.0
        if parent != obstacle:
            share = float(rng.uniform(0.2, 0.5)) if rng.random() < 0.4 else 1.0
            load[parent] += share * load[body]
            joints[names.pop()] = _joint(rng, parent, body, share * load[body], crush * rng.uniform(0.15, 0.4), plain)
        if parent == obstacle or share < 1.0:
            rest = 1.0 if parent == obstacle else 1.0 - share
            joints[names.pop()] = _joint(rng, obstacle, body, rest * load[body], crush, plain)
    world.joints.update(reversed(joints.items()))


def _joint(rng: np.random.Generator, front: str, back: str, force: float, crush: float, plain: bool) -> Joint:
    """A joint that yields at about `force` (N) over about `crush` (m)."""
    force *= rng.uniform(0.85, 1.15)
    elastic, stiff = crush * rng.uniform(0.08, 0.25), rng.uniform(3.0, 8.0)
    if plain or rng.random() < 0.75:
        return Joint(front, back, "crush_plateau", _plateau(rng, force, elastic, crush, stiff))
    return Joint(front, back, "piecewise_affine", _broken_line(rng, force, elastic, crush, stiff))


def _plateau(rng: np.random.Generator, force: float, elastic: float, crush: float, stiff: float) -> dict[str, float]:
    return {
        "elastic_stiffness": force / elastic,
        "crush_force": force,
        "densification_deformation": crush * rng.uniform(0.6, 1.0),
        "densification_stiffness": force / elastic * rng.uniform(0.4, 1.2),
        "unloading_stiffness": force / elastic * stiff,
    }


def _broken_line(rng: np.random.Generator, force: float, elastic: float, crush: float, stiff: float) -> dict[str, object]:
    deformations = [elastic, *(crush * np.sort(rng.uniform(0.3, 1.0, int(rng.integers(1, 3)))))]
    forces = [force * rng.uniform(0.6, 0.9), *(force * np.sort(rng.uniform(0.8, 1.4, len(deformations) - 1)))]
    final = force / elastic * rng.uniform(0.2, 0.8)
    return {
        "deformation": [float(f"{deformation:.4g}") for deformation in deformations],
        "force": [float(value) for value in forces],
        "final_stiffness": final,
        "unloading_stiffness": max(forces[0] / elastic, final) * stiff,
    }
