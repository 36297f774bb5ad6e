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
def nudge(bodies, joint, end, m):
    """How the attachment of an end moves: by its body's two coordinates and angle, then by its own two."""
    if m == 0:
        return 1.0, 0.0
    if m == 1:
        return 0.0, 1.0
    body = joint.second if end else joint.first
    if m == 2:
        x, y = arm(bodies[body], joint.places[3 * end], joint.places[3 * end + 1])
        return -y, x
    return arm(bodies[body], 1.0 if m == 3 else 0.0, 1.0 if m == 4 else 0.0)


@compiled
def curve(bodies, joint, state, row):
    """The derivatives of the gradient to the displacements of the two bodies and to the two attachments."""
    nx, ny, length, ax, ay, bx, by = direction(bodies, joint, state, row)
    for end in range(2):
        side = 2.0 * end - 1.0
        for m in range(5):
            k = 3 * end + m if m < 3 else 6 + 2 * end + m - 3
            px, py = nudge(bodies, joint, end, m)
            dx, dy = side * px, side * py
            dax, day, dbx, dby = 0.0, 0.0, 0.0, 0.0
            if m >= 2 and end == 0:
                dax, day = px, py
            if m >= 2 and end == 1:
                dbx, dby = px, py
            if joint.face:
                turn = 1.0 if end == 0 and m == 2 else 0.0
                dnx, dny = -turn * ny, turn * nx
                dax, day = dax + dx, day + dy
            else:
                along = nx * dx + ny * dy
                dnx, dny = (dx - nx * along) / length, (dy - ny * along) / length
            joint.hessian[0, k] = dnx
            joint.hessian[1, k] = dny
            joint.hessian[2, k] = dax * ny - day * nx + ax * dny - ay * dnx
            joint.hessian[3, k] = -dnx
            joint.hessian[4, k] = -dny
            joint.hessian[5, k] = dby * nx - dbx * ny + by * dnx - bx * dny


@compiled
def to_rotations(bodies, state, tangent, row, chart):
    """Derivatives of the positions become those of the rotations: they are."""


@compiled
def to_rotations_adjoint(bodies, state, backward, chart):
    """The adjoint of `to_rotations`."""


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
