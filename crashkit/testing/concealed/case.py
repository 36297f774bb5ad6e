"""A concealed case: what the user believes, recordings of a world that holds more, and the answer."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.testing.concealed.draft import Draft, Secret, draw_draft
from crashkit.testing.concealed.given import model_text
from crashkit.testing.concealed.recording import record
from crashkit.testing.concealed.size import SIZES, named


@frozen
class Case:
    """A concealed case.

    Arguments:
        model: the given model, TOML.
        runs, holdout: recordings.
        answer: `accept` (right answers: physics, kind of place, place), `all` (whether each must be found), `size`, `secrets`.
    """

    model: str
    runs: list[xr.DataTree]
    holdout: list[xr.DataTree]
    answer: dict[str, Any]


def make_case(seed: int | Sequence[int], physics: Sequence[str], size: str | tuple[float, float], plain: bool = False) -> Case:
    """A case, the same for the same arguments.

    Arguments:
        seed: of everything random.
        physics: names in EFFECTS that are concealed together; none: nothing is.
        size: of each: one of SIZES, or the least and most standard deviations that it leaves.
        plain: in a vehicle of one body that is fully instrumented, and in the plainest of their forms.

    Raises:
        ValueError: no vehicle was found that can have it so.
    """
    drawing, given, noise = (np.random.default_rng(part) for part in np.random.SeedSequence(seed).spawn(3))
    draft = draw_draft(drawing, physics, SIZES[size] if isinstance(size, str) else size, plain)
    scene = draft.scene
    recordings = [
        record(scene.instruments, motion, scene.duration, scene.bodies, noise) for motion in scene.motions(slice(None))
    ]
    return Case(model_text(draft.base, given), recordings[:-1], recordings[-1:], _answer(draft))


def write_case(case: Case, folder: Path) -> None:
    """Write model.toml, run_1.nc, ... and holdout_1.nc: all that a diagnosis may see, in place of a case that was there."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.nc"):
        old.unlink()
    (folder / "model.toml").write_text(case.model, encoding="utf-8")
    for kind, recordings in (("run", case.runs), ("holdout", case.holdout)):
        for number, recording in enumerate(recordings, 1):
            recording.to_netcdf(folder / f"{kind}_{number}.nc")


def _answer(draft: Draft) -> dict[str, Any]:
    accepted = [list(answer) for secret in draft.secrets for answer in secret.effect.answers()]
    left = [secret.left for secret in draft.secrets]
    return {
        "accept": accepted or [["consistent", None, None]],
        "all": len(draft.secrets) > 1,
        "size": named(min(left)) if left else None,
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
