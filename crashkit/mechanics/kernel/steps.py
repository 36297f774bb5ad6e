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
FIRST = 0.01
"""Of a step, before which the first trial does not look for a crossing: a guard may begin at 0 and grow."""
LANDED = 1e-14
"""Of a guard, which is 0 but for rounding."""
BELOW = 1e-15
"""How far below its largest deformation, relative to it, a joint is that has just turned round."""


@compiled
def try_step(bodies, joints, functions, parameters, given, state, t, piece, h):
    """A Runge-Kutta step of fourth order into the row END; returns the guard there with its joint, and the smallest inside."""
    size = state.shape[1] // 2
    guard, culprit, inside = math.inf, NONE, math.inf
    for row in range(1, 5):
        inside = min(inside, guard)
        part = h if row >= 3 else 0.5 * h
        for i in range(size):
            slope = state[row - 1, size + i]
            if row == END:
                inner = state[1, size + i] + state[2, size + i]
                slope = (state[START, size + i] + 2.0 * inner + slope) / 6.0
            state[row, i] = state[START, i] + part * slope
        guard, culprit = accelerate(bodies, joints, functions, parameters, given, state, row, t + part, piece)
    return guard, culprit, inside


@compiled
def find_step(bodies, joints, functions, parameters, given, state, t, piece, longest, guard_before, step):
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
    low, high = land(bodies, joints, functions, parameters, given, state, t, piece, h, guard_before, guard, RESOLUTION * step)
    guard, culprit, _ = try_step(bodies, joints, functions, parameters, given, state, t, piece, high)
    if guard > -math.inf:
        return high, True, 0.0, guard, culprit
    guard = try_step(bodies, joints, functions, parameters, given, state, t, piece, low)[0]
    return low, True, 2.0 * (high - low), guard, culprit


@compiled
def land(bodies, joints, functions, parameters, given, state, t, piece, high, near, far, close):
    """The two sides of the first crossing within a step whose guard is negative at its end.

    The guard is the smallest of many. What is negative beyond a crossing is the one that vanishes there, and a secant through
    two such trials finds it; what is smallest before it may be another one, which the crossing has nothing to do with: it is
    believed only while it falls. Trials are aimed a hair past the crossing, to end on its far side.

    Arguments:
        high: length of the step; near, far: the guards at its start and its end.
        close: s, from the crossing to the end, at which the search is over.
    """
    low, count, misses, past, slope = 0.0, 0, 0, high, (far - near) / high
    while high - low > close and past > close and far < -LANDED:
        count += 1
        trial = high - far / slope + 0.5 * close
        if count == 1:
            trial = max(trial, FIRST * high)
        if misses > 0:
            trial = low + 0.1 * misses * (high - low)
        if count % 8 == 0 or not (low < trial < high and slope > -math.inf):
            trial = 0.5 * (low + high)
        guard = try_step(bodies, joints, functions, parameters, given, state, t, piece, trial)[0]
        if guard < 0.0:
            slope = (far - guard) / (high - trial)
            past = guard / slope if slope < 0.0 and guard > -math.inf else high
            high, far, misses = trial, guard, 0
        else:
            misses = misses + 1 if guard > 0.5 * near else 0
            slope = (far - guard) / (high - trial) if misses == 0 else slope
            low, near = trial, guard
    return low, high


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
