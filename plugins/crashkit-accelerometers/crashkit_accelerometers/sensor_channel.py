"""From a quantity of the bodies to the recorded channels of sensors: interpolation, the sensors' errors, the channel's filter."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from crashkit.data.channel_filter import filter_channel
from crashkit.data.schema import Attribute
from crashkit.errors import CrashkitError
from crashkit.protocols import Observer, ParameterSpec, SensorErrors

DIMS = ("time", "sensor", "axis")
CHANNEL_FREQUENCY_CLASS = Attribute(
    "channel_frequency_class", "SAE J211 class that the channels are filtered to, 0 for unfiltered", (0, 60, 180, 600, 1000)
)


def channel_errors(unit: str) -> tuple[ParameterSpec, ...]:
    """The error parameters of a channel recorded in `unit`."""
    return (
        ParameterSpec("gain", "1", "recorded per true", 0.2, 5.0, default=1.0, null=1.0),
        ParameterSpec("bias", unit, "offset of the recorded values", default=0.0, null=0.0),
        ParameterSpec("clock_offset", "s", "how late the time stamps are", -0.05, 0.05, default=0.0, null=0.0),
    )


def predict_channels(
    observer: Observer, motion: xr.Dataset, variable: str, instrument: xr.Dataset, errors: SensorErrors | None
) -> xr.Dataset:
    """What the sensors record of a variable of the motion: filter(gain q(t - clock_offset) + bias).

    Arguments:
        observer: with the errors of `channel_errors`.
        motion: with `variable` (time, body, axis) and maybe `<variable>_sensitivity`.
        instrument: with `sensor_body`, and the attribute `channel_frequency_class`.
        errors: of the sensors.

    Returns:
        The dataset that `Observer.predict` describes.
    """
    own = error_values(observer, instrument.variables["sensor"].values.tolist(), errors)
    gain, bias = own["gain"][:, None], own["bias"][:, None]
    times = instrument.variables["time"].values
    nodes = motion.variables["time"].values
    at = times - own["clock_offset"][0]
    seen = _seen(nodes, at)
    cfc = int(instrument.attrs.get("channel_frequency_class", 0))

    def record(samples: np.ndarray) -> np.ndarray:
        recorded = np.full((len(times), *samples.shape[1:]), np.nan)
        recorded[seen] = filter_channel(samples, times[seen], cfc, before=0.0)
        return recorded

    truth = _sensor_variable(observer, motion, variable, instrument)
    unscaled = record(sample(nodes, truth, at[seen]))
    rate = record(slope(nodes, truth, at[seen], times))
    derivatives = np.stack([unscaled, np.ones_like(unscaled), -gain * rate], axis=-1)
    units = instrument.variables[observer.quantity].attrs.get("units", "")
    predicted = {
        observer.quantity: xr.Variable(DIMS, gain * unscaled + bias, {"units": units}),
        f"{observer.quantity}_error_sensitivity": xr.Variable((*DIMS, "error"), derivatives),
    }
    coords = {name: instrument.variables[name] for name in DIMS} | {"error": [spec.name for spec in observer.errors]}
    if f"{variable}_sensitivity" in motion.variables:
        columns = _sensor_variable(observer, motion, f"{variable}_sensitivity", instrument)
        sensitivity = gain[..., None] * record(sample(nodes, columns, at[seen]))
        predicted[f"{observer.quantity}_sensitivity"] = xr.Variable((*DIMS, "parameter"), sensitivity)
        coords["parameter"] = motion.variables["parameter"]
    return xr.Dataset(predicted, coords)


def reconstruct_bodies(observer: Observer, instrument: xr.Dataset, variable: str) -> xr.Dataset:
    """The recorded quantity by body, `variable` (time, body, axis): the mean of the sensors on it, NaN where one has a gap."""
    carriers = instrument["sensor_body"].values
    bodies = list(dict.fromkeys(carriers.tolist()))
    recorded = instrument[observer.quantity].transpose(*DIMS)
    means = np.stack([recorded.values[:, carriers == body].mean(axis=1) for body in bodies], axis=1)
    attrs = {"units": recorded.attrs.get("units", "")}
    coords = {"time": instrument["time"], "body": bodies, "axis": instrument["axis"]}
    return xr.Dataset({variable: (("time", "body", "axis"), means, attrs)}, coords)


def error_values(observer: Observer, sensors: Sequence[str], errors: SensorErrors | None) -> dict[str, np.ndarray]:
    """Every error parameter of the observer as one value for each sensor.

    Sensors that `errors` names and the instrument does not have are passed over: a run may lack a sensor that others have.

    Raises CrashkitError for a parameter that is not declared, or not of a single sensor.
    """
    values = {spec.name: np.full(len(sensors), spec.null) for spec in observer.errors}
    for sensor, given in (errors or {}).items():
        known = set(values) if sensor == "" else set(values) - set(observer.instrument_errors)
        rows = [row for row, name in enumerate(sensors) if sensor in ("", name)]
        for name, value in given.items():
            if name not in known:
                raise CrashkitError(f"{observer.name} {sensor!r}: expected an error of {sorted(known)}, found {name!r}")
            values[name][rows] = value
    return values


def sample(nodes: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Linear interpolation, 0 before the first node: motion is uniform before an impact.

    Arguments:
        nodes: s, (node,).
        values: (node, ...).
        at: s, (time,), none after the last node.

    Returns:
        (time, ...).
    """
    index = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    weight = (at - nodes[index]) / (nodes[index + 1] - nodes[index])
    left = values[index]
    if weight.any():
        left = left + weight.reshape(-1, *(1,) * (values.ndim - 1)) * (values[index + 1] - left)
    left[at < nodes[0]] = 0.0
    return left


def slope(nodes: np.ndarray, values: np.ndarray, at: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The rate of `sample`, over the width of one recorded sample because it jumps at the nodes."""
    half = 0.5 * (times[-1] - times[0]) / max(len(times) - 1, 1)
    later = np.minimum(at + half, nodes[-1])
    width = (later - at + half).reshape(-1, *(1,) * (values.ndim - 1))
    return (sample(nodes, values, later) - sample(nodes, values, at - half)) / width


def _seen(nodes: np.ndarray, at: np.ndarray) -> slice:
    """The time stamps that the motion tells of; before contact, at t = 0, it is uniform."""
    first = 0 if nodes[0] <= 0.0 else int(np.searchsorted(at, nodes[0], side="left"))
    return slice(first, max(first, int(np.searchsorted(at, nodes[-1], side="right"))))


def _sensor_variable(observer: Observer, motion: xr.Dataset, name: str, instrument: xr.Dataset) -> np.ndarray:
    """A variable of the motion, (time, body, axis, ...), for each sensor's body and axes: (time, sensor, axis, ...)."""
    if name not in motion.variables:
        raise CrashkitError(f"{observer.name}: expected a motion with {name}, found none")
    bodies = _rows(observer, motion, "body", instrument.variables["sensor_body"].values)
    axes = _rows(observer, motion, "axis", instrument.variables["axis"].values)
    return motion.variables[name].values[:, bodies][:, :, axes]


def _rows(observer: Observer, motion: xr.Dataset, dim: str, names: np.ndarray) -> list[int]:
    known = motion.variables[dim].values.tolist()
    missing = set(names.tolist()) - set(known)
    if missing:
        place = f"{observer.name}: expected a {dim} of the motion"
        raise CrashkitError(f"{place} ({', '.join(known)}), found {', '.join(sorted(missing))}")
    return [known.index(name) for name in names.tolist()]
