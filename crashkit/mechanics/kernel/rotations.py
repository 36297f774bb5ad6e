# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""Rotations in space are integrated on the group.

Within a step a body has turned by the rotation vector phi from its orientation at the
step's start, R = exp(phi) R_0, with phi' = omega - phi x omega / 2 + phi x (phi x omega) / 12 (the next term is of fourth
order in phi and vanishes; Bortz's equation, Mizzi & Jezequel 1992, eq 21-28, for angular velocities in the laboratory
frame). At its end R_0 is replaced. A column's derivative of a rotation is the small rotation vector in the laboratory frame,
dR = dtheta x R; the Runge-Kutta rule itself is differentiated in phi, because a mixture of the two would lose its order.
"""

import math

from crashkit.mechanics.kernel.arrays import START
from crashkit.mechanics.kernel.stand_ins import compiled
from crashkit.mechanics.kernel.vectors import cross, dot, entries, plus, put, scaled, set_entries, three, three_of

# ---- compiled from here ----


@compiled
def orientation(bodies, state, row, body):
    """The quaternion exp(phi) q_0 of a stage."""
    x, y, z = three(state, row, 6 * body + 3)
    square = x * x + y * y + z * z
    w, part = 1.0 - square / 8.0, 0.5 - square / 48.0
    if square > 1e-8:
        angle = math.sqrt(square)
        w, part = math.cos(0.5 * angle), math.sin(0.5 * angle) / angle
    v = (part * x, part * y, part * z)
    w0, v0 = bodies[body].frame[9], entries(bodies[body].frame, 10)
    x, y, z = plus(plus(scaled(w, v0), scaled(w0, v)), cross(v, v0))
    return w * w0 - dot(v, v0), x, y, z


@compiled
def locate(bodies, state, row):
    """Turn the bodies' frames to a stage."""
    for body in range(bodies.size):
        w, x, y, z = orientation(bodies, state, row, body)
        bodies[body].frame[0] = 1.0 - 2.0 * (y * y + z * z)
        bodies[body].frame[1] = 2.0 * (x * y - w * z)
        bodies[body].frame[2] = 2.0 * (x * z + w * y)
        bodies[body].frame[3] = 2.0 * (x * y + w * z)
        bodies[body].frame[4] = 1.0 - 2.0 * (x * x + z * z)
        bodies[body].frame[5] = 2.0 * (y * z - w * x)
        bodies[body].frame[6] = 2.0 * (x * z - w * y)
        bodies[body].frame[7] = 2.0 * (y * z + w * x)
        bodies[body].frame[8] = 1.0 - 2.0 * (x * x + y * y)


@compiled
def settle(bodies, state):
    """Make the end of a step the origin of rotations."""
    for body in range(bodies.size):
        w, x, y, z = orientation(bodies, state, START, body)
        length = math.sqrt(w * w + x * x + y * y + z * z)
        bodies[body].frame[9] = w / length
        bodies[body].frame[10] = x / length
        bodies[body].frame[11] = y / length
        bodies[body].frame[12] = z / length
        for i in range(6 * body + 3, 6 * body + 6):
            state[START, i] = 0.0
    rates(bodies, state, START)


@compiled
def series(phi, a, first, second, third):
    """a + first phi x a + second phi x (phi x a) + third phi x (phi x (phi x a))."""
    once = cross(phi, a)
    twice = cross(phi, once)
    return plus(plus(a, scaled(first, once)), plus(scaled(second, twice), scaled(third, cross(phi, twice))))


@compiled
def to_chart(phi, a):
    """The change of phi that a small rotation a makes: dexp^-1."""
    return series(phi, a, -0.5, 1.0 / 12.0, 0.0)


@compiled
def from_chart(phi, a):
    """The small rotation that a change a of phi makes: dexp."""
    return series(phi, a, 0.5, 1.0 / 6.0, 1.0 / 24.0)


@compiled
def rates(bodies, state, row):
    """The derivatives of the positions."""
    size, n = state.shape[1] // 2, 6 * bodies.size
    for i in range(0, n, 6):
        put(state, row, size + i, three(state, row, n + i))
        put(state, row, size + i + 3, to_chart(three(state, row, i + 3), three(state, row, n + i + 3)))


@compiled
def rates_tangent(bodies, state, tangent, row):
    """The derivatives of `rates` to the columns."""
    size, n = state.shape[1] // 2, 6 * bodies.size
    for i in range(0, n, 6):
        phi, omega = three(state, row, i + 3), three(state, row, n + i + 3)
        swept = cross(phi, omega)
        for c in range(tangent.shape[2]):
            phi_c = to_chart(phi, three_of(tangent, row, i + 3, c))
            across = cross(omega, phi_c)
            bent = plus(cross(swept, phi_c), cross(phi, across))
            turning = plus(to_chart(phi, three_of(tangent, row, n + i + 3, c)), scaled(0.5, across))
            turning = plus(turning, scaled(-1.0 / 12.0, bent))
            for k in range(3):
                tangent[row, size + i + k, c] = tangent[row, n + i + k, c]
                tangent[row, size + i + 3 + k, c] = turning[k]


@compiled
def rates_adjoint(bodies, state, row, response, backward):
    """Carry the adjoint of the derivatives of the positions back."""
    n = 6 * bodies.size
    for i in range(0, n, 6):
        phi, omega = three(state, row, i + 3), three(state, row, n + i + 3)
        turning, reverse = entries(response, i + 3), scaled(-1.0, phi)
        bent = plus(cross(cross(phi, omega), turning), scaled(-1.0, cross(omega, cross(phi, turning))))
        phi_c = plus(scaled(-0.5, cross(omega, turning)), scaled(1.0 / 12.0, bent))
        for k in range(3):
            backward[n + i + k] += response[i + k]
            backward[n + i + 3 + k] += to_chart(reverse, turning)[k]
            backward[i + 3 + k] += to_chart(reverse, phi_c)[k]


@compiled
def to_rotations(bodies, state, tangent, row, chart):
    """Derivatives of phi become those of the rotations, with phi of the row `chart` of the state."""
    for i in range(3, 6 * bodies.size, 6):
        phi = three(state, chart, i)
        for c in range(tangent.shape[2]):
            turning = from_chart(phi, three_of(tangent, row, i, c))
            for k in range(3):
                tangent[row, i + k, c] = turning[k]


@compiled
def to_rotations_adjoint(bodies, state, backward, chart):
    """Carry the adjoint of the rotations back to phi of the row `chart` of the state."""
    for i in range(3, 6 * bodies.size, 6):
        set_entries(backward, i, from_chart(scaled(-1.0, three(state, chart, i)), entries(backward, i)))
