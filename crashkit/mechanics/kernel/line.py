# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""The geometry of one axis: a joint keeps the direction that it has at t = 0."""

from crashkit.mechanics.kernel.arrays import TOTAL
from crashkit.mechanics.kernel.stand_ins import compiled

# ---- compiled from here ----

DOF, AXES = 1, 1
CURVED = False
"""Whether the direction of a joint changes with the positions."""


@compiled
def locate(bodies, state, row):
    """Turn the bodies' frames to a stage: none turns."""


@compiled
def settle(bodies, state):
    """Make the end of a step the origin of rotations."""


@compiled
def measure(bodies, joint, state, row):
    """The distance of a joint's ends, and the gradient of its deformation."""
    side = joint.places[6]
    joint.gradient[0] = side
    joint.gradient[1] = -side
    joint.gradient[2] = side
    joint.gradient[3] = -side
    return side * (state[row, joint.second] + joint.places[3] - state[row, joint.first] - joint.places[0])


@compiled
def curve(bodies, joint, state, row):
    """The derivatives of the gradient: none."""


@compiled
def to_rotations(bodies, state, tangent, row, chart):
    """Derivatives of the positions become those of the rotations: they are."""


@compiled
def to_rotations_adjoint(bodies, state, backward, chart):
    """The adjoint of `to_rotations`."""


@compiled
def gradient_row(joint):
    """The gradient to the positions."""
    return joint.gradient[0], joint.gradient[1]


@compiled
def bend_row(joint):
    """The derivatives of the deformation rate to the positions."""
    return joint.bend[0], joint.bend[1]


@compiled
def hessian_row(joint, i, factor):
    """A row of the Hessian to the positions, times a factor."""
    return factor * joint.hessian[i, 0], factor * joint.hessian[i, 1]


@compiled
def add_columns(w, tangent, row, a, b, out, place):
    """Add the weighted derivatives of the coordinates from a and from b on to a row of `out`."""
    for c in range(out.shape[1]):
        out[place, c] += w[0] * tangent[row, a, c] + w[1] * tangent[row, b, c]


@compiled
def rates(bodies, state, row):
    """The derivatives of the positions."""
    size = state.shape[1] // 2
    for i in range(bodies.size):
        state[row, size + i] = state[row, bodies.size + i]


@compiled
def rates_tangent(bodies, state, tangent, row):
    """The derivatives of `rates` to the columns."""
    size = state.shape[1] // 2
    for i in range(bodies.size):
        for c in range(tangent.shape[2]):
            tangent[row, size + i, c] = tangent[row, bodies.size + i, c]


@compiled
def respond(bodies, state, row):
    """The accelerations under their forces."""
    first = state.shape[1] // 2 + bodies.size
    for i in range(bodies.size):
        state[row, first + i] = bodies[i].inverse_mass * bodies[i].net[TOTAL, 0]


@compiled
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
