# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""The geometry of space: SE(3), each body with three coordinates and a rotation (rotations.py).

Angular velocities are kept in the laboratory frame, Euler's equation is solved in the body's: I omega' + omega x I omega =
tau.
"""

import math

from crashkit.mechanics.kernel.arrays import TOTAL
from crashkit.mechanics.kernel.stand_ins import compiled, inlined, unaliased
from crashkit.mechanics.kernel.vectors import (
    column_of,
    cross,
    dot,
    entries,
    plus,
    put,
    scaled,
    set_entries,
    three,
    three_of,
    times,
    turned,
    turned_back,
    unit,
)

# ---- compiled from here ----

DOF, AXES = 6, 3
CURVED = True
"""Whether the direction of a joint changes with the positions."""


@inlined
def measure(bodies, joint, state, row):
    """The distance of a joint's ends, and the gradient of its deformation; `shape` keeps what its derivatives need."""
    a, b = joint.first, joint.second
    arm_a = turned(bodies[a], entries(joint.places, 0))
    arm_b = turned(bodies[b], entries(joint.places, 3))
    ends = plus(plus(three(state, row, 6 * b), arm_b), scaled(-1.0, plus(three(state, row, 6 * a), arm_a)))
    if joint.face:
        n = turned(bodies[a], entries(joint.places, 6))
        length = dot(n, ends)
        arm_a = plus(arm_a, ends)
    else:
        length = math.sqrt(dot(ends, ends))
        n = scaled(1.0 / length, ends)
    set_entries(joint.gradient, 0, n)
    set_entries(joint.gradient, 3, cross(arm_a, n))
    set_entries(joint.gradient, 6, scaled(-1.0, n))
    set_entries(joint.gradient, 9, cross(n, arm_b))
    set_entries(joint.shape, 0, arm_a)
    set_entries(joint.shape, 3, arm_b)
    joint.shape[6] = 1.0 / length
    return length


@inlined
def turn(face, n, arm_a, arm_b, inverse, a, turn_a, b, turn_b):
    """How a joint's direction turns, and its two moments per unit of force change, along a motion of its bodies.

    Arguments:
        inverse: of its length.
        a, turn_a, b, turn_b: the motion.
    """
    moved_b = cross(turn_b, arm_b)
    apart = plus(plus(b, moved_b), scaled(-1.0, a))
    if face:
        moved_a, swing = apart, cross(turn_a, n)
    else:
        moved_a = cross(turn_a, arm_a)
        swing = across(n, inverse, plus(apart, scaled(-1.0, moved_a)))
    return swing, plus(cross(moved_a, n), cross(arm_a, swing)), plus(cross(n, moved_b), cross(swing, arm_b))


@compiled
def across(n, inverse, apart):
    """How the direction n of a line turns when its ends move apart: (I - n n') apart / length."""
    return scaled(inverse, plus(apart, scaled(-dot(n, apart), n)))


@compiled
def measure_points(bodies, joint):
    """The gradient of the deformation to the attachments."""
    n = entries(joint.gradient, 0)
    set_entries(joint.gradient, 12, turned_back(bodies[joint.first], n))
    set_entries(joint.gradient, 15, scaled(-1.0, turned_back(bodies[joint.second], n)))


@compiled
def set_bend(joint, swing, moment_a, moment_b):
    """Keep how the gradient to the positions changes."""
    set_entries(joint.bend, 0, swing)
    set_entries(joint.bend, 3, moment_a)
    set_entries(joint.bend, 6, scaled(-1.0, swing))
    set_entries(joint.bend, 9, moment_b)


@compiled
def bend(bodies, joint):
    """How the gradient changes along the motion `along` of the two bodies, into `bend`."""
    n, turn_a, turn_b = entries(joint.gradient, 0), entries(joint.along, 3), entries(joint.along, 9)
    arm_a, arm_b = entries(joint.shape, 0), entries(joint.shape, 3)
    swing, moment_a, moment_b = turn(
        joint.face, n, arm_a, arm_b, joint.shape[6], entries(joint.along, 0), turn_a, entries(joint.along, 6), turn_b
    )
    set_bend(joint, swing, moment_a, moment_b)
    swing_a = plus(swing, cross(n, turn_a))
    swing_b = plus(swing, cross(n, turn_b))
    set_entries(joint.bend, 12, turned_back(bodies[joint.first], swing_a))
    set_entries(joint.bend, 15, scaled(-1.0, turned_back(bodies[joint.second], swing_b)))


@compiled
def bend_adjoint(bodies, joint):
    """The transpose of `bend`: rotations do not commute, so that the Hessian is not symmetric, H' w = H w + D x w."""
    bend(bodies, joint)
    for i in range(3, 12, 6):
        swept = cross(entries(joint.gradient, i), entries(joint.along, i))
        set_entries(joint.bend, i, plus(entries(joint.bend, i), swept))


@compiled
def bend_to_point(bodies, joint, m):
    """How the gradient to the positions changes with a coordinate of an attachment, into `bend`."""
    n, end = entries(joint.gradient, 0), m // 3
    moved = turned(bodies[joint.second if end else joint.first], unit(m % 3))
    moved_a, moved_b, swing = scaled(1.0 - end, moved), scaled(1.0 * end, moved), (0.0, 0.0, 0.0)
    if joint.face:
        moved_a = moved_b
    else:
        swing = across(n, joint.shape[6], plus(moved_b, scaled(-1.0, moved_a)))
    moment_a = plus(cross(moved_a, n), cross(entries(joint.shape, 0), swing))
    set_bend(joint, swing, moment_a, plus(cross(n, moved_b), cross(swing, entries(joint.shape, 3))))


@unaliased
def push_columns(
    joint, v_a, v_b, q_a_c, q_b_c, v_a_c, v_b_c, rest_c, d_max_c, d_c, rate_c, force_c, net_a_c, net_b_c, force, to_d, to_rate,
    to_d_max,
):  # fmt: skip
    """Derivatives of a joint's deformation, rate, force and part of the net forces: as in one axis."""
    face, inverse, arm_a, arm_b = joint.face, joint.shape[6], entries(joint.shape, 0), entries(joint.shape, 3)
    normal, g_a, g_b = entries(joint.gradient, 0), entries(joint.gradient, 3), entries(joint.gradient, 9)
    v, turning_a, turning_b = plus(entries(v_a, 0), scaled(-1.0, entries(v_b, 0))), entries(v_a, 3), entries(v_b, 3)
    for c in range(d_c.size):
        q_a, turn_a = column_of(q_a_c, 0, c), column_of(q_a_c, 3, c)
        q_b, turn_b = column_of(q_b_c, 0, c), column_of(q_b_c, 3, c)
        swing, moment_a, moment_b = turn(face, normal, arm_a, arm_b, inverse, q_a, turn_a, q_b, turn_b)
        d = rest_c[c] + dot(normal, q_a) - dot(normal, q_b) + dot(g_a, turn_a) + dot(g_b, turn_b)
        rate = dot(swing, v) + dot(moment_a, turning_a) + dot(moment_b, turning_b)
        rate += dot(normal, column_of(v_a_c, 0, c)) - dot(normal, column_of(v_b_c, 0, c))
        rate += dot(g_a, column_of(v_a_c, 3, c)) + dot(g_b, column_of(v_b_c, 3, c))
        pushed = to_d * d + to_rate * rate + to_d_max * d_max_c[c]
        d_c[c] = d
        rate_c[c] = rate
        force_c[c] = pushed
        f = plus(scaled(pushed, normal), scaled(force, swing))
        m_a = plus(scaled(pushed, g_a), scaled(force, moment_a))
        m_b = plus(scaled(pushed, g_b), scaled(force, moment_b))
        for k in range(3):
            net_a_c[k, c] -= f[k]
            net_b_c[k, c] += f[k]
            net_a_c[3 + k, c] -= m_a[k]
            net_b_c[3 + k, c] -= m_b[k]


@compiled
def respond(bodies, state, row):
    """The accelerations under their forces and moments: Newton's and Euler's equations."""
    n = 6 * bodies.size
    first = state.shape[1] // 2 + n
    for body in range(bodies.size):
        i = 6 * body
        put(state, row, first + i, scaled(bodies[body].inverse_mass, entries(bodies[body].net[TOTAL], 0)))
        omega = turned_back(bodies[body], three(state, row, n + i + 3))
        turning = cross(omega, times(bodies[body], 0, omega))
        moment = plus(turned_back(bodies[body], entries(bodies[body].net[TOTAL], 3)), scaled(-1.0, turning))
        put(state, row, first + i + 3, turned(bodies[body], times(bodies[body], 1, moment)))


@compiled
def respond_tangent(bodies, net_tangent, state, tangent, row):
    """The derivatives of `respond` to the columns."""
    n = 6 * bodies.size
    first = state.shape[1] // 2 + n
    for body in range(bodies.size):
        i, inverse_mass, column = 6 * body, bodies[body].inverse_mass, bodies[body].mass_column
        tau, omega_lab = entries(bodies[body].net[TOTAL], 3), three(state, row, n + i + 3)
        omega = turned_back(bodies[body], omega_lab)
        momentum = times(bodies[body], 0, omega)
        moment = plus(turned_back(bodies[body], tau), scaled(-1.0, cross(omega, momentum)))
        alpha = times(bodies[body], 1, moment)
        alpha_lab = turned(bodies[body], alpha)
        for c in range(tangent.shape[2]):
            theta_c = three_of(tangent, row, i + 3, c)
            back = scaled(-1.0, theta_c)
            omega_c = turned_back(bodies[body], plus(three_of(tangent, row, n + i + 3, c), cross(back, omega_lab)))
            tau_c = (net_tangent[i + 3, c], net_tangent[i + 4, c], net_tangent[i + 5, c])
            tau_c = turned_back(bodies[body], plus(tau_c, cross(back, tau)))
            turning_c = plus(cross(omega_c, momentum), cross(omega, times(bodies[body], 0, omega_c)))
            alpha_c = times(bodies[body], 1, plus(tau_c, scaled(-1.0, turning_c)))
            alpha_c = plus(turned(bodies[body], alpha_c), cross(theta_c, alpha_lab))
            for k in range(3):
                tangent[row, first + i + k, c] = inverse_mass * net_tangent[i + k, c]
                tangent[row, first + i + 3 + k, c] = alpha_c[k]
        if column >= 0:
            for k in range(3):
                tangent[row, first + i + k, column] -= inverse_mass * inverse_mass * bodies[body].net[TOTAL, k]
        for entry in range(6):
            column = bodies[body].inertia_columns[entry]
            if column >= 0:
                change = plus(unit_inertia(entry, alpha), cross(omega, unit_inertia(entry, omega)))
                change = turned(bodies[body], times(bodies[body], 1, change))
                for k in range(3):
                    tangent[row, first + i + 3 + k, column] -= change[k]


@compiled
def unit_inertia(entry, a):
    """An inertia whose only entry is 1 (xx, yy, zz, xy, xz, yz), times a vector."""
    if entry < 3:
        kept = unit(entry)
        return kept[0] * a[0], kept[1] * a[1], kept[2] * a[2]
    if entry == 3:
        return a[1], a[0], 0.0
    if entry == 4:
        return a[2], 0.0, a[0]
    return 0.0, a[2], a[1]


@compiled
def respond_adjoint(bodies, state, row, response, load, backward, body_gradient):
    """Carry the adjoint of the accelerations back to forces (`load`), rotations and rates (`backward`) and inertia."""
    n = 6 * bodies.size
    for body in range(bodies.size):
        i, inverse_mass = 6 * body, bodies[body].inverse_mass
        for k in range(3):
            load[i + k] = inverse_mass * response[i + k]
            body_gradient[body, 6] -= inverse_mass * inverse_mass * bodies[body].net[TOTAL, k] * response[i + k]
        tau, omega_lab = entries(bodies[body].net[TOTAL], 3), three(state, row, n + i + 3)
        omega = turned_back(bodies[body], omega_lab)
        momentum = times(bodies[body], 0, omega)
        moment = plus(turned_back(bodies[body], tau), scaled(-1.0, cross(omega, momentum)))
        alpha = times(bodies[body], 1, moment)
        wanted = (response[i + 3], response[i + 4], response[i + 5])
        back = times(bodies[body], 1, turned_back(bodies[body], wanted))
        load_c = turned(bodies[body], back)
        swept = cross(back, omega)
        omega_c = plus(cross(momentum, back), times(bodies[body], 0, swept))
        omega_c = turned(bodies[body], scaled(-1.0, omega_c))
        theta_c = plus(cross(turned(bodies[body], alpha), wanted), cross(load_c, tau))
        theta_c = plus(theta_c, cross(omega_c, omega_lab))
        for k in range(3):
            load[i + 3 + k] = load_c[k]
            backward[n + i + 3 + k] += omega_c[k]
            backward[i + 3 + k] += theta_c[k]
        for entry in range(6):
            change = dot(back, unit_inertia(entry, alpha)) + dot(swept, unit_inertia(entry, omega))
            body_gradient[body, entry] -= change
