"""Synchronisation of a film with accelerometers on the same bodies, by the motion that both see."""

import numpy as np
import xarray as xr
from attrs import frozen
from scipy.interpolate import CubicHermiteSpline
from scipy.stats import median_abs_deviation

from crashkit.errors import CrashkitError
from crashkit_cameras.synchronise.clocks import DRIFT, settled

GAIN_STD = 0.02
"""Of an accelerometer's sensitivity, as far as nothing is known of it."""
WITHIN = 0.02
ITERATIONS = 20
TINY = 1e-9
LEAST_OVERLAP, LEAST_FRAMES = 0.5, 6


@frozen
class _Track:
    """A marker along an axis: stamps, s, readings and their deviation, m, and its body's acceleration integrated twice."""

    stamps: np.ndarray
    reading: np.ndarray
    std: float
    integral: CubicHermiteSpline


@frozen
class _Fit:
    """All tracks fitted with one clock (offset, rate): its normal equations, and the residual's mean square in variances."""

    clock: np.ndarray
    normal: np.ndarray
    gradient: np.ndarray
    square: float


def synchronise_with_accelerometer(
    film: xr.Dataset, accelerometer: xr.Dataset, within: float = WITHIN, drift: float = DRIFT, gain_std: float = GAIN_STD
) -> xr.Dataset:
    r"""The film's clock against the accelerometers', from bodies that carry markers and sensors and do not turn.

    With p the double integral of a body's acceleration, every marker must read along every axis

        z(s) = x_0 + v_0 τ + b τ^2 / 2 + g p(t),   t = s - offset - rate (s - epoch),   τ = t - epoch,

    whatever its start x_0, v_0, the sensor's bias b and its gain g. Offset and rate by Gauss-Newton, the others eliminated
    (Golub & Pereyra 1973, doi:10.1137/0710036). Where the velocity hardly changes, an offset looks like another start: then
    the clock is not determined.

    Arguments:
        film: a film group; its markers on bodies with sensors count, with `position_std` where it is known.
        accelerometer: an accelerometer group, in the axes of the film.
        within: how large the offset may be, s.
        drift: standard deviation of the film's rate, as far as it is known beforehand.
        gain_std: standard deviation of the sensors' gain, likewise.

    Returns:
        The clock (see `clocks`) of the view "film", with the attribute `normalised_residual`: the residual over its standard
        deviation, NaN where that is not known. Far above 1, the instruments contradict each other, or the bodies turn.

    Raises CrashkitError where film and accelerometers have no body, axis or time in common.
    """
    stamps, tracks = film["time"].values, _tracks(film, accelerometer)
    epoch = float(0.5 * (stamps[0] + stamps[-1]))
    count = int(np.ceil(2.0 * within / np.median(np.diff(stamps))))
    trials = [_fit(tracks, np.array([offset, 0.0]), epoch, gain_std) for offset in np.linspace(-within, within, 2 * count + 1)]
    fit = min((trial for trial in trials if trial is not None), key=lambda trial: trial.square, default=None)
    if fit is None:
        raise CrashkitError("film: expected a film and accelerometers of the same time, found too little in common")
    prior = np.diag([3.0 / within**2, 1.0 / drift**2])
    for _ in range(ITERATIONS):
        step = np.linalg.solve(fit.normal + prior, fit.gradient - prior @ fit.clock)
        moved = _fit(tracks, fit.clock + step, epoch, gain_std)
        if moved is None or moved.square > fit.square + TINY:
            break
        fit = moved
    covariance = np.linalg.inv(fit.normal + prior) * max(1.0, fit.square)
    return settled(["film"], fit.clock[None], covariance[None], epoch, within, normalised_residual=float(np.sqrt(fit.square)))


def _tracks(film: xr.Dataset, accelerometer: xr.Dataset) -> list[_Track]:
    """Every marker along every axis that an accelerometer on its body sees too."""
    carriers = accelerometer["sensor_body"]
    axes = [axis for axis in film["axis"].values if axis in accelerometer["axis"].values]
    tracks = []
    for marker in film["marker"].values:
        one = film.sel(marker=marker)
        felt = accelerometer["acceleration"].sel(sensor=carriers == one["marker_body"])
        std = float(one["position_std"]) if "position_std" in film else np.nan
        for axis in axes if felt.sizes["sensor"] else []:
            reading = one["position"].sel(axis=axis).dropna("time")
            integral = _integrated(felt.sel(axis=axis).mean("sensor").dropna("time"))
            noise = std if np.isfinite(std) else _noise(reading.values)
            tracks.append(_Track(reading["time"].values, reading.values, noise, integral))
    if not tracks:
        raise CrashkitError("film: expected markers on a body with an accelerometer, and an axis in common, found none")
    return tracks


def _integrated(acceleration: xr.DataArray) -> CubicHermiteSpline:
    """Twice over time, from rest, taken as linear between samples."""
    a, times = acceleration.values, acceleration["time"].values
    h = np.diff(times)
    velocity = np.append(0.0, np.cumsum(0.5 * h * (a[:-1] + a[1:])))
    position = np.append(0.0, np.cumsum(h * velocity[:-1] + h * h * (2.0 * a[:-1] + a[1:]) / 6.0))
    return CubicHermiteSpline(times, position, velocity)


def _noise(reading: np.ndarray) -> float:
    """Standard deviation of noise on a smooth motion, from its third differences."""
    return float(median_abs_deviation(np.diff(reading, 3), scale="normal") / np.sqrt(20.0))


def _fit(tracks: list[_Track], clock: np.ndarray, epoch: float, gain_std: float) -> _Fit | None:
    """All tracks with a clock; None where too little of the film falls into the accelerometers' time."""
    normal, gradient, square, freedom = np.zeros((2, 2)), np.zeros(2), 0.0, -2
    for track in tracks:
        since = track.stamps - epoch
        time = track.stamps - clock[0] - clock[1] * since
        inside = (time >= track.integral.x[0]) & (time <= track.integral.x[-1])
        if inside.sum() < max(LEAST_OVERLAP * len(time), LEAST_FRAMES):
            return None
        slopes, residual = _eliminated(track, time[inside] - epoch, since[inside], track.reading[inside], epoch, gain_std)
        normal, gradient = normal + slopes.T @ slopes, gradient + slopes.T @ residual
        square, freedom = square + residual @ residual, freedom + inside.sum() - 3
    return _Fit(clock, normal, gradient, square / freedom)


def _eliminated(
    track: _Track, tau: np.ndarray, since: np.ndarray, reading: np.ndarray, epoch: float, gain_std: float
) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives to offset and rate, and residual, in standard deviations, with start, bias and gain as they fit best."""
    columns = np.stack([np.ones_like(tau), tau, 0.5 * tau**2, track.integral(tau + epoch)], axis=1) / track.std
    columns = np.vstack([columns, [0.0, 0.0, 0.0, 1.0 / gain_std]])
    wanted = np.append(reading / track.std, 1.0 / gain_std)
    basis, _ = np.linalg.qr(columns)
    _, v0, bias, gain = np.linalg.lstsq(columns, wanted, rcond=None)[0]
    velocity = v0 + bias * tau + gain * track.integral(tau + epoch, 1)
    slopes = np.vstack([-velocity[:, None] * np.stack([np.ones_like(since), since], axis=1) / track.std, [0.0, 0.0]])
    return slopes - basis @ (basis.T @ slopes), wanted - basis @ (basis.T @ wanted)
