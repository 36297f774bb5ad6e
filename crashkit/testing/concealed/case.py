"""A concealed case: a public model, recordings of a world that holds more, and the sealed answer."""

import base64
import json
import math
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.testing.concealed.body_effects import BODY_EFFECTS
from crashkit.testing.concealed.effect import Effect, Stage
from crashkit.testing.concealed.joint_effects import JOINT_EFFECTS
from crashkit.testing.concealed.sensor_effects import SENSOR_EFFECTS
from crashkit.testing.concealed.sensors import record
from crashkit.testing.concealed.significance import TAIL, Tuning, signals, traces
from crashkit.testing.concealed.vehicle import PUBLIC, Scene, draw_scene
from crashkit.testing.concealed.world import run

EFFECTS = JOINT_EFFECTS | BODY_EFFECTS | SENSOR_EFFECTS
PHYSICS = (*EFFECTS, "null", "pair")
SIZES = {"small": (15.0, 60.0), "middle": (60.0, 400.0), "gross": (400.0, 6000.0)}
"""Standard deviations that a secret leaves after tuning, over all runs together."""

_ATTEMPTS = 50
_VISIBLE = (SIZES["small"][0], SIZES["gross"][1])
_OFF = 0.15  # how far the public numbers are off, at most


@frozen
class Case:
    """A concealed case.

    Arguments:
        model_toml: the public model.
        runs, holdout: recordings.
        truth: `accept` (right answers: physics, kind of place, place), `all` (whether each must be found), `size`, `secret`.
    """

    model_toml: str
    runs: list[xr.DataTree]
    holdout: list[xr.DataTree]
    truth: dict[str, Any]


@frozen
class Secret:
    """An effect at its strength, and how visible it is."""

    effect: Effect
    strength: float
    sigmas: float


@frozen
class Draft:
    """A case before anything is recorded: the scene as the model's form can describe it, and the scene with its secrets."""

    base: Scene
    scene: Scene
    secrets: list[Secret]

    @property
    def size(self) -> str | None:
        """The size of the least visible secret."""
        least = min((secret.sigmas for secret in self.secrets), default=None)
        return None if least is None else next(name for name, (_, most) in SIZES.items() if least <= most)


def make_case(
    seed: int, physics: str | Sequence[str] | None = None, size: str | None = None, n_effects: int | None = None
) -> Case:
    """A case with a secret, the same for the same arguments.

    Arguments:
        seed: of everything random.
        physics: what is concealed: one of PHYSICS, or several of EFFECTS together; None: chance decides.
        size: how visible, one of SIZES; None: chance decides.
        n_effects: how many secrets, where `physics` does not say; None: mostly one, sometimes none, sometimes two.

    Raises ValueError for a name that is not known, or a size that this physics cannot have.
    """
    plan, world_rng, public_rng, noise_rng = (np.random.default_rng(part) for part in np.random.SeedSequence(seed).spawn(4))
    draft = draw_draft(world_rng, _names(plan, physics, n_effects), size)
    recordings = [
        record(draft.scene.instruments, trace, draft.scene.duration, speed, draft.scene.bodies, noise_rng)
        for trace, speed in zip(traces(draft.scene, slice(0, 4)), draft.scene.speeds, strict=True)
    ]
    return Case(_model_toml(draft.base, public_rng), recordings[:3], recordings[3:], _truth(draft))


def write_case(case: Case, folder: str | Path, sealed: bool = True) -> None:
    """Write model.toml, run_1.nc to run_3.nc, holdout_1.nc and truth.json; sealed, the truth cannot be read by accident."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.toml").write_text(case.model_toml)
    for name, trees in (("run", case.runs), ("holdout", case.holdout)):
        for number, tree in enumerate(trees, 1):
            tree.to_netcdf(folder / f"{name}_{number}.nc")
    text = json.dumps(case.truth, indent=1)
    if sealed:
        text = json.dumps({"sealed": base64.b64encode(zlib.compress(text.encode())).decode()})
    (folder / "truth.json").write_text(text + "\n")


def open_seal(folder: str | Path) -> dict[str, Any]:
    """The truth of a written case, sealed or not."""
    truth = json.loads((Path(folder) / "truth.json").read_text())
    return json.loads(zlib.decompress(base64.b64decode(truth["sealed"]))) if "sealed" in truth else truth


def _names(rng: np.random.Generator, physics: str | Sequence[str] | None, n_effects: int | None) -> list[str]:
    """The physics to conceal."""
    names = [physics] if isinstance(physics, str) else list(physics or ())
    unknown = set(names) - set(PHYSICS)
    if unknown:
        raise ValueError(f"expected physics among {', '.join(PHYSICS)}, found {', '.join(sorted(unknown))}")
    if names == ["null"]:
        return []
    if names == ["pair"]:
        names, n_effects = [], 2
    if n_effects is None:
        n_effects = len(names) or int(rng.choice([0, 1, 2], p=[0.1, 0.75, 0.15]))
    others = [str(name) for name in rng.permutation(list(EFFECTS)) if name not in (*names, "unknown" if n_effects > 1 else "")]
    return names + others[: n_effects - len(names)] if n_effects > len(names) else names


def draw_draft(rng: np.random.Generator, names: Sequence[str], size: str | None) -> Draft:
    """Draw vehicles and places until every secret of `names` is as visible as `size` says."""
    if size is not None and size not in SIZES:
        raise ValueError(f"expected a size among {', '.join(SIZES)}, found {size}")
    for _ in range(_ATTEMPTS):
        draft = _try(rng, names, size)
        if draft is not None:
            return draft
    raise ValueError(f"expected {' and '.join(names)} in a {size or 'visible'} size, found no vehicle that shows it so")


def _try(rng: np.random.Generator, names: Sequence[str], size: str | None) -> Draft | None:
    sensor_fault = any(name in SENSOR_EFFECTS for name in names)
    scene = draw_scene(rng, wall=True if "added_mass" in names else None, complete=sensor_fault)
    if not _is_sane(scene):
        return None
    _scale_wall_noise(scene)
    stage = Stage(scene, traces(scene), rng)
    effects = [EFFECTS[name](stage) for name in names]
    if None in effects or len({str(effect.place) for effect in effects if effect}) < len(effects):
        return None
    if len(effects) > 1 and any(effect.rivals for effect in effects if effect):
        return None  # `all` could not say which of the answers must be found
    if not effects:
        return Draft(scene, scene, [])
    secrets = _calibrated(scene, [effect for effect in effects if effect], size, rng)
    full = scene
    for secret in secrets or ():
        full = secret.effect.into(full, secret.strength)
    return Draft(scene, full, secrets) if secrets and _is_sane(full) else None


def _calibrated(scene: Scene, effects: list[Effect], size: str | None, rng: np.random.Generator) -> list[Secret] | None:
    """Each effect at a strength of the wanted size or any visible one, none hidden by the others."""
    tuning = Tuning.of(scene)
    secrets = [_at_size(tuning, effect, size, rng) for effect in effects]
    found = [secret for secret in secrets if secret is not None]
    if len(found) < len(effects):
        return None
    seen = [signals(secret.effect.into(scene, secret.strength)) for secret in found]
    for index in range(len(found)) if len(found) > 1 else ():
        others = np.stack([it - tuning.base for number, it in enumerate(seen) if number != index], 1)
        if tuning.left(seen[index], beside=others) < _VISIBLE[0]:
            return None
    return found


def _at_size(tuning: Tuning, effect: Effect, size: str | None, rng: np.random.Generator) -> Secret | None:
    """Try a random strength first, then halve the interval of strengths."""
    low, high = (math.log(limit) for limit in effect.limits)
    least, most = SIZES[size] if size else _VISIBLE
    wanted = math.exp(rng.uniform(math.log(least), math.log(most)))
    strength = math.exp(rng.uniform(low, high))
    for _ in range(8):
        sigmas = tuning.left(signals(effect.into(tuning.scene, strength)))
        if least <= sigmas <= most:
            return Secret(effect, strength, sigmas)
        low, high = (low, math.log(strength)) if sigmas > wanted else (math.log(strength), high)
        strength = math.exp(0.5 * (low + high))
    return None


def _is_sane(scene: Scene) -> bool:
    """Nothing passes through anything, in the hold-out neither, and all numbers stay in a crash's range."""
    for trace in traces(scene, slice(0, 4)):
        row = [trace.position[body] for body in (scene.obstacle, *scene.bodies)]
        apart = min(float((front - back).min()) for front, back in zip(row, row[1:], strict=False))
        hardest = max(float(np.abs(trace.acceleration[body]).max()) for body in scene.bodies)
        if not (apart > 0.03 and hardest < 4000.0):
            return False
    return True


def _scale_wall_noise(scene: Scene) -> None:
    """From a share of the middle run's peak force to newtons."""
    if "wall" in scene.instruments:
        trace = run(scene.world, scene.speeds[1], scene.duration + TAIL)
        scene.instruments["wall"].sensors["wall"].noise *= float(np.abs(trace.contact[scene.obstacle]).max())


def _model_toml(scene: Scene, rng: np.random.Generator) -> str:
    """The public model: everything but the secret, its numbers a little off."""
    lines = ['schema = "crashkit-model/1"', 'name = "public"', 'axes = ["x"]', ""]
    lines += ["[[body]]", f'name = "{scene.obstacle}"', "fixed = true", "position = [0.0]", ""]
    for body in scene.bodies:
        position, mass = scene.world.bodies[body]["position"], scene.mass(body)
        lines += ["[[body]]", f'name = "{body}"', f"mass = {mass:.1f}", f"position = [{position}]"]
        lines += [f"velocity = [{scene.speeds[1]}]", ""]
    for name in scene.public_joints:
        joint = scene.world.joints[name]
        lines += ["[[joint]]", f'name = "{name}"', f'bodies = ["{joint.front}", "{joint.back}"]', 'law = "crush_plateau"']
        lines += ["[joint.parameters]"]
        lines += [
            f"{field} = {float(f'{joint.fields[field] * rng.uniform(1.0 - _OFF, 1.0 + _OFF):.6g}')}"
            for field in PUBLIC
            if field in joint.fields
        ]
        lines += [""]
    return "\n".join(lines)


def _truth(draft: Draft) -> dict[str, Any]:
    answers = [list(answer) for secret in draft.secrets for answer in secret.effect.answers()]
    return {
        "accept": answers or [["consistent", None, None]],
        "all": len(draft.secrets) > 1,
        "size": draft.size,
        "secret": {
            "effects": [_told(secret) for secret in draft.secrets],
            "parameters": {name: draft.base.world.joints[name].fields for name in draft.base.public_joints},
        },
    }


def _told(secret: Secret) -> dict[str, Any]:
    effect = secret.effect
    return {
        "physics": effect.physics,
        "form": effect.form,
        "kind": effect.kind,
        "place": effect.place,
        "numbers": effect.numbers(secret.strength),
        "sigmas_after_tuning": round(secret.sigmas, 1),
    }
