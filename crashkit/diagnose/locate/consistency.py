"""Sensor or structure: instruments that watch the same body are compared by kinematics alone, without any model of forces."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve, frozen
from scipy.constants import foot, g
from scipy.integrate import cumulative_trapezoid
from scipy.linalg import solve_triangular

from crashkit.misfit import Group, Misfit

SIGNIFICANT = 5.0
"""Sigma from which a check is reported as inconsistent."""
MISTAKEN = {
    "accelerations in g": 1.0 / g,
    "accelerations in ft/s²": 1.0 / foot,
    "accelerations in mm/s²": 1e3,
    "accelerations in cm/s²": 1e2,
    "positions in mm": 1e-3,
    "positions in cm": 1e-2,
}
"""How much too large accelerations then are, compared with positions."""
FEWEST = 8
"""Instants that both saw."""
ROUNDS = 6
"""To first order a late clock adds what the body moves meanwhile; one that is late by much is put right so often."""
UNIT = 0.1
"""Share by which a ratio may be off one of these: a sensor is rarely wrong by more."""


@frozen(eq=False)
class Comparison:
    """One body of one run seen by position and by acceleration.

    Attributes:
        along: in which axis, where there are several.
        times, position: of the film, s and m.
        stamps, velocity, displacement: of the accelerometer, s, and its integrals.
        variance, density: of the noise of the positions, m2, and spectral of the accelerations.
    """

    body: str
    along: str
    film: str
    accelerometer: str
    times: np.ndarray
    position: np.ndarray
    stamps: np.ndarray
    velocity: np.ndarray
    displacement: np.ndarray
    variance: float
    density: float

    @property
    def key(self) -> tuple[str, ...]:
        """What is the same in all runs."""
        return self.body, self.along, self.film, self.accelerometer

    def put_right(self, late: float) -> "Comparison":
        """The same, the accelerometer's clock put right by so much, over what both then saw."""
        stamps = self.stamps - late
        seen = (self.times >= stamps[0]) & (self.times <= stamps[-1])
        return evolve(self, stamps=stamps, times=self.times[seen], position=self.position[seen])

    def columns(self, error: str) -> np.ndarray:
        """(time, 4) a straight line, what an error of 1 adds, and y = position - double integral; in units of the noise."""
        integral, slope = (np.interp(self.times, self.stamps, part) for part in (self.displacement, self.velocity))
        since = self.times - self.times[0]
        added = {"gain": -integral, "bias": -0.5 * since**2, "clock_offset": slope}[error]
        table = np.column_stack([np.ones_like(since), since, added, self.position - integral])
        covariance = _covariance(self.times - self.stamps[0], self.variance, self.density)
        white: np.ndarray = solve_triangular(np.linalg.cholesky(covariance), table, lower=True)
        return white


def check_instruments(groups: Mapping[str, list[Group]]) -> xr.Dataset:
    """How far the accelerometers of each body agree with its film, as an error of sensitivity, offset or clock.

    Of several axes that is asked along the one in which the body is accelerated most.
    y(t) = x(t) - ∫∫ a dt² is a straight line for perfect instruments. A sensitivity 1 + g adds -g / (1 + g) ∫∫a, an offset b
    adds -b t²/2, a clock late by τ adds τ ∫a; each is estimated alone, by generalised least squares with the integrated noise;
    the clock again with stamps put right by what was found, as long as that leaves less.

    Arguments:
        groups: the instruments of each run.

    Returns:
        Dataset over `check`: `sentence`, `place`, `body`, `film`, `accelerometer`, `error`, `estimate`, `std`, `sigma`, and
        `left`, what the error leaves unexplained, normalised by the noise.
    """
    comparisons = [one for instruments in groups.values() for one in _comparisons(instruments)]
    keys = dict.fromkeys(c.key for c in comparisons)
    rows = [row for key in keys for row in _rows([c for c in comparisons if c.key == key])]
    names = ("sentence", "place", "body", "film", "accelerometer", "error", "estimate", "std", "sigma", "left")
    columns = zip(*rows, strict=True) if rows else ((),) * len(names)
    return xr.Dataset({name: ("check", np.array(column)) for name, column in zip(names, columns, strict=True)})


def by_run(misfit: Misfit) -> dict[str, list[Group]]:
    """The instruments of each run."""
    return {run: [group for group in misfit.groups if group.run == run] for run in misfit.recordings}


def _comparisons(instruments: list[Group]) -> Iterator[Comparison]:
    films = [g for g in instruments if "position" in g.dataset and g.observer.quantity == "position"]
    sensors = [g for g in instruments if g.observer.quantity == "acceleration"]
    for film in films:
        for sensor in sensors:
            seen, felt = film.motion(), sensor.motion()
            if seen is None or felt is None:
                continue
            position, acceleration = xr.align(seen["position"], felt["acceleration"], join="inner", exclude="time")
            for body in sorted(position["body"].values.tolist()) if position.size else ():
                yield from _compare(film, sensor, position.sel(body=body), acceleration.sel(body=body))


def _compare(film: Group, sensor: Group, seen: xr.DataArray, felt: xr.DataArray) -> Iterator[Comparison]:
    body, axis = str(seen["body"].item()), _strongest(felt)
    position, acceleration = seen.sel(axis=axis).values, felt.sel(axis=axis).values
    inside = np.isfinite(position) & (film.times >= sensor.times[0]) & (film.times <= sensor.times[-1])
    if inside.sum() < FEWEST or not np.isfinite(acceleration).all():
        return
    velocity = cumulative_trapezoid(acceleration, sensor.times, initial=0.0)
    displacement = cumulative_trapezoid(velocity, sensor.times, initial=0.0)
    along = f" along {axis}" if seen.sizes["axis"] > 1 else ""
    noise = _variance(film, body, axis, "marker"), _density(sensor, body, axis)
    seen_by = film.times[inside], position[inside], sensor.times, velocity, displacement
    yield Comparison(body, along, film.name, sensor.name, *seen_by, *noise)


def _strongest(felt: xr.DataArray) -> str:
    """The axis along which a body (time, axis) was accelerated most; where it is not, noise looks like a gain."""
    return str((felt**2).sum("time").idxmax("axis").item())


def _rows(comparisons: list[Comparison]) -> list[tuple[str | float, ...]]:
    first = comparisons[0]
    units = {"gain": "", "bias": " m/s²", "clock_offset": " s"}
    rows: list[tuple[str | float, ...]] = []
    for error, unit in units.items():
        estimate, std, left = _estimate(comparisons, error)
        sigma = abs(estimate) / std
        if error == "gain":
            recorded_per_true = 1.0 / (1.0 - estimate) if estimate != 1.0 else np.inf
            estimate, std = recorded_per_true - 1.0, std * recorded_per_true**2
        verdict = "inconsistent (as an error of " if sigma > SIGNIFICANT else "consistent ("
        sentence = (
            f"{first.accelerometer} against {first.film} on {first.body}{first.along}: {verdict}"
            f"{error.replace('_', ' ')} {estimate:+.3g} ± {std:.2g}{unit}){_mistaken(estimate) if error == 'gain' else ''}"
        )
        rows.append(
            (sentence, f"body {first.body}", first.body, first.film, first.accelerometer, error, estimate, std, sigma, left)
        )
    return rows


def _mistaken(gain: float) -> str:
    """The units in which readings seem to be that are that much too large, in words."""
    units = [unit for unit, factor in MISTAKEN.items() if abs(1.0 + gain - factor) < UNIT * factor]
    return f": {units[0]}?" if units else ""


def _estimate(comparisons: Sequence[Comparison], error: str) -> tuple[float, float, float]:
    """One error, common to all runs (of a sensitivity, over 1 + g), its deviation, and what it leaves."""
    best = _to_first_order(comparisons, error)
    for _ in range(ROUNDS if error == "clock_offset" else 0):
        late, *_ = best
        again = [one.put_right(late) for one in comparisons]
        if any(len(one.times) < FEWEST for one in again):
            break
        further, std, left = _to_first_order(again, error)
        if left >= best[2]:
            break
        best = late + further, std, left
    return best


def _to_first_order(comparisons: Sequence[Comparison], error: str) -> tuple[float, float, float]:
    """Each run has a straight line of its own."""
    information = gradient = chi_squared = 0.0
    for one in comparisons:
        white = one.columns(error)
        basis, _ = np.linalg.qr(white[:, :2])
        free = white[:, 2:] - basis @ (basis.T @ white[:, 2:])
        information += float(free[:, 0] @ free[:, 0])
        gradient += float(free[:, 0] @ free[:, 1])
        chi_squared += float(free[:, 1] @ free[:, 1])
    information, samples = max(information, 1e-300), sum(len(one.times) - 2 for one in comparisons)
    left = np.sqrt(max(chi_squared - gradient**2 / information, 0.0) / samples)
    return gradient / information, float(np.sqrt(1.0 / information)), float(left)


def _covariance(times: np.ndarray, variance: float, density: float) -> np.ndarray:
    """Of film noise and doubly integrated white noise: density m² (3 M - m) / 6, m and M the earlier and later time."""
    earlier, later = np.minimum.outer(times, times), np.maximum.outer(times, times)
    return variance * np.eye(len(times)) + density * earlier**2 * (3.0 * later - earlier) / 6.0


def _variance(group: Group, body: str, axis: str, channel: str) -> float:
    """Of the mean of a body's readings along an axis."""
    carriers = dict(zip(group.dataset[channel].values, group.dataset[f"{channel}_body"].values, strict=True))
    stds = [c.noise.std for c in group.channels if carriers[c.sensor] == body and c.axis == axis]
    return float(np.sum(np.square(stds))) / len(stds) ** 2


def _density(sensor: Group, body: str, axis: str) -> float:
    """Spectral density of the mean of a body's accelerometers at low frequencies."""
    correlation = sensor.channels[0].noise.correlation
    return _variance(sensor, body, axis, "sensor") * correlation * float(np.median(np.diff(sensor.times)))
