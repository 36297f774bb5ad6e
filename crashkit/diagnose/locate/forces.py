"""The missing force: what the recordings say that the model's joints do not."""

from itertools import product

import numpy as np
import xarray as xr

from crashkit.mechanics.along import forces_along
from crashkit.mechanics.joint_track import in_space
from crashkit.mechanics.state_form import given_loads
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Laws, Smoother

BIN = 1e-3
"""s; forces are averaged over this long, which is short against a crash and long against the noise."""

ACROSS = 0.05
"""Part of a direction along an axis below which a force along that axis need not be known."""


def recorded_motion(misfit: Misfit, run: str, simulated: xr.Dataset, smoother: Smoother) -> xr.Dataset:
    """A fitted simulation with the accelerations that the instruments of the run saw.

    They come from accelerometers, else from film through the smoother. Positions and velocities stay those of the simulation,
    which agrees with all instruments: accelerations drift by centimetres when integrated twice, and a joint that unloads makes
    hundreds of kilonewtons of these. The variable `observed` (body, axis) says what an instrument saw.
    """
    acceleration = simulated["acceleration"].copy(deep=True)
    observed = xr.zeros_like(acceleration.isel(time=0, drop=True), dtype=bool)
    for group in [g for g in misfit.groups if g.run == run and g.observer.quantity in ("position", "acceleration")]:
        seen = group.motion()
        if seen is None:
            continue
        for body, axis in product(seen["body"].values, seen["axis"].values):
            at = {"body": body, "axis": axis}
            if group.observer.quantity == "acceleration":
                acceleration.loc[at] = _interpolated(seen["acceleration"].sel(at), acceleration["time"].values)
            elif not observed.loc[at]:
                smooth = smoother.smooth(seen["position"].sel(at, drop=True))
                acceleration.loc[at] = np.interp(acceleration["time"], smooth["time"], smooth["second_derivative"])
            observed.loc[at] = True
    return simulated.assign(acceleration=acceleration, observed=observed)


def missing_force(model: Model, laws: Laws, motion: xr.Dataset) -> xr.DataArray:
    """What each body's motion asks of forces beyond those of the model: m (a - g) - Σ F(d, ddot) - what is given.

    Returns:
        (time, body, axis), N; NaN where that is not observed.
    """
    own = motion.sel(body=[body.name for body in model.bodies])
    mass = np.array([body.mass.value if body.mass and body.is_free else np.nan for body in model.bodies])
    fall = in_space(model.axes, model.gravity or (0.0,) * len(model.axes))
    given = given_loads(model, motion, 1 if len(model.axes) == 1 else 6)[:, :, :3]
    known = forces_along(model, laws, motion)["contact_force"] + given
    return ((own["acceleration"] - fall) * mass[:, None] - known).where(own["observed"])


def on_joint(missing: xr.DataArray, bodies: tuple[str, str], direction: np.ndarray) -> np.ndarray:
    """The force, compression positive, that a joint would have to add; (time,), N.

    Each moving and observed end gives an estimate; their mean is taken.

    Arguments:
        bodies: that it pushes.
        direction: (time, axis), in which it pushes the second.
    """
    ends = [(name, sign * direction) for name, sign in zip(bodies, (-1.0, 1.0), strict=True) if name in missing["body"]]
    stack = np.array([_along(missing.sel(body=name).values, push) for name, push in ends])
    seen = np.isfinite(stack)
    return np.where(seen.any(axis=0), np.where(seen, stack, 0.0).sum(axis=0) / np.maximum(seen.sum(axis=0), 1), np.nan)


def _along(force: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """A force (time, axis) along a direction; what is not known of it does not count where that is across."""
    across = np.isnan(force) & (np.abs(direction) < ACROSS)
    return np.where(across, 0.0, force * direction).sum(axis=1)


def binned(times: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Means over bins, with the standard deviation of each mean: (bin,) times, means and deviations."""
    index = np.floor((times - times[0]) / BIN + 1e-9).astype(int)
    count = np.bincount(index)
    keep = count > 0

    def mean(of: np.ndarray) -> np.ndarray:
        return np.bincount(index, of)[keep] / count[keep]

    centre = mean(values)
    spread = np.sqrt(np.maximum(mean(values**2) - centre**2, 0.0) / np.maximum(count[keep] - 1, 1))
    return mean(times), centre, spread


def _interpolated(acceleration: xr.DataArray, times: np.ndarray) -> np.ndarray:
    known = acceleration.dropna("time")
    return np.interp(times, known["time"].values, known.values)
