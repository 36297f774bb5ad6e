"""The force of each joint as a surface over deformation and rate: a double Chebyshev series, no law supposed."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import frozen
from numpy.polynomial.chebyshev import chebvander2d
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator
from scipy.spatial import Delaunay, QhullError, cKDTree

from crashkit.errors import CrashkitError
from crashkit.mechanics.state_form import StateForm
from crashkit.misfit import Misfit
from crashkit_identifiers.recorded import engine_of, laws_of

RIDGES = np.logspace(-11.0, 1.0, 49)
"""Of the squared coefficients against the misfit, as shares of the largest curvature."""
NEAR = 0.25
"""Of a half width of the surface: a place without a reading that near is extrapolated."""
FLAT = 0.02
"""Smallest height of a triangle of readings, of a half width, that is interpolated in; a flatter one says nothing across."""
GRID = 41
MOST_READINGS = 400
"""Of a run, for least squares."""
SMOOTH = 0.1
"""What the ridge costs the constant term, where a term of degree k costs k."""
PUSHED = 5.0
"""Standard deviations of an acceleration that no freely moving body has."""


@frozen(eq=False)
class Surface:
    """h(d, rate) = sum over k, l of c_kl T_k(d') T_l(rate'), d' and rate' in [-1, 1] (Mizzi & Jezequel 1992, eq 35).

    Arguments:
        joint: its name.
        low, high: the corners of the surface, (deformation, rate), m and m s-1.
        coefficients: (k, l), N.
        readings: (reading, 2) where it was measured, in [-1, 1].
        choice: how the coefficients were found, a sentence.
    """

    joint: str
    low: np.ndarray
    high: np.ndarray
    coefficients: np.ndarray
    readings: np.ndarray
    choice: str

    @property
    def size(self) -> float:
        """N, of its largest term."""
        return max(float(np.abs(self.coefficients).max()), 1e-300)

    def force(self, deformation: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """N, by states; beyond the corners it is held at its edge."""
        shares = np.clip(_shares(np.column_stack([deformation, rate]), self.low, self.high), -1.0, 1.0)
        return _series(shares, self.coefficients.shape) @ self.coefficients.ravel()

    def is_inside(self, deformation: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Whether a state lies between the corners."""
        states = np.column_stack([deformation, rate])
        return np.asarray(((states >= self.low) & (states <= self.high)).all(axis=1))

    def is_extrapolated(self, deformation: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Whether a state lies outside the readings, or in a gap between them."""
        shares = _shares(np.column_stack([deformation, rate]), self.low, self.high)
        far = cKDTree(self.readings).query(shares)[0] > NEAR
        try:
            outside = Delaunay(self.readings).find_simplex(shares) < 0
        except QhullError:  # readings on one line surround nothing
            outside = np.ones(len(shares), dtype=bool)
        return np.asarray(far | outside)

    def table(self) -> xr.Dataset:
        """The surface on a grid: `force` (deformation, deformation_rate), N, and whether it is `extrapolated` there."""
        axes = [np.linspace(low, high, GRID) for low, high in zip(self.low, self.high, strict=True)]
        d, rate = (grid.ravel() for grid in np.meshgrid(*axes, indexing="ij"))
        dims = ("deformation", "deformation_rate")
        return xr.Dataset(
            {
                "force": (dims, self.force(d, rate).reshape(GRID, GRID), {"units": "N"}),
                "extrapolated": (dims, self.is_extrapolated(d, rate).reshape(GRID, GRID)),
            },
            {"deformation": (dims[0], axes[0], {"units": "m"}), "deformation_rate": (dims[1], axes[1], {"units": "m s-1"})},
            {"joint": self.joint, "choice": self.choice},
        )


@frozen(eq=False)
class Readings:
    """What the measured motion of all runs says of the forces: sum of the joints' forces on a body = m a.

    Arguments:
        states: by joint, (reading, 2), deformation and rate.
        along: by joint, (reading, row), what a force of 1 N adds to each equation, one row for each body that moves.
        load: (reading, row), m a, N, at the masses of the model.
        weight: (row,) one over its standard deviation.
        runs: (reading,) the number of its run.
    """

    states: Mapping[str, np.ndarray]
    along: Mapping[str, np.ndarray]
    load: np.ndarray
    weight: np.ndarray
    runs: np.ndarray


def readings_of(misfit: Misfit, measured: Mapping[str, xr.Dataset], per_run: int = MOST_READINGS) -> Readings:
    """Readings of a model in one axis, evenly spread over each run until its bodies move freely."""
    model = misfit.model
    moving = [body for body in model.bodies if not body.fixed]
    rows = [model.bodies.index(body) for body in moving]
    masses = np.array([body.mass.value for body in moving if body.mass is not None])
    states: dict[str, list[np.ndarray]] = {joint.name: [] for joint in model.joints}
    along: dict[str, list[np.ndarray]] = {joint.name: [] for joint in model.joints}
    loads, stds, runs = [], [], []
    values = model.values()
    for number, motion in enumerate(measured.values()):
        acceleration, std = (motion[name].values[:, rows, 0] for name in ("acceleration", "acceleration_std"))
        keep = _spread(acceleration, std, per_run)
        for track in StateForm(model, laws_of(misfit), motion, engine_of(misfit)).tracks:
            push = np.zeros((len(keep), len(model.bodies)))
            for row, unit in track.ends:
                push[:, row] = unit[keep, 0]
            states[track.law.without_memory().joint.name].append(track.states(values)[keep, :2])
            along[track.law.joint.name].append(push[:, rows])
        loads.append(masses * acceleration[keep])
        stds.append(masses * np.sqrt(np.mean(std[keep] ** 2, axis=0)))
        runs.append(np.full(len(keep), number))
    joined = [{name: np.concatenate(parts) for name, parts in table.items()} for table in (states, along)]
    return Readings(joined[0], joined[1], np.concatenate(loads), 1.0 / np.mean(stds, axis=0), np.concatenate(runs))


def fitted(readings: Readings, degree: int) -> dict[str, Surface]:
    """Surfaces by least squares of all equations at once, with a ridge on rough terms that the runs choose together."""
    shape = (degree + 1, degree + 1)
    corners = {name: (states.min(axis=0), states.max(axis=0)) for name, states in readings.states.items()}
    shares = {name: _shares(states, *corners[name]) for name, states in readings.states.items()}
    rough = np.hypot(*np.meshgrid(np.arange(shape[0]), np.arange(shape[1]), indexing="ij")).ravel() + SMOOTH
    blocks = [readings.along[name][:, :, None] * (_series(share, shape) / rough)[:, None, :] for name, share in shares.items()]
    rows = np.concatenate(blocks, axis=2) * readings.weight[:, None]
    runs = np.repeat(readings.runs, rows.shape[1])
    coefficients, ridge = _ridge(rows.reshape(-1, rows.shape[2]), (readings.load * readings.weight).ravel(), runs)
    chosen = "chosen by leaving out one run after the other" if np.ptp(runs) else "not chosen: there is one run only"
    choice = f"least squares with a ridge of {ridge:.1e}, {chosen}"
    tables = coefficients.reshape(len(shares), *shape) / rough.reshape(shape)
    return {n: Surface(n, *corners[n], table, shares[n], choice) for n, table in zip(shares, tables, strict=True)}


def interpolated(readings: Readings, degree: int, points: int) -> dict[str, Surface]:
    """Surfaces from forces interpolated at the points where the Chebyshev polynomials are orthogonal (eq 36-37).

    Inside triangles of readings that are not too flat linearly, elsewhere the nearest reading.

    Raises:
        CrashkitError: the forces of joints cannot be told apart at an instant, for example of two between the same bodies.
    """
    forces = _forces(readings)
    nodes = np.cos(np.pi * (np.arange(points) + 0.5) / points)
    grid = np.column_stack([part.ravel() for part in np.meshgrid(nodes, nodes, indexing="ij")])
    count = degree + 1
    double = np.where(np.arange(count) == 0, 1.0, 2.0) / points
    surfaces = {}
    for name, states in readings.states.items():
        low, high = states.min(axis=0), states.max(axis=0)
        shares = _shares(states, low, high)
        values, share = _scattered(shares, forces[name], grid)
        coefficients = (_series(grid, (count, count)).T @ values).reshape(count, count) * np.outer(double, double)
        choice = f"{len(states)} readings interpolated at {points} by {points} points, {share:.0%} of them inside triangles"
        surfaces[name] = Surface(name, low, high, coefficients, shares, choice)
    return surfaces


def _spread(acceleration: np.ndarray, std: np.ndarray, count: int) -> np.ndarray:
    """Instants (reading,) spread evenly over a run until all bodies move freely."""
    pushed = np.flatnonzero((np.abs(acceleration) > PUSHED * std).any(axis=1))
    end = pushed[-1] + 2 if len(pushed) else len(acceleration)
    present = np.flatnonzero(np.isfinite(acceleration[:end]).all(axis=1))
    return present[np.unique(np.linspace(0, len(present) - 1, min(count, len(present))).round().astype(int))]


def _forces(readings: Readings) -> dict[str, np.ndarray]:
    """The force of each joint at each reading."""
    matrix = np.stack(list(readings.along.values()), axis=2)
    if np.linalg.matrix_rank(matrix[0]) < matrix.shape[2]:
        found = ", ".join(readings.along)
        raise CrashkitError(f"expected joints whose forces the motion tells apart, found {found}; the direct form shares them")
    forces = np.stack([np.linalg.lstsq(m, load, rcond=None)[0] for m, load in zip(matrix, readings.load, strict=True)])
    return dict(zip(readings.along, forces.T, strict=True))


def _scattered(places: np.ndarray, values: np.ndarray, wanted: np.ndarray) -> tuple[np.ndarray, float]:
    """Values at the wanted places, and the share of those that lie in triangles."""
    result = NearestNDInterpolator(places, values)(wanted)
    try:
        triangles = Delaunay(places)
    except QhullError:
        return result, 0.0
    inside = triangles.find_simplex(wanted)
    use = (inside >= 0) & (_heights(places[triangles.simplices])[inside] > FLAT)
    result[use] = LinearNDInterpolator(triangles, values)(wanted[use])
    return result, float(use.mean())


def _heights(corners: np.ndarray) -> np.ndarray:
    """The smallest height of each triangle (triangle, 3, 2)."""
    sides = corners - np.roll(corners, 1, axis=1)
    double_area = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
    return double_area / np.linalg.norm(sides, axis=2).max(axis=1)


def _ridge(rows: np.ndarray, target: np.ndarray, runs: np.ndarray) -> tuple[np.ndarray, float]:
    """Coefficients, and the ridge with which each run is best predicted from all others.

    Samples of one run lie on one curve across the surface: only another run shows what happens between.

    Arguments:
        rows: (row, coefficient).
        target: (row,).
        runs: (row,) the number of its run.
    """
    known = np.unique(runs)
    errors = np.zeros(len(RIDGES))
    for left_out in known:
        other, own = (runs != left_out, runs == left_out) if len(known) > 1 else (runs >= 0, runs >= 0)
        solutions = _solutions(rows[other], target[other])
        errors += ((rows[own] @ solutions - target[own][:, None]) ** 2).sum(axis=0)
    best = int(np.argmin(errors)) if len(known) > 1 else len(RIDGES) // 2
    return _solutions(rows, target)[:, best], float(RIDGES[best])


def _solutions(rows: np.ndarray, target: np.ndarray) -> np.ndarray:
    """(coefficient, ridge)."""
    size, vectors = np.linalg.eigh(rows.T @ rows)
    pulled = vectors.T @ (rows.T @ target)
    return np.asarray(vectors @ (pulled[:, None] / (np.maximum(size, 0.0)[:, None] + RIDGES * size[-1])))


def _shares(states: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    return 2.0 * (states - low) / np.where(high > low, high - low, 1.0) - 1.0


def _series(shares: np.ndarray, shape: Sequence[int]) -> np.ndarray:
    """T_k(d') T_l(rate') of each state, (state, term)."""
    return np.asarray(chebvander2d(shares[:, 0], shares[:, 1], [shape[0] - 1, shape[1] - 1]))
