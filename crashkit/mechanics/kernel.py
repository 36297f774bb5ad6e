"""Event-located integration of bodies and joints, with forward sensitivities.

Within a step every function keeps the branches it had at the start (its mode), so that what the Runge-Kutta rule sees is smooth. A step at
whose end some guard is negative has crossed from one branch to another: it is shortened until it ends just past the first
crossing, and there the modes are taken anew. Landing on the far side leaves every new guard at 0 or above, so the next step starts clean.

A joint's largest deformation d_max is memory of the engine. While the joint is loaded further, d_max is d itself and its guard is ddot;
otherwise d_max stands still and its guard is d_max - d.

Sensitivities follow the variational equations on the same branches and steps. Forces are continuous, so a crossing gives them no jump.

The functions below the line are not run from here: the engine writes them behind the laws it was made for and compiles both.
"""

import math

from crashkit.mechanics.arrays import Floats


def compiled(function):  # type: ignore[no-untyped-def]
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
def kinematics(structure, state, row, joint):
    """Deformation and rate of a joint."""
    a, b, s = structure.first[joint], structure.second[joint], structure.direction[joint]
    d = structure.rest[joint] - s * (state.position[row, b] - state.position[row, a])
    ddot = -s * (state.velocity[row, b] - state.velocity[row, a])
    return d, ddot


@compiled
def joint_force(structure, state, joint, d, ddot):
    """Force of a joint on its frozen branches, and its smallest guard."""
    d_max, guard = state.d_max[joint], state.d_max[joint] - d
    if state.loading[joint]:
        d_max, guard = d, ddot
    force = 1.0
    for f in range(structure.start[joint], structure.start[joint + 1]):
        value, distance = law_frozen(
            structure.function[f], state.mode[f], d, ddot, d_max, structure.parameters, structure.offset[f]
        )
        force *= value
        guard = min(guard, distance)
    return force, guard


@compiled
def accelerate(structure, state, row):
    """Forces and accelerations at a stage; returns the smallest guard (minus infinity where a force is not finite) and its joint."""
    acceleration = state.acceleration
    for body in range(structure.inverse_mass.size):
        acceleration[row, body] = 0.0
    smallest, culprit = math.inf, -1
    for joint in range(structure.first.size):
        d, ddot = kinematics(structure, state, row, joint)
        force, guard = joint_force(structure, state, joint, d, ddot)
        if not math.isfinite(force):
            guard = -math.inf
        if guard < smallest:
            smallest, culprit = guard, joint
        state.force[joint] = force
        acceleration[row, structure.first[joint]] -= structure.direction[joint] * force
        acceleration[row, structure.second[joint]] += structure.direction[joint] * force
    for body in range(structure.inverse_mass.size):
        acceleration[row, body] *= structure.inverse_mass[body]
    return smallest, culprit


@compiled
def try_step(structure, state, h):
    """A Runge-Kutta step of fourth order into row 4; returns the guard at its end with its joint, and the smallest inside."""
    x, v, a = state.position, state.velocity, state.acceleration
    bodies = structure.inverse_mass.size
    inside = math.inf
    for row in range(1, 4):
        part = h if row == 3 else 0.5 * h
        for body in range(bodies):
            x[row, body] = x[0, body] + part * v[row - 1, body]
            v[row, body] = v[0, body] + part * a[row - 1, body]
        inside = min(inside, accelerate(structure, state, row)[0])
    for body in range(bodies):
        x[4, body] = x[0, body] + h / 6.0 * (v[0, body] + 2.0 * (v[1, body] + v[2, body]) + v[3, body])
        v[4, body] = v[0, body] + h / 6.0 * (a[0, body] + 2.0 * (a[1, body] + a[2, body]) + a[3, body])
    guard, culprit = accelerate(structure, state, 4)
    return guard, culprit, inside


@compiled
def try_careful_step(structure, state, h, step):
    """A step, halved while a guard that is negative inside it is not at its end; returns its length, guard and joint."""
    guard, culprit, inside = try_step(structure, state, h)
    while inside < 0.0 and guard >= 0.0 and h > SHORTEST * step:
        h *= 0.5
        guard, culprit, inside = try_step(structure, state, h)
    return h, guard, culprit


@compiled
def locate(structure, state, h, guard_before, guard_after, step):
    """Shorten a step to end just past the first crossing (Illinois rule, a bisection every third time).

    Returns its length, and how far ahead of its end to look for the new branches: 0, or a little where the far side is not finite.
    """
    low, low_guard = 0.0, guard_before
    high, high_guard = h, guard_after
    side, count = 0, 0
    while high - low > RESOLUTION * step:
        count += 1
        trial = (low * high_guard - high * low_guard) / (high_guard - low_guard)
        if count % 3 == 0 or not low < trial < high:
            trial = 0.5 * (low + high)
        guard = try_step(structure, state, trial)[0]
        if guard < 0.0:
            low_guard = 0.5 * low_guard if side < 0 else low_guard
            high, high_guard, side = trial, guard, -1
        else:
            high_guard = 0.5 * high_guard if side > 0 else high_guard
            low, low_guard, side = trial, guard, 1
    if try_step(structure, state, high)[0] > -math.inf:
        return high, 0.0
    try_step(structure, state, low)
    return low, 2.0 * (high - low)


@compiled
def choose_branches(structure, state, tangent, ahead):
    """Take the branches anew from the state in row 0, looking `ahead` seconds; freeze or free the largest deformations."""
    for joint in range(structure.first.size):
        a, b, s = structure.first[joint], structure.second[joint], structure.direction[joint]
        d, ddot = kinematics(structure, state, 0, joint)
        d += ahead * ddot
        ddot -= ahead * s * (state.acceleration[0, b] - state.acceleration[0, a])
        if state.loading[joint]:
            state.d_max[joint] = d
            for c in range(tangent.rest.shape[1]):
                tangent.d_max[joint, c] = tangent.rest[joint, c] - s * (tangent.position[0, b, c] - tangent.position[0, a, c])
        state.loading[joint] = d >= state.d_max[joint] and ddot > 0.0
        state.d_max[joint] = max(d, state.d_max[joint])
        for f in range(structure.start[joint], structure.start[joint + 1]):
            state.mode[f] = law_mode(
                structure.function[f], d, ddot, state.d_max[joint], structure.parameters, structure.offset[f]
            )


@compiled
def weight(structure, tangent, joint, f):
    """Product of the values of a joint's other functions."""
    start = structure.start[joint]
    product = 1.0
    for other in range(start, structure.start[joint + 1]):
        if other != f:
            product *= tangent.values[other - start]
    return product


@compiled
def joint_partials(structure, state, tangent, joint, d, ddot):
    """Derivatives of a joint's force to d, ddot and d_max; those to the parameters stay in `tangent.partials`."""
    start, stop = structure.start[joint], structure.start[joint + 1]
    d_max = d if state.loading[joint] else state.d_max[joint]
    for f in range(start, stop):
        tangent.values[f - start] = law_partials(
            structure.function[f],
            state.mode[f],
            d,
            ddot,
            d_max,
            structure.parameters,
            structure.offset[f],
            tangent.partials[f - start],
        )
    to_d, to_ddot, to_d_max = 0.0, 0.0, 0.0
    for f in range(start, stop):
        others = weight(structure, tangent, joint, f)
        to_d += others * tangent.partials[f - start, 0]
        to_ddot += others * tangent.partials[f - start, 1]
        to_d_max += others * tangent.partials[f - start, 2]
    if state.loading[joint]:
        return to_d + to_d_max, to_ddot, 0.0
    return to_d, to_ddot, to_d_max


@compiled
def joint_tangent(structure, state, tangent, row, joint):
    """Derivatives of a joint's deformation and force at a stage to the columns."""
    a, b, s = structure.first[joint], structure.second[joint], structure.direction[joint]
    d, ddot = kinematics(structure, state, row, joint)
    to_d, to_ddot, to_d_max = joint_partials(structure, state, tangent, joint, d, ddot)
    for c in range(tangent.rest.shape[1]):
        d_c = tangent.rest[joint, c] - s * (tangent.position[row, b, c] - tangent.position[row, a, c])
        ddot_c = -s * (tangent.velocity[row, b, c] - tangent.velocity[row, a, c])
        tangent.deformation[joint, c] = d_c
        tangent.force[joint, c] = to_d * d_c + to_ddot * ddot_c + to_d_max * tangent.d_max[joint, c]
    for f in range(structure.start[joint], structure.start[joint + 1]):
        others = weight(structure, tangent, joint, f)
        for i in range(structure.offset[f], structure.offset[f + 1]):
            column = tangent.parameter_column[i]
            if column >= 0:
                partial = tangent.partials[f - structure.start[joint], 3 + i - structure.offset[f]]
                tangent.force[joint, column] += others * partial


@compiled
def accelerate_tangent(structure, state, tangent, row):
    """Derivatives of the accelerations at a stage to the columns."""
    acceleration = tangent.acceleration
    columns = tangent.rest.shape[1]
    if columns == 0:
        return
    for body in range(structure.inverse_mass.size):
        for c in range(columns):
            acceleration[row, body, c] = 0.0
    for joint in range(structure.first.size):
        joint_tangent(structure, state, tangent, row, joint)
        a, b, s = structure.first[joint], structure.second[joint], structure.direction[joint]
        for c in range(columns):
            acceleration[row, a, c] -= s * structure.inverse_mass[a] * tangent.force[joint, c]
            acceleration[row, b, c] += s * structure.inverse_mass[b] * tangent.force[joint, c]
    for body in range(structure.inverse_mass.size):
        if tangent.mass_column[body] >= 0:
            share = state.acceleration[row, body] * structure.inverse_mass[body]
            acceleration[row, body, tangent.mass_column[body]] -= share


@compiled
def step_tangent(structure, state, tangent, h):
    """The derivative of the Runge-Kutta step whose stages `state` holds; row 0 moves from its start to its end."""
    x, v, a = tangent.position, tangent.velocity, tangent.acceleration
    bodies, columns = x.shape[1], x.shape[2]
    for row in range(1, 4):
        part = h if row == 3 else 0.5 * h
        for body in range(bodies):
            for c in range(columns):
                x[row, body, c] = x[0, body, c] + part * v[row - 1, body, c]
                v[row, body, c] = v[0, body, c] + part * a[row - 1, body, c]
        accelerate_tangent(structure, state, tangent, row)
    for body in range(bodies):
        for c in range(columns):
            x[0, body, c] += h / 6.0 * (v[0, body, c] + 2.0 * (v[1, body, c] + v[2, body, c]) + v[3, body, c])
            v[0, body, c] += h / 6.0 * (a[0, body, c] + 2.0 * (a[1, body, c] + a[2, body, c]) + a[3, body, c])


@compiled
def start(structure, state, tangent):
    """Set the largest deformations and the branches from the state in row 0; returns the smallest guard and its joint."""
    for joint in range(structure.first.size):
        a, b, s = structure.first[joint], structure.second[joint], structure.direction[joint]
        d = kinematics(structure, state, 0, joint)[0]
        state.d_max[joint] = max(0.0, d)
        for c in range(tangent.rest.shape[1]):
            ahead = tangent.position[0, b, c] - tangent.position[0, a, c]
            tangent.d_max[joint, c] = tangent.rest[joint, c] - s * ahead if d > 0.0 else 0.0
    choose_branches(structure, state, tangent, 0.0)
    guard, culprit = accelerate(structure, state, 0)
    accelerate_tangent(structure, state, tangent, 0)
    return guard, culprit


@compiled
def advance(structure, state, tangent, longest, guard, step):
    """One step of at most `longest`, ending early at a crossing.

    Returns its length, the guard at its end, the joint of the smallest guard, and whether it ended at a crossing.
    """
    h, after, culprit = try_careful_step(structure, state, longest, step)
    crossing, ahead = after < 0.0, 0.0
    if crossing:
        h, ahead = locate(structure, state, h, guard, after, step)
    step_tangent(structure, state, tangent, h)
    for body in range(structure.inverse_mass.size):
        state.position[0, body] = state.position[4, body]
        state.velocity[0, body] = state.velocity[4, body]
        state.acceleration[0, body] = state.acceleration[4, body]
    if crossing:
        choose_branches(structure, state, tangent, ahead)
        after = accelerate(structure, state, 0)[0]
    accelerate_tangent(structure, state, tangent, 0)
    return h, after, culprit, crossing


@compiled
def write(structure, state, tangent, record, k):
    """The state in row 0 becomes entry k of the record."""
    columns = tangent.rest.shape[1]
    for body in range(structure.inverse_mass.size):
        record.position[k, body] = state.position[0, body]
        record.velocity[k, body] = state.velocity[0, body]
        record.acceleration[k, body] = state.acceleration[0, body]
        for c in range(columns):
            record.position_sensitivity[k, body, c] = tangent.position[0, body, c]
            record.velocity_sensitivity[k, body, c] = tangent.velocity[0, body, c]
            record.acceleration_sensitivity[k, body, c] = tangent.acceleration[0, body, c]
    for joint in range(structure.first.size):
        record.deformation[k, joint], record.deformation_rate[k, joint] = kinematics(structure, state, 0, joint)
        record.force[k, joint] = state.force[joint]
        for c in range(columns):
            record.deformation_sensitivity[k, joint, c] = tangent.deformation[joint, c]
            record.force_sensitivity[k, joint, c] = tangent.force[joint, c]


@compiled
def integrate(times, step, structure, state, tangent, record):
    """Run from t = 0 through `times`; returns how it ended, the joint concerned and the time."""
    t, since, crossings = 0.0, 0.0, 0
    guard, culprit = start(structure, state, tangent)
    if guard == -math.inf:
        return NOT_FINITE, culprit, t
    for k in range(times.size):
        while times[k] - t > RESOLUTION * step:
            remaining = times[k] - t
            longest = remaining / max(1.0, math.ceil(remaining / step - 1e-6))
            h, guard, culprit, crossing = advance(structure, state, tangent, longest, guard, step)
            t += h
            if t - since > step:
                since, crossings = t, 0
            crossings += crossing
            if crossings > MAX_CROSSINGS or guard == -math.inf:
                return NOT_FINITE if guard == -math.inf else NO_PROGRESS, culprit, t
        t = times[k]
        write(structure, state, tangent, record, k)
    return DONE, -1, t
