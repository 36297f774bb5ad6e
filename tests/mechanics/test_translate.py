"""What LLVM makes of the generated functions of laws does what Python makes of them."""

import math

import numba
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from crashkit.mechanics import LawFunction, compile_engine
from crashkit.mechanics.laws.linking import law_distance, law_frozen, law_guard, law_mode, law_partials
from crashkit.mechanics.laws.plain import plain
from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws import SPRING_LAWS

LENGTH = 3


def everything(d, ddot, d_max, a, b, v):
    """Every function that a law may call, and every construction of what is generated."""
    total = math.sqrt(1.0 + d * d) + math.exp(-abs(ddot)) + math.expm1(d) + math.log(2.0 + d_max) + math.log1p(d_max)
    total += math.sin(d) + math.cos(ddot) + math.tan(0.1 * d) + math.asin(0.1 * d) + math.acos(0.1 * d) + math.atan(ddot)
    total += math.sinh(d) + math.cosh(d) + math.tanh(ddot) + math.erf(d)
    for i, entry in enumerate(v):
        total -= entry * max(0.0, d - 0.1 * i, ddot) / (1.0 + b)
    if a > b or d > 0.5:
        return total * math.pi
    if a == b:
        return -total
    return total + (1.0 + d_max) ** a


SPECS = tuple(ParameterSpec(name, "1", "any", vector=name == "v") for name in "abv")
EVERYTHING = type("Everything", (SpringLaw,), {"name": "everything", "parameters": SPECS, "force": staticmethod(everything)})


def functions_of_all_laws():
    for law in (EVERYTHING, *SPRING_LAWS):
        sizes = tuple(LENGTH for spec in law.parameters if spec.vector)
        yield LawFunction(law, sizes)
        if law.memory:
            yield LawFunction(law, sizes, "memory_rate")


FUNCTIONS = tuple(functions_of_all_laws())


@pytest.fixture(scope="module")
def engine():
    return compile_engine(FUNCTIONS)


@numba.njit
def mode(code, d, ddot, d_max, z, p):
    return law_mode(code, d, ddot, d_max, z, p, 0)


@numba.njit
def frozen(code, bits, d, ddot, d_max, z, p):
    return law_frozen(code, bits, d, ddot, d_max, z, p, 0)


@numba.njit
def distance(code, which, bits, d, ddot, d_max, z, p):
    return law_distance(code, which, bits, d, ddot, d_max, z, p, 0)


@numba.njit
def partials(code, bits, d, ddot, d_max, z, p, out):
    return law_partials(code, bits, d, ddot, d_max, z, p, 0, out)


@numba.njit
def guard(code, bits, d, ddot, d_max, z, p, out):
    return law_guard(code, bits, d, ddot, d_max, z, p, 0, out)


def in_python(written, state, numbers):
    """Branches, value and guard, and the derivatives of both, each behind what it belongs to."""
    bits = written.mode(*state, numbers, 0)
    found = []
    for function in (written.partials, written.guard):
        slopes = np.zeros(4 + numbers.size)
        value = function(bits, *state, numbers, 0, slopes) if function else math.inf
        found.append(np.append(slopes, value))
    return bits, written.frozen(bits, *state, numbers, 0), found


@settings(deadline=None, max_examples=300)
@given(data=st.data())
def test_every_law_gives_what_its_text_gives_in_python(engine, data):
    function = data.draw(st.sampled_from(FUNCTIONS), label="function")
    state = [data.draw(st.floats(*limits)) for limits in ((-0.3, 1.0), (-9.0, 9.0), (0.0, 1.0), (-1.0, 1.0))]
    numbers = np.sort(data.draw(st.lists(st.floats(0.01, 2.0), min_size=function.count(), max_size=function.count())))
    try:
        bits, value, slopes = in_python(plain(function), state, numbers)
    except (ArithmeticError, ValueError, RuntimeWarning):  # compiled code goes on with nan or infinity
        assume(False)
    assume(all(np.isfinite(slope[:-1]).all() for slope in slopes))
    code = engine.codes[function]
    assert mode(code, *state, numbers) == bits
    assert frozen(code, bits, *state, numbers) == pytest.approx(value, rel=1e-12, abs=1e-12)
    distances = [distance(code, which, bits, *state, numbers) for which in range(62)]
    written = [plain(function).distance(which, bits, *state, numbers, 0) for which in range(62)]
    np.testing.assert_allclose(distances, written, rtol=1e-12, atol=1e-12)
    assert min(distances) == pytest.approx(value[1], rel=1e-12, abs=1e-12)
    for derivative, expected in zip((partials, guard), slopes, strict=True):
        found = np.zeros(4 + numbers.size)
        found = np.append(found, derivative(code, bits, *state, numbers, found))
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 + 1e-9 * np.abs(expected[:-1]).max())
