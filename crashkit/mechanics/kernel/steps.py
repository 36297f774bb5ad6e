# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""Steps that keep to the branches they begin on, and the branches at the end of one; landing.py ends them on crossings.

Within a step every function keeps the branches it had at the start (its mode), so that what the Runge-Kutta rule sees is
smooth. A step at whose end some guard is negative has crossed from one branch to another: it is shortened until it ends just
past the first crossing, and there the modes are taken anew. Landing on the far side leaves every new guard at 0 or above, so
the next step starts clean.

A joint's largest deformation d_max is memory of the engine. While the joint is loaded further, d_max is d itself and its guard
is ddot; otherwise d_max stands still and its guard is d_max - d.
"""

import math

from crashkit.mechanics.kernel.arrays import END, NONE, START
from crashkit.mechanics.kernel.forces import ROUNDING, accelerate_stage, kinematics
from crashkit.mechanics.kernel.line import DOF, locate
from crashkit.mechanics.kernel.stand_ins import compiled, inlined, law_mode

# ---- compiled from here ----

RESOLUTION = 1e-12
"""Of a crossing in time, relative to the longest step."""
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
        guard, culprit = accelerate_stage(bodies, joints, functions, parameters, given, state, row, t + part, piece)
    return guard, culprit, inside


@inlined
def change_within(ahead, rate):
    """What changes at a rate within so many seconds ahead; by no less than rounding, or it would seem not to."""
    change = ahead * rate
    return change if ahead == 0.0 or rate == 0.0 else math.copysign(max(abs(change), ROUNDING), rate)


@compiled
def choose_branches_of(bodies, joint, functions, parameters, state, ahead):
    """Take the branches of a joint anew from the state at START, looking `ahead` seconds; freeze or free its d_max."""
    first, second = state.shape[1] // 2 + DOF * bodies.size, 0.0
    d, ddot = kinematics(bodies, joint, state, START)
    a, b = first + DOF * joint.first, first + DOF * joint.second
    for i in range(DOF):
        second += joint.gradient[i] * state[START, a + i] + joint.gradient[DOF + i] * state[START, b + i]
    ddot += change_within(ahead, second)
    d += change_within(ahead, ddot)
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
            function.memory_mode = law_mode(function.memory_code, d, ddot, joint.d_max, z, parameters, o)
        function.mode = law_mode(function.code, d, ddot, joint.d_max, z, parameters, o)


@compiled
def choose_branches(bodies, joints, functions, parameters, state, ahead):
    """Take the branches of all joints anew from the state at START."""
    locate(bodies, state, START)
    for joint in joints:
        choose_branches_of(bodies, joint, functions, parameters, state, ahead)
