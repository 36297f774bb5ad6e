"""From a point to an Identification: covariance, intervals, and what the data do not see."""

import numpy as np
import xarray as xr

from crashkit.misfit import Misfit
from crashkit.misfit.bands import CONFIDENCE
from crashkit.misfit.units import units_of
from crashkit.protocols import Identification, Problem, Status
from crashkit_identifiers.parabola import Parabola, parabola_at
from crashkit_identifiers.profile import intervals
from crashkit_identifiers.recorded import laws_of

UNSEEN_STD = 1.0
"""A parameter, or a combination, that the data leave this uncertain relative to its value is not identifiable."""
MAIN_SHARE = 0.3
"""Of its largest entry: what of a combination is named."""
ALONE = 0.98
"""Share of a parameter that lies in what is not seen, from which it is named for itself."""

Path = tuple[tuple[float, np.ndarray], ...]


def conclude(
    problem: Problem,
    point: np.ndarray,
    status: Status,
    path: Path,
    objective: Problem | None = None,
    count: float | None = None,
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
        count: of independent readings among them, if these are not all of the problem's.
    """
    found = parabola_at(problem, objective or problem, point, count)
    if found is None:
        return _without_simulation(problem, point, status, path)
    names, size = list(problem.names), _sizes(problem, point)
    low, high = intervals(objective or problem, found)
    columns, covariance = _columns(problem, found, low, high, size)
    table = _table(problem, columns).assign(covariance=(("parameter", "parameter_2"), covariance))
    table.attrs = {"normalised_residual": found.normalised, "remarks": " ".join(_remarks(names, found))}
    sided = _one_sided(table)
    unseen = [told for told in _unseen(names, found.curvature, size, found.held) if told.split(" is ")[0] not in sided]
    return Identification(table, status, found.cost, (*unseen, *sided.values()), _path(names, path))


def _columns(
    problem: Problem, found: Parabola, low: np.ndarray, high: np.ndarray, size: np.ndarray
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """What the table of a result says of each parameter, and their covariance."""
    (lower, upper), point, scaling = problem.bounds(), found.point, problem.scaling(found.point)
    half = 0.5 * (high - low)
    with np.errstate(over="ignore", invalid="ignore"):  # what is not seen at all has an infinite variance
        spread = found.spread + np.outer(found.left, found.left)
        std = np.where(found.held | found.is_far, np.nan, np.maximum(np.sqrt(np.diag(spread)), half / CONFIDENCE))
        seen = np.sqrt(np.diag(found.spread)) if found.is_far else half / CONFIDENCE
        covariance = spread * np.outer(scaling, scaling)
    # An end that only a distant bound sets is none.
    is_open = ((low <= lower) & (point - lower > UNSEEN_STD * size)) | ((high >= upper) & (upper - point > UNSEEN_STD * size))
    columns = {
        "value": problem.parameters(point),
        "std": std * scaling,
        "interval_lower": problem.parameters(low),
        "interval_upper": problem.parameters(high),
        "lower": problem.parameters(lower),
        "upper": problem.parameters(upper),
        "at_bound": found.held,
        "identifiable": ~found.held & (seen < UNSEEN_STD * size) & (~is_open | found.is_far),
    }
    return columns, covariance


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
    known = units_of(problem.model, laws_of(problem), problem.groups) if isinstance(problem, Misfit) else {}
    return table.assign(units=("parameter", np.array([known.get(name, "") for name in names], dtype=str)))


def _remarks(names: list[str], found: Parabola) -> list[str]:
    remarks = []
    if found.excess > 1.0:
        remarks.append(
            f"What remains is {found.normalised:.3g} times the noise: "
            "the model at these values does not explain the recordings."
        )
    away = np.abs(found.left) > np.sqrt(np.diag(found.spread))
    if away.any():
        moved = ", ".join(name for name, is_away in zip(names, away, strict=True) if is_away)
        remarks.append(f"The least misfit lies elsewhere: it would still move {moved}.")
    if found.is_far:
        remarks.append("It is too far away for intervals.")
    return remarks


def _sizes(problem: Problem, point: np.ndarray) -> np.ndarray:
    """What counts as 100 %, in search variables: a value, or the width of its bounds if it may be 0."""
    lower, upper = problem.bounds()
    span = problem.parameters(upper) - problem.parameters(lower)
    widths = np.where(np.isfinite(span), span, 0.0) * (problem.scaling(lower) == 1.0)
    return np.asarray(np.maximum(np.abs(problem.parameters(point)), widths) / problem.scaling(point))


def _unseen(names: list[str], curvature: np.ndarray, size: np.ndarray, held: np.ndarray) -> tuple[str, ...]:
    """Combinations of parameters, in units of their size, that may change by 100 % without the data noticing."""
    keep = np.flatnonzero(~held)
    size = np.where(np.isfinite(size) & (size > 0), size, 1.0)[keep]
    eigenvalues, vectors = np.linalg.eigh(curvature[np.ix_(keep, keep)] * np.outer(size, size))
    unseen = vectors[:, eigenvalues < 1.0 / UNSEEN_STD**2]
    alone = np.linalg.norm(unseen, axis=1) > ALONE
    told = [f"{names[i]} is not seen by these recordings" for i in keep[alone]]
    # What is not seen at all is no part of a combination.
    directions, _, _ = np.linalg.svd(np.where(alone[:, None], 0.0, unseen), full_matrices=False)
    rest = directions.T[: unseen.shape[1] - int(alone.sum())]
    return (*told, *(_combination([names[i] for i in keep], vector) for vector in rest))


def _one_sided(table: xr.Dataset) -> dict[str, str]:
    """Sentences on the parameters of which the data set only one end, by name."""
    sentences = {}
    for name in table["parameter"].values[~(table["identifiable"] | table["at_bound"]).values].tolist():
        row = table.sel(parameter=name)
        low, high = (float(row["interval_lower"]), float(row["lower"])), (float(row["interval_upper"]), float(row["upper"]))
        if low[0] > low[1] and high[0] >= high[1]:
            sentences[name] = f"{name} is at least {low[0]:.4g}; how much more these recordings do not see"
        elif low[0] <= low[1] and high[0] < high[1]:
            sentences[name] = f"{name} is at most {high[0]:.4g}; how much less these recordings do not see"
    return sentences


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
