# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""The geometry of plane motion: SE(2), each body with two coordinates and an angle.

A joint pushes along n, from its first attachment to its second, or along the normal of a face of its first body. With r the
arms from the centres of mass to where the force acts, the gradient of the deformation to the displacements is
(n, r_a x n) of the first body and -(n, r_b x n) of the second (Mizzi & Jezequel 1992, eq 7-11).
"""

import math

from crashkit.mechanics.kernel.arrays import TOTAL
from crashkit.mechanics.kernel.stand_ins import compiled

# ---- compiled from here ----

DOF, AXES = 3, 2
CURVED = True
"""Whether the direction of a joint changes with the positions."""


@compiled
def locate(bodies, state, row):
    """Turn the bodies' frames to a stage."""
    for body in range(bodies.size):
        bodies[body].frame[0] = math.cos(state[row, 3 * body + 2])
        bodies[body].frame[1] = math.sin(state[row, 3 * body + 2])


@compiled
def settle(bodies, state):
    """Make the end of a step the origin of rotations: an angle needs none."""


@compiled
def arm(body, px, py):
    """A point of a body, from its centre of mass, in the laboratory frame."""
    c, s = body.frame[0], body.frame[1]
    return c * px - s * py, s * px + c * py


@compiled
def direction(bodies, joint, state, row):
    """The direction in which a joint pushes, the distance of its ends, and the arms to where it pushes."""
    a, b = joint.first, joint.second
    ax, ay = arm(bodies[a], joint.places[0], joint.places[1])
    bx, by = arm(bodies[b], joint.places[3], joint.places[4])
    dx = state[row, 3 * b] + bx - state[row, 3 * a] - ax
    dy = state[row, 3 * b + 1] + by - state[row, 3 * a + 1] - ay
    if joint.face:
        nx, ny = arm(bodies[a], joint.places[6], joint.places[7])
        return nx, ny, nx * dx + ny * dy, ax + dx, ay + dy, bx, by
    length = math.sqrt(dx * dx + dy * dy)
    return dx / length, dy / length, length, ax, ay, bx, by


@compiled
def measure(bodies, joint, state, row):
    """The distance of a joint's ends, and the gradient of its deformation."""
    nx, ny, length, ax, ay, bx, by = direction(bodies, joint, state, row)
    joint.gradient[0] = nx
    joint.gradient[1] = ny
    joint.gradient[2] = ax * ny - ay * nx
    joint.gradient[3] = -nx
    joint.gradient[4] = -ny
    joint.gradient[5] = by * nx - bx * ny
    ca, sa = bodies[joint.first].frame[0], bodies[joint.first].frame[1]
    cb, sb = bodies[joint.second].frame[0], bodies[joint.second].frame[1]
    joint.gradient[6] = ca * nx + sa * ny
    joint.gradient[7] = ca * ny - sa * nx
    joint.gradient[8] = -cb * nx - sb * ny
    joint.gradient[9] = sb * nx - cb * ny
    return length


@compiled
def curve(bodies, joint, state, row):
    """The derivatives of the gradient to the displacements of the two bodies and to the two attachments.

    With t across n, a line's are -T T' / length with T = (t, n r_a, -t, -n r_b), and what the arms add as they turn.
    """
    nx, ny, length, ax, ay, bx, by = direction(bodies, joint, state, row)
    along_a, along_b = nx * ax + ny * ay, nx * bx + ny * by
    hessian = joint.hessian
    for k in range(10):
        for i in range(6):
            hessian[i, k] = 0.0
    across = (-ny, nx, along_a, ny, -nx, -along_b)
    if joint.face:
        for i in range(6):
            hessian[i, 2] = across[i]
            hessian[2, i] = across[i]
    else:
        for i in range(6):
            for k in range(6):
                hessian[i, k] = -across[i] * across[k] / length
        hessian[2, 2] -= along_a
    hessian[5, 5] += along_b
    for m in range(4):
        curve_to_point(bodies, joint, m, nx, ny, length, across)


@compiled
def curve_to_point(bodies, joint, m, nx, ny, length, across):
    """The derivatives of the gradient to a coordinate of an attachment."""
    end, axis = m // 2, m % 2
    x, y = arm(bodies[joint.second if end else joint.first], 1.0 - axis, 1.0 * axis)
    turning = x * ny - y * nx
    if joint.face:
        joint.hessian[2, 6 + m] = turning * end
        joint.hessian[5, 6 + m] = -turning * end
        return
    moved = (2.0 * end - 1.0) * (nx * y - ny * x) / length
    for i in range(6):
        joint.hessian[i, 6 + m] = moved * across[i]
    joint.hessian[5 if end else 2, 6 + m] += -turning if end else turning


@compiled
def to_rotations(bodies, state, tangent, row, chart):
    """Derivatives of the positions become those of the rotations: they are."""


@compiled
def to_rotations_adjoint(bodies, state, backward, chart):
    """The adjoint of `to_rotations`."""


@compiled
def gradient_row(joint):
    """The gradient to the positions."""
    return (
        joint.gradient[0],
        joint.gradient[1],
        joint.gradient[2],
        joint.gradient[3],
        joint.gradient[4],
        joint.gradient[5],
    )


@compiled
def bend_row(joint):
    """The derivatives of the deformation rate to the positions."""
    return joint.bend[0], joint.bend[1], joint.bend[2], joint.bend[3], joint.bend[4], joint.bend[5]


@compiled
def hessian_row(joint, i, factor):
    """A row of the Hessian to the positions, times a factor."""
    return (
        factor * joint.hessian[i, 0],
        factor * joint.hessian[i, 1],
        factor * joint.hessian[i, 2],
        factor * joint.hessian[i, 3],
        factor * joint.hessian[i, 4],
        factor * joint.hessian[i, 5],
    )


@compiled
def add_columns(w, tangent, row, a, b, out, place):
    """Add the weighted derivatives of the coordinates from a and from b on to a row of `out`."""
    for c in range(out.shape[1]):
        first = w[0] * tangent[row, a, c] + w[1] * tangent[row, a + 1, c] + w[2] * tangent[row, a + 2, c]
        out[place, c] += first + w[3] * tangent[row, b, c] + w[4] * tangent[row, b + 1, c] + w[5] * tangent[row, b + 2, c]


@compiled
def rates(bodies, state, row):
    """The derivatives of the positions."""
    size, n = state.shape[1] // 2, 3 * bodies.size
    for i in range(n):
        state[row, size + i] = state[row, n + i]


@compiled
def rates_tangent(bodies, state, tangent, row):
    """The derivatives of `rates` to the columns."""
    size, n = state.shape[1] // 2, 3 * bodies.size
    for i in range(n):
        for c in range(tangent.shape[2]):
            tangent[row, size + i, c] = tangent[row, n + i, c]


@compiled
def respond(bodies, state, row):
    """The accelerations under their forces and moments."""
    first = state.shape[1] // 2 + 3 * bodies.size
    for body in range(bodies.size):
        i = 3 * body
        state[row, first + i] = bodies[body].inverse_mass * bodies[body].net[TOTAL, 0]
        state[row, first + i + 1] = bodies[body].inverse_mass * bodies[body].net[TOTAL, 1]
        state[row, first + i + 2] = bodies[body].inertia[1, 2, 2] * bodies[body].net[TOTAL, 2]


@compiled
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
