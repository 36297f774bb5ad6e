"""The gradient of a misfit by the adjoint: one run forward and one back, however many parameters there are."""

from collections.abc import Iterator, Mapping

import numpy as np
import xarray as xr

from crashkit.data.channel_filter import frequency_class
from crashkit.misfit import Group, Misfit
from crashkit.misfit.predictor import initial_state
from crashkit.protocols import PlainObserver, Problem, Reading
from crashkit_identifiers.cost import cost_and_gradient, half_square, residual_at
from crashkit_identifiers.measured import SAME_INSTANT, instants
from crashkit_identifiers.recorded import laws_of

MANY = 40
"""Parameters from which the adjoint is the cheaper way: it costs about as much as the sensitivities of so many."""


def cost_and_cheapest_gradient(problem: Problem, point: np.ndarray) -> tuple[float, np.ndarray]:
    """The cost and its gradient, by the adjoint where that is to be had and cheaper than forward sensitivities."""
    if isinstance(problem, Misfit) and len(point) >= MANY and has_adjoint(problem):
        return cost_and_adjoint(problem, point)
    return cost_and_gradient(problem, point)


def cost_and_adjoint(problem: Misfit, point: np.ndarray) -> tuple[float, np.ndarray]:
    """The cost ½ |r|² and its gradient to the search variables (Mizzi & Jezequel 1992, eq 56-64).

    λ' + ∂H/∂X = 0, back from the last instant, with the weighted residuals as what drives it.
    """
    residual = residual_at(problem, point)
    cost = half_square(residual)
    if not np.isfinite(cost):
        return np.inf, np.zeros(len(point))
    values, weights = problem.model.values() | problem.values(point), _weights(problem, residual)
    gradient = np.zeros(len(point))
    for run, weight in weights.items():
        initial, step = initial_state(problem.recordings[run], problem.model), problem.predictor.step
        simulator = problem.predictor.simulator
        gradient += simulator.adjoint(weight["time"].values, weight, values, initial, problem.names, step).values
    return cost, gradient * problem.scaling(point)


def has_adjoint(misfit: Misfit) -> bool:
    """Whether all instruments show single numbers of the motion from t = 0 on as they are, and no law's force jumps."""
    plain = all(_is_plain(misfit, group) for group in misfit.groups)
    knows_more = misfit.model.instruments or misfit.prior.centres
    return plain and not knows_more and not any(law.jumps for law in laws_of(misfit).values())


def _is_plain(misfit: Misfit, group: Group) -> bool:
    is_raw = not frequency_class(group.dataset) and group.times[0] >= 0.0
    return is_raw and _reading(misfit, group) is not None


def _reading(misfit: Misfit, group: Group) -> Reading | None:
    turning = len(misfit.model.axes) > 1
    reading = group.observer.reading(group.dataset, turning) if isinstance(group.observer, PlainObserver) else None
    return reading if isinstance(reading, Reading) else None


def _weights(misfit: Misfit, residual: np.ndarray) -> Mapping[str, xr.Dataset]:
    """dJ / d motion of each run: -r / s for every number that was read, over the dims of a motion."""
    names = misfit.predictor.simulator.names
    weights: dict[str, dict[str, np.ndarray]] = {run: {} for run in misfit.recordings}
    times = {run: instants(misfit, run) for run in misfit.recordings}
    for group, rows in _rows(misfit, residual):
        reading = _reading(misfit, group)
        assert reading is not None  # as `has_adjoint` found
        places = np.searchsorted(times[group.run], group.times - SAME_INSTANT)
        shape = (len(times[group.run]), names["body"].size, names["axis"].size)
        table = weights[group.run].setdefault(reading.quantity, np.zeros(shape))
        for column, (body, axis) in enumerate(zip(reading.bodies, reading.axes, strict=True)):
            b, a = names["body"].values.tolist().index(body), names["axis"].values.tolist().index(axis)
            np.add.at(table, (places, b, a), -rows[:, column] * group.channels[column].noise.weight)
    return {
        run: xr.Dataset(
            {name: (("time", "body", "axis"), table) for name, table in tables.items()},
            {"time": times[run], "body": names["body"], "axis": names["axis"]},
        )
        for run, tables in weights.items()
    }


def _rows(misfit: Misfit, residual: np.ndarray) -> Iterator[tuple[Group, np.ndarray]]:
    """Every instrument with its residuals (time, channel); 0 where nothing was recorded."""
    start = 0
    for group in misfit.groups:
        present, table = np.isfinite(group.recorded), np.zeros(group.recorded.shape)
        count = int(present.sum())
        table[present] = residual[start : start + count]
        start += count
        yield group, table
