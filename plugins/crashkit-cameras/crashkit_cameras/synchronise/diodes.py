"""Synchronisation by a diode that blinks at a known frequency in every view."""

import numpy as np
import xarray as xr
from attrs import frozen
from scipy.optimize import linprog

from crashkit.errors import CrashkitError
from crashkit_cameras.synchronise.clocks import DRIFT, clocks
from crashkit_cameras.synchronise.polygon import cut, moments


@frozen
class _Clock:
    """Mean and covariance of offset, s, and rate, against the diode's clock, and the slack of the readings, s."""

    mean: np.ndarray
    covariance: np.ndarray
    slack: float


def synchronise_by_diode(
    time_marker: xr.DataArray, frequency: float, duty: float = 0.5, drift: float = DRIFT, reference: str | None = None
) -> xr.Dataset:
    r"""The views' clocks from the frames in which a common diode is seen on and off.

    Between a frame that sees it off and the next that sees it on, it was switched on: with the time T of switching

        s_i - T < offset + rate (s_i - epoch),   offset + rate (s_i+1 - epoch) <= s_i+1 - T.

    All clocks that satisfy every such inequality are equally likely; the result is their mean and covariance. So the
    uncertainty falls with the number of times that the diode is switched, not with its root.

    Offsets are told against the reference view, and are known but for whole periods of the diode: of those the smallest. Rates
    are told against the diode.

    Arguments:
        time_marker: (time, view), 1 where the diode is on, 0 where it is off, NaN where the view has no frame.
        frequency: at which it blinks, Hz.
        duty: the part of each period in which it is on.
        drift: standard deviation of the clocks' rates, as far as it is known beforehand.
        reference: the view whose offset is 0; the first, if omitted.

    Returns:
        The clocks (see `clocks`), with `slack` (view), s: by how much the readings contradict every steady clock. A view that
        never sees the diode switch is not determined.

    Raises CrashkitError where the frames are too far apart to see the diode blink, where they contradict its frequency, and
    where the reference never sees it switch.
    """
    stamps, names = time_marker["time"].values, [str(name) for name in time_marker["view"].values]
    states = time_marker.transpose("view", "time").values.astype(float)
    epoch, period = float(0.5 * (stamps[0] + stamps[-1])), 1.0 / frequency
    found = []
    for name, state in zip(names, states, strict=True):
        seen = np.isfinite(state)
        _refuse_slow(name, stamps[seen], period * min(duty, 1.0 - duty))
        found.append(_clock(name, _switches(stamps[seen], state[seen], frequency, duty), epoch, drift))
    first = names.index(reference or names[0])
    if not np.isfinite(found[first].mean[0]):
        raise CrashkitError(f"{names[first]}: expected a reference that sees the diode switch, found none")
    means, covariances = np.array([one.mean for one in found]), np.array([one.covariance for one in found])
    offset = means[:, 0] - means[first, 0]
    covariances[:, 0, 0] += covariances[first, 0, 0]
    covariances[first, 0, :] = covariances[first, :, 0] = 0.0
    about = {"reference": names[first], "known_but_for": f"whole multiples of {period:g} s"}
    result = clocks(names, offset - period * np.round(offset / period), means[:, 1], covariances, epoch, **about)
    return result.assign(slack=("view", [one.slack for one in found], {"units": "s"}))


def _switches(stamps: np.ndarray, state: np.ndarray, frequency: float, duty: float) -> np.ndarray:
    """When the diode was switched, on its own clock, and the stamps of the frames before and after, (switch, 3), s."""
    before = np.flatnonzero(np.diff(state))
    early, late = stamps[before], stamps[before + 1]
    phase = np.where(state[before] == 0.0, 0.0, duty)
    middle = 0.5 * frequency * (early + late)
    period = np.round(middle - phase - (middle[:1] - phase[:1]))
    return np.stack([(period + phase) / frequency, early, late], axis=1)


def _clock(name: str, switches: np.ndarray, epoch: float, drift: float) -> _Clock:
    """All clocks that are consistent with a view's switches."""
    if len(switches) == 0:
        return _Clock(np.array([np.nan, 0.0]), np.diag([np.inf, drift**2]), 0.0)
    time, early, late = switches.T
    frame, reach, most = np.max(late - early), np.max(np.abs(switches[:, 1:] - epoch)), np.sqrt(3.0) * drift
    unit = np.array([frame, frame / reach])
    normals = np.stack([np.repeat([-1.0, 1.0], len(time)), np.append(epoch - early, late - epoch)], axis=1) * unit
    middle = np.mean(0.5 * (early + late) - time)
    limits = np.append(time - early + middle, late - time - middle)
    slack = _slack(normals, limits, most / unit[1])
    if slack > frame:
        raise CrashkitError(f"{name}: expected a diode of the given frequency, found readings {slack:.2g} s away from it")
    width = 1.0 + 2.0 * slack / frame + 2.0 * most * reach / frame
    polygon = np.array([[-width, -1.0], [width, -1.0], [width, 1.0], [-width, 1.0]]) * [1.0, most / unit[1]]
    for normal, limit in zip(normals, limits + 2.0 * slack, strict=True):
        polygon = cut(polygon, normal, limit)
    mean, covariance = moments(polygon)
    return _Clock(mean * unit + [middle, 0.0], covariance * np.outer(unit, unit), slack)


def _slack(normals: np.ndarray, limits: np.ndarray, most: float) -> float:
    """The least number that makes all inequalities hold when added to the limits, 0 if they do; Chebyshev's solution, s."""
    columns = np.column_stack([normals, -np.ones(len(limits))])
    found = linprog([0.0, 0.0, 1.0], columns, limits, bounds=[(None, None), (-most, most), (0.0, None)])
    return float(found.x[2])


def _refuse_slow(name: str, stamps: np.ndarray, shortest: float) -> None:
    longest = np.max(np.diff(stamps), initial=0.0)
    if longest >= shortest:
        raise CrashkitError(
            f"{name}: expected frames less than {shortest:.3g} s apart, to see the diode both on and off in each period, "
            f"found {longest:.3g} s"
        )
