"""How time is taken on a machine that others use as well."""

from collections.abc import Callable, Mapping
from time import perf_counter, thread_time


def fastest(
    calls: Mapping[str, Callable[[], object] | None],
    budget: float = 4.0,
    rounds: int = 3,
    clock: Callable[[], float] = thread_time,
) -> dict[str, float | None]:
    """The least time of each call, s, taken by turns until the budget is spent, after a first one that does not count.

    What else runs on the machine only ever adds to a time, so that the least is the nearest to the truth. The time is that of
    the processor, in which the thread's pauses do not count; for calls of several threads `clock` is that of the wall.
    """
    known = {name: call for name, call in calls.items() if call}
    for call in known.values():
        call()
    times: dict[str, list[float]] = {name: [] for name in known}
    end = perf_counter() + budget
    while perf_counter() < end or min(map(len, times.values())) < rounds:
        for name, call in known.items():
            start = clock()
            call()
            times[name].append(clock() - start)
    return {name: min(times[name]) if name in known else None for name in calls}
