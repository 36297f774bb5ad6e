# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""A run from t = 0 through the times asked for; many runs."""

import math

from crashkit.mechanics.kernel.arrays import (
    D_MAX,
    DEFORMATION,
    DEFORMATION_BEFORE,
    END,
    FORCES,
    NONE,
    RATE,
    RATE_BEFORE,
    REST,
    START,
)
from crashkit.mechanics.kernel.between import write_between
from crashkit.mechanics.kernel.forces import kinematics
from crashkit.mechanics.kernel.history import remember
from crashkit.mechanics.kernel.jumps import change_branches
from crashkit.mechanics.kernel.landing import find_step
from crashkit.mechanics.kernel.line import AXES, CURVED, DOF, locate, settle
from crashkit.mechanics.kernel.stand_ins import compiled, inlined
from crashkit.mechanics.kernel.steps import RESOLUTION, choose_branches, try_step
from crashkit.mechanics.kernel.tangents import accelerate_tangent, deformation_tangent, step_tangent

# ---- compiled from here ----

DONE = 0
NO_PROGRESS = 1
NOT_FINITE = 2
FULL = 3
MEETING = 4

MAX_CROSSINGS = 1000
"""Within the time of one longest step, where forces jump."""
PATIENCE = 100
"""Crossings within that time, and one more for each joint, after which corners are taken for rounding if no force jumps."""
ROUNDED = 1e-9
"""Of the longest step: what is asked for no further before the end of a step is what its end was to be."""
BLIND = 1e-3
"""Of a step that does not look for corners, relative to the longest step."""


@compiled
def begin(bodies, joints, state, tangent, joint_tangent, net_tangent):
    """Give the joints without a free length their distance at t = 0, and let them remember how they are compressed."""
    settle(bodies, state)
    locate(bodies, state, START)
    for j in range(joints.size):
        joint, own = joints[j], joint_tangent[j]
        at_start = math.isnan(joint.rest)
        if at_start:
            joint.rest = 0.0
        d = kinematics(bodies, joint, state, START)[0]
        deformation_tangent(bodies, joint, state, tangent, own, net_tangent, START)
        if at_start:
            joint.rest, d = -d, 0.0
            for c in range(tangent.shape[2]):
                own[REST, c] = -own[DEFORMATION, c]
        joint.d_max = max(0.0, d)
        joint.loading = 0
        for c in range(tangent.shape[2]):
            own[D_MAX, c] = own[DEFORMATION, c] if d > 0.0 else 0.0


@compiled
def meeting(joints):
    """The joint whose direction has turned by more than a right angle within a step: its attachments have met."""
    if CURVED:
        for j in range(joints.size):
            joint, turned = joints[j], 0.0
            for i in range(AXES):
                turned += joint.aim[i] * joint.gradient[i]
                joint.aim[i] = joint.gradient[i]
            if turned < 0.0:
                return j
    return NONE


@inlined
def note(value, slope, values, tangents, to, k):
    """One entry of row k, and its derivatives, unless the record leaves it out."""
    if to != NONE:
        values[k, to] = value
        for c in range(slope.size):
            tangents[k, to, c] = slope[c]


@compiled
def write(bodies, joints, state, tangent, joint_tangent, net_tangent, values, tangents, slots, k):
    """The state at START becomes row k of the record."""
    end = state.shape[1]
    for i in range(end):
        note(state[START, i], tangent[START, i], values, tangents, slots[i], k)
    for j in range(joints.size):
        joint, own = joints[j], joint_tangent[j]
        note(joint.forces[START], own[FORCES + START], values, tangents, slots[end], k)
        note(joint.d, own[DEFORMATION], values, tangents, slots[end + 1], k)
        note(joint.ddot, own[RATE], values, tangents, slots[end + 2], k)
        end += 3
    for i in range(DOF * bodies.size):
        note(bodies[i // DOF].net[START, i % DOF], net_tangent[START, i], values, tangents, slots[end + i], k)
    end += DOF * bodies.size
    if AXES == 3:
        for i in range(4 * bodies.size):
            if slots[end + i] != NONE:
                values[k, slots[end + i]] = bodies[i // 4].frame[9 + i % 4]


@compiled
def is_smooth(bodies, state):
    """Whether the accelerations at START are those that the step had at its END: other branches, but no other forces."""
    n = DOF * bodies.size
    first, change, largest = state.shape[1] // 2 + n, 0.0, 0.0
    for i in range(first, first + n):
        change = max(change, abs(state[START, i] - state[END, i]))
        largest = max(largest, abs(state[END, i]))
    return change <= 1e-6 * largest


@inlined
def piece_at(given, t, piece, step):
    """The piece of what is given that begins at t or is still going on."""
    while piece + 1 < given.shape[0] and given[piece + 1, 0] <= t + RESOLUTION * step:
        piece += 1
    return piece


@inlined
def longest_step(left, step):
    """An equal share of the time left, no longer than a step."""
    return left / max(1.0, math.ceil(left / step - 1e-6))


@inlined
def choose_step(bodies, joints, functions, parameters, given, state, t, piece, longest, step, blind):
    """Take a step into the row END: one that lands on crossings, or a short one that is `blind` to them; see `find_step`."""
    for joint in joints:
        joint.d_before, joint.ddot_before = joint.d, joint.ddot
    if blind:
        h = min(longest, BLIND * step)
        guard, culprit, _ = try_step(bodies, joints, functions, parameters, given, state, t, piece, h)
        return h, True, 0.0, guard, culprit
    return find_step(bodies, joints, functions, parameters, given, state, t, piece, longest, step)


@inlined
def remember_before(joint_tangent):
    """The derivatives of deformations and rates where a step begins."""
    for j in range(joint_tangent.shape[0]):
        own = joint_tangent[j]
        for c in range(own.shape[1]):
            own[DEFORMATION_BEFORE, c], own[RATE_BEFORE, c] = own[DEFORMATION, c], own[RATE, c]


@inlined
def pass_on(bodies, joints, joint_tangent, net_tangent):
    """The forces at the end of a step are those at the start of the next."""
    for j in range(joints.size):
        joints[j].forces[START] = joints[j].forces[END]
        for c in range(joint_tangent.shape[2]):
            joint_tangent[j, FORCES + START, c] = joint_tangent[j, FORCES + END, c]
    for i in range(DOF * bodies.size):
        bodies[i // DOF].net[START, i % DOF] = bodies[i // DOF].net[END, i % DOF]
        for c in range(net_tangent.shape[2]):
            net_tangent[START, i, c] = net_tangent[END, i, c]


@compiled
def take_step(
    times, k, step, bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent,
    net_tangent, values, tangents, slots, t, piece, h,
):  # fmt: skip
    """The end of a step becomes the start of the next; returns the next of the times, after those that lie within it."""
    due, end = k, t + h - ROUNDED * step
    if tangent.shape[2] > 0:
        remember_before(joint_tangent)
        step_tangent(
            bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent, net_tangent,
            t, piece, h,
        )  # fmt: skip
        if AXES < 3 or times[k] < end:
            accelerate_tangent(
                bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent, net_tangent,
                END, t + h, piece,
            )  # fmt: skip
    while due < times.size and times[due] < end:
        write_between(
            bodies, joints, state, tangent, joint_tangent, net_tangent, values, tangents, slots, due, (times[due] - t) / h, h
        )
        due += 1
    for i in range(state.shape[1]):
        state[START, i] = state[END, i]
        for c in range(tangent.shape[2]):
            tangent[START, i, c] = tangent[END, i, c]
    pass_on(bodies, joints, joint_tangent, net_tangent)
    settle(bodies, state)
    return due


@compiled
def integrate(
    times, stops, step, bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent,
    net_tangent, values, tangents, slots, history,
):  # fmt: skip
    """Run from t = 0 through `times`; returns how it ended, the joint concerned, the time and the number of steps.

    Steps end at `stops`, of which the last is that of `times`.
    """
    t, since, crossings, k, m, piece, s = 0.0, 0.0, 0, START, START, START, START
    crossing, ahead, guard, culprit = True, 0.0, math.inf, NONE
    begin(bodies, joints, state, tangent, joint_tangent, net_tangent)
    choose_branches(bodies, joints, functions, parameters, state, ahead)
    while True:
        before, piece = piece, piece_at(given, t, piece, step)
        changing = crossing or piece > before
        if changing:
            guard, culprit = change_branches(
                bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent, net_tangent,
                t, piece, ahead,
            )  # fmt: skip
        if guard == -math.inf or crossings > MAX_CROSSINGS:
            return NOT_FINITE if guard == -math.inf or ahead > 0.0 else NO_PROGRESS, culprit, t, s
        if tangent.shape[2] > 0 and (changing or AXES == 3):
            accelerate_tangent(
                bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent, net_tangent,
                START, t, piece,
            )  # fmt: skip
        due = NONE
        if times[k] - t <= RESOLUTION * step:
            t, due = times[k], k
            write(bodies, joints, state, tangent, joint_tangent, net_tangent, values, tangents, slots, k)
            k += 1
        if history.shape[0] > 0:
            if s == history.shape[0]:
                return FULL, NONE, t, s
            remember(bodies, joints, functions, state, t, piece, due, changing, history, s)
            s += 1
        if k == times.size:
            return DONE, NONE, t, s
        while stops[m] <= t:
            m += 1
        blind = crossings > PATIENCE + joints.size and is_smooth(bodies, state)
        crossings -= blind
        h, crossing, ahead, guard, culprit = choose_step(
            bodies, joints, functions, parameters, given, state, t, piece, longest_step(stops[m] - t, step), step, blind
        )
        met = meeting(joints)
        if met != NONE:
            return MEETING, met, t, s
        k = take_step(
            times, k, step, bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent,
            net_tangent, values, tangents, slots, t, piece, h,
        )  # fmt: skip
        t += h
        if t - since > step:
            since, crossings = t, 0
        crossings += crossing


@compiled
def integrate_many(
    times, stops, step, bodies, joints, functions, parameters, given, starts, state, columns, partials, tangent, joint_tangent,
    net_tangent, values, tangents, slots, history, ends,
):  # fmt: skip
    """Many runs of one model; `ends` (run, 3) is how each ended, the joint concerned and the time."""
    for r in range(bodies.shape[0]):
        for i in range(starts.shape[1]):
            state[START, i] = starts[r, i]
        status, culprit, t, s = integrate(
            times, stops, step, bodies[r], joints[r], functions, parameters[r], given, state, columns, partials, tangent,
            joint_tangent, net_tangent, values[r], tangents, slots, history,
        )  # fmt: skip
        ends[r, 0] = status
        ends[r, 1] = culprit
        ends[r, 2] = t
