"""What is read from the source of a law, and what is refused."""

import math
from typing import ClassVar

import numpy as np
import pytest

from crashkit.errors import CrashkitError
from crashkit.mechanics import LawFunction
from crashkit.mechanics.laws.emit import emit
from crashkit.mechanics.laws.plain import plain
from crashkit.protocols import ParameterSpec, SpringLaw

LIMIT = 0.3


def law_of(function, *parameters):
    specs = tuple(ParameterSpec(name, "1", "any", vector=name.startswith("v")) for name in parameters)
    return type("Law", (SpringLaw,), {"name": "tested", "parameters": specs, "force": staticmethod(function)})


def functions(law, *sizes):
    """The emitted functions as plain Python."""
    written = plain(LawFunction(law, sizes))
    return written.mode, written.frozen, written.partials


def check(law, state, parameters, *sizes):
    """Value and partials at a state, against the law itself and its central differences."""
    mode, frozen, partials = functions(law, *sizes)
    vector = np.array([entry for value in parameters for entry in np.atleast_1d(value)], float)
    bits = mode(*state, 0.0, vector, 0)
    value, guard = frozen(bits, *state, 0.0, vector, 0)
    assert value == pytest.approx(law.force(*state, *parameters), rel=1e-14)
    assert guard >= 0.0
    found = np.empty(4 + vector.size)
    assert partials(bits, *state, 0.0, vector, 0, found) == value
    found = np.delete(found, 3)
    inputs = np.concatenate([state, vector])
    for i, h in enumerate(1e-6 * np.maximum(1.0, np.abs(inputs))):
        above, below = (inputs + sign * h * (np.arange(inputs.size) == i) for sign in (1, -1))
        slope = (frozen(bits, *above[:3], 0.0, above[3:], 0)[0] - frozen(bits, *below[:3], 0.0, below[3:], 0)[0]) / (2 * h)
        assert found[i] == pytest.approx(slope, rel=1e-6, abs=1e-8)
    return bits, value, guard


def everything(d, ddot, d_max, a, b, v):
    """Every construction of the subset."""
    total: float = 0.0
    for i in range(len(v) - 1):
        if v[i] <= d < v[i + 1]:
            total += a * (d - v[i]) ** 2
    for i, entry in enumerate(v):
        total -= entry * max(0.0, d - i * LIMIT, ddot) / (1 + b)
    total = total + (math.sin(d * a) if not (ddot > 0 and d_max > 2 * d) else -math.exp(-abs(ddot)))
    if a > b or d > 5.0:
        return total * math.pi
    elif min(a, d) < v[-1]:
        return math.sqrt(1.0 + total**2) + a**b
    return math.tanh(total) * math.log(1.0 + d_max) + 2.0**a


@pytest.mark.parametrize("d", [-0.2, 0.35, 0.75, 1.6])
@pytest.mark.parametrize("ddot", [-0.5, 0.4])
@pytest.mark.parametrize("a", [0.3, 1.4])
@pytest.mark.parametrize("d_max", [1.7, 4.0])
def test_the_whole_subset(d, ddot, d_max, a):
    check(law_of(everything, "a", "b", "v"), (d, ddot, d_max), (a, 0.8, [0.1, 0.5, 1.1]), 3)


def test_branches_of_parameters_alone_have_no_guard():
    def force(d, ddot, d_max, a):
        return a * d if a > 1.0 else -a * d

    law = law_of(force, "a")
    assert check(law, (0.5, 0.0, 0.5), (2.0,)) == (0, 1.0, math.inf)
    assert check(law, (0.5, 0.0, 0.5), (0.5,)) == (0, -0.25, math.inf)


def test_the_guard_is_the_distance_to_the_nearest_branch():
    def force(d, ddot, d_max, a):
        return a * max(0.0, d - 0.2) + min(0.0, ddot)

    law = law_of(force, "a")
    assert check(law, (0.5, 2.0, 0.5), (3.0,))[2] == pytest.approx(0.3)
    assert check(law, (0.5, 0.1, 0.5), (3.0,))[2] == pytest.approx(0.1)
    mode, frozen, _ = functions(law)
    before = mode(0.5, 0.1, 0.5, 0.0, [3.0], 0)
    assert frozen(before, 0.15, 0.1, 0.5, 0.0, [3.0], 0) == (pytest.approx(-0.15), pytest.approx(-0.05))


def loop(d, ddot, d_max, a):
    while d > a:
        d = d - a
    return d


def unlike(d, ddot, d_max, a):
    return a * d


def calls_itself(d, ddot, d_max, a):
    return calls_itself(d, ddot, d_max, a) if d > a else d


def calls_a_loop(d, ddot, d_max, a):
    return loop(d, ddot, d_max, a)


def calls_with_too_little(d, ddot, d_max, a):
    return unlike(d, a)


def calls_something_else(d, ddot, d_max, a):
    return round(d * a)


def equality(d, ddot, d_max, a):
    return a if d == 0.0 else 0.0


def open_path(d, ddot, d_max, a):
    if d > a:
        return d


def one_side(d, ddot, d_max, a):
    if d > a:
        x = 1.0
    return x


def too_far(d, ddot, d_max, v):
    return v[3] * d


def bare(d, ddot, d_max, v):
    return v * d


def moving(d, ddot, d_max, v):
    return v[d]


def many(d, ddot, d_max, v):
    total = 0.0
    for knot in range(len(v)):
        total = total + v[knot] * max(0.0, d - knot)
    return total


def remainder(d, ddot, d_max, a):
    return d % a


REFUSED = [
    (loop, ("a",), (), "found `while d > a:`; use assignments, if, min"),
    (calls_a_loop, ("a",), (), "found `while d > a:`; use assignments, if, min"),
    (calls_itself, ("a",), (), r"found `calls_itself\(d, ddot, d_max, a\)`, a function that calls itself; use"),
    (calls_with_too_little, ("a",), (), r"found `unlike\(d, a\)`; expected d, ddot, d_max, a as its arguments"),
    (calls_something_else, ("a",), (), r"found `round\(d \* a\)`; use .*; of math: acos"),
    (equality, ("a",), (), "found a state compared for equality; compare with <, <=, > or >="),
    (open_path, ("a",), (), "found a path without return; return a value on every path"),
    (one_side, ("a",), (), "found `x`, which is not assigned on every path and no constant"),
    (too_far, ("v",), (3,), "found entry 3 of `v`; it has 3 entries"),
    (bare, ("v",), (3,), r"found the vector `v` without an index; write v\[i\]"),
    (moving, ("v",), (3,), "found the index `d`; use whole numbers that do not depend on the state"),
    (many, ("v",), (63,), "found 63 branches; at most 62 are possible: use fewer knots"),
    (remainder, ("a",), (), "found `d % a`; use assignments"),
    (unlike, ("a", "b"), (), "expected force to take d, ddot, d_max, a, b, found d, ddot, d_max, a"),
]


@pytest.mark.parametrize(("function", "parameters", "sizes", "message"), REFUSED)
def test_what_is_outside_the_subset_is_named_with_line_and_remedy(function, parameters, sizes, message):
    with pytest.raises(CrashkitError, match=rf"^spring law tested \(.*test_derivation.py:\d+\): {message}"):
        emit(LawFunction(law_of(function, *parameters), sizes))


def test_the_line_is_the_line_of_the_file():
    line = equality.__code__.co_firstlineno + 1
    with pytest.raises(CrashkitError, match=f"test_derivation.py:{line}"):
        emit(LawFunction(law_of(equality, "a")))


def test_a_law_without_source():
    written: dict = {}
    exec("def force(d, ddot, d_max):\n    return d\n", written)
    with pytest.raises(
        CrashkitError, match="spring law tested: its force has no source that can be read .* define it with def"
    ):
        emit(LawFunction(law_of(written["force"])))


class Indented(SpringLaw):
    """Defined as a third party would."""

    name = "indented"
    parameters: ClassVar = (ParameterSpec("k", "N m-1", "slope"),)

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        k: float,
    ) -> float:
        """With a docstring."""
        return k * d


def test_a_method_over_several_lines():
    assert check(Indented, (0.5, 0.0, 0.5), (3.0,))[1] == 1.5


# ---- functions of the author's own ----


def share(x, limit):
    """Several returns, each with a branch of its own."""
    if x > limit:
        return 1.0
    if x <= 0.0:
        return 0.0
    return x / limit


def along(x, xs, ys):
    """A broken line, by a loop over two vectors."""
    total = 0.0
    for start, slope in zip(xs, ys):  # noqa: B905
        total += slope * max(0.0, x - start)
    return total


def pasting(d, ddot, d_max, a, v, v2):
    if ddot > 0.0:
        return a * share(d, LIMIT) + along(d, v, v2)
    return np.tanh(along(d_max, v, v2)) * share(share(d, 2.0 * a), 0.7)


@pytest.mark.parametrize("d", [-0.2, 0.15, 0.35, 1.6])
@pytest.mark.parametrize("ddot", [-0.5, 0.4])
def test_functions_are_pasted(d, ddot):
    check(law_of(pasting, "a", "v", "v2"), (d, ddot, 1.7), (1.3, [0.1, 0.5], [0.4, 0.9]), 2, 2)


def of_constants(d, ddot, d_max, a):
    return a * (math.tanh(d) + math.tanh(1.5 * LIMIT))


def test_a_function_of_constants_is_a_constant():
    check(law_of(of_constants, "a"), (0.5, 0.0, 0.5), (2.0,))


def iterating(d, ddot, d_max, v):
    total = 0.0
    for entry in v:
        total += entry * max(0.0, d)
    return total


def test_a_loop_over_a_vector():
    assert check(law_of(iterating, "v"), (0.5, 0.0, 0.5), ([1.0, 2.0, 3.0],), 3)[1] == 3.0


def test_a_function_of_an_enclosing_scope():
    """Laws that a function makes, each with numbers of its own."""

    def made(limit):
        def force(d, ddot, d_max, a):
            return a * max(0.0, d - limit)

        return law_of(force, "a")

    assert check(made(0.2), (0.5, 0.0, 0.5), (2.0,))[1] == pytest.approx(0.6)
    assert check(made(0.4), (0.5, 0.0, 0.5), (2.0,))[1] == pytest.approx(0.2)


# ---- memory and jumps ----


class Breaking(SpringLaw):
    """Remembers, and jumps with the memory, the deformation or the rate."""

    name = "breaking"
    memory = "z"
    jumps = True
    parameters: ClassVar = (ParameterSpec("k", "N m-1", "slope"), ParameterSpec("limit", "1", "any"))

    @staticmethod
    def force(d, ddot, d_max, z, k, limit):
        if z * k > limit or d_max > 2.0 * limit:
            return 0.0
        return k * (d - z) if ddot > limit else k * d

    @staticmethod
    def memory_rate(d, ddot, d_max, z, k, limit):
        return (d - z) / limit


POINTS = [(0.3, 0.2, 0.4, 0.1), (0.3, 0.9, 0.4, 0.1), (0.3, 0.9, 0.4, 0.7), (0.3, 0.9, 1.4, 0.1)]


@pytest.mark.parametrize("point", POINTS)
def test_the_derivatives_of_the_nearest_guard(point):
    written = plain(LawFunction(Breaking))
    numbers, out = np.array([1.5, 0.5]), np.empty(6)
    mode = written.mode(*point, numbers, 0)
    found = written.guard(mode, *point, numbers, 0, out)
    assert found == written.frozen(mode, *point, numbers, 0)[1] >= 0.0
    inputs = np.array([*point, *numbers])
    for i in range(6):
        above, below = (inputs + sign * 1e-6 * (np.arange(6) == i) for sign in (1, -1))
        slope = sum(sign * written.frozen(mode, *near[:4], near[4:], 0)[1] for sign, near in ((1, above), (-1, below))) / 2e-6
        assert out[i] == pytest.approx(slope, abs=1e-8)


def test_a_memory_is_an_argument_of_both_functions():
    rate = plain(LawFunction(Breaking, (), "memory_rate"))
    out = np.empty(6)
    assert rate.partials(0, 0.3, 0.2, 0.4, 0.1, np.array([1.5, 0.5]), 0, out) == pytest.approx(0.4)
    np.testing.assert_allclose(out, [2.0, 0.0, 0.0, -2.0, 0.0, -0.8])
