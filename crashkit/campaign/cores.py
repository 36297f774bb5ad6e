"""Work spread over the processor's cores: processes that begin as copies of this one, and send back only what is new."""

import multiprocessing
import os
import sys
import warnings
from collections.abc import Callable, Sequence
from functools import wraps
from multiprocessing.connection import Connection
from typing import Any, ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

Item = TypeVar("Item")
Result = TypeVar("Result")
Given = ParamSpec("Given")
_alone = False
"""In a copy: what it is asked to spread it does itself."""


def one_thread(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """The function with numpy's libraries kept to one thread.

    On many small matrices their threads only wait for each other, and those of copies of this process take each other's cores.
    """

    @wraps(function)
    def alone(*arguments: Given.args, **named: Given.kwargs) -> Result:
        with threadpool_limits(1, "blas"):
            return function(*arguments, **named)

    return alone


def spread(
    function: Callable[[Item], Result], items: Sequence[Item], told: Callable[[int], None] = lambda done: None
) -> list[Result]:
    """[function(item) for item in items], on all cores where the system can copy processes (Linux).

    This process takes items like the others. What a copy leaves undone, it does as well: so an error shows here.

    Arguments:
        function: its results can be pickled.
        told: how many have been taken so far, before each that this process takes; where it raises, nothing more is taken.
    """
    copies = 0 if _alone or sys.platform != "linux" else min(len(os.sched_getaffinity(0)), len(items)) - 1
    if copies < 1:
        results = {}
        for number, item in enumerate(items):
            told(number)
            results[number] = function(item)
        return list(results.values())
    results = _shared(function, items, copies, told)
    return [results[number] if number in results else function(item) for number, item in enumerate(items)]


def _shared(
    function: Callable[[Item], Result], items: Sequence[Item], copies: int, told: Callable[[int], None]
) -> dict[int, Result]:
    context = multiprocessing.get_context("fork")
    taken = context.Value("i", 0)
    ends: list[Connection] = []
    for _ in range(copies):
        here, there = context.Pipe(duplex=False)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            context.Process(target=_copy, args=(function, items, taken, there, (*ends, here)), daemon=True).start()
        there.close()
        ends.append(here)
    try:
        results = _take(function, items, taken, told)
    except BaseException:
        taken.value = len(items)
        raise
    for end in ends:
        try:
            results |= end.recv()
        except EOFError:
            continue
    return results


def _take(
    function: Callable[[Item], Result], items: Sequence[Item], taken: Any, told: Callable[[int], None]
) -> dict[int, Result]:
    results: dict[int, Result] = {}
    while True:
        with taken.get_lock():
            number = taken.value
            taken.value += 1
        if number >= len(items):
            return results
        told(number)
        results[number] = function(items[number])


def _copy(
    function: Callable[[Item], Result], items: Sequence[Item], taken: Any, there: Connection, ends: Sequence[Connection]
) -> None:
    """What a copy does. It closes the ends at which its parent reads: holding them, it would wait forever to be read."""
    global _alone
    _alone = True
    for end in ends:
        end.close()
    sys.stderr = open(os.devnull, "w")
    there.send(_take(function, items, taken, lambda done: None))
