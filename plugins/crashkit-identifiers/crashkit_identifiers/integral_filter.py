"""The integral filter: as many costs as parameters, each the misfit seen through a window of time."""

from collections.abc import Callable, Mapping
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve, field, frozen

from crashkit.errors import CrashkitError, SimulationError
from crashkit.misfit import Misfit
from crashkit.protocols import Identification, Identifier, Problem, Status
from crashkit_identifiers.cost import is_least
from crashkit_identifiers.measured import measured_motions
from crashkit_identifiers.recorded import with_recordings
from crashkit_identifiers.result import Path, conclude

LONGEST = 0.5
"""No step changes a parameter that is searched in its logarithm by more than a factor 1.6."""
TRUNCATIONS = (1e-12, 1e-6, 1e-3, 3e-2)
"""Shares of the largest singular value below which a step leaves a combination of parameters alone; the best is taken."""
HALVINGS = 10
EXACT = 1e-14
"""Share of the first cost at which the zero counts as found."""


def power(share: np.ndarray, count: int) -> np.ndarray:
    """(t/T)^(i-1)."""
    return share[:, None] ** np.arange(count)


def sine(share: np.ndarray, count: int) -> np.ndarray:
    """sin(π i t / (s T)) with s as many as there are: never below 0."""
    return np.sin(np.pi * share[:, None] * np.arange(1, count + 1) / count)


def chebyshev(share: np.ndarray, count: int) -> np.ndarray:
    """T_(i-1)(2 t/T - 1)², so that no window is negative."""
    return np.cos(np.arange(count) * np.arccos(np.clip(2.0 * share[:, None] - 1.0, -1.0, 1.0))) ** 2


BASES: Mapping[str, Callable[[np.ndarray, int], np.ndarray]] = {"power": power, "sine": sine, "chebyshev": chebyshev}


@frozen(eq=False)
class FilterState:
    """Where the search stands: the sum of the costs there, and the measured motion of each run."""

    point: np.ndarray
    cost: float
    status: Status
    measured: Mapping[str, xr.Dataset]
    path: Path = field(default=())


@frozen
class IntegralFilter(Identifier[FilterState]):
    """Newton's steps towards the zero of J_i = ∫ L(X, U) B_i(t) dt, i = 1 ... m (Mizzi & Jezequel 1992, eq 46).

    L is the squared difference of simulated and measured displacement, speed and acceleration, each as a share of its largest
    value, times its weight; the windows B_i are as many as the parameters, in every run. A zero of squares is double, so a
    step is twice Newton's. With noise there is no zero: the search ends where the costs fall no further, which is not the
    least misfit. Every body that moves must be seen by an instrument, or it does not count.

    Arguments:
        basis: of the windows: "power", "sine" or "chebyshev" (squared).
        displacement, speed, acceleration: weights.
        penalty: weight of the squared distance of the search variables from their start.
        step_limit: steps after which the search ends unconverged.
    """

    name: ClassVar[str] = "integral_filter"
    basis: str = field(default="chebyshev")
    displacement: float = 2.0
    speed: float = 1.0
    acceleration: float = 0.0
    penalty: float = 0.0
    step_limit: int = 100

    @basis.validator
    def _check_basis(self, attribute: object, value: str) -> None:
        if value not in BASES:
            raise CrashkitError(f"{self.name}: expected a basis of {', '.join(BASES)}, found {value}")

    def start(self, problem: Problem) -> FilterState:
        """The state at the problem's own start."""
        misfit = with_recordings(problem, self.name)
        measured = measured_motions(misfit)
        point = np.clip(misfit.start(), *misfit.bounds())
        cost = self._costs(misfit, measured).sum_at(point)
        status = Status.RUNNING if np.isfinite(cost) else Status.FAILED
        return FilterState(point, cost, status, measured, ((cost, misfit.parameters(point)),))

    def step(self, problem: Problem, state: FilterState) -> FilterState:
        """The best of Newton's steps on all costs at once."""
        if state.status is not Status.RUNNING:
            return state
        misfit = with_recordings(problem, self.name)
        if state.cost <= EXACT * state.path[0][0]:
            return evolve(state, status=Status.CONVERGED)
        if len(state.path) > self.step_limit:
            return evolve(state, status=Status.STEP_LIMIT)
        costs = self._costs(misfit, state.measured)
        for moves in _ever_shorter(costs.steps(state.point)):
            trials = [np.clip(state.point + move, *misfit.bounds()) for move in moves]
            best = min(trials, key=costs.sum_at)
            if costs.sum_at(best) < state.cost:
                cost = costs.sum_at(best)
                return evolve(state, point=best, cost=cost, path=(*state.path, (cost, misfit.parameters(best))))
        return evolve(state, status=Status.CONVERGED if is_least(misfit, state.point) else Status.STALLED)

    def finish(self, problem: Problem, state: FilterState) -> Identification:
        """The parameters, with what the recordings themselves say of them."""
        return conclude(problem, state.point, state.status, state.path)

    def _costs(self, misfit: Misfit, measured: Mapping[str, xr.Dataset]) -> "_Costs":
        weights = {"position": self.displacement, "velocity": self.speed, "acceleration": self.acceleration}
        return _Costs(misfit, measured, BASES[self.basis], {name: w for name, w in weights.items() if w}, self.penalty)


class _Costs:
    """The costs J_i of every run, and of the penalty."""

    def __init__(
        self,
        misfit: Misfit,
        measured: Mapping[str, xr.Dataset],
        basis: Callable[[np.ndarray, int], np.ndarray],
        weights: Mapping[str, float],
        penalty: float,
    ) -> None:
        self.misfit, self.measured, self.penalty = misfit, measured, penalty
        self.first = misfit.start()
        self._windows = {run: _windows(motion["time"].values, basis, len(misfit.names)) for run, motion in measured.items()}
        self._weights = {name: weight / _size(name, measured) ** 2 for name, weight in weights.items()}
        self._known: dict[bytes, float] = {}

    def sum_at(self, point: np.ndarray) -> float:
        """The sum of all costs; infinite where the model cannot be simulated."""
        key = point.tobytes()
        if key not in self._known:
            try:
                with np.errstate(over="ignore", invalid="ignore"):
                    total = float(self.at(point, sensitivities=False)[0].sum())
            except SimulationError:
                total = np.inf
            self._known[key] = total if np.isfinite(total) else np.inf
        return self._known[key]

    def at(self, point: np.ndarray, sensitivities: bool) -> tuple[np.ndarray, np.ndarray]:
        """The costs, and their derivatives (cost, variable) to the search variables."""
        values = self.misfit.values(point)
        parts = [self._of_run(run, values, sensitivities) for run in self.measured]
        costs, slopes = (np.concatenate(side) for side in zip(*parts, strict=True))
        away = point - self.first
        costs = np.concatenate([costs, self.penalty * away**2])
        return costs, np.concatenate([slopes * self.misfit.scaling(point), 2.0 * self.penalty * np.diag(away)])

    def steps(self, point: np.ndarray) -> list[np.ndarray]:
        """Twice Newton's step, with more and more of the ill-determined combinations left alone."""
        costs, slopes = self.at(point, sensitivities=True)
        size = np.linalg.norm(slopes, axis=0)
        size[size == 0.0] = 1.0
        moves = [-2.0 * np.linalg.lstsq(slopes / size, costs, rcond=share)[0] / size for share in TRUNCATIONS]
        return [move * min(1.0, LONGEST / max(float(np.abs(move).max(initial=0.0)), 1e-300)) for move in moves]

    def _of_run(self, run: str, values: Mapping[str, float], sensitivities: bool) -> tuple[np.ndarray, np.ndarray]:
        measured, window = self.measured[run], self._windows[run]
        motion = self.misfit.predictor.motion(run, values, sensitivities).isel(time=slice(measured.sizes["time"]))
        moving = [row for row, body in enumerate(self.misfit.model.bodies) if not body.fixed]
        costs, slopes = np.zeros(window.shape[1]), np.zeros((window.shape[1], len(self.misfit.names)))
        for name, weight in self._weights.items():
            away = np.nan_to_num((motion[name].values - measured[name].values)[:, moving])
            costs += weight * window.T @ (away**2).sum(axis=(1, 2))
            if sensitivities:
                table = motion[f"{name}_sensitivity"]
                columns = [self.misfit.names.index(str(path)) for path in table["parameter"].values]
                slopes[:, columns] += 2.0 * weight * window.T @ (away[..., None] * table.values[:, moving]).sum(axis=(1, 2))
        return costs, slopes


def _ever_shorter(moves: list[np.ndarray]) -> list[list[np.ndarray]]:
    """The moves, and all of them halved again and again."""
    return [[0.5**times * move for move in moves] for times in range(HALVINGS)]


def _windows(times: np.ndarray, basis: Callable[[np.ndarray, int], np.ndarray], count: int) -> np.ndarray:
    """The windows (time, window), times dt / T."""
    share = times / times[-1]
    return basis(share, count) * np.gradient(share)[:, None]


def _size(name: str, measured: Mapping[str, xr.Dataset]) -> float:
    """The largest value that was measured; of positions, the longest way."""
    sizes = [motion[name] - (motion[name].isel(time=0) if name == "position" else 0.0) for motion in measured.values()]
    return max(float(np.nanmax(np.abs(size.values))) for size in sizes)
