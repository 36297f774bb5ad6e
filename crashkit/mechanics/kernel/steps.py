# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""Steps that keep to the branches they begin on and land on crossings.

Within a step every function keeps the branches it had at the start (its mode), so that what the Runge-Kutta rule sees is
smooth. A step at whose end some guard is negative has crossed from one branch to another: it is shortened until it ends just
past the first crossing, and there the modes are taken anew. Landing on the far side leaves every new guard at 0 or above, so
the next step starts clean.

A joint's largest deformation d_max is memory of the engine. While the joint is loaded further, d_max is d itself and its guard
is ddot; otherwise d_max stands still and its guard is d_max - d.
"""

import math

from crashkit.mechanics.kernel.arrays import END, NONE, START
from crashkit.mechanics.kernel.forces import accelerate, kinematics
from crashkit.mechanics.kernel.line import DOF, locate
from crashkit.mechanics.kernel.stand_ins import compiled, law_mode

# ---- compiled from here ----

RESOLUTION = 1e-12
"""Of a crossing in time, relative to the longest step."""
SHORTEST = 1.0 / 64.0
"""Of a step that looks for a branch left and entered again within it, relative to the longest step."""
BELOW = 1e-15
"""How far below its largest deformation, relative to it, a joint is that has just turned round."""


@compiled
def try_step(bodies, joints, functions, parameters, given, state, t, piece, h):
    """A Runge-Kutta step of fourth order into the row END; returns the guard there with its joint, and the smallest inside."""
    size = state.shape[1] // 2
    guard, culprit, inside = math.inf, NONE, math.inf
    for row in range(1, 4):
        part = h if row == 3 else 0.5 * h
        for i in range(size):
            state[row, i] = state[START, i] + part * state[row - 1, size + i]
        guard, culprit = accelerate(bodies, joints, functions, parameters, given, state, row, t + part, piece)
        inside = min(inside, guard)
    for i in range(size):
        slopes = state[START, size + i] + 2.0 * (state[1, size + i] + state[2, size + i]) + state[3, size + i]
        state[END, i] = state[START, i] + h / 6.0 * slopes
    guard, culprit = accelerate(bodies, joints, functions, parameters, given, state, END, t + h, piece)
    return guard, culprit, inside


@compiled
def find_step(bodies, joints, functions, parameters, given, state, t, piece, longest, guard_before, step):
    """The longest step that stays on the branches it began on, or that ends just past the first crossing.

    A step is halved while a guard that is negative inside it is not at its end. A crossing is found by the Illinois rule, with
    a bisection every third time.

    Returns:
        length, whether it ends past a crossing, and how far ahead of its end to look for the new branches (0, or a little
        where the far side is not finite); the guard at its end and its joint.
    """
    low, low_guard, side, count = 0.0, guard_before, 0, 0
    high = longest
    high_guard, culprit, inside = try_step(bodies, joints, functions, parameters, given, state, t, piece, high)
    while inside < 0.0 and high_guard >= 0.0 and high > SHORTEST * step:
        high *= 0.5
        high_guard, culprit, inside = try_step(bodies, joints, functions, parameters, given, state, t, piece, high)
    if high_guard >= 0.0:
        return high, False, 0.0, high_guard, culprit
    while high - low > RESOLUTION * step:
        count += 1
        trial = (low * high_guard - high * low_guard) / (high_guard - low_guard)
        if count % 3 == 0 or not low < trial < high:
            trial = 0.5 * (low + high)
        guard = try_step(bodies, joints, functions, parameters, given, state, t, piece, trial)[0]
        if guard < 0.0:
            low_guard = 0.5 * low_guard if side < 0 else low_guard
            high, high_guard, side = trial, guard, -1
        else:
            high_guard = 0.5 * high_guard if side > 0 else high_guard
            low, low_guard, side = trial, guard, 1
    if try_step(bodies, joints, functions, parameters, given, state, t, piece, high)[0] > -math.inf:
        return high, True, 0.0, high_guard, culprit
    try_step(bodies, joints, functions, parameters, given, state, t, piece, low)
    return low, True, 2.0 * (high - low), low_guard, culprit


@compiled
def choose_branches_of(bodies, joint, functions, parameters, state, ahead):
    """Take the branches of a joint anew from the state at START, looking `ahead` seconds; freeze or free its d_max."""
    first = state.shape[1] // 2 + DOF * bodies.size
    d, ddot = kinematics(bodies, joint, state, START)
    a, b = first + DOF * joint.first, first + DOF * joint.second
    for i in range(DOF):
        second = joint.gradient[i] * state[START, a + i] + joint.gradient[DOF + i] * state[START, b + i]
        ddot += ahead * second
    d += ahead * ddot
    before = joint.loading
    if before:
        joint.d_max = d
    joint.loading = 1 if d >= joint.d_max and ddot > 0.0 else 0
    joint.d_max = max(d, joint.d_max)
    if before and not joint.loading:
        d -= BELOW * abs(d)
    for f in range(joint.start, joint.stop):
        function = functions[f]
        z, o = 0.0, function.offset
        if function.memory >= 0:
            z = state[START, function.memory]
            function.memory_mode = law_mode(function.memory_number, d, ddot, joint.d_max, z, parameters, o)
        function.mode = law_mode(function.number, d, ddot, joint.d_max, z, parameters, o)


@compiled
def choose_branches(bodies, joints, functions, parameters, state, ahead):
    """Take the branches of all joints anew from the state at START."""
    locate(bodies, state, START)
    for joint in joints:
        choose_branches_of(bodies, joint, functions, parameters, state, ahead)
