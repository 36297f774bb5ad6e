"""The functions that the engine compiles of a law, as plain Python: for checks, and for one state at a time."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from attrs import frozen

from crashkit.mechanics.laws.emit import emit
from crashkit.mechanics.laws.source import LawFunction


@frozen
class Plain:
    """A law's functions, see `emit`.

    Arguments:
        mode: (d, ddot, d_max, memory, numbers, 0), the branches that a state takes.
        frozen: (mode, d, ddot, d_max, memory, numbers, 0), value and smallest guard on given branches.
        distance: (branch, mode, d, ddot, d_max, memory, numbers, 0), one of the guards.
        partials: (mode, d, ddot, d_max, memory, numbers, 0, out), value, and into `out` its derivatives.
        guard: the same for the smallest guard of a law that may jump; None for others.
    """

    mode: Callable[..., int]
    frozen: Callable[..., tuple[float, float]]
    distance: Callable[..., float]
    partials: Callable[..., float]
    guard: Callable[..., float] | None


@cache
def plain(function: LawFunction) -> Plain:
    """A law's functions as plain Python; raises CrashkitError where they cannot be had."""
    scope: dict[str, Any] = {"math": math, "np": np, "jitted": lambda written: written}
    exec(compile(emit(function), f"<{function.law.name}>", "exec"), scope)
    mode, value, distance, partials = (scope[f"law_{part}"] for part in ("mode", "frozen", "distance", "partials"))
    return Plain(mode, value, distance, partials, scope.get("law_guard"))
