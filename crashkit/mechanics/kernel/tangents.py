# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""Forward sensitivities: the derivative of the same steps on the same branches, one column for each parameter.

With D the gradient and H the Hessian of a joint's deformation d to the displacements q of its bodies (velocities v), its force
F = F(d, ddot, d_max, z, p) puts -F D on them, and

    d_c = rest_c + D q_c,  ddot_c = D v_c + v H q_c,  -(F D)_c = -F_c D - F H q_c.

A crossing where the force is continuous gives them no jump; for others see jumps.py.
"""

from crashkit.mechanics.kernel.arrays import (
    D_MAX,
    DEFORMATION,
    END,
    FORCES,
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
    DOF,
    bend,
    bend_to_point,
    measure_points,
    push_columns,
    rates_tangent,
    respond_tangent,
    to_rotations,
)
from crashkit.mechanics.kernel.stand_ins import compiled, inlined, law_partials

# ---- compiled from here ----


@inlined
def joint_partials(joints, joint, functions, parameters, partials, state, row):
    """Force of a joint and its derivatives to d, ddot and d_max; `partials` then holds those to memories and parameters, and
    to the d and ddot of what drives it."""
    d_max = joint.d if joint.loading else joint.d_max
    for f in range(joint.start, joint.stop):
        function = functions[f]
        z = state[row, function.memory] if function.memory >= 0 else 0.0
        code, mode, o = function.code, function.mode, function.offset
        if function.driver >= 0:
            driver = joints[function.driver]
            function.value = law_partials(code, 0, driver.d, driver.ddot, driver.d, z, parameters, o, partials[f])
        else:
            function.value = law_partials(code, mode, joint.d, joint.ddot, d_max, z, parameters, o, partials[f])
    to_d, to_rate, to_d_max, force = 0.0, 0.0, 0.0, 1.0
    for f in range(joint.start, joint.stop):
        force *= functions[f].value
        for other in range(joint.start, joint.stop):
            if other != f:
                for i in range(TO_PARAMETERS + functions[f].count):
                    partials[f, i] *= functions[other].value
        if functions[f].driver < 0:
            to_d += partials[f, TO_D]
            to_rate += partials[f, TO_RATE]
            to_d_max += partials[f, TO_D_MAX]
    if joint.loading:
        return force, to_d + to_d_max, to_rate, 0.0
    return force, to_d, to_rate, to_d_max


@inlined
def push_tangent(bodies, joint, state, tangent, own, net_tangent, row, force, to_d, to_rate, to_d_max):
    """Derivatives of a joint's deformation, rate, force and part of the net forces through the motion of its bodies.

    Arguments:
        force, to_d, to_rate, to_d_max: the joint's, and its derivatives.
    """
    n = DOF * bodies.size
    a, b = DOF * joint.first, DOF * joint.second
    near, far = DOF * joint.pushed_first, DOF * joint.pushed_second
    push_columns(
        joint, state[row, n + a : n + a + DOF], state[row, n + b : n + b + DOF], tangent[row, a : a + DOF],
        tangent[row, b : b + DOF], tangent[row, n + a : n + a + DOF], tangent[row, n + b : n + b + DOF], own[REST], own[D_MAX],
        own[DEFORMATION], own[RATE], own[FORCES + row], net_tangent[near : near + DOF], net_tangent[far : far + DOF], force,
        to_d, to_rate, to_d_max,
    )  # fmt: skip


@inlined
def add_force(joint, own, net_tangent, row, column, change):
    """Add a derivative of a joint's force at a stage to one column."""
    a, b = DOF * joint.pushed_first, DOF * joint.pushed_second
    own[FORCES + row, column] += change
    for i in range(DOF):
        net_tangent[a + i, column] -= joint.gradient[i] * change
        net_tangent[b + i, column] -= joint.gradient[DOF + i] * change


@inlined
def parameter_columns(joint, functions, columns, tangent, own, net_tangent, partials, row):
    """A joint's force depends on the parameters and memories of its functions."""
    for f in range(joint.start, joint.stop):
        function = functions[f]
        for i in range(function.count):
            column = columns[function.offset + i]
            if column >= 0:
                add_force(joint, own, net_tangent, row, column, partials[f, TO_PARAMETERS + i])
        if function.memory >= 0:
            for c in range(tangent.shape[2]):
                add_force(joint, own, net_tangent, row, c, partials[f, TO_MEMORY] * tangent[row, function.memory, c])


@compiled
def driver_columns(joints, functions, joint_tangent, net_tangent, partials, row):
    """Forces depend on the deformations of the joints that drive them, whose derivatives are known."""
    for j in range(joints.size):
        for f in range(joints[j].start, joints[j].stop):
            if functions[f].driver >= 0:
                driver = joint_tangent[functions[f].driver]
                for c in range(joint_tangent.shape[2]):
                    change = partials[f, TO_D] * driver[DEFORMATION, c] + partials[f, TO_RATE] * driver[RATE, c]
                    add_force(joints[j], joint_tangent[j], net_tangent, row, c, change)


@compiled
def point_columns(bodies, joint, state, own, net_tangent, row, force, to_d, to_rate):
    """A joint's deformation, its rate, and where its force acts depend on its attachments.

    The derivative of the rate to an attachment is how the derivative of the deformation to it changes along the velocities.
    """
    n = DOF * bodies.size
    a, b = DOF * joint.first, DOF * joint.second
    measure_points(bodies, joint)
    for m in range(2 * AXES):
        column = joint.point_columns[m]
        if column >= 0:
            for i in range(DOF):
                joint.along[i] = state[row, n + a + i]
                joint.along[DOF + i] = state[row, n + b + i]
            bend(bodies, joint)
            d, rate = joint.gradient[2 * DOF + m], joint.bend[2 * DOF + m]
            own[DEFORMATION, column] += d
            own[RATE, column] += rate
            add_force(joint, own, net_tangent, row, column, to_d * d + to_rate * rate)
            bend_to_point(bodies, joint, m)
            for i in range(DOF):
                net_tangent[a + i, column] -= force * joint.bend[i]
                net_tangent[b + i, column] -= force * joint.bend[DOF + i]


@compiled
def deformation_tangent(bodies, joint, state, tangent, own, net_tangent, row):
    """Derivatives of a joint's deformation and of its rate; `net_tangent` stays as it is."""
    push_tangent(bodies, joint, state, tangent, own, net_tangent[row], row, 0.0, 0.0, 0.0, 0.0)
    if joint.moves_points:
        point_columns(bodies, joint, state, own, net_tangent[row], row, 0.0, 0.0, 0.0)


@compiled
def memory_tangent(joint, function, parameters, state, columns, tangent, own, slopes, row, entry):
    """Derivatives of the rate of a memory."""
    z, o = function.memory, function.offset
    d_max = joint.d if joint.loading else joint.d_max
    code, mode = function.memory_code, function.memory_mode
    law_partials(code, mode, joint.d, joint.ddot, d_max, state[row, z], parameters, o, slopes)
    largest = DEFORMATION if joint.loading else D_MAX
    for c in range(tangent.shape[2]):
        change = slopes[TO_D] * own[DEFORMATION, c] + slopes[TO_RATE] * own[RATE, c]
        tangent[row, entry, c] = change + slopes[TO_D_MAX] * own[largest, c] + slopes[TO_MEMORY] * tangent[row, z, c]
    for i in range(function.count):
        if columns[o + i] >= 0:
            tangent[row, entry, columns[o + i]] += slopes[TO_PARAMETERS + i]


@compiled
def accelerate_tangent(
    bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent, net_tangent, row, t, piece
):
    """Derivatives of the state's derivative at a stage; the forces are taken anew."""
    size, net = state.shape[1] // 2, net_tangent[row]
    begin_forces(bodies, state, row)
    for i in range(net.shape[0]):
        for c in range(tangent.shape[2]):
            net[i, c] = 0.0
    for joint in joints:
        kinematics(bodies, joint, state, row)
    for j in range(joints.size):
        joint, own = joints[j], joint_tangent[j]
        force, to_d, to_rate, to_d_max = joint_partials(joints, joint, functions, parameters, partials, state, row)
        push(bodies, joint, row, force)
        push_tangent(bodies, joint, state, tangent, own, net, row, force, to_d, to_rate, to_d_max)
        parameter_columns(joint, functions, columns, tangent, own, net, partials, row)
        if joint.moves_points:
            point_columns(bodies, joint, state, own, net, row, force, to_d, to_rate)
        for f in range(joint.start, joint.stop):
            if functions[f].memory >= 0:
                memory = functions[f].memory
                memory_tangent(joint, functions[f], parameters, state, columns, tangent, own, partials[f], row, size + memory)
    driver_columns(joints, functions, joint_tangent, net, partials, row)
    add_given(bodies, given, row, t, piece)
    respond_tangent(bodies, net, state, tangent, row)
    rates_tangent(bodies, state, tangent, row)


@compiled
def step_tangent(
    bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent, net_tangent, t, piece, h
):
    """The derivative of the Runge-Kutta step whose stages `state` holds, into the row END."""
    size = state.shape[1] // 2
    for row in range(1, 4):
        part = h if row == 3 else 0.5 * h
        for i in range(size):
            for c in range(tangent.shape[2]):
                tangent[row, i, c] = tangent[START, i, c] + part * tangent[row - 1, size + i, c]
        to_rotations(bodies, state, tangent, row, row)
        accelerate_tangent(
            bodies, joints, functions, parameters, given, state, columns, partials, tangent, joint_tangent, net_tangent,
            row, t + part, piece,
        )  # fmt: skip
    for i in range(size):
        for c in range(tangent.shape[2]):
            inner = tangent[1, size + i, c] + tangent[2, size + i, c]
            slope = (tangent[START, size + i, c] + 2.0 * inner + tangent[3, size + i, c]) / 6.0
            tangent[END, i, c] = tangent[START, i, c] + h * slope
    to_rotations(bodies, state, tangent, END, END)


@compiled
def freeze_tangent(bodies, joints, state, tangent, joint_tangent, net_tangent):
    """While a joint is loaded further the derivatives of its largest deformation are those of its deformation."""
    for j in range(joints.size):
        if joints[j].loading:
            kinematics(bodies, joints[j], state, START)
            deformation_tangent(bodies, joints[j], state, tangent, joint_tangent[j], net_tangent, START)
            for c in range(tangent.shape[2]):
                joint_tangent[j, D_MAX, c] = joint_tangent[j, DEFORMATION, c]
