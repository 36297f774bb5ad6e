"""How long one record takes, from 200 to a million samples, by turns with each peer."""

from functools import partial

from benchmarks import Row, pair
from benchmarks.smoothing.peers import AUTOMATIC, BEST, OWN, SLOW, TOLD, Method, ours
from benchmarks.smoothing.pulses import even, film, half_sine

COUNTS = (200, 2000, 10_000, 100_000, 1_000_000)
LIMITS = {"make_smoothing": (2000, "a minute at 1e5"), "pynumdiff": (200, "its search calls the method hundreds of times")}
"""By a part of a peer's name, the samples that it can be waited for, and why no more."""


def run() -> list[Row]:
    """Times of every method at every number of samples."""
    rows = []
    for count in COUNTS:
        recorded = film(half_sine, even(count), 0)
        mine = partial(ours(BEST), recorded)
        mine()  # compiled, or read from the cache, once
        peers = {**AUTOMATIC, **TOLD, **{name: ours(name) for name in (*OWN, "spectral")}, **SLOW}
        for name, method in peers.items():
            label, theirs = _limited(name, method, count)
            call = partial(theirs, recorded) if theirs else None
            repeats = 1 if "pynumdiff" in name or count > 100_000 else 3
            our_time, their_time = pair(mine, call, repeats)
            rows.append(Row(f"{count} samples", "time", "s", our_time, label, their_time))
    return rows


def _limited(name: str, method: Method | None, count: int) -> tuple[str, Method | None]:
    for part, (most, reason) in LIMITS.items():
        if part in name and count > most:
            return f"{name} (skipped: {reason})", None
    return name, method
