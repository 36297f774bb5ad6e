"""A law whose author gives its branches and their derivatives himself: what the engine calls, around his functions."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numba
import numpy as np
from numba.core.errors import NumbaError

from crashkit.errors import CrashkitError
from crashkit.mechanics.laws.paste import paste
from crashkit.mechanics.laws.source import LawFunction, read_law
from crashkit.protocols import SpringLaw

PARTS = {"branch": ((), ()), "branch_force": (("branch",), ()), "branch_slopes": (("branch",), ("slopes",))}
"""The author's functions, each with its arguments before and after those of `force`."""


def has_own_branches(function: LawFunction) -> bool:
    """Whether the author gives the branches of this function himself."""
    return function.part == "force" and any(getattr(function.law, part, None) is not None for part in PARTS)


def emit_own(function: LawFunction) -> str:
    """Source of what the engine calls around the author's functions, which are pasted before it.

    They tell no guard but the smallest, which stands for each.
    """
    law = function.law
    check_own(law)
    values = ", ".join(["d", "ddot", "d_max", *(["z"] if law.memory else []), *_parameters(function)])
    pasted = [paste(law.name, getattr(law, part), f"law_{part}") for part in PARTS]
    slopes = [f"law_branch_slopes(mode, {values}, out)"]
    if not law.memory:  # what is written without a memory leaves no room for its derivative
        slopes = [
            f"law_branch_slopes(mode, {values}, out[1:])",
            "out[0], out[1], out[2], out[3] = out[1], out[2], out[3], 0.0",
        ]
    return "\n\n".join(
        [
            *pasted,
            _function("law_mode(d, ddot, d_max, z, p, o)", [f"return law_branch({values})"]),
            _function("law_frozen(mode, d, ddot, d_max, z, p, o)", [f"return law_branch_force(mode, {values})"]),
            _function("law_distance(which, mode, d, ddot, d_max, z, p, o)", [f"return law_branch_force(mode, {values})[1]"]),
            _function(
                "law_partials(mode, d, ddot, d_max, z, p, o, out)",
                [*slopes, f"return law_branch_force(mode, {values})[0]"],
            ),
        ]
    )


def check_own(law: type[SpringLaw]) -> None:
    """Raise CrashkitError where one of the author's functions is missing or takes other arguments than it should."""
    for part, (before, after) in PARTS.items():
        if getattr(law, part, None) is None:
            raise CrashkitError(f"spring law {law.name}: expected {', '.join(PARTS)} together, found no {part}")
        read_law(law, part, before, after)
    if law.jumps:
        raise CrashkitError(
            f"spring law {law.name}: expected a law with branches of its own to be continuous, found jumps = True; "
            "keep what jumps to a factor whose `force` alone says all"
        )


def compile_own(function: LawFunction, point: Sequence[float], numbers: np.ndarray) -> None:
    """Raise CrashkitError where numba cannot compile one of the author's functions.

    Arguments:
        function: of the law.
        point: d, ddot, d_max and memory, at which they are called.
        numbers: of the parameters.
    """
    scope: dict[str, Any] = {"math": math, "np": np, "jitted": numba.njit(error_model="numpy")}
    exec(compile(emit_own(function), f"<{function.law.name}>", "exec"), scope)
    try:
        mode = scope["law_mode"](*point, numbers, 0)
        scope["law_frozen"](mode, *point, numbers, 0)
        scope["law_partials"](mode, *point, numbers, 0, np.zeros(4 + numbers.size))
    except NumbaError as error:
        reason = next((line.strip() for line in str(error).splitlines() if line.strip()), "")
        raise CrashkitError(f"spring law {function.law.name}: numba cannot compile its branches: {reason}") from error


def _parameters(function: LawFunction) -> Iterator[str]:
    """Each parameter as the author's functions take it: a number, or an array where it is a vector."""
    lengths, place = function.lengths(), 0
    for spec in function.law.parameters:
        length = lengths.get(spec.name, 1)
        yield f"p[o + {place} : o + {place + length}]" if spec.vector else f"p[o + {place}]"
        place += length


def _function(head: str, body: list[str]) -> str:
    return "\n".join(["@jitted", f"def {head}:", *(f"    {line}" for line in body)])
