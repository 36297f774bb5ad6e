# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""Vectors of three numbers, as tuples."""

from crashkit.mechanics.kernel.stand_ins import compiled

# ---- compiled from here ----


@compiled
def cross(a, b):
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled
def dot(a, b):
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def scaled(factor, a):
    """factor a."""
    return factor * a[0], factor * a[1], factor * a[2]


@compiled
def plus(a, b):
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@compiled
def unit(k):
    """A unit vector."""
    return 1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0


@compiled
def turned(body, a):
    """A vector of a body's frame in the laboratory's."""
    return (
        body.frame[0] * a[0] + body.frame[1] * a[1] + body.frame[2] * a[2],
        body.frame[3] * a[0] + body.frame[4] * a[1] + body.frame[5] * a[2],
        body.frame[6] * a[0] + body.frame[7] * a[1] + body.frame[8] * a[2],
    )


@compiled
def turned_back(body, a):
    """A vector of the laboratory's frame in a body's."""
    return (
        body.frame[0] * a[0] + body.frame[3] * a[1] + body.frame[6] * a[2],
        body.frame[1] * a[0] + body.frame[4] * a[1] + body.frame[7] * a[2],
        body.frame[2] * a[0] + body.frame[5] * a[1] + body.frame[8] * a[2],
    )


@compiled
def times(body, which, a):
    """The inertia of a body (0) or its inverse (1) times a vector of the body's frame."""
    m = body.inertia[which]
    return (
        m[0, 0] * a[0] + m[0, 1] * a[1] + m[0, 2] * a[2],
        m[1, 0] * a[0] + m[1, 1] * a[1] + m[1, 2] * a[2],
        m[2, 0] * a[0] + m[2, 1] * a[1] + m[2, 2] * a[2],
    )


@compiled
def three(values, row, i):
    """Three entries of a row."""
    return values[row, i], values[row, i + 1], values[row, i + 2]


@compiled
def entries(values, i):
    """Three entries."""
    return values[i], values[i + 1], values[i + 2]


@compiled
def three_of(values, row, i, c):
    """Three entries of a row and a column."""
    return values[row, i, c], values[row, i + 1, c], values[row, i + 2, c]


@compiled
def column_of(values, i, c):
    """Three entries of a column."""
    return values[i, c], values[i + 1, c], values[i + 2, c]


@compiled
def put(values, j, i, a):
    """Set three entries of a row."""
    values[j, i] = a[0]
    values[j, i + 1] = a[1]
    values[j, i + 2] = a[2]


@compiled
def set_entries(values, i, a):
    """Set three entries."""
    values[i] = a[0]
    values[i + 1] = a[1]
    values[i + 2] = a[2]
