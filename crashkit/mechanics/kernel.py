# mypy: disallow-untyped-defs=False
"""Event-located integration of bodies and joints, with forward sensitivities.

Within a step every function keeps the branches it had at the start (its mode), so that what the Runge-Kutta rule sees is
smooth. A step at whose end some guard is negative has crossed from one branch to another: it is shortened until it ends just
past the first crossing, and there the modes are taken anew. Landing on the far side leaves every new guard at 0 or above, so
the next step starts clean.

A joint's largest deformation d_max is memory of the engine. While the joint is loaded further, d_max is d itself and its guard
is ddot; otherwise d_max stands still and its guard is d_max - d.

Sensitivities follow the variational equations on the same branches and steps. Forces are continuous, so a crossing gives them
no jump; that of a law with a force jump would be added where `integrate` chooses the branches.

The functions below the line are not run from here: the engine writes them behind the laws it was made for and compiles both.
"""

import math

from crashkit.mechanics.arrays import D_MAX, END, FORCE, REST, START, Floats


def compiled(function):
    """Stands for the compiler."""
    return function


def law_mode(number: int, d: float, ddot: float, d_max: float, p: Floats, o: int) -> int:
    """Stands for the laws of the engine: the branches that function `number` takes."""
    raise NotImplementedError


def law_frozen(number: int, mode: int, d: float, ddot: float, d_max: float, p: Floats, o: int) -> tuple[float, float]:
    """Stands for the laws of the engine: value and guard with the branches of `mode`."""
    raise NotImplementedError


def law_partials(number: int, mode: int, d: float, ddot: float, d_max: float, p: Floats, o: int, out: Floats) -> float:
    """Stands for the laws of the engine: value, and into `out` its derivatives to d, ddot, d_max and the parameters."""
    raise NotImplementedError


# ---- compiled from here ----

DONE = 0
NO_PROGRESS = 1
NOT_FINITE = 2

RESOLUTION = 1e-12
"""Of a crossing in time, relative to the longest step."""
SHORTEST = 1.0 / 64.0
"""Of a step that looks for a branch left and entered again within it, relative to the longest step."""
MAX_CROSSINGS = 1000
"""Within the time of one longest step."""


@compiled
def kinematics(bodies, joint, state, row):
    """Deformation and rate of a joint."""
    n = bodies.size
    d = joint.rest - joint.direction * (state[row, joint.second] - state[row, joint.first])
    ddot = -joint.direction * (state[row, n + joint.second] - state[row, n + joint.first])
    return d, ddot


@compiled
def joint_force(joint, functions, parameters, d, ddot):
    """Force of a joint on its frozen branches, and its smallest guard."""
    d_max, guard = joint.d_max, joint.d_max - d
    if joint.loading:
        d_max, guard = d, ddot
    force = 1.0
    for f in range(joint.start, joint.stop):
        function = functions[f]
        value, distance = law_frozen(function.number, function.mode, d, ddot, d_max, parameters, function.offset)
        force *= value
        guard = min(guard, distance)
    return force, guard


@compiled
def accelerate(bodies, joints, functions, parameters, state, row):
    """Forces and accelerations at a stage; returns the smallest guard (minus infinity: a force not finite) and its joint."""
    n = bodies.size
    for body in range(n):
        state[row, 2 * n + body] = 0.0
    smallest, culprit = math.inf, -1
    for j in range(joints.size):
        joint = joints[j]
        d, ddot = kinematics(bodies, joint, state, row)
        force, guard = joint_force(joint, functions, parameters, d, ddot)
        if not math.isfinite(force):
            guard = -math.inf
        if guard < smallest:
            smallest, culprit = guard, j
        joint.force = force
        state[row, 2 * n + joint.first] -= joint.direction * force
        state[row, 2 * n + joint.second] += joint.direction * force
    for body in range(n):
        state[row, 2 * n + body] *= bodies[body].inverse_mass
    return smallest, culprit


@compiled
def try_step(bodies, joints, functions, parameters, state, h):
    """A Runge-Kutta step of fourth order into the row END; returns the guard there with its joint, and the smallest inside."""
    n = bodies.size
    guard, culprit, inside = math.inf, -1, math.inf
    for row in range(1, 4):
        part = h if row == 3 else 0.5 * h
        for i in range(2 * n):
            state[row, i] = state[START, i] + part * state[row - 1, n + i]
        guard, culprit = accelerate(bodies, joints, functions, parameters, state, row)
        inside = min(inside, guard)
    for i in range(2 * n):
        slopes = state[START, n + i] + 2.0 * (state[1, n + i] + state[2, n + i]) + state[3, n + i]
        state[END, i] = state[START, i] + h / 6.0 * slopes
    guard, culprit = accelerate(bodies, joints, functions, parameters, state, END)
    return guard, culprit, inside


@compiled
def find_step(bodies, joints, functions, parameters, state, longest, guard_before, step):
    """The longest step that stays on the branches it began on, or that ends just past the first crossing.

    A step is halved while a guard that is negative inside it is not at its end. A crossing is found by the Illinois rule, with
    a bisection every third time.

    Returns:
        length, whether it ends past a crossing, and how far ahead of its end to look for the new branches (0, or a little
        where the far side is not finite); the guard at its end and its joint.
    """
    low, low_guard, side, count = 0.0, guard_before, 0, 0
    high = longest
    high_guard, culprit, inside = try_step(bodies, joints, functions, parameters, state, high)
    while inside < 0.0 and high_guard >= 0.0 and high > SHORTEST * step:
        high *= 0.5
        high_guard, culprit, inside = try_step(bodies, joints, functions, parameters, state, high)
    if high_guard >= 0.0:
        return high, False, 0.0, high_guard, culprit
    while high - low > RESOLUTION * step:
        count += 1
        trial = (low * high_guard - high * low_guard) / (high_guard - low_guard)
        if count % 3 == 0 or not low < trial < high:
            trial = 0.5 * (low + high)
        guard = try_step(bodies, joints, functions, parameters, state, trial)[0]
        if guard < 0.0:
            low_guard = 0.5 * low_guard if side < 0 else low_guard
            high, high_guard, side = trial, guard, -1
        else:
            high_guard = 0.5 * high_guard if side > 0 else high_guard
            low, low_guard, side = trial, guard, 1
    if try_step(bodies, joints, functions, parameters, state, high)[0] > -math.inf:
        return high, True, 0.0, high_guard, culprit
    try_step(bodies, joints, functions, parameters, state, low)
    return low, True, 2.0 * (high - low), low_guard, culprit


@compiled
def choose_branches(bodies, joints, functions, parameters, state, tangent, joint_tangent, ahead):
    """Take the branches anew from the state at START, looking `ahead` seconds; freeze or free the largest deformations."""
    n = bodies.size
    for j in range(joints.size):
        joint = joints[j]
        a, b, s = joint.first, joint.second, joint.direction
        d, ddot = kinematics(bodies, joint, state, START)
        d += ahead * ddot
        ddot -= ahead * s * (state[START, 2 * n + b] - state[START, 2 * n + a])
        if joint.loading:
            joint.d_max = d
            for c in range(tangent.shape[2]):
                apart = tangent[START, b, c] - tangent[START, a, c]
                joint_tangent[j, D_MAX, c] = joint_tangent[j, REST, c] - s * apart
        joint.loading = 1 if d >= joint.d_max and ddot > 0.0 else 0
        joint.d_max = max(d, joint.d_max)
        for f in range(joint.start, joint.stop):
            function = functions[f]
            function.mode = law_mode(function.number, d, ddot, joint.d_max, parameters, function.offset)


@compiled
def joint_partials(joint, functions, parameters, partials, d, ddot):
    """Derivatives of a joint's force to d, ddot and d_max; `partials` then holds those to its parameters."""
    d_max = d if joint.loading else joint.d_max
    for f in range(joint.start, joint.stop):
        function = functions[f]
        function.value = law_partials(function.number, function.mode, d, ddot, d_max, parameters, function.offset, partials[f])
    to_d, to_ddot, to_d_max = 0.0, 0.0, 0.0
    for f in range(joint.start, joint.stop):
        for other in range(joint.start, joint.stop):
            if other != f:
                for i in range(3 + functions[f].count):
                    partials[f, i] *= functions[other].value
        to_d += partials[f, 0]
        to_ddot += partials[f, 1]
        to_d_max += partials[f, 2]
    if joint.loading:
        return to_d + to_d_max, to_ddot, 0.0
    return to_d, to_ddot, to_d_max


@compiled
def accelerate_tangent(bodies, joints, functions, parameters, state, columns, tangent, joint_tangent, partials, row):
    """Derivatives of the forces and accelerations at a stage to the columns."""
    n = bodies.size
    for body in range(n):
        for c in range(tangent.shape[2]):
            tangent[row, 2 * n + body, c] = 0.0
    for j in range(joints.size):
        joint = joints[j]
        a, b, s = joint.first, joint.second, joint.direction
        d, ddot = kinematics(bodies, joint, state, row)
        to_d, to_ddot, to_d_max = joint_partials(joint, functions, parameters, partials, d, ddot)
        for c in range(tangent.shape[2]):
            d_c = joint_tangent[j, REST, c] - s * (tangent[row, b, c] - tangent[row, a, c])
            ddot_c = -s * (tangent[row, n + b, c] - tangent[row, n + a, c])
            joint_tangent[j, FORCE, c] = to_d * d_c + to_ddot * ddot_c + to_d_max * joint_tangent[j, D_MAX, c]
        for f in range(joint.start, joint.stop):
            for i in range(functions[f].count):
                column = columns[functions[f].offset + i]
                if column >= 0:
                    joint_tangent[j, FORCE, column] += partials[f, 3 + i]
        to_a, to_b = -s * bodies[a].inverse_mass, s * bodies[b].inverse_mass
        for c in range(tangent.shape[2]):
            tangent[row, 2 * n + a, c] += to_a * joint_tangent[j, FORCE, c]
            tangent[row, 2 * n + b, c] += to_b * joint_tangent[j, FORCE, c]
    for body in range(n):
        if bodies[body].mass_column >= 0:
            share = state[row, 2 * n + body] * bodies[body].inverse_mass
            tangent[row, 2 * n + body, bodies[body].mass_column] -= share


@compiled
def step_tangent(bodies, joints, functions, parameters, state, columns, tangent, joint_tangent, partials, h):
    """The derivative of the Runge-Kutta step whose stages `state` holds; START moves to its end."""
    n = bodies.size
    for row in range(1, 4):
        part = h if row == 3 else 0.5 * h
        for i in range(2 * n):
            for c in range(tangent.shape[2]):
                tangent[row, i, c] = tangent[START, i, c] + part * tangent[row - 1, n + i, c]
        accelerate_tangent(bodies, joints, functions, parameters, state, columns, tangent, joint_tangent, partials, row)
    for i in range(2 * n):
        for c in range(tangent.shape[2]):
            inner = tangent[1, n + i, c] + tangent[2, n + i, c]
            tangent[START, i, c] += h / 6.0 * (tangent[START, n + i, c] + 2.0 * inner + tangent[3, n + i, c])


@compiled
def write(joints, state, tangent, joint_tangent, state_record, force_record, tangent_record, force_tangent_record, k):
    """The state at START becomes entry k of the record."""
    for i in range(state.shape[1]):
        state_record[k, i] = state[START, i]
        for c in range(tangent.shape[2]):
            tangent_record[k, i, c] = tangent[START, i, c]
    for j in range(joints.size):
        force_record[k, j] = joints[j].force
        for c in range(tangent.shape[2]):
            force_tangent_record[k, j, c] = joint_tangent[j, FORCE, c]


@compiled
def integrate(
    times,
    step,
    bodies,
    joints,
    functions,
    parameters,
    state,
    columns,
    tangent,
    joint_tangent,
    partials,
    state_record,
    force_record,
    tangent_record,
    force_tangent_record,
):
    """Run from t = 0 through `times`; returns how it ended, the joint concerned and the time."""
    t, since, crossings, k = 0.0, 0.0, 0, START
    crossing, ahead = True, 0.0
    guard, culprit = math.inf, -1
    while True:
        if crossing:
            choose_branches(bodies, joints, functions, parameters, state, tangent, joint_tangent, ahead)
            guard, culprit = accelerate(bodies, joints, functions, parameters, state, START)
        if guard == -math.inf or crossings > MAX_CROSSINGS:
            return NOT_FINITE if guard == -math.inf or ahead > 0.0 else NO_PROGRESS, culprit, t
        if tangent.shape[2] > 0:
            accelerate_tangent(bodies, joints, functions, parameters, state, columns, tangent, joint_tangent, partials, START)
        if times[k] - t <= RESOLUTION * step:
            t = times[k]
            write(joints, state, tangent, joint_tangent, state_record, force_record, tangent_record, force_tangent_record, k)
            k += 1
            if k == times.size:
                return DONE, -1, t
        remaining = times[k] - t
        longest = remaining / max(1.0, math.ceil(remaining / step - 1e-6))
        h, crossing, ahead, guard, culprit = find_step(bodies, joints, functions, parameters, state, longest, guard, step)
        if tangent.shape[2] > 0:
            step_tangent(bodies, joints, functions, parameters, state, columns, tangent, joint_tangent, partials, h)
        for i in range(state.shape[1]):
            state[START, i] = state[END, i]
        t += h
        if t - since > step:
            since, crossings = t, 0
        crossings += crossing
