"""Draws vehicles, and places and strengths of secrets, until each secret is of the wanted size."""

import json
import math
from collections.abc import Sequence

import numpy as np
from attrs import evolve, frozen

from crashkit.testing.concealed.body_effects import BODY_EFFECTS
from crashkit.testing.concealed.effect import Effect, Maker, Stage
from crashkit.testing.concealed.joint_effects import JOINT_EFFECTS
from crashkit.testing.concealed.scene import Scene
from crashkit.testing.concealed.sensor_effects import SENSOR_EFFECTS
from crashkit.testing.concealed.size import Tuning, left_when_fitted, samples
from crashkit.testing.concealed.vehicle import draw_scene

EFFECTS: dict[str, Maker] = {**JOINT_EFFECTS, **BODY_EFFECTS, **SENSOR_EFFECTS}
"""Everything that can be concealed, by the name that a diagnosis should give it."""
Size = tuple[float, float]
"""Standard deviations that a secret leaves, at least and at most."""

_ATTEMPTS = 60
_HARDEST = 8000.0
"""m s-2, beyond which nothing is a crash any more."""


@frozen
class Secret:
    """An effect at its strength; `change` and `left`: standard deviations, before and after a model that lacks it is tuned."""

    effect: Effect
    strength: float
    change: float
    left: float


@frozen
class Draft:
    """The scene as the model's form can describe it, the scene with its secrets, and the secrets."""

    base: Scene
    scene: Scene
    secrets: list[Secret]


def draw_draft(rng: np.random.Generator, physics: Sequence[str], size: Size, plain: bool = False) -> Draft:
    """A draft that conceals these physics, each of this size; `plain`: in a plain vehicle and in their plainest forms.

    Raises:
        ValueError: no vehicle was found that can have it so.
    """
    wall, complete = "added_mass" in physics, any(name in SENSOR_EFFECTS for name in physics)
    for _ in range(_ATTEMPTS):
        draft = _try(rng, draw_scene(rng, wall, complete, plain), physics, size, plain)
        if draft is not None:
            return draft
    raise ValueError(
        f"no vehicle was found that shows {' and '.join(physics)} by {size[0]:g} to {size[1]:g} standard deviations"
    )


def _try(rng: np.random.Generator, scene: Scene, physics: Sequence[str], size: Size, plain: bool) -> Draft | None:
    if not _is_sane(scene):
        return None
    if not physics:
        return Draft(scene, scene, [])
    stage = Stage(scene, scene.motions(), rng, plain)
    effects = [effect for effect in (EFFECTS[name](stage) for name in physics) if effect is not None]
    places = {json.dumps(effect.place) for effect in effects}
    if len(effects) < len(physics) or len(places) < len(physics) or not _is_sane(scene):
        return None
    if len(effects) > 1 and any(effect.rivals for effect in effects):
        return None  # it could not be said which of the answers must be found
    secrets = _sized(scene, effects, size, rng)
    full = scene
    for secret in secrets or ():
        full = secret.effect.into(full, secret.strength)
    return Draft(scene, full, _as_left(scene, full, secrets)) if secrets and _is_sane(full) else None


def _as_left(scene: Scene, full: Scene, secrets: list[Secret]) -> list[Secret]:
    """Each secret with what it leaves once the model that lacks only it is fitted."""
    recorded = samples(full)
    added = [lambda told, factor, one=one: one.effect.into(told, factor * one.strength) for one in secrets]
    return [
        evolve(secret, left=left_when_fitted(scene, [*added[:index], *added[index + 1 :]], recorded))
        for index, secret in enumerate(secrets)
    ]


def _sized(scene: Scene, effects: list[Effect], size: Size, rng: np.random.Generator) -> list[Secret] | None:
    """Each effect at a strength of the wanted size, none hidden by the others."""
    base, least = samples(scene), size[0]
    for effect in effects:
        if np.linalg.norm(samples(effect.into(scene, effect.limits[1])) - base) < least:
            return None  # spares the tuning
    tuning, secrets = Tuning.of(scene), []
    for effect in effects:
        secret = _at_size(tuning, effect, size, rng)
        if secret is None:
            return None
        secrets.append(secret)
    changed = [samples(secret.effect.into(scene, secret.strength)) for secret in secrets]
    for index, one in enumerate(changed):
        others = changed[:index] + changed[index + 1 :]
        if others and tuning.left_beside(one, others) < least:
            return None
    return secrets


def _at_size(tuning: Tuning, effect: Effect, size: Size, rng: np.random.Generator) -> Secret | None:
    """Halve the interval of the strength's logarithms until what is left is of this size."""
    low, high = (math.log(limit) for limit in effect.limits)
    least, most = size
    wanted = math.exp(rng.uniform(math.log(least), math.log(most)))
    for _ in range(9):
        middle = 0.5 * (low + high)
        changed = samples(effect.into(tuning.scene, math.exp(middle)))
        left = tuning.left(changed)
        if 0.9 * wanted <= left <= 1.1 * wanted:
            break
        low, high = (low, middle) if left > wanted else (middle, high)
    if not least <= left <= most:
        return None
    return Secret(effect, math.exp(middle), float(np.linalg.norm(changed - tuning.base)), left)


def _is_sane(scene: Scene) -> bool:
    """In all runs, the held-out one too: joined bodies stay apart, and all accelerations are a crash's."""
    joints = {name: scene.world.joints[name] for name in scene.public}
    for motion in scene.motions(slice(None)):
        if any(np.any(motion.deformation[name] > 0.95 * abs(scene.world.length(one))) for name, one in joints.items()):
            return False
        if not all(float(np.abs(motion.acceleration[body]).max()) < _HARDEST for body in scene.bodies):
            return False
    return True
