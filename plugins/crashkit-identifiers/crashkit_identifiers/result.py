"""From a point and its curvature to an Identification: covariance, bounds, and what the data do not see."""

import numpy as np
import xarray as xr

from crashkit.protocols import Identification, Problem, Status

UNSEEN_STD = 1.0
"""A parameter, or a combination, that the data leave this uncertain relative to its value is not identifiable."""
MAIN_SHARE = 0.3


def summarise(
    problem: Problem,
    point: np.ndarray,
    cost: float,
    curvature: np.ndarray,
    status: Status,
    path: tuple[tuple[float, np.ndarray], ...],
) -> Identification:
    """The result at `point`, where `curvature` is JᵀJ of the weighted residuals: cov(u) = (JᵀJ)⁻¹."""
    lower, upper = problem.bounds()
    scaling, values = problem.scaling(point), problem.parameters(point)
    held = (point <= lower) | (point >= upper)
    covariance = _covariance(curvature, held) * np.outer(scaling, scaling)
    std = np.sqrt(np.diag(covariance))
    size = np.maximum(np.abs(values), _spans(problem, lower, upper))
    names = list(problem.names)
    table = xr.Dataset(
        {
            "value": ("parameter", values),
            "std": ("parameter", np.where(held, np.nan, std)),
            "lower": ("parameter", problem.parameters(lower)),
            "upper": ("parameter", problem.parameters(upper)),
            "at_bound": ("parameter", held),
            "identifiable": ("parameter", ~held & (std < UNSEEN_STD * size)),
            "covariance": (("parameter", "parameter_2"), covariance),
        },
        coords={"parameter": names, "parameter_2": names},
    )
    return Identification(table, status, cost, _unseen(names, curvature, size / scaling, held), _path(names, path))


def _covariance(curvature: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Inverse over the parameters that no bound holds; directions without information get a huge variance, not a crash."""
    covariance = np.zeros_like(curvature)
    free = np.ix_(~held, ~held)
    root = np.sqrt(np.maximum(np.diag(curvature[free]), 1e-300))
    eigenvalues, vectors = np.linalg.eigh(curvature[free] / np.outer(root, root))
    inverse = vectors / np.maximum(eigenvalues, 1e-14) @ vectors.T
    with np.errstate(over="ignore"):  # what is not seen at all has an infinite variance
        covariance[free] = inverse / np.outer(root, root)
    return covariance


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


def _combination(names: list[str], vector: np.ndarray) -> str:
    main = np.flatnonzero(np.abs(vector) > MAIN_SHARE * np.abs(vector).max())
    parts = sorted(main, key=lambda i: -abs(vector[i]))
    if len(parts) == 1:
        return f"{names[parts[0]]} is not seen by these recordings"
    terms = ", ".join(f"{names[i]} ({'+' if vector[i] * vector[parts[0]] > 0 else '-'})" for i in parts)
    return f"only a combination is seen: {terms} can change together"


def _path(names: list[str], path: tuple[tuple[float, np.ndarray], ...]) -> xr.Dataset:
    return xr.Dataset(
        {
            "cost": ("step", np.array([cost for cost, _ in path])),
            "value": (("step", "parameter"), np.array([values for _, values in path]).reshape(len(path), len(names))),
        },
        coords={"parameter": names},
    )
