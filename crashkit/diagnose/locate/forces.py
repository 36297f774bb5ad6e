"""The missing force: what the recordings say that the model's joints do not."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from crashkit.mechanics.along import forces_along
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Smoother, SpringLaw

BIN = 1e-3
"""s; forces are averaged over this long, which is short against a crash and long against the noise."""


def recorded_motion(misfit: Misfit, run: str, simulated: xr.Dataset, smoother: Smoother) -> xr.Dataset:
    """A fitted simulation with the accelerations that the instruments of the run saw.

    They come from accelerometers, else from film through the smoother. Positions and velocities stay those of the simulation,
    which agrees with all instruments: accelerations drift by centimetres when integrated twice, and a joint that unloads makes
    hundreds of kilonewtons of these. The variable `observed` (body) says which bodies an instrument saw.
    """
    acceleration = simulated["acceleration"].copy(deep=True)
    observed = xr.zeros_like(simulated["body"], dtype=bool)
    for group in [g for g in misfit.groups if g.run == run and g.observer.quantity in ("position", "acceleration")]:
        seen = group.motion()
        if seen is None:
            continue
        for body in seen["body"].values:
            at = {"body": body, "axis": acceleration["axis"].values[0]}
            if group.observer.quantity == "acceleration":
                acceleration.loc[at] = _interpolated(seen["acceleration"].sel(body=body), acceleration["time"].values)
            elif not observed.sel(body=body):
                smooth = smoother.smooth(seen["position"].sel(body=body).isel(axis=0, drop=True))
                acceleration.loc[at] = np.interp(acceleration["time"], smooth["time"], smooth["second_derivative"])
            observed.loc[{"body": body}] = True
    return simulated.assign(acceleration=acceleration, observed=observed)


def missing_force(model: Model, laws: Mapping[str, type[SpringLaw]], motion: xr.Dataset) -> xr.Dataset:
    """What each body's motion asks of forces beyond those of the model's joints: m a - Σ F(d, ddot).

    Returns:
        Dataset with `missing_force` (time, body), N, in the direction of the axis; NaN for bodies that are not observed.
    """
    joints = forces_along(model, laws, motion)
    mass = np.array([np.nan if b.mass is None else b.mass.value for b in model.bodies])
    inertia = mass * motion["acceleration"].sel(body=[b.name for b in model.bodies]).isel(axis=0).values
    missing = inertia - joints["contact_force"].isel(axis=0).values
    missing = np.where(motion["observed"].sel(body=[b.name for b in model.bodies]).values, missing, np.nan)
    return xr.Dataset(
        {"missing_force": (("time", "body"), missing, {"units": "N"})},
        coords={"time": motion["time"], "body": [b.name for b in model.bodies]},
    )


def on_joint(missing: xr.Dataset, model: Model, bodies: tuple[str, str]) -> np.ndarray:
    """The force, compression positive, that a joint between two bodies would have to add; (time,), N.

    Each moving and observed end gives an estimate; their mean is taken.
    """
    first, second = (model.body(name) for name in bodies)
    direction = 1.0 if second.position[0] >= first.position[0] else -1.0
    ends = [-direction * missing["missing_force"].sel(body=first.name).values] if not first.fixed else []
    ends += [direction * missing["missing_force"].sel(body=second.name).values] if not second.fixed else []
    stack = np.array(ends)
    seen = np.isfinite(stack)
    return np.where(seen.any(axis=0), np.where(seen, stack, 0.0).sum(axis=0) / np.maximum(seen.sum(axis=0), 1), np.nan)


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
    known = acceleration.isel(axis=0).dropna("time")
    return np.interp(times, known["time"].values, known.values)
