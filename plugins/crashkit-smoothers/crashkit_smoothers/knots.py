"""Where the knots of a smoothing spline are."""

import numpy as np

CLOSEST = 0.2
"""Distance of two knots, of the mean distance if there are as many as allowed."""


def knot_vector(x: np.ndarray, interior: int, degree: int, contacts: tuple[float, ...] = ()) -> np.ndarray:
    """Knots at no more than `interior` of the samples, as dense as these are, over all of [0, 1].

    A sample too close after a knot gets none: second differences over the gap would lose the digits of a derivative. A knot at
    a contact is as multiple as leaves the spline a continuous slope only.

    Arguments:
        x: (sample,), strictly increasing, in [0, 1].
        interior: the largest number of knots within ]0, 1[, contacts apart.
        degree: of the spline.
        contacts: in ]0, 1[, where the second derivative may jump.
    """
    chosen = np.unique(np.linspace(0, len(x) - 1, interior + 2).round().astype(int))
    closest = CLOSEST / interior
    inner = [0.0]
    for place in x[chosen].tolist():
        if inner[-1] + closest <= place <= 1.0 - closest and all(abs(place - contact) >= closest for contact in contacts):
            inner.append(place)
    inside = np.sort([*inner[1:], *np.repeat(contacts, degree - 1)])
    return np.concatenate([np.zeros(degree + 1), inside, np.ones(degree + 1)])
