# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""The geometry of one axis: a joint keeps the direction that it has at t = 0."""

from crashkit.mechanics.kernel.arrays import TOTAL
from crashkit.mechanics.kernel.stand_ins import compiled, inlined, unaliased

# ---- compiled from here ----

DOF, AXES = 1, 1
CURVED = False
"""Whether the direction of a joint changes with the positions."""


@inlined
def locate(bodies, state, row):
    """Turn the bodies' frames to a stage: none turns."""


@compiled
def settle(bodies, state):
    """Make the end of a step the origin of rotations."""


@inlined
def measure(bodies, joint, state, row):
    """The distance of a joint's ends, and the gradient of its deformation."""
    side = joint.places[6]
    joint.gradient[0] = side
    joint.gradient[1] = -side
    return side * (state[row, joint.second] + joint.places[3] - state[row, joint.first] - joint.places[0])


@compiled
def measure_points(bodies, joint):
    """The gradient of the deformation to the attachments."""
    joint.gradient[2] = joint.gradient[0]
    joint.gradient[3] = joint.gradient[1]


@compiled
def bend(bodies, joint):
    """How the gradient changes along a motion of the two bodies: not at all."""


@compiled
def bend_adjoint(bodies, joint):
    """The transpose of `bend`."""


@compiled
def bend_to_point(bodies, joint, m):
    """How the gradient changes with a coordinate of an attachment: not at all."""


@unaliased
def push_columns(
    joint, v_a, v_b, q_a_c, q_b_c, v_a_c, v_b_c, rest_c, d_max_c, d_c, rate_c, force_c, net_a_c, net_b_c, force, to_d, to_rate,
    to_d_max,
):  # fmt: skip
    """Derivatives of a joint's deformation, rate, force and part of the net forces through the motion of its bodies.

    Arguments:
        v_a, v_b: velocities of its bodies.
        q_a_c, q_b_c, v_a_c, v_b_c: (coordinate, column) derivatives of their positions and velocities.
        rest_c, d_max_c: (column) of its rest and largest deformation; d_c, rate_c, force_c: become the joint's.
        net_a_c, net_b_c: (coordinate, column) of the forces on its bodies, to which it adds.
        force, to_d, to_rate, to_d_max: the joint's, and its derivatives.
    """
    side = joint.gradient[0]
    for c in range(d_c.size):
        d = rest_c[c] + side * (q_a_c[0, c] - q_b_c[0, c])
        rate = side * (v_a_c[0, c] - v_b_c[0, c])
        pushed = to_d * d + to_rate * rate + to_d_max * d_max_c[c]
        d_c[c] = d
        rate_c[c] = rate
        force_c[c] = pushed
        net_a_c[0, c] -= side * pushed
        net_b_c[0, c] += side * pushed


@compiled
def to_rotations(bodies, state, tangent, row, chart):
    """Derivatives of the positions become those of the rotations: they are."""


@compiled
def to_rotations_adjoint(bodies, state, backward, chart):
    """The adjoint of `to_rotations`."""


@inlined
def rates(bodies, state, row):
    """The derivatives of the positions."""
    size = state.shape[1] // 2
    for i in range(bodies.size):
        state[row, size + i] = state[row, bodies.size + i]


@inlined
def rates_tangent(bodies, state, tangent, row):
    """The derivatives of `rates` to the columns."""
    size = state.shape[1] // 2
    for i in range(bodies.size):
        for c in range(tangent.shape[2]):
            tangent[row, size + i, c] = tangent[row, bodies.size + i, c]


@inlined
def respond(bodies, state, row):
    """The accelerations under their forces."""
    first = state.shape[1] // 2 + bodies.size
    for i in range(bodies.size):
        state[row, first + i] = bodies[i].inverse_mass * bodies[i].net[TOTAL, 0]


@inlined
def respond_tangent(bodies, net_tangent, state, tangent, row):
    """The derivatives of `respond` to the columns."""
    first = state.shape[1] // 2 + bodies.size
    for i in range(bodies.size):
        inverse_mass, column = bodies[i].inverse_mass, bodies[i].mass_column
        for c in range(tangent.shape[2]):
            tangent[row, first + i, c] = inverse_mass * net_tangent[i, c]
        if column >= 0:
            tangent[row, first + i, column] -= inverse_mass * inverse_mass * bodies[i].net[TOTAL, 0]


@compiled
def respond_adjoint(bodies, state, row, response, load, backward, body_gradient):
    """Carry the adjoint of the accelerations back to forces (`load`), rotations and rates (`backward`) and inertia."""
    for i in range(bodies.size):
        inverse_mass = bodies[i].inverse_mass
        load[i] = inverse_mass * response[i]
        body_gradient[i, 6] -= inverse_mass * inverse_mass * bodies[i].net[TOTAL, 0] * response[i]


@compiled
def rates_adjoint(bodies, state, row, response, backward):
    """Carry the adjoint of the derivatives of the positions back."""
    for i in range(bodies.size):
        backward[bodies.size + i] += response[i]
