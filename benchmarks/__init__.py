"""Studies that measure crashkit beside its peers: each module is one, with `run() -> list[Row]`.

`python -m benchmarks NAME --json FILE` runs one, from the checkout.
"""

from collections.abc import Callable
from statistics import median
from time import perf_counter

from attrs import frozen


@frozen
class Row:
    """One comparison.

    Arguments:
        case: what was done.
        measure: "time", "error", "rate" or "memory".
        unit: of both numbers.
        ours: crashkit's number.
        peer: who else did it.
        theirs: the peer's number; None where it is not installed.
    """

    case: str
    measure: str
    unit: str
    ours: float
    peer: str
    theirs: float | None

    @property
    def ratio(self) -> float | None:
        """Ours over theirs; None where there is no peer or nothing to divide by."""
        return self.ours / self.theirs if self.theirs else None


def seconds(call: Callable[[], object]) -> float:
    """How long one call takes, s."""
    start = perf_counter()
    call()
    return perf_counter() - start


def pair(ours: Callable[[], object], theirs: Callable[[], object] | None, repeats: int = 7) -> tuple[float, float | None]:
    """Median times of both, s, taken by turns, as machines are noisy."""
    times = [(seconds(ours), seconds(theirs) if theirs else None) for _ in range(repeats)]
    return median(time for time, _ in times), median(time for _, time in times if time is not None) if theirs else None
