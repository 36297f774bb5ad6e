"""How near the derivatives are: medians of the root mean square error over draws of the noise."""

from collections.abc import Mapping, Sequence

import numpy as np

from benchmarks import Row
from benchmarks.smoothing.peers import AUTOMATIC, BEST, EVEN_ONLY, OWN, SLOW, TOLD, Method, oracle, ours
from benchmarks.smoothing.pulses import PULSES, Recorded, even, film, half_sine, uneven

DRAWS, FEW = 20, 3
QUANTITIES = (("x", "mm", 1e3), ("v", "m s-1", 1.0), ("a", "m s-2", 1.0))
SMALL = 200
COUNTS = (2000, 20_000, 200_000)
SCIPY_MOST = 5000
"""Samples that scipy's search can be waited for; at 1e5 it takes a minute."""


def run() -> list[Row]:
    """The table of marks, other pulses, other samplings."""
    return [*_marks(), *_pulses(), *_unequal(), *_counts()]


def compared(
    case: str, draws: Sequence[Recorded], peers: Mapping[str, Method | None], quantities: str = "xva", worst: bool = False
) -> list[Row]:
    """Rows of the best smoother against each peer on the same draws; `worst` adds the worst acceleration of all draws."""
    mine, rows = errors(ours(BEST), draws), []
    for peer, method in peers.items():
        theirs = errors(method, draws) if method else None
        for index, (name, unit, scale) in enumerate(QUANTITIES):
            if name in quantities:
                other = None if theirs is None else float(np.median(theirs[:, index])) * scale
                rows.append(Row(f"{case}: {name}", "error", unit, float(np.median(mine[:, index])) * scale, peer, other))
        if worst:
            other = None if theirs is None else float(theirs[:, 2].max())
            rows.append(Row(f"{case}: a, worst of {len(draws)}", "error", "m s-2", float(mine[:, 2].max()), peer, other))
    return rows


def errors(method: Method, draws: Sequence[Recorded]) -> np.ndarray:
    """(draw, 3) root mean square errors of position, velocity and acceleration."""
    return np.array([np.sqrt(np.mean((method(draw) - draw.truth) ** 2, axis=1)) for draw in draws])


def own(*names: str) -> dict[str, Method | None]:
    """Others of crashkit's smoothers, as peers."""
    return {name: ours(name) for name in names}


def _marks() -> list[Row]:
    draws = [film(half_sine, even(SMALL), draw) for draw in range(DRAWS)]
    peers = {**EVEN_ONLY, **AUTOMATIC, **TOLD, **own(*OWN, "spectral"), "oracle quintic": oracle}
    few = compared(f"half sine, {FEW} draws", draws[:FEW], SLOW)
    return [*compared("half sine", draws, peers, worst=True), *few]


def _pulses() -> list[Row]:
    peers = {**EVEN_ONLY, **AUTOMATIC, **TOLD, **own("gcv_quintic", "spectral"), "oracle quintic": oracle}
    rows = []
    for pulse, acceleration in PULSES.items():
        draws = [film(acceleration, even(SMALL), draw) for draw in range(DRAWS)]
        rows += compared(pulse, draws, peers, "a", worst=True)
    return rows


def _unequal() -> list[Row]:
    draws = [film(half_sine, uneven(SMALL), draw) for draw in range(DRAWS)]
    return compared("steps 0.2 to 1.8 ms", draws, {**AUTOMATIC, **TOLD, **own(*OWN), "oracle quintic": oracle})


def _counts() -> list[Row]:
    rows = []
    for count in COUNTS:
        draws = [film(half_sine, even(count), draw) for draw in range(FEW)]
        peers = {**AUTOMATIC, **TOLD, **own("gcv_quintic", "gcv_heptic"), "oracle quintic": oracle}
        if count > SCIPY_MOST:
            peers = {_skipped(name): None if "make_smoothing" in name else method for name, method in peers.items()}
        rows += compared(f"{count} samples", draws, peers, "a")
    return rows


def _skipped(name: str) -> str:
    return f"{name} (skipped: a minute at 1e5)" if "make_smoothing" in name else name
