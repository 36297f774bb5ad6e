# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""The geometry of plane motion: SE(2), each body with two coordinates and an angle.

A joint pushes along n, from its first attachment to its second, or along the normal of a face of its first body. With r the
arms from the centres of mass to where the force acts, the gradient of the deformation to the displacements is
(n, r_a x n) of the first body and -(n, r_b x n) of the second (Mizzi & Jezequel 1992, eq 7-11).
"""

import math

from crashkit.mechanics.kernel.arrays import TOTAL
from crashkit.mechanics.kernel.stand_ins import compiled, inlined, unaliased

# ---- compiled from here ----

DOF, AXES = 3, 2
CURVED = True
"""Whether the direction of a joint changes with the positions."""


@inlined
def locate(bodies, state, row):
    """Turn the bodies' frames to a stage."""
    for body in range(bodies.size):
        bodies[body].frame[0] = math.cos(state[row, 3 * body + 2])
        bodies[body].frame[1] = math.sin(state[row, 3 * body + 2])


@compiled
def settle(bodies, state):
    """Make the end of a step the origin of rotations: an angle needs none."""


@inlined
def arm(body, px, py):
    """A point of a body, from its centre of mass, in the laboratory frame."""
    c, s = body.frame[0], body.frame[1]
    return c * px - s * py, s * px + c * py


@inlined
def measure(bodies, joint, state, row):
    """The distance of a joint's ends, and the gradient of its deformation; `shape` keeps what its derivatives need."""
    a, b = joint.first, joint.second
    ax, ay = arm(bodies[a], joint.places[0], joint.places[1])
    bx, by = arm(bodies[b], joint.places[3], joint.places[4])
    dx = state[row, 3 * b] + bx - state[row, 3 * a] - ax
    dy = state[row, 3 * b + 1] + by - state[row, 3 * a + 1] - ay
    if joint.face:
        nx, ny = arm(bodies[a], joint.places[6], joint.places[7])
        length, inverse = nx * dx + ny * dy, 0.0
        ax += dx
        ay += dy
    else:
        length = math.sqrt(dx * dx + dy * dy)
        inverse = 1.0 / length
        nx, ny = inverse * dx, inverse * dy
    joint.gradient[0] = nx
    joint.gradient[1] = ny
    joint.gradient[2] = ax * ny - ay * nx
    joint.gradient[3] = -nx
    joint.gradient[4] = -ny
    joint.gradient[5] = by * nx - bx * ny
    joint.shape[0] = nx * ax + ny * ay
    joint.shape[1] = nx * bx + ny * by
    joint.shape[2] = inverse
    return length


@inlined
def turn(face, nx, ny, along_a, along_b, inverse, ax, ay, turn_a, bx, by, turn_b):
    """How a joint's direction turns, and its two moments per unit of force change, along a motion of its bodies.

    Arguments:
        along_a, along_b: of the arms, along n; `inverse` of its length.
        ax, ay, turn_a, bx, by, turn_b: the motion.
    """
    across = nx * (by - ay) - ny * (bx - ax) + along_b * turn_b - along_a * turn_a
    if face:
        return turn_a, -across, along_b * (turn_b - turn_a)
    turned = inverse * across
    return turned, along_a * (turned - turn_a), along_b * (turn_b - turned)


@compiled
def bend(bodies, joint):
    """How the gradient changes along the motion `along` of the two bodies, into `bend`."""
    nx, ny, w = joint.gradient[0], joint.gradient[1], joint.along
    turned, moment_a, moment_b = turn(
        joint.face, nx, ny, joint.shape[0], joint.shape[1], joint.shape[2], w[0], w[1], w[2], w[3], w[4], w[5]
    )
    joint.bend[0] = -turned * ny
    joint.bend[1] = turned * nx
    joint.bend[2] = moment_a
    joint.bend[3] = turned * ny
    joint.bend[4] = -turned * nx
    joint.bend[5] = moment_b
    ca, sa = bodies[joint.first].frame[0], bodies[joint.first].frame[1]
    cb, sb = bodies[joint.second].frame[0], bodies[joint.second].frame[1]
    joint.bend[6] = (turned - w[2]) * (sa * nx - ca * ny)
    joint.bend[7] = (turned - w[2]) * (sa * ny + ca * nx)
    joint.bend[8] = (turned - w[5]) * (cb * ny - sb * nx)
    joint.bend[9] = -(turned - w[5]) * (sb * ny + cb * nx)


@compiled
def measure_points(bodies, joint):
    """The gradient of the deformation to the attachments."""
    nx, ny = joint.gradient[0], joint.gradient[1]
    ca, sa = bodies[joint.first].frame[0], bodies[joint.first].frame[1]
    cb, sb = bodies[joint.second].frame[0], bodies[joint.second].frame[1]
    joint.gradient[6] = ca * nx + sa * ny
    joint.gradient[7] = ca * ny - sa * nx
    joint.gradient[8] = -cb * nx - sb * ny
    joint.gradient[9] = sb * nx - cb * ny


@compiled
def bend_adjoint(bodies, joint):
    """The transpose of `bend`: the same, as the Hessian is symmetric."""
    bend(bodies, joint)


@compiled
def bend_to_point(bodies, joint, m):
    """How the gradient to the positions changes with a coordinate of an attachment, into `bend`."""
    nx, ny, end, axis = joint.gradient[0], joint.gradient[1], m // 2, m % 2
    x, y = arm(bodies[joint.second if end else joint.first], 1.0 - axis, 1.0 * axis)
    across, moment = (2.0 * end - 1.0) * (nx * y - ny * x), x * ny - y * nx
    turned = 0.0 if joint.face else across * joint.shape[2]
    joint.bend[0] = -turned * ny
    joint.bend[1] = turned * nx
    joint.bend[2] = joint.shape[0] * turned
    joint.bend[3] = turned * ny
    joint.bend[4] = -turned * nx
    joint.bend[5] = -joint.shape[1] * turned - moment * end
    if joint.face:
        joint.bend[2] = moment * end
    elif not end:
        joint.bend[2] += moment


@unaliased
def push_columns(
    joint, v_a, v_b, q_a_c, q_b_c, v_a_c, v_b_c, rest_c, d_max_c, d_c, rate_c, force_c, net_a_c, net_b_c, force, to_d, to_rate,
    to_d_max,
):  # fmt: skip
    """Derivatives of a joint's deformation, rate, force and part of the net forces: as in one axis."""
    nx, ny, ga, gb = joint.gradient[0], joint.gradient[1], joint.gradient[2], joint.gradient[5]
    face, along_a, along_b, inverse = joint.face, joint.shape[0], joint.shape[1], joint.shape[2]
    va, vb, sweep = v_a[2], v_b[2], nx * (v_a[1] - v_b[1]) - ny * (v_a[0] - v_b[0])
    for c in range(d_c.size):
        ax, ay, turn_a = q_a_c[0, c], q_a_c[1, c], q_a_c[2, c]
        bx, by, turn_b = q_b_c[0, c], q_b_c[1, c], q_b_c[2, c]
        turned, moment_a, moment_b = turn(face, nx, ny, along_a, along_b, inverse, ax, ay, turn_a, bx, by, turn_b)
        d = rest_c[c] + nx * (ax - bx) + ny * (ay - by) + ga * turn_a + gb * turn_b
        rate = sweep * turned + va * moment_a + vb * moment_b
        rate += nx * (v_a_c[0, c] - v_b_c[0, c]) + ny * (v_a_c[1, c] - v_b_c[1, c]) + ga * v_a_c[2, c] + gb * v_b_c[2, c]
        pushed = to_d * d + to_rate * rate + to_d_max * d_max_c[c]
        d_c[c] = d
        rate_c[c] = rate
        force_c[c] = pushed
        fx, fy = nx * pushed - ny * force * turned, ny * pushed + nx * force * turned
        net_a_c[0, c] -= fx
        net_a_c[1, c] -= fy
        net_a_c[2, c] -= ga * pushed + force * moment_a
        net_b_c[0, c] += fx
        net_b_c[1, c] += fy
        net_b_c[2, c] -= gb * pushed + force * moment_b


@compiled
def to_rotations(bodies, state, tangent, row, chart):
    """Derivatives of the positions become those of the rotations: they are."""


@compiled
def to_rotations_adjoint(bodies, state, backward, chart):
    """The adjoint of `to_rotations`."""


@inlined
def rates(bodies, state, row):
    """The derivatives of the positions."""
    size, n = state.shape[1] // 2, 3 * bodies.size
    for i in range(n):
        state[row, size + i] = state[row, n + i]


@inlined
def rates_tangent(bodies, state, tangent, row):
    """The derivatives of `rates` to the columns."""
    size, n = state.shape[1] // 2, DOF * bodies.size
    for i in range(n):
        for c in range(tangent.shape[2]):
            tangent[row, size + i, c] = tangent[row, n + i, c]


@inlined
def respond(bodies, state, row):
    """The accelerations under their forces and moments."""
    first = state.shape[1] // 2 + 3 * bodies.size
    for body in range(bodies.size):
        i = 3 * body
        state[row, first + i] = bodies[body].inverse_mass * bodies[body].net[TOTAL, 0]
        state[row, first + i + 1] = bodies[body].inverse_mass * bodies[body].net[TOTAL, 1]
        state[row, first + i + 2] = bodies[body].inertia[1, 2, 2] * bodies[body].net[TOTAL, 2]


@inlined
def respond_tangent(bodies, net_tangent, state, tangent, row):
    """The derivatives of `respond` to the columns."""
    first = state.shape[1] // 2 + 3 * bodies.size
    for body in range(bodies.size):
        for k in range(3):
            i = 3 * body + k
            inverse = bodies[body].inertia[1, 2, 2] if k == 2 else bodies[body].inverse_mass
            column = bodies[body].inertia_columns[2] if k == 2 else bodies[body].mass_column
            for c in range(tangent.shape[2]):
                tangent[row, first + i, c] = inverse * net_tangent[i, c]
            if column >= 0:
                tangent[row, first + i, column] -= inverse * inverse * bodies[body].net[TOTAL, k]


@compiled
def respond_adjoint(bodies, state, row, response, load, backward, body_gradient):
    """Carry the adjoint of the accelerations back to forces (`load`), rotations and rates (`backward`) and inertia."""
    for body in range(bodies.size):
        for k in range(3):
            i = 3 * body + k
            inverse = bodies[body].inertia[1, 2, 2] if k == 2 else bodies[body].inverse_mass
            load[i] = inverse * response[i]
            body_gradient[body, 2 if k == 2 else 6] -= inverse * inverse * bodies[body].net[TOTAL, k] * response[i]


@compiled
def rates_adjoint(bodies, state, row, response, backward):
    """Carry the adjoint of the derivatives of the positions back."""
    n = 3 * bodies.size
    for i in range(n):
        backward[n + i] += response[i]
