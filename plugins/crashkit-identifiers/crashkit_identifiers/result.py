"""From a point to an Identification: covariance, intervals, and what the data do not see."""

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.protocols import Identification, Problem, Status
from crashkit_identifiers.profile import CONFIDENCE, Found, intervals
from crashkit_identifiers.units import units_of

UNSEEN_STD = 1.0
"""A parameter, or a combination, that the data leave this uncertain relative to its value is not identifiable."""
MAIN_SHARE = 0.3
UNDETERMINED = 1e-10
"""Share of the largest curvature below which the misfit does not say where to go."""
NO_INFORMATION = 1e-14
"""Curvature, of parameters scaled to 1, that counts as none."""

Path = tuple[tuple[float, np.ndarray], ...]


def conclude(
    problem: Problem, point: np.ndarray, status: Status, path: Path, objective: Problem | None = None
) -> Identification:
    """The result of any method that ended at `point`.

    With r the weighted residuals there and J their derivatives, H = JᵀJ:

    cov(u) = max(1, rᵀr / ν) H⁻¹ + Δ Δᵀ, where Δ = -H⁻¹ Jᵀ r is the way that is left to the least misfit: nothing where a
    method ends there, and honest where it ends elsewhere. The first factor counts only where the residuals are larger than
    chance allows. `std` is widened where the interval is wider than 1.96 of it to either side. Where the point is too far from
    the least misfit to tell, it is NaN, and the interval all that the bounds allow; it is NaN too for a parameter at a bound.

    Arguments:
        problem: that was to be solved.
        point: in search variables.
        status, path: as the method leaves them.
        objective: whose residuals are meant, if these are not the problem's own: those of a prior may have joined them.
    """
    objective = objective or problem
    fit = _fit(problem, objective, point)
    if fit is None:
        return _without_simulation(problem, point, status, path)
    names, (lower, upper) = list(problem.names), problem.bounds()
    scaling, values = problem.scaling(point), problem.parameters(point)
    held = (point <= lower) | (point >= upper)
    left = _way_left(fit, held)
    drop = 0.5 * float(left @ fit.curvature @ left)
    found = Found(point, fit.cost, left, fit.excess * _inverse(fit.curvature, held), fit.excess, drop)
    low, high = intervals(objective, found)
    half = 0.5 * (high - low)
    with np.errstate(over="ignore", invalid="ignore"):  # what is not seen at all has an infinite variance
        spread = found.spread + np.outer(left, left)
        std = np.where(held | found.is_far, np.nan, np.maximum(np.sqrt(np.diag(spread)), half / CONFIDENCE))
        seen = np.sqrt(np.diag(found.spread)) if found.is_far else half / CONFIDENCE
        covariance = spread * np.outer(scaling, scaling)
    size = np.maximum(np.abs(values), _spans(problem, lower, upper)) / scaling
    # An end that only a distant bound sets is none.
    is_open = ((low <= lower) & (point - lower > UNSEEN_STD * size)) | ((high >= upper) & (upper - point > UNSEEN_STD * size))
    columns = {
        "value": values,
        "std": std * scaling,
        "interval_lower": problem.parameters(low),
        "interval_upper": problem.parameters(high),
        "lower": problem.parameters(lower),
        "upper": problem.parameters(upper),
        "at_bound": held,
        "identifiable": ~held & (seen < UNSEEN_STD * size) & (~is_open | found.is_far),
    }
    table = _table(problem, columns).assign(covariance=(("parameter", "parameter_2"), covariance))
    table.attrs = {"normalised_residual": fit.normalised, "remarks": " ".join(_remarks(names, fit, found))}
    unseen = (*_unseen(names, fit.curvature, size, held), *_one_sided(table))
    return Identification(table, status, fit.cost, unseen, _path(names, path))


@frozen
class _Fit:
    """The misfit and its derivatives at a point; `count` residuals are as many as they amount to independently."""

    cost: float
    gradient: np.ndarray
    curvature: np.ndarray
    count: float

    @property
    def normalised(self) -> float:
        """Root mean square of the residuals over their noise."""
        return float(np.sqrt(2.0 * self.cost / max(self.count, 1.0)))

    @property
    def excess(self) -> float:
        """χ² over its expectation, where that is more than chance allows; else 1."""
        freedom = max(self.count - len(self.gradient), 1.0)
        ratio = 2.0 * self.cost / freedom
        return ratio if ratio > 1.0 + 3.0 * np.sqrt(2.0 / freedom) else 1.0


def _fit(problem: Problem, objective: Problem, point: np.ndarray) -> _Fit | None:
    """None where the model cannot be simulated."""
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            residual, jacobian = objective.residual_and_jacobian(point)
            cost = 0.5 * float(residual @ residual)
            gradient, curvature = jacobian.T @ residual, jacobian.T @ jacobian
    except SimulationError:
        return None
    if not (np.isfinite(cost) and np.isfinite(curvature).all()):
        return None
    count = problem.independent_samples if isinstance(problem, Misfit) else float(len(residual))
    return _Fit(cost, gradient, curvature, count)


def _without_simulation(problem: Problem, point: np.ndarray, status: Status, path: Path) -> Identification:
    """Values of which nothing can be said."""
    lower, upper = problem.bounds()
    nothing, none = np.full(len(point), np.nan), np.zeros(len(point), dtype=bool)
    columns = {
        "value": problem.parameters(point),
        **dict.fromkeys(("std", "interval_lower", "interval_upper"), nothing),
        "lower": problem.parameters(lower),
        "upper": problem.parameters(upper),
        "at_bound": none,
        "identifiable": none,
    }
    square = np.full((len(point), len(point)), np.nan)
    table = _table(problem, columns).assign(covariance=(("parameter", "parameter_2"), square))
    table.attrs = {"normalised_residual": np.inf, "remarks": "The model cannot be simulated at these values."}
    ended = Status.FAILED if status is Status.CONVERGED else status
    return Identification(table, ended, np.inf, (), _path(list(problem.names), path))


def _table(problem: Problem, columns: dict[str, np.ndarray]) -> xr.Dataset:
    names = list(problem.names)
    table = xr.Dataset(
        {name: ("parameter", values) for name, values in columns.items()},
        coords={"parameter": names, "parameter_2": names},
    )
    return table.assign(units=("parameter", units_of(problem)))


def _inverse(curvature: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Inverse over the parameters that no bound holds; directions without information get a huge variance, not a crash."""
    inverse = np.zeros_like(curvature)
    free = np.ix_(~held, ~held)
    root = np.sqrt(np.maximum(np.diag(curvature[free]), 1e-300))
    eigenvalues, vectors = np.linalg.eigh(curvature[free] / np.outer(root, root))
    with np.errstate(over="ignore"):
        inverse[free] = vectors / np.maximum(eigenvalues, NO_INFORMATION) @ vectors.T / np.outer(root, root)
    return inverse


def _way_left(fit: _Fit, held: np.ndarray) -> np.ndarray:
    """The Gauss-Newton step that the misfit would still take, in the directions in which it says where to go."""
    step = np.zeros(len(held))
    free = np.flatnonzero(~held)
    root = np.sqrt(np.maximum(np.diag(fit.curvature)[free], 1e-300))
    eigenvalues, vectors = np.linalg.eigh(fit.curvature[np.ix_(free, free)] / np.outer(root, root))
    seen = eigenvalues > UNDETERMINED * eigenvalues.max(initial=0.0)
    downhill = vectors[:, seen].T @ (fit.gradient[free] / root)
    step[free] = -(vectors[:, seen] @ (downhill / eigenvalues[seen])) / root
    return step


def _remarks(names: list[str], fit: _Fit, found: Found) -> list[str]:
    remarks = []
    if fit.excess > 1.0:
        remarks.append(
            f"What remains is {fit.normalised:.3g} times the noise: the model at these values does not explain the recordings."
        )
    away = np.abs(found.left) > np.sqrt(np.diag(found.spread))
    if away.any():
        moved = ", ".join(name for name, is_away in zip(names, away, strict=True) if is_away)
        remarks.append(f"The least misfit lies elsewhere: it would still move {moved}.")
    if found.is_far:
        remarks.append("It is too far away for intervals.")
    return remarks


def _spans(problem: Problem, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """A parameter near 0 is measured against the width of its bounds."""
    span = problem.parameters(upper) - problem.parameters(lower)
    return np.where(np.isfinite(span), span, 0.0) * (problem.scaling(lower) == 1.0)


def _unseen(names: list[str], curvature: np.ndarray, size: np.ndarray, held: np.ndarray) -> tuple[str, ...]:
    """Combinations of parameters, in units of their size, that may change by 100 % without the data noticing."""
    keep = np.flatnonzero(~held)
    size = np.where(np.isfinite(size) & (size > 0), size, 1.0)[keep]
    eigenvalues, vectors = np.linalg.eigh(curvature[np.ix_(keep, keep)] * np.outer(size, size))
    unseen = [vector for value, vector in zip(eigenvalues, vectors.T, strict=True) if value < 1.0 / UNSEEN_STD**2]
    return tuple(_combination([names[i] for i in keep], vector) for vector in unseen)


def _one_sided(table: xr.Dataset) -> tuple[str, ...]:
    """Parameters of which the data set only one end."""
    sentences = []
    for name in table["parameter"].values[~table["identifiable"].values]:
        row = table.sel(parameter=name)
        low, high = (float(row["interval_lower"]), float(row["lower"])), (float(row["interval_upper"]), float(row["upper"]))
        if low[0] > low[1] and high[0] >= high[1]:
            sentences.append(f"{name} is at least {low[0]:.4g}; how much more these recordings do not see")
        elif low[0] <= low[1] and high[0] < high[1]:
            sentences.append(f"{name} is at most {high[0]:.4g}; how much less these recordings do not see")
    return tuple(sentences)


def _combination(names: list[str], vector: np.ndarray) -> str:
    main = np.flatnonzero(np.abs(vector) > MAIN_SHARE * np.abs(vector).max())
    parts = sorted(main, key=lambda i: -abs(vector[i]))
    if len(parts) == 1:
        return f"{names[parts[0]]} is not seen by these recordings"
    terms = ", ".join(f"{names[i]} ({'+' if vector[i] * vector[parts[0]] > 0 else '-'})" for i in parts)
    return f"only a combination is seen: {terms} can change together"


def _path(names: list[str], path: Path) -> xr.Dataset:
    return xr.Dataset(
        {
            "cost": ("step", np.array([cost for cost, _ in path])),
            "value": (("step", "parameter"), np.array([values for _, values in path]).reshape(len(path), len(names))),
        },
        coords={"parameter": names},
    )
