"""A concealed case: what the user believes, recordings of a world that holds more, and the answer."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from attrs import frozen

from benchmarks.blind.body_effects import BODY_EFFECTS
from benchmarks.blind.effect import Effect, Maker, Stage
from benchmarks.blind.instruments import record
from benchmarks.blind.joint_effects import JOINT_EFFECTS
from benchmarks.blind.sensor_effects import SENSOR_EFFECTS
from benchmarks.blind.size import SIZES, Tuning, free_numbers, named, seen, tuned
from benchmarks.blind.vehicle import Scene, draw_scene

EFFECTS: dict[str, Maker] = {**JOINT_EFFECTS, **BODY_EFFECTS, **SENSOR_EFFECTS}
"""Everything that can be concealed, by the name that a diagnosis should give it."""

_ATTEMPTS = 60
_OFF = 0.15
"""How far the numbers of the given model are off, at most."""
_HARDEST = 8000.0
"""m s-2, beyond which nothing is a crash any more."""


@frozen
class Case:
    """A concealed case.

    Arguments:
        model: the given model, TOML.
        runs, holdout: recordings.
        truth: `accept` (right answers: physics, kind of place, place), `all` (whether each must be found), `size`, `secrets`.
    """

    model: str
    runs: list[xr.DataTree]
    holdout: list[xr.DataTree]
    truth: dict[str, Any]


@frozen
class Secret:
    """An effect at its strength; `change` and `left`: standard deviations, before and after the model is tuned."""

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


def make_case(seed: Sequence[int], physics: Sequence[str], size: str) -> Case:
    """A case, the same for the same arguments.

    Arguments:
        seed: of everything random.
        physics: names in EFFECTS that are concealed together; none: nothing is.
        size: of each, one of SIZES.

    Raises:
        ValueError: no vehicle was found that can have it so.
    """
    drawing, public, noise = (np.random.default_rng(part) for part in np.random.SeedSequence(seed).spawn(3))
    draft = draw_draft(drawing, physics, size)
    scene = draft.scene
    trees = [
        record(scene.instruments, trace, scene.contact(trace), scene.duration, scene.bodies, noise)
        for trace in scene.traces(slice(None))
    ]
    return Case(model_text(draft.base, public), trees[:-1], trees[-1:], _truth(draft))


def write_case(case: Case, folder: Path) -> None:
    """Write model.toml, run_1.nc, ... and holdout_1.nc: all that a diagnosis may see."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.toml").write_text(case.model, encoding="utf-8")
    for kind, trees in (("run", case.runs), ("holdout", case.holdout)):
        for number, tree in enumerate(trees, 1):
            tree.to_netcdf(folder / f"{kind}_{number}.nc")


def draw_draft(rng: np.random.Generator, physics: Sequence[str], size: str) -> Draft:
    """Draw vehicles and places until every secret is of the wanted size."""
    for _ in range(_ATTEMPTS):
        draft = _try(rng, physics, size)
        if draft is not None:
            return draft
    raise ValueError(f"no vehicle was found that shows {' and '.join(physics)} in {size} size")


def model_text(scene: Scene, rng: np.random.Generator | None) -> str:
    """The given model as TOML; its numbers a little off, or with no `rng` as they are."""
    if rng is not None:
        count = len(list(free_numbers(scene)))
        scene = tuned(scene, np.log(rng.uniform(1.0 - _OFF, 1.0 + _OFF, count)))
    lines = ['schema = "crashkit-model/1"', 'name = "given"', 'axes = ["x"]', ""]
    lines += ["[[body]]", f'name = "{scene.obstacle}"', "fixed = true", "position = [0.0]", ""]
    for name in scene.bodies:
        body = scene.world.bodies[name]
        lines += ["[[body]]", f'name = "{name}"', f"mass = {body.mass}", f"position = [{body.place}]"]
        lines += [f"velocity = [{scene.speeds[0]}]", ""]
    for name in scene.public:
        link = scene.world.links[name]
        lines += ["[[joint]]", f'name = "{name}"', f'bodies = ["{link.front}", "{link.back}"]', f'law = "{link.law}"']
        lines += ["[joint.parameters]", *(f"{key} = {_rounded(value, rng)}" for key, value in link.numbers.items()), ""]
    return "\n".join(lines)


def _rounded(value: float | list[float], rng: np.random.Generator | None) -> Any:
    if isinstance(value, list):
        return [_rounded(one, rng) for one in value]
    return float(value if rng is None else f"{value:.6g}")


def _try(rng: np.random.Generator, physics: Sequence[str], size: str) -> Draft | None:
    scene = draw_scene(rng, wall="added_mass" in physics, complete=any(name in SENSOR_EFFECTS for name in physics))
    if not _is_sane(scene):
        return None
    if not physics:
        return Draft(scene, scene, [])
    stage = Stage(scene, scene.traces(), rng)
    effects = [effect for effect in (EFFECTS[name](stage) for name in physics) if effect is not None]
    places = {json.dumps(effect.place) for effect in effects}
    if len(effects) < len(physics) or len(places) < len(physics) or not _is_sane(scene):
        return None
    if len(effects) > 1 and any(effect.rivals for effect in effects):
        return None  # `all` could not say which of the answers must be found
    secrets = _sized(scene, effects, size, rng)
    full = scene
    for secret in secrets or ():
        full = secret.effect.into(full, secret.strength)
    return Draft(scene, full, secrets) if secrets and _is_sane(full) else None


def _sized(scene: Scene, effects: list[Effect], size: str, rng: np.random.Generator) -> list[Secret] | None:
    """Each effect at a strength of the wanted size, none hidden by the others."""
    base, least = seen(scene), SIZES[size][0]
    for effect in effects:
        if np.linalg.norm(_seen(effect, scene, effect.limits[1]) - base) < least:
            return None  # spares the tuning
    tuning, secrets = Tuning.of(scene), []
    for effect in effects:
        secret = _at_size(tuning, effect, size, rng)
        if secret is None:
            return None
        secrets.append(secret)
    signals = [_seen(secret.effect, scene, secret.strength) for secret in secrets]
    for index, one in enumerate(signals):
        others = signals[:index] + signals[index + 1 :]
        if others and tuning.left_beside(one, others) < least:
            return None
    return secrets


def _at_size(tuning: Tuning, effect: Effect, size: str, rng: np.random.Generator) -> Secret | None:
    """Halve the interval of the strength's logarithms until what is left is of this size."""
    low, high = (math.log(limit) for limit in effect.limits)
    least, most = SIZES[size]
    wanted = math.exp(rng.uniform(math.log(least), math.log(most)))
    for _ in range(9):
        middle = 0.5 * (low + high)
        signals = _seen(effect, tuning.scene, math.exp(middle))
        left = tuning.left(signals)
        if 0.9 * wanted <= left <= 1.1 * wanted:
            break
        low, high = (low, middle) if left > wanted else (middle, high)
    if not least <= left <= most:
        return None
    return Secret(effect, math.exp(middle), float(np.linalg.norm(signals - tuning.base)), left)


def _seen(effect: Effect, scene: Scene, strength: float) -> np.ndarray:
    return seen(effect.into(scene, strength))


def _is_sane(scene: Scene) -> bool:
    """In all runs, the held-out one too: joined bodies stay apart, and all accelerations are a crash's."""
    for trace in scene.traces(slice(None)):
        for name in scene.public:
            link = scene.world.links[name]
            if np.any(
                trace.deformation[name]
                > 0.95 * abs(scene.world.bodies[link.front].place - scene.world.bodies[link.back].place)
            ):
                return False
        if not all(float(np.abs(trace.acceleration[body]).max()) < _HARDEST for body in scene.bodies):
            return False
    return True


def _truth(draft: Draft) -> dict[str, Any]:
    answers = [list(answer) for secret in draft.secrets for answer in secret.effect.answers()]
    lefts = [secret.left for secret in draft.secrets]
    return {
        "accept": answers or [["consistent", None, None]],
        "all": len(draft.secrets) > 1,
        "size": named(min(lefts)) if lefts else None,
        "secrets": [_told(secret) for secret in draft.secrets],
    }


def _told(secret: Secret) -> dict[str, Any]:
    effect = secret.effect
    return {
        "physics": effect.physics,
        "form": effect.form,
        "kind": effect.kind,
        "place": effect.place,
        "numbers": effect.numbers,
        "strength": round(secret.strength, 5),
        "change": round(secret.change, 1),
        "left": round(secret.left, 1),
    }
