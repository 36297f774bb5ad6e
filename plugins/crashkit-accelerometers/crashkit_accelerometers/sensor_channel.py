"""From a quantity of the bodies to the recorded channels of sensors: interpolation, errors, filter."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numba import njit

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
    bodies = _rows(observer, motion, "body", instrument.variables["sensor_body"].values)
    axes = _rows(observer, motion, "axis", instrument.variables["axis"].values)
    cfc = int(instrument.attrs.get("channel_frequency_class", 0))

    def truth(name: str, at: np.ndarray) -> np.ndarray:
        if name not in motion.variables:
            raise CrashkitError(f"{observer.name}: expected a motion with {name}, found none")
        return sample(nodes, motion.variables[name].values, bodies, axes, at)

    def record(samples: np.ndarray) -> np.ndarray:
        return _pad(filter_channel(samples, times[seen], cfc, before=0.0), seen, len(times))

    unscaled = record(truth(variable, at[seen]))
    half = 0.5 * (times[-1] - times[0]) / max(len(times) - 1, 1)  # a rate over one sample's width: it jumps at the nodes
    earlier, later = at[seen] - half, np.minimum(at[seen] + half, nodes[-1])
    rate = record((truth(variable, later) - truth(variable, earlier)) / (later - earlier)[:, None, None])
    derivatives = np.stack([unscaled, np.ones_like(unscaled), -gain * rate], axis=-1)
    units = instrument.variables[observer.quantity].attrs.get("units", "")
    predicted = {
        observer.quantity: xr.Variable(DIMS, gain * unscaled + bias, {"units": units}),
        f"{observer.quantity}_error_sensitivity": xr.Variable((*DIMS, "error"), derivatives),
    }
    if f"{variable}_sensitivity" in motion.variables:
        sensitivity = record(truth(f"{variable}_sensitivity", at[seen]))
        sensitivity *= gain[..., None]
        predicted[f"{observer.quantity}_sensitivity"] = xr.Variable((*DIMS, "parameter"), sensitivity)
    return xr.Dataset(predicted, _coordinates(observer, motion, instrument))


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


def sample(nodes: np.ndarray, values: np.ndarray, bodies: np.ndarray, axes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Some bodies and axes by linear interpolation, 0 before the first node: motion is uniform before an impact.

    Arguments:
        nodes: s, (node,).
        values: (node, body, axis) or (node, body, axis, parameter).
        bodies, axes: the indices to take.
        at: s, (time,), none after the last node.

    Returns:
        (time, len(bodies), len(axes)) or with a last dim (parameter).
    """
    right = np.searchsorted(nodes, at, side="right").clip(1, len(nodes) - 1)
    weight = (at - nodes[right - 1]) / (nodes[right] - nodes[right - 1])
    columns = values if values.ndim == 4 else values[..., None]
    result = _interpolate(columns, bodies, axes, right, weight)
    result[: np.searchsorted(at, nodes[0])] = 0.0
    return result.reshape(result.shape[: values.ndim])


def _seen(nodes: np.ndarray, at: np.ndarray) -> slice:
    """The time stamps that the motion tells of; before contact, at t = 0, it is uniform."""
    first = 0 if nodes[0] <= 0.0 else int(np.searchsorted(at, nodes[0], side="left"))
    return slice(first, max(first, int(np.searchsorted(at, nodes[-1], side="right"))))


def _pad(recorded: np.ndarray, seen: slice, count: int) -> np.ndarray:
    """The samples with NaN for the time stamps that the motion does not tell of."""
    if len(recorded) == count:
        return recorded
    padded = np.full((count, *recorded.shape[1:]), np.nan)
    padded[seen] = recorded
    return padded


def _rows(observer: Observer, motion: xr.Dataset, dim: str, names: np.ndarray) -> np.ndarray:
    known = motion.variables[dim].values.tolist()
    missing = set(names.tolist()) - set(known)
    if missing:
        place = f"{observer.name}: expected a {dim} of the motion"
        raise CrashkitError(f"{place} ({', '.join(known)}), found {', '.join(sorted(missing))}")
    return np.array([known.index(name) for name in names.tolist()])


def _coordinates(observer: Observer, motion: xr.Dataset, instrument: xr.Dataset) -> xr.Coordinates:
    """The coordinates of a prediction, without indexes: building those takes longer than predicting."""
    variables = {"error": xr.Variable("error", [spec.name for spec in observer.errors])}
    for source, dims in ((instrument, DIMS), (motion, ("parameter",))):
        variables |= {dim: source.variables[dim] for dim in dims if dim in source.variables}
    return xr.Coordinates(variables, indexes={})


@njit(cache=True)
def _interpolate(
    values: np.ndarray, bodies: np.ndarray, axes: np.ndarray, right: np.ndarray, weight: np.ndarray
) -> np.ndarray:  # pragma: no cover
    """Plain loops: whole-array expressions would go through memory five times."""
    result = np.empty((len(right), len(bodies), len(axes), values.shape[3]))
    for time in range(len(right)):
        for sensor in range(len(bodies)):
            for axis in range(len(axes)):
                start = values[right[time] - 1, bodies[sensor], axes[axis]]
                end = values[right[time], bodies[sensor], axes[axis]]
                for parameter in range(values.shape[3]):
                    step = end[parameter] - start[parameter]
                    result[time, sensor, axis, parameter] = start[parameter] + weight[time] * step
    return result
