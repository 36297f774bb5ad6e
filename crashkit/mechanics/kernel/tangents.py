# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""Forward sensitivities: the derivative of the same steps on the same branches, one column for each parameter.

With D the gradient and H the Hessian of a joint's deformation d to the displacements q of its bodies (velocities v), its force
F = F(d, ddot, d_max, z, p) puts -F D on them, and

    d_c = rest_c + D q_c,  ddot_c = D v_c + v H q_c,  -(F D)_c = -F_c D - F H q_c.

A crossing where the force is continuous gives them no jump. Where it jumps, with f- and f+ the state's derivatives on its two
sides and g the guard whose zero it is, the derivatives jump by (f- - f+) tau_c, tau_c = -g_c / g' (saltation).
"""

import math

from crashkit.mechanics.kernel.arrays import (
    D_MAX,
    DEFORMATION,
    END,
    FORCE,
    RATE,
    REST,
    START,
    TO_D,
    TO_D_MAX,
    TO_MEMORY,
    TO_PARAMETERS,
    TO_RATE,
)
from crashkit.mechanics.kernel.forces import add_given, begin_forces, kinematics, push
from crashkit.mechanics.kernel.line import (
    AXES,
    CURVED,
    DOF,
    add_columns,
    bend_row,
    curve,
    gradient_row,
    hessian_row,
    rates_tangent,
    respond_tangent,
    to_rotations,
)
from crashkit.mechanics.kernel.stand_ins import compiled, law_guard, law_partials

# ---- compiled from here ----


@compiled
def joint_partials(joint, functions, parameters, partials, state, row):
    """Force of a joint and its derivatives to d, ddot and d_max; `partials` then holds those to memories and parameters."""
    d_max = joint.d if joint.loading else joint.d_max
    for f in range(joint.start, joint.stop):
        function = functions[f]
        z = state[row, function.memory] if function.memory >= 0 else 0.0
        number, mode, o = function.number, function.mode, function.offset
        function.value = law_partials(number, mode, joint.d, joint.ddot, d_max, z, parameters, o, partials[f])
    to_d, to_rate, to_d_max, force = 0.0, 0.0, 0.0, 1.0
    for f in range(joint.start, joint.stop):
        force *= functions[f].value
        for other in range(joint.start, joint.stop):
            if other != f:
                for i in range(TO_PARAMETERS + functions[f].count):
                    partials[f, i] *= functions[other].value
        to_d += partials[f, TO_D]
        to_rate += partials[f, TO_RATE]
        to_d_max += partials[f, TO_D_MAX]
    if joint.loading:
        return force, to_d + to_d_max, to_rate, 0.0
    return force, to_d, to_rate, to_d_max


@compiled
def deformation_tangent(joint, tangent, own, row):
    """Derivatives of a joint's deformation."""
    for c in range(tangent.shape[2]):
        own[DEFORMATION, c] = own[REST, c]
    add_columns(gradient_row(joint), tangent, row, DOF * joint.first, DOF * joint.second, own, DEFORMATION)
    for m in range(2 * AXES):
        if joint.point_columns[m] >= 0:
            own[DEFORMATION, joint.point_columns[m]] += joint.gradient[2 * DOF + m]


@compiled
def rate_tangent(bodies, joint, state, tangent, own, row):
    """Derivatives of a joint's deformation rate."""
    n = DOF * bodies.size
    a, b = DOF * joint.first, DOF * joint.second
    for c in range(tangent.shape[2]):
        own[RATE, c] = 0.0
    add_columns(gradient_row(joint), tangent, row, n + a, n + b, own, RATE)
    if CURVED:
        for k in range(2 * DOF + 2 * AXES):
            if k < 2 * DOF or joint.point_columns[k - 2 * DOF] >= 0:
                bend = 0.0
                for i in range(DOF):
                    first, second = joint.hessian[i, k], joint.hessian[DOF + i, k]
                    bend += first * state[row, n + a + i] + second * state[row, n + b + i]
                joint.bend[k] = bend
        add_columns(bend_row(joint), tangent, row, a, b, own, RATE)
        for m in range(2 * AXES):
            if joint.point_columns[m] >= 0:
                own[RATE, joint.point_columns[m]] += joint.bend[2 * DOF + m]


@compiled
def force_tangent(joint, functions, parameters, state, columns, tangent, own, partials, row):
    """Derivatives of a joint's force, and of the rates of its memories; returns the force."""
    size = state.shape[1] // 2
    force, to_d, to_rate, to_d_max = joint_partials(joint, functions, parameters, partials, state, row)
    for c in range(tangent.shape[2]):
        own[FORCE, c] = to_d * own[DEFORMATION, c] + to_rate * own[RATE, c] + to_d_max * own[D_MAX, c]
    for f in range(joint.start, joint.stop):
        function = functions[f]
        for i in range(function.count):
            if columns[function.offset + i] >= 0:
                own[FORCE, columns[function.offset + i]] += partials[f, TO_PARAMETERS + i]
        z = function.memory
        if z >= 0:
            for c in range(tangent.shape[2]):
                own[FORCE, c] += partials[f, TO_MEMORY] * tangent[row, z, c]
            memory_tangent(joint, function, parameters, state, columns, tangent, own, partials[f], row, size + z)
    return force


@compiled
def memory_tangent(joint, function, parameters, state, columns, tangent, own, slopes, row, entry):
    """Derivatives of the rate of a memory."""
    z, o = function.memory, function.offset
    d_max = joint.d if joint.loading else joint.d_max
    number, mode = function.memory_number, function.memory_mode
    law_partials(number, mode, joint.d, joint.ddot, d_max, state[row, z], parameters, o, slopes)
    largest = DEFORMATION if joint.loading else D_MAX
    for c in range(tangent.shape[2]):
        change = slopes[TO_D] * own[DEFORMATION, c] + slopes[TO_RATE] * own[RATE, c]
        tangent[row, entry, c] = change + slopes[TO_D_MAX] * own[largest, c] + slopes[TO_MEMORY] * tangent[row, z, c]
    for i in range(function.count):
        if columns[o + i] >= 0:
            tangent[row, entry, columns[o + i]] += slopes[TO_PARAMETERS + i]


@compiled
def net_tangent_of(joint, tangent, own, net_tangent, row):
    """Add the derivatives of the forces that a joint puts on its bodies."""
    a, b = DOF * joint.first, DOF * joint.second
    for i in range(2 * DOF):
        place = a + i if i < DOF else b + i - DOF
        slope = joint.gradient[i]
        for c in range(tangent.shape[2]):
            net_tangent[place, c] -= slope * own[FORCE, c]
        if CURVED:
            add_columns(hessian_row(joint, i, -joint.force), tangent, row, a, b, net_tangent, place)
    if CURVED:
        for m in range(2 * AXES):
            column = joint.point_columns[m]
            if column >= 0:
                for i in range(2 * DOF):
                    place = a + i if i < DOF else b + i - DOF
                    net_tangent[place, column] -= joint.force * joint.hessian[i, 2 * DOF + m]


@compiled
def accelerate_tangent(
    bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent, net_tangent, row, t, piece
):
    """Derivatives of the state's derivative at a stage; the forces are taken anew."""
    begin_forces(bodies, state, row)
    for i in range(net_tangent.shape[0]):
        for c in range(tangent.shape[2]):
            net_tangent[i, c] = 0.0
    for j in range(joints.size):
        joint, own = joints[j], joint_tangent[j]
        kinematics(bodies, joint, state, row)
        if CURVED:
            curve(bodies, joint, state, row)
        deformation_tangent(joint, tangent, own, row)
        rate_tangent(bodies, joint, state, tangent, own, row)
        force = force_tangent(joint, functions, parameters, state, columns, tangent, own, partials, row)
        push(bodies, joint, force)
        net_tangent_of(joint, tangent, own, net_tangent, row)
    add_given(bodies, given, t, piece)
    respond_tangent(bodies, net_tangent, state, tangent, row)
    rates_tangent(bodies, state, tangent, row)


@compiled
def step_tangent(
    bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent, net_tangent, t, piece, h
):
    """The derivative of the Runge-Kutta step whose stages `state` holds; START moves to its end."""
    size = state.shape[1] // 2
    for row in range(1, 4):
        part = h if row == 3 else 0.5 * h
        for i in range(size):
            for c in range(tangent.shape[2]):
                tangent[row, i, c] = tangent[START, i, c] + part * tangent[row - 1, size + i, c]
        to_rotations(bodies, state, tangent, row, row)
        accelerate_tangent(
            bodies,
            joints,
            functions,
            parameters,
            given,
            state,
            columns,
            partials,
            tangent,
            joint_tangent,
            net_tangent,
            row,
            t + part,
            piece,
        )
    for i in range(size):
        for c in range(tangent.shape[2]):
            inner = tangent[1, size + i, c] + tangent[2, size + i, c]
            tangent[START, i, c] += h / 6.0 * (tangent[START, size + i, c] + 2.0 * inner + tangent[3, size + i, c])
    to_rotations(bodies, state, tangent, START, END)


@compiled
def freeze_tangent(bodies, joints, state, tangent, joint_tangent):
    """While a joint is loaded further the derivatives of its largest deformation are those of its deformation."""
    for j in range(joints.size):
        if joints[j].loading:
            kinematics(bodies, joints[j], state, START)
            deformation_tangent(joints[j], tangent, joint_tangent[j], START)
            for c in range(tangent.shape[2]):
                joint_tangent[j, D_MAX, c] = joint_tangent[j, DEFORMATION, c]


@compiled
def acceleration_of(bodies, joint, state):
    """The second derivative of a joint's deformation in time, at START."""
    n, second = DOF * bodies.size, 0.0
    first = state.shape[1] // 2 + n
    for i in range(2 * DOF):
        place = DOF * joint.first + i if i < DOF else DOF * joint.second + i - DOF
        second += joint.gradient[i] * state[START, first + place]
        if CURVED:
            for k in range(2 * DOF):
                other = DOF * joint.first + k if k < DOF else DOF * joint.second + k - DOF
                second += state[START, n + place] * joint.hessian[i, k] * state[START, n + other]
    return second


@compiled
def moment_tangent(bodies, joint, function, state, columns, tangent, own, slopes):
    """Derivatives of the time at which a guard of this joint with these slopes vanishes, into `own[FORCE]`."""
    size, z = state.shape[1] // 2, function.memory
    if CURVED:
        curve(bodies, joint, state, START)
    rate_tangent(bodies, joint, state, tangent, own, START)
    speed = slopes[TO_D] * joint.ddot + slopes[TO_RATE] * acceleration_of(bodies, joint, state)
    if joint.loading:
        speed += slopes[TO_D_MAX] * joint.ddot
    if z >= 0:
        speed += slopes[TO_MEMORY] * state[START, size + z]
    for c in range(tangent.shape[2]):
        change = slopes[TO_D] * own[DEFORMATION, c] + slopes[TO_RATE] * own[RATE, c] + slopes[TO_D_MAX] * own[D_MAX, c]
        own[FORCE, c] = change + slopes[TO_MEMORY] * tangent[START, z, c] if z >= 0 else change
    for i in range(function.count):
        if columns[function.offset + i] >= 0:
            own[FORCE, columns[function.offset + i]] += slopes[TO_PARAMETERS + i]
    for c in range(tangent.shape[2]):
        own[FORCE, c] *= -1.0 / speed


@compiled
def crossing_tangent(bodies, joint, functions, parameters, state, columns, partials, tangent, own):
    """Derivatives of the time of a crossing where the force of this joint may jump, into `own[FORCE]`; whether it is one.

    A force may also jump where the joint turns round at its largest deformation: the guard is then the rate.
    """
    d, ddot = kinematics(bodies, joint, state, START)
    d_max, turns = joint.d_max, False
    if joint.loading:
        d_max, turns = d, ddot < 0.0
    deformation_tangent(joint, tangent, own, START)
    for f in range(joint.start, joint.stop):
        function, slopes = functions[f], partials[f]
        o, z = function.offset, 0.0
        guard = math.inf
        if function.memory >= 0:
            z = state[START, function.memory]
            guard = law_guard(function.memory_number, function.memory_mode, d, ddot, d_max, z, parameters, o, slopes)
        if guard >= 0.0:
            guard = min(guard, law_guard(function.number, function.mode, d, ddot, d_max, z, parameters, o, slopes))
        if guard < 0.0 or (turns and guard < math.inf):
            if guard >= 0.0:
                for i in range(TO_PARAMETERS + function.count):
                    slopes[i] = 1.0 if i == TO_RATE else 0.0
            moment_tangent(bodies, joint, function, state, columns, tangent, own, slopes)
            return True
    return False
