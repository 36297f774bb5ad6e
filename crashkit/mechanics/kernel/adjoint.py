# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""The adjoint of a run: one gradient to any number of parameters, at the cost of a few runs.

It is the transpose of the forward sensitivities (see tangents.py), step by step from the last to the first: with lam the
adjoint of the state at the end of a step, and f the state's derivative at its stages 0 to 3,

    mu_3 = f_y' (h/6 lam), mu_2 = f_y' (h/3 lam + h mu_3), mu_1 = f_y' (h/3 lam + h/2 mu_2), mu_0 = f_y' (h/6 lam + h/2 mu_1),

the adjoint at its start is lam + mu_0 + mu_1 + mu_2 + mu_3, and what stands in brackets times f_p is added to the gradient.
(Mizzi & Jezequel 1992, eq 56-64, where the adjoint equation is solved instead.)
"""

from crashkit.mechanics.kernel.arrays import END, NONE, START, TO_D, TO_D_MAX, TO_MEMORY, TO_PARAMETERS, TO_RATE
from crashkit.mechanics.kernel.forces import accelerate, add_given, begin_forces, kinematics, push
from crashkit.mechanics.kernel.history import recall, recall_branches
from crashkit.mechanics.kernel.jumps import jumping_function, lateness
from crashkit.mechanics.kernel.line import (
    AXES,
    DOF,
    bend_adjoint,
    locate,
    measure_points,
    rates_adjoint,
    respond_adjoint,
    to_rotations_adjoint,
)
from crashkit.mechanics.kernel.stand_ins import compiled, law_partials
from crashkit.mechanics.kernel.steps import try_step
from crashkit.mechanics.kernel.tangents import joint_partials

# ---- compiled from here ----


@compiled
def memory_adjoint(function, joint, parameters, state, row, wanted, slopes, lam, parameter_gradient):
    """Carry the adjoint of a memory's rate back; returns its parts for d, ddot and d_max."""
    z, o = function.memory, function.offset
    d_max = joint.d if joint.loading else joint.d_max
    code, mode = function.memory_code, function.memory_mode
    law_partials(code, mode, joint.d, joint.ddot, d_max, state[row, z], parameters, o, slopes)
    lam[z] += wanted * slopes[TO_MEMORY]
    for i in range(function.count):
        parameter_gradient[o + i] += wanted * slopes[TO_PARAMETERS + i]
    return wanted * slopes[TO_D], wanted * slopes[TO_RATE], wanted * slopes[TO_D_MAX]


@compiled
def motion_adjoint(bodies, joint, state, row, d_bar, rate_bar, force, load, lam, own):
    """Carry the adjoints of a joint's deformation, of its rate and of its direction back to the state and to its own.

    Arguments:
        force, load: the joint's, and the adjoint of the forces and moments on the bodies.
    """
    n = DOF * bodies.size
    a, b = DOF * joint.first, DOF * joint.second
    own[1] += d_bar
    for i in range(DOF):
        joint.along[i] = rate_bar * state[row, n + a + i] - force * load[a + i]
        joint.along[DOF + i] = rate_bar * state[row, n + b + i] - force * load[b + i]
        lam[n + a + i] += rate_bar * joint.gradient[i]
        lam[n + b + i] += rate_bar * joint.gradient[DOF + i]
    measure_points(bodies, joint)
    bend_adjoint(bodies, joint)
    for i in range(DOF):
        lam[a + i] += d_bar * joint.gradient[i] + joint.bend[i]
        lam[b + i] += d_bar * joint.gradient[DOF + i] + joint.bend[DOF + i]
    for m in range(2 * AXES):
        own[2 + m] += d_bar * joint.gradient[2 * DOF + m] + joint.bend[2 * DOF + m]


@compiled
def joint_adjoint(
    bodies, joints, j, functions, parameters, state, partials, row, response, load, seeds, lam, parameter_gradient,
    joint_gradient,
):  # fmt: skip
    """Carry the adjoint of the forces that a joint puts on its bodies back to the state and to its parameters.

    Arguments:
        response: of the state's derivative.
        load: of the forces and moments on the bodies.
        seeds: of the joint's own force, deformation and rate.
        joint_gradient: of each joint's largest deformation, its rest and its attachments.
    """
    joint, own = joints[j], joint_gradient[j]
    a, b = DOF * joint.pushed_first, DOF * joint.pushed_second
    wanted = seeds[0]
    for i in range(DOF):
        wanted -= load[a + i] * joint.gradient[i] + load[b + i] * joint.gradient[DOF + i]
    force, to_d, to_rate, to_d_max = joint_partials(joints, joint, functions, parameters, partials, state, row)
    d_bar, rate_bar = wanted * to_d + seeds[1], wanted * to_rate + seeds[2]
    own[0] += wanted * to_d_max
    for f in range(joint.start, joint.stop):
        function = functions[f]
        for i in range(function.count):
            parameter_gradient[function.offset + i] += wanted * partials[f, TO_PARAMETERS + i]
        if function.driver >= 0:
            k, there, then = function.driver, wanted * partials[f, TO_D], wanted * partials[f, TO_RATE]
            motion_adjoint(bodies, joints[k], state, row, there, then, 0.0, load, lam, joint_gradient[k])
        if function.memory >= 0:
            lam[function.memory] += wanted * partials[f, TO_MEMORY]
            rate, slopes = response[function.memory], partials[f]
            to_d, to_rate, to_d_max = memory_adjoint(
                function, joint, parameters, state, row, rate, slopes, lam, parameter_gradient
            )
            d_bar += to_d + (to_d_max if joint.loading else 0.0)
            rate_bar += to_rate
            own[0] += 0.0 if joint.loading else to_d_max
    motion_adjoint(bodies, joint, state, row, d_bar, rate_bar, force, load, lam, own)


@compiled
def accelerate_adjoint(
    bodies, joints, functions, parameters, given, state, partials, row, t, piece, response, seeds, lam, load,
    parameter_gradient, joint_gradient, body_gradient,
):  # fmt: skip
    """Add to `lam` and to the gradients what the adjoint `response` of the state's derivative at a stage brings.

    Arguments:
        seeds: adjoints of the joints' forces, deformations and rates, then of the forces and moments on the bodies.
    """
    n = DOF * bodies.size
    begin_forces(bodies, state, row)
    for joint in joints:
        kinematics(bodies, joint, state, row)
    for joint in joints:
        force = joint_partials(joints, joint, functions, parameters, partials, state, row)[0]
        push(bodies, joint, row, force)
    add_given(bodies, given, row, t, piece)
    rates_adjoint(bodies, state, row, response, lam)
    respond_adjoint(bodies, state, row, response[n : 2 * n], load, lam, body_gradient)
    for i in range(n):
        load[i] += seeds[3 * joints.size + i]
    for j in range(joints.size):
        wanted = seeds[3 * j : 3 * j + 3]
        joint_adjoint(
            bodies, joints, j, functions, parameters, state, partials, row, response, load, wanted, lam, parameter_gradient,
            joint_gradient,
        )  # fmt: skip


@compiled
def deformation_adjoint(bodies, joint, state, wanted, lam, own):
    """Carry the adjoint of a joint's deformation at START back to the state, its rest and its attachments."""
    kinematics(bodies, joint, state, START)
    measure_points(bodies, joint)
    own[1] += wanted
    for k in range(DOF):
        lam[DOF * joint.first + k] += wanted * joint.gradient[k]
        lam[DOF * joint.second + k] += wanted * joint.gradient[DOF + k]
    for m in range(2 * AXES):
        own[2 + m] += wanted * joint.gradient[2 * DOF + m]


@compiled
def thaw(bodies, joints, state, history, s, lam, joint_gradient):
    """Where a largest deformation was frozen at the start of a step, its adjoint goes to the deformation there."""
    locate(bodies, state, START)
    for j in range(joints.size):
        joint, own = joints[j], joint_gradient[j]
        if s > 0 and not joint.loading and history[s - 1, state.shape[1] // 2 + 5 + 2 * j] > 0.0:
            deformation_adjoint(bodies, joint, state, own[0], lam, own)
            own[0] = 0.0


@compiled
def begin_adjoint(bodies, joints, state, lam, joint_gradient, free):
    """The transpose of `begin`: what rest and the largest deformation at t = 0 owe to the initial state.

    Arguments:
        free: by joint, whether its free length is the distance at t = 0.
    """
    locate(bodies, state, START)
    for j in range(joints.size):
        joint, own = joints[j], joint_gradient[j]
        d = kinematics(bodies, joint, state, START)[0]
        if not free[j] and d > 0.0:
            deformation_adjoint(bodies, joint, state, own[0], lam, own)
        if free[j]:
            deformation_adjoint(bodies, joint, state, -own[1], lam, own)
            own[1] = 0.0


@compiled
def jump_adjoint(bodies, joint, function, state, slopes, wanted, nothing, lam, parameter_gradient, own):
    """Carry the adjoint of the time of a crossing whose guard has these slopes back, at START."""
    wanted *= lateness(bodies, joint, function, state, slopes)
    to_d_max = wanted * slopes[TO_D_MAX]
    d_bar, rate_bar = wanted * slopes[TO_D], wanted * slopes[TO_RATE]
    if joint.loading:
        d_bar += to_d_max
    else:
        own[0] += to_d_max
    if function.memory >= 0:
        lam[function.memory] += wanted * slopes[TO_MEMORY]
    for i in range(function.count):
        parameter_gradient[function.offset + i] += wanted * slopes[TO_PARAMETERS + i]
    motion_adjoint(bodies, joint, state, START, d_bar, rate_bar, 0.0, nothing, lam, own)


@compiled
def change_adjoint(
    bodies, joints, functions, parameters, given, state, partials, history, s, t, piece, nothing, lam, parameter_gradient,
    joint_gradient,
):  # fmt: skip
    """The transpose of `change_branches`: the joints return to their branches before step s, the last one first."""
    size = state.shape[1] // 2
    locate(bodies, state, START)
    for back in range(joints.size):
        j = joints.size - 1 - back
        joint = joints[j]
        recall_branches(joints, functions, history, s - 1, size, j)
        f = jumping_function(bodies, joint, functions, parameters, state, partials)
        if f != NONE:
            recall_branches(joints, functions, history, s, size, j)
            accelerate(bodies, joints, functions, parameters, given, state, START, t, piece)
            wanted = 0.0
            for i in range(size):
                wanted -= state[START, size + i] * lam[i]
            recall_branches(joints, functions, history, s - 1, size, j)
            accelerate(bodies, joints, functions, parameters, given, state, START, t, piece)
            for i in range(size):
                wanted += state[START, size + i] * lam[i]
            own = joint_gradient[j]
            jump_adjoint(bodies, joint, functions[f], state, partials[f], wanted, nothing, lam, parameter_gradient, own)


@compiled
def step_adjoint(
    bodies, joints, functions, parameters, given, state, partials, t, piece, h, response, nothing, lam, mu, load,
    parameter_gradient, joint_gradient, body_gradient,
):  # fmt: skip
    """Take a step again, whose start is at START, and carry the adjoint at its end back to its start.

    Arguments:
        response, load, mu: room for the adjoints of a stage's derivative, of its forces, and of its state.
        nothing: zeros.
    """
    size = state.shape[1] // 2
    try_step(bodies, joints, functions, parameters, given, state, t, piece, h)
    to_rotations_adjoint(bodies, state, lam, END)
    for row in range(3, -1, -1):
        part = h if row == 3 else 0.0 if row == 0 else 0.5 * h
        for i in range(size):
            response[i] = (h / 3.0 if 0 < row < 3 else h / 6.0) * lam[i]
            if row < 3:
                response[i] += (h if row == 2 else 0.5 * h) * mu[row + 1, i]
            mu[row, i] = 0.0
        accelerate_adjoint(
            bodies, joints, functions, parameters, given, state, partials, row, t + part, piece, response, nothing, mu[row],
            load, parameter_gradient, joint_gradient, body_gradient,
        )  # fmt: skip
        to_rotations_adjoint(bodies, state, mu[row], row)
    for i in range(size):
        lam[i] += mu[0, i] + mu[1, i] + mu[2, i] + mu[3, i]


@compiled
def sweep(
    history, steps, bodies, joints, functions, parameters, given, state, partials, seeds, own_seeds, free, response, load,
    nothing, mu, lam, parameter_gradient, joint_gradient, body_gradient,
):  # fmt: skip
    """Go back through the steps of a run.

    Arguments:
        history: of a forward run, see `remember`; `steps` of its rows.
        seeds: (time, entry) adjoint of the record's entries: of the state and its derivative.
        own_seeds: (time, entry) of the others, but for quaternions.
        free: by joint, whether its free length is the distance at t = 0.
        response, load, nothing, mu: room for the adjoint of the state's derivative, of the forces, of what is recorded
            beside the state (all 0), and of the state at each stage.
        lam: becomes the gradient to the initial state.
        parameter_gradient, joint_gradient, body_gradient: gradients to the laws' parameters; to each joint's largest
            deformation, rest and attachments; to each body's inertia (six entries) and mass.
    """
    size, later = state.shape[1] // 2, 0.0
    for back in range(steps):
        s = steps - 1 - back
        t, piece, k, crossing = recall(bodies, joints, functions, state, history, s)
        accelerate(bodies, joints, functions, parameters, given, state, START, t, piece)
        if back > 0:
            step_adjoint(
                bodies, joints, functions, parameters, given, state, partials, t, piece, later - t, response, nothing, lam, mu,
                load, parameter_gradient, joint_gradient, body_gradient,
            )  # fmt: skip
        if k >= 0:
            for i in range(size):
                response[i] = seeds[k, size + i]
            accelerate_adjoint(
                bodies, joints, functions, parameters, given, state, partials, START, t, piece, response, own_seeds[k], lam,
                load, parameter_gradient, joint_gradient, body_gradient,
            )  # fmt: skip
            for i in range(size):
                lam[i] += seeds[k, i]
        if crossing and s > 0:
            change_adjoint(
                bodies, joints, functions, parameters, given, state, partials, history, s, t, piece, nothing, lam,
                parameter_gradient, joint_gradient,
            )  # fmt: skip
            recall(bodies, joints, functions, state, history, s)
        thaw(bodies, joints, state, history, s, lam, joint_gradient)
        later = t
    begin_adjoint(bodies, joints, state, lam, joint_gradient, free)
