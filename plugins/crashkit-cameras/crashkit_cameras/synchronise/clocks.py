"""The clocks of instruments: how late and how fast their time stamps are."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from crashkit.errors import CrashkitError

DRIFT = 1e-3
"""Standard deviation of a clock's rate, as far as nothing is known of it."""
UNDETERMINED = 0.3
"""An offset whose standard deviation is this part of the range that was searched is not determined."""
SECOND, ONE = {"units": "s"}, {"units": "1"}


def clocks(
    names: Sequence[str], offset: np.ndarray, rate: np.ndarray, covariance: np.ndarray, epoch: float, **about: object
) -> xr.Dataset:
    """What is known of the clocks of several views.

    A view's time stamp s belongs to the time t = s - offset - rate (s - epoch).

    Arguments:
        names: of the views.
        offset: how late the stamps are at the epoch, (view,), s; NaN where unknown.
        rate: how much faster than time they run, (view,).
        covariance: of offset and rate, (view, 2, 2); infinite where unknown.
        epoch: s.
        about: further attributes.

    Returns:
        Dataset over `view`: `offset`, `offset_std`, s; `rate`, `rate_std`; `determined`; the attribute `epoch`.
    """
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    return xr.Dataset(
        {
            "offset": ("view", offset, SECOND),
            "offset_std": ("view", std[:, 0], SECOND),
            "rate": ("view", rate, ONE),
            "rate_std": ("view", std[:, 1], ONE),
            "determined": ("view", np.isfinite(offset)),
        },
        {"view": list(names)},
        {"epoch": epoch, **about},
    )


def settled(
    names: Sequence[str], clock: np.ndarray, covariance: np.ndarray, epoch: float, within: float, **about: object
) -> xr.Dataset:
    """The same from clocks (view, 2) of offset and rate that were searched for within a range, s.

    An offset that remains as uncertain as the range, or lies outside, is not determined.
    """
    unknown = (covariance[:, 0, 0] > (UNDETERMINED * within) ** 2) | (np.abs(clock[:, 0]) > within)
    known, certain = clock.copy(), covariance.copy()
    known[unknown, 0] = np.nan
    certain[unknown, 0, 0] = np.inf
    return clocks(names, known[:, 0], known[:, 1], certain, epoch, **about)


def corrected_time(stamps: xr.DataArray, clock: xr.Dataset) -> xr.DataArray:
    """The times that stamps belong to, t = s - offset - rate (s - epoch), in s.

    Arguments:
        stamps: (time,), s.
        clock: from a function of this package, for one view or for several.

    Returns:
        (time,), or (time, view) for several; `time` keeps the stamps.

    Raises CrashkitError where a clock could not be determined.
    """
    unknown = [str(name) for name in np.atleast_1d(clock["view"].values[~clock["determined"].values])]
    if unknown:
        raise CrashkitError(f"clock: expected one that could be determined, found {', '.join(unknown)}, which could not")
    time = stamps - clock["offset"] - clock["rate"] * (stamps - clock.attrs["epoch"])
    return time.assign_attrs(units="s")


def synchronised(instrument: xr.Dataset, clock: xr.Dataset) -> xr.Dataset:
    """An instrument with corrected time stamps; no sample is changed.

    A group with the dimension `view` gets `frame_time` (time, view), s: when each view took each frame. Any other gets the
    corrected time as its coordinate.

    Raises CrashkitError where a clock could not be determined.
    """
    if "view" in instrument.dims:
        return instrument.assign(frame_time=corrected_time(instrument["time"], clock).transpose("time", "view"))
    return instrument.assign_coords(time=("time", corrected_time(instrument["time"], clock.squeeze("view")).values, SECOND))
