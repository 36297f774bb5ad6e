# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""Instants within a step: the cubic through the state and its derivative at both ends, and the derivative of that.

With the state y and its derivative k at the ends 0 and 1 of a step h, after a share s of it

    y(s) = (1 + 2 s) (1 - s)^2 y_0 + s^2 (3 - 2 s) y_1 + h s (1 - s)^2 k_0 - h s^2 (1 - s) k_1,
    k(s) = 6 s (1 - s) (y_1 - y_0) / h + (1 - s) (1 - 3 s) k_0 + s (3 s - 2) k_1.

A force is to its impulse what k is to y, and the impulse over the step is that of the Runge-Kutta rule,

    F(s) = s (1 - s) (F_0 + 2 F_1 + 2 F_2 + F_3) + (1 - s) (1 - 3 s) F_0 + s (3 s - 2) F_4,

with the forces F_0 to F_3 at its stages and F_4 at its end.
"""

import math

from crashkit.mechanics.kernel.arrays import (
    DEFORMATION,
    DEFORMATION_BEFORE,
    END,
    FORCES,
    NONE,
    RATE,
    RATE_BEFORE,
    START,
)
from crashkit.mechanics.kernel.line import DOF
from crashkit.mechanics.kernel.stand_ins import compiled, inlined, unaliased

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


@inlined
def force_within(s):
    """The weights of the forces at the five stages; those of the two in the middle are the same."""
    both = s * (1.0 - s)
    return both + (1.0 - s) * (1.0 - 3.0 * s), 2.0 * both, both, s * (3.0 * s - 2.0)


@unaliased
def blend(out, w_0, w_1, w_2, w_3, start, end, slope_start, slope_end):
    """The derivatives of what is read off a cubic."""
    for c in range(out.size):
        ends = w_0 * start[c] + w_1 * end[c]
        out[c] = ends + w_2 * slope_start[c] + w_3 * slope_end[c]


@unaliased
def blend_stages(out, f_0, f_1, f_3, f_4, start, first, second, third, end):
    """The derivatives of a force within a step."""
    for c in range(out.size):
        inner = f_1 * (first[c] + second[c]) + f_3 * third[c]
        out[c] = f_0 * start[c] + inner + f_4 * end[c]


@inlined
def write_state_between(state, tangent, values, tangents, slots, k, weights):
    """The state and its derivative, each by its own weights."""
    size = state.shape[1] // 2
    for part in range(2):
        y_0, y_1, k_0, k_1 = weights[part]
        for i in range(size):
            to = slots[part * size + i]
            if to == NONE:
                continue
            ends = y_0 * state[START, i] + y_1 * state[END, i]
            values[k, to] = ends + k_0 * state[START, size + i] + k_1 * state[END, size + i]
            blend(
                tangents[k, to], y_0, y_1, k_0, k_1, tangent[START, i], tangent[END, i], tangent[START, size + i],
                tangent[END, size + i],
            )  # fmt: skip


@inlined
def write_joint_between(joint, own, values, tangents, slots, k, entry, shares, weights):
    """Its force, and the cubic through its deformation and the rate of that, with its derivative."""
    f_0, f_1, f_3, f_4 = shares
    forces, to = joint.forces, slots[entry]
    if to != NONE:
        inner = f_1 * (forces[1] + forces[2]) + f_3 * forces[3]
        values[k, to] = f_0 * forces[START] + inner + f_4 * forces[END]
        blend_stages(
            tangents[k, to], f_0, f_1, f_3, f_4, own[FORCES + START], own[FORCES + 1], own[FORCES + 2], own[FORCES + 3],
            own[FORCES + END],
        )  # fmt: skip
    for part in range(2):
        d_0, d_1, ddot_0, ddot_1 = weights[part]
        to = slots[entry + 1 + part]
        if to == NONE:
            continue
        values[k, to] = d_0 * joint.d_before + d_1 * joint.d + ddot_0 * joint.ddot_before + ddot_1 * joint.ddot
        blend(
            tangents[k, to], d_0, d_1, ddot_0, ddot_1, own[DEFORMATION_BEFORE], own[DEFORMATION], own[RATE_BEFORE], own[RATE]
        )


@inlined
def write_net_between(bodies, net_tangent, values, tangents, slots, k, entry, shares):
    """The forces and moments of the joints on the bodies."""
    f_0, f_1, f_3, f_4 = shares
    for i in range(DOF * bodies.size):
        net, axis, to = bodies[i // DOF].net, i % DOF, slots[entry + i]
        if to == NONE:
            continue
        inner = f_1 * (net[1, axis] + net[2, axis]) + f_3 * net[3, axis]
        values[k, to] = f_0 * net[START, axis] + inner + f_4 * net[END, axis]
        blend_stages(
            tangents[k, to], f_0, f_1, f_3, f_4, net_tangent[START, i], net_tangent[1, i], net_tangent[2, i],
            net_tangent[3, i], net_tangent[END, i],
        )  # fmt: skip


@compiled
def write_between(bodies, joints, state, tangent, joint_tangent, net_tangent, values, tangents, slots, k, s, h):
    """The motion and the forces after a share of a step become row k of the record; orientations in space are not known."""
    weights, shares = (cubic(s, h), slope_of_cubic(s, h)), force_within(s)
    write_state_between(state, tangent, values, tangents, slots, k, weights)
    end = state.shape[1]
    for j in range(joints.size):
        write_joint_between(joints[j], joint_tangent[j], values, tangents, slots, k, end, shares, weights)
        end += 3
    write_net_between(bodies, net_tangent, values, tangents, slots, k, end, shares)
    for i in range(end + DOF * bodies.size, slots.size):
        if slots[i] != NONE:
            values[k, slots[i]] = math.nan
