"""Checks that every part of a model shares: single numbers, vectors, rows over time."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from crashkit.errors import Fault
from crashkit.model.parameter import Parameter

if TYPE_CHECKING:  # the protocols know the model, which checks its values here
    from crashkit.protocols import ParameterSpec


def parameter_faults(parameter: Parameter, spec: "ParameterSpec | None", where: str) -> Iterator[Fault]:
    """A parameter is finite and within its bounds."""
    value, lower, upper = parameter.value, parameter.lower, parameter.upper
    if (
        spec is not None and parameter.fixed and value in (spec.null, spec.default)
    ):  # absent physics may lie outside the bounds
        return
    slack = 1e-9 * abs(value)  # a value that was searched in its logarithm comes back from its bound with a rounding error
    if not math.isfinite(value):
        yield Fault(where, "a finite number", str(value))
    elif not lower <= upper:
        yield Fault(where, "a lower bound that does not exceed the upper", f"{lower} and {upper}")
    elif not lower - slack <= value <= upper + slack:
        yield Fault(where, f"a value {_interval(lower, upper)}", str(value))


def positive_faults(parameter: Parameter, noun: str, where: str) -> Iterator[Fault]:
    """A mass or a moment of inertia is above 0 and stays there."""
    yield from parameter_faults(parameter, None, where)
    if parameter.value <= 0:
        yield Fault(where, f"{noun} above 0", str(parameter.value))
    elif not parameter.fixed and parameter.lower < 0:
        yield Fault(where, "a lower bound of at least 0", str(parameter.lower))


def vector_faults(values: Sequence[float], axes: int, where: str) -> Iterator[Fault]:
    """A vector has a finite number for each axis of the model."""
    if len(values) != axes:
        yield Fault(where, f"one number for each of {axes} axes", counted(len(values)))
    yield from finite_faults(values, where)


def finite_faults(values: Sequence[float], where: str) -> Iterator[Fault]:
    """All numbers are finite."""
    for value in values:
        if not math.isfinite(value):
            yield Fault(where, "finite numbers", str(value))


def time_faults(time: Sequence[float], where: str) -> Iterator[Fault]:
    """Times of samples are at least two and increase."""
    yield from finite_faults(time, where)
    if len(time) < 2:
        yield Fault(where, "at least two times", counted(len(time)))
    for before, after in pairwise(time):
        if after <= before:
            yield Fault(where, "strictly increasing numbers", f"{after} after {before}")


def row_faults(rows: Sequence[Sequence[float]], times: int, numbers: int, where: str) -> Iterator[Fault]:
    """There is a row of so many finite numbers for each time; of the rows that are wrong only the first is told.

    That there are no times at all is a fault of the times.
    """
    if times and len(rows) != times:
        yield Fault(where, f"one row for each of {times} times", f"{len(rows)} rows")
    for index, row in enumerate(rows):
        if len(row) != numbers:
            yield Fault(f"{where}[{index}]", f"a row of {counted(numbers)}", counted(len(row)))
            return
    for index, row in enumerate(rows):
        yield from finite_faults(row, f"{where}[{index}]")


def counted(count: int) -> str:
    """How messages count numbers."""
    return "1 number" if count == 1 else f"{count} numbers"


def _interval(lower: float, upper: float) -> str:
    if lower == -math.inf:
        return f"of at most {upper}"
    return f"of at least {lower}" if upper == math.inf else f"from {lower} to {upper}"
