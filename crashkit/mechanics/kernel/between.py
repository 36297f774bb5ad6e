# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""Instants within a step: the cubic through the state and its derivative at both ends, and the derivative of that.

With the state y and its derivative k at the ends 0 and 1 of a step h, after a share s of it

    y(s) = (1 + 2 s) (1 - s)^2 y_0 + s^2 (3 - 2 s) y_1 + h s (1 - s)^2 k_0 - h s^2 (1 - s) k_1,
    k(s) = 6 s (1 - s) (y_1 - y_0) / h + (1 - s) (1 - 3 s) k_0 + s (3 s - 2) k_1.
"""

import math

from crashkit.mechanics.kernel.arrays import END, START
from crashkit.mechanics.kernel.stand_ins import compiled, inlined

# ---- compiled from here ----


@inlined
def cubic(s, h):
    """The weights of y_0, y_1, k_0 and k_1 in the state after a share of a step."""
    left = 1.0 - s
    return (1.0 + 2.0 * s) * left * left, s * s * (3.0 - 2.0 * s), h * s * left * left, -h * s * s * left


@inlined
def slope_of_cubic(s, h):
    """Those in its derivative."""
    change = 6.0 * s * (1.0 - s) / h
    return -change, change, (1.0 - s) * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)


@compiled
def write_between(state, tangent, values, tangents, k, s, h):
    """The state after a share of a step becomes entry k of the record, in which nothing is known of forces."""
    size = state.shape[1] // 2
    weights = cubic(s, h), slope_of_cubic(s, h)
    for part in range(2):
        y_0, y_1, k_0, k_1 = weights[part]
        for i in range(size):
            to = part * size + i
            ends = y_0 * state[START, i] + y_1 * state[END, i]
            values[k, to] = ends + k_0 * state[START, size + i] + k_1 * state[END, size + i]
            for c in range(tangent.shape[2]):
                ends = y_0 * tangent[START, i, c] + y_1 * tangent[END, i, c]
                tangents[k, to, c] = ends + k_0 * tangent[START, size + i, c] + k_1 * tangent[END, size + i, c]
    for i in range(2 * size, values.shape[1]):
        values[k, i] = math.nan
