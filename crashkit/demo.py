"""The demonstration: a made-up crash with a secret in it, diagnosed without the secret, which is opened at the end."""

import json
import os
import secrets
import sys
import webbrowser
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from crashkit import api
from crashkit.data.files import folder_to_fill
from crashkit.diagnose import Diagnosis
from crashkit.diagnose.result import place_of
from crashkit.errors import CrashkitError
from crashkit.registry import load
from crashkit.testing.concealed import EFFECTS, Case, make_case, read_answer, write_answer, write_case

SIZES = ("middle", "gross")
"""How visible the secret is: a small one would need luck."""
SEEDS = 100_000


def run(seed: int | None, output: Path, open_page: bool, progress: Callable[[str], None]) -> str:
    """Conceal a piece of physics, diagnose, show the page, open the seal.

    Arguments:
        seed: which secret; None: any.
        output: folder for the page; what is diagnosed goes into `case` below it.
        open_page: whether to show the page in a browser, if there is one.
        progress: told what is being done.

    Returns:
        the answer, where the page is, and whether the answer was right.
    """
    seed = secrets.randbelow(SEEDS) if seed is None else seed
    with folder_to_fill(output):
        progress(f"making a crash with a secret in it (to see it again: crashkit demo --seed {seed})")
        folder, case = output / "case", conceal(seed)
        write_case(case, folder)
        write_answer(case.answer, folder / "answer.json")
    runs, unseen = (sorted(folder.glob(f"{kind}_*.nc")) for kind in ("run", "holdout"))
    diagnosis = api.diagnose_files(folder / "model.toml", runs, unseen, output, progress)
    page = output / "index.html"
    if open_page:
        _show(page)
    judgement = reveal(diagnosis, read_answer(folder / "answer.json"))
    return "\n".join([diagnosis.summary, f"The page: {page}", "", judgement, f"Seed {seed}."])


def conceal(seed: int) -> Case:
    """A case with one piece of physics, plain to see, that an installed hypothesis names; the same for the same seed."""
    chance = np.random.default_rng(seed)
    size = str(chance.choice(SIZES))
    for physics in chance.permutation(_known_physics()):
        try:
            return make_case(seed, (str(physics),), size, plain=True)
        except ValueError:  # not every physics can be that plain to see in every crash
            continue
    raise CrashkitError(f"seed {seed}: expected one that conceals a physics, found none that fits its crash")


def reveal(diagnosis: Diagnosis, answer: dict[str, Any]) -> str:
    """What was concealed, and whether that, and nothing else, was found: physics and place count, the form does not."""
    told = [f"{e['physics']} at {place_of({e['kind']: e['place']})}" for e in answer["secrets"]]
    found = {_claim(f.physics, kind, place) for f in diagnosis.findings for kind, place in f.location.items()}
    right = {_claim(*accepted) for accepted in answer["accept"]}
    others = [f for f in diagnosis.findings if not any(_claim(f.physics, k, p) in right for k, p in f.location.items())]
    if not found & right:
        judgement = "The answer was wrong."
    elif others:
        judgement = f"It was found, and besides something that is not there: {', '.join(f.physics for f in others)}."
    else:
        judgement = "The answer was right."
    return f"The seal is opened. Concealed was: {' and '.join(told)}.\n{judgement}"


def _known_physics() -> list[str]:
    """What can be concealed and what an installed hypothesis names; `unknown` names nothing."""
    return sorted((set(EFFECTS) & set(load().hypotheses)) - {"unknown"})


def _claim(physics: str, kind: str, place: object) -> tuple[str, str, str]:
    """Comparable, with two bodies in any order."""
    return physics, kind, json.dumps(sorted(place) if isinstance(place, Iterable) and not isinstance(place, str) else place)


def _show(page: Path) -> None:
    """Opens the page where there is a screen; a demonstration never fails for want of one."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return
    try:
        webbrowser.open(page.resolve().as_uri())
    except (OSError, webbrowser.Error):
        pass
