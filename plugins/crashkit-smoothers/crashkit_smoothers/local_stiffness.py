"""A stiffness that follows the motion: less where it is rough, as in a contact, more where it is quiet."""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from crashkit_smoothers.penalised_spline import Fit, PenalisedSpline

WIDTH = 1.2
"""Standard deviation of the window in which roughness is averaged, in lengths of a degree of freedom."""
END = 1.0
"""So near to an end, in the same length, a smoothing spline shows no roughness, and it is taken from further inside."""
LEAST = 0.1
"""Of the mean roughness, what the quietest part is taken to have."""
FEWEST_CELLS = 1000


def local_stiffness(spline: PenalisedSpline, fit: Fit) -> np.ndarray:
    """One over the local mean square of the fit's own penalised derivative, on each interval of the knots.

    As the prior of a smoothing spline that derivative is white noise of one level; with this stiffness it has the level that
    the motion shows. The geometric mean is 1.

    Pintore, Speckman & Holmes 2006, doi:10.1093/biomet/93.1.113, on smoothing splines whose stiffness varies.
    """
    edges = spline.knots[2 * spline.order - 1 : len(spline.knots) - 2 * spline.order + 1]
    middle = 0.5 * (edges[1:] + edges[:-1])
    cells = max(FEWEST_CELLS, len(middle))
    grid = np.linspace(0.0, 1.0, cells + 1)
    filled = np.diff(edges) > 0.0
    squares = np.interp(grid, middle[filled], spline.roughness_of(fit)[filled])
    end = int(cells * min(END / fit.freedom, 0.3))
    inside = gaussian_filter1d(squares[end : cells + 1 - end], cells * WIDTH / fit.freedom, mode="nearest")
    level = np.pad(inside, end, mode="edge")
    level += LEAST * level.mean()
    if not level.all():
        return np.ones(len(middle))
    stiffness = 1.0 / np.interp(middle, grid, level)
    return stiffness / np.exp(np.mean(np.log(stiffness)))
