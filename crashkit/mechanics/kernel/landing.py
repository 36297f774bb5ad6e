# mypy: disable-error-code="no-untyped-def, no-untyped-call, assignment"
"""Steps that end just past the first crossing within them.

A step at whose end guards are negative may have crossed several, in metres, newtons and whatever else a law compares. A
secant through two values of the smallest of them is one through two different guards; so one guard is followed at a time.
"""

import math

from crashkit.mechanics.kernel.arrays import END, NONE, START
from crashkit.mechanics.kernel.forces import ROUNDING
from crashkit.mechanics.kernel.stand_ins import compiled, inlined, law_distance, law_mode
from crashkit.mechanics.kernel.steps import RESOLUTION, try_step

# ---- compiled from here ----

SHORTEST = 1.0 / 64.0
"""Of a step that looks for a branch left and entered again within it, relative to the longest step."""
FIRST = 0.01
"""Of a step, before which the first trial does not look for a crossing: a guard may begin at 0 and grow."""
LANDED = 1e-14
"""Of a guard, which is 0 but for rounding."""
OF_MEMORY, OF_JOINT = 64, 128
"""A function's branches are counted from 0, those of its memory from 64; 128 is the largest deformation of its joint."""


@compiled
def guard_of(joint, functions, parameters, state, row, d, ddot, f, which):
    """One guard of a joint at a stage: that of a branch of a function, of its memory, or of the largest deformation."""
    if which == OF_JOINT:
        return ddot + ROUNDING if joint.loading else joint.d_max - d + ROUNDING
    function, z = functions[f], 0.0
    d_max, o = d if joint.loading else joint.d_max, function.offset
    if function.memory >= 0:
        z = state[row, function.memory]
    if which < OF_MEMORY:
        return law_distance(function.code, which, function.mode, d, ddot, d_max, z, parameters, o)
    return law_distance(function.memory_code, which - OF_MEMORY, function.memory_mode, d, ddot, d_max, z, parameters, o)


@compiled
def left_branches(joint, function, parameters, state):
    """The branches, one bit each, of a function and of its memory that are not those of the state at END."""
    d_max, z, of_memory, o = joint.d if joint.loading else joint.d_max, 0.0, 0, function.offset
    if function.memory >= 0:
        z = state[END, function.memory]
        of_memory = law_mode(function.memory_code, joint.d, joint.ddot, d_max, z, parameters, o) ^ function.memory_mode
    return law_mode(function.code, joint.d, joint.ddot, d_max, z, parameters, o) ^ function.mode, of_memory


@compiled
def is_rounding(joint, functions, parameters, state, f, which):
    """Whether a guard would be 0 or above at END with a deformation or a rate that differs by rounding."""
    d, ddot = joint.d, joint.ddot
    below = guard_of(joint, functions, parameters, state, END, d - ROUNDING, ddot, f, which)
    above = guard_of(joint, functions, parameters, state, END, d + ROUNDING, ddot, f, which)
    slower = guard_of(joint, functions, parameters, state, END, d, ddot - ROUNDING, f, which)
    faster = guard_of(joint, functions, parameters, state, END, d, ddot + ROUNDING, f, which)
    return max(max(below, above), max(slower, faster)) >= 0.0


@compiled
def first_crossing(joints, functions, parameters, state):
    """The guard that is negative at END by more than rounding and that a straight line from START puts first.

    Returns:
        its joint (NONE where there is none), function and branch; its value at START and at END; and whether any guard is
        negative.
    """
    first, told = math.inf, False
    found = NONE, NONE, NONE, math.nan, math.nan
    for j in range(joints.size):
        joint = joints[j]
        if joint.guard < 0.0:
            for f in range(joint.start, joint.stop):
                bits, of_memory = left_branches(joint, functions[f], parameters, state)
                for which in range(OF_JOINT + 1):
                    word = bits if which < OF_MEMORY else of_memory
                    if which == OF_JOINT or (word >> (which % OF_MEMORY)) & 1:
                        far = guard_of(joint, functions, parameters, state, END, joint.d, joint.ddot, f, which)
                        near = guard_of(
                            joint, functions, parameters, state, START, joint.d_before, joint.ddot_before, f, which
                        )
                        told = told or far < 0.0
                        is_first = far < 0.0 and near / (near - far) < first
                        if is_first and not is_rounding(joint, functions, parameters, state, f, which):
                            first, found = near / (near - far), (j, f, which, near, far)
    return found, told


@inlined
def aimed(low, high, crossing, close, count):
    """The next trial: a hair past where the crossing is expected, or in the middle."""
    trial = max(crossing + 0.5 * close, FIRST * high if count == 1 else low)
    if count % 8 == 0 or not (low < trial < high):
        trial = 0.5 * (low + high)
    return trial


@compiled
def land(bodies, joints, functions, parameters, given, state, t, piece, high, far, close):
    """The two sides of the first crossing within a step at whose end some guard is negative.

    The guard whose crossing is expected first is followed by secants, aimed a hair past it to end on its far side, until no
    other is crossed before. Bisection where secants get nowhere, and where no guard tells: a force that is not finite.

    Arguments:
        high: length of the step, which was tried last; far: the smallest guard at its end.
        close: s, from the crossing to the end, at which the search is over.

    Returns:
        the two lengths, the smallest guard beyond the crossing, and the length of the last trial.
    """
    low, last, count, chosen = 0.0, high, 0, False
    while high - low > close and far < -LANDED:
        fresh = not chosen
        if fresh:
            (j, f, which, near, now), told = first_crossing(joints, functions, parameters, state)
            before, chosen = 0.0, True
        crossing = last - now * (last - before) / (now - near)
        landed = told if j == NONE else is_rounding(joints[j], functions, parameters, state, f, which)
        if last == high and far > -math.inf and (landed or high - crossing <= close):
            if fresh:
                break
            chosen = False
            continue
        count += 1
        trial = aimed(low, high, crossing, close, count)
        guard = try_step(bodies, joints, functions, parameters, given, state, t, piece, trial)[0]
        before, near, last, now = last, now, trial, guard
        if j != NONE:
            now = guard_of(joints[j], functions, parameters, state, END, joints[j].d, joints[j].ddot, f, which)
        if guard < 0.0:
            high, far, chosen = trial, guard, now < 0.0
        else:
            low = trial
    return low, high, far, last


@compiled
def find_step(bodies, joints, functions, parameters, given, state, t, piece, longest, step):
    """The longest step that stays on the branches it began on, or that ends just past the first crossing.

    A step is halved while a guard that is negative inside it is not at its end.

    Returns:
        length, whether it ends past a crossing, and how far ahead of its end to look for the new branches (0, or a little
        where the far side is not finite); the guard at its end and its joint.
    """
    h = longest
    guard, culprit, inside = try_step(bodies, joints, functions, parameters, given, state, t, piece, h)
    while inside < 0.0 and guard >= 0.0 and h > SHORTEST * step:
        h *= 0.5
        guard, culprit, inside = try_step(bodies, joints, functions, parameters, given, state, t, piece, h)
    if guard >= 0.0:
        return h, False, 0.0, guard, culprit
    low, high, far, last = land(bodies, joints, functions, parameters, given, state, t, piece, h, guard, RESOLUTION * step)
    h = high if far > -math.inf else low
    if h != last:
        guard, culprit, _ = try_step(bodies, joints, functions, parameters, given, state, t, piece, h)
    return h, True, 2.0 * (high - h), guard, culprit
