"""From what sensors feel to what they record, and back to the bodies."""

import numpy as np
import xarray as xr

from crashkit.data.instrument_errors import error_values, positions, prediction_coordinates
from crashkit.data.schema import Attribute
from crashkit.errors import CrashkitError
from crashkit.protocols import Observer, SensorErrors
from crashkit_accelerometers.chain import Chain, Own
from crashkit_accelerometers.error_specs import AXES
from crashkit_accelerometers.sampling import Felt
from crashkit_accelerometers.sensing import directions

DIMS = ("time", "sensor", "axis")
CHANNEL_FREQUENCY_CLASS = Attribute(
    "channel_frequency_class", "SAE J211 class that the channels are filtered to, 0 for unfiltered", (0, 60, 180, 600, 1000)
)


def own_errors(observer: Observer, instrument: xr.Dataset, errors: SensorErrors | None) -> Own:
    """Every error parameter as one value for each channel, (sensor, axis)."""
    sensors, axes = (instrument.variables[dim].values.tolist() for dim in DIMS[1:])
    return error_values(observer, sensors, axes, errors)


def bodies_of(observer: Observer, motion: xr.Dataset, instrument: xr.Dataset) -> np.ndarray:
    """The index in the motion of each sensor's body."""
    return positions(observer, motion, "body", instrument.variables["sensor_body"].values.tolist())


def felt_in_laboratory(observer: Observer, motion: xr.Dataset, name: str, rows: np.ndarray) -> Felt:
    """A quantity of the bodies as it is, along the axes of the laboratory; raises CrashkitError where the motion lacks it."""
    if name not in motion.variables:
        raise CrashkitError(f"{observer.name}: expected a motion with {name}, found none")
    sensitivity = motion.variables.get(f"{name}_sensitivity")
    values = motion.variables[name].values
    axes = tuple(motion.variables["axis"].values.tolist())
    changes = None if sensitivity is None else sensitivity.values
    return Felt(motion.variables["time"].values, values, changes, None, rows, axes)


def predict_channels(observer: Observer, motion: xr.Dataset, instrument: xr.Dataset, own: Own, felt: Felt) -> xr.Dataset:
    """What the sensors record of what they feel.

    Arguments:
        observer: with the errors of `channel_errors`.
        motion: for its axes and the names of its parameters.
        instrument: with the time stamps, the axes and the attribute `channel_frequency_class`.
        own: error parameters, (sensor, axis).
        felt: without errors.

    Returns:
        The dataset that `Observer.predict` describes.
    """
    axes = instrument.variables["axis"].values.tolist()
    positions(observer, motion, "axis", axes)
    times = instrument.variables["time"].values
    at = times * (1.0 - own["clock_rate"][0, 0]) - own["clock_offset"][0, 0]
    known = felt.known(at)
    half = 0.5 * (times[-1] - times[0]) / max(len(times) - 1, 1)
    value, errors, model = _sensed(felt, own, tuple(axes), at[known], times[known], half)
    chain = Chain(value, errors, model, {name: values.ravel() for name, values in own.items()}, times[known])
    if len(value):
        chain.run(int(instrument.attrs.get("channel_frequency_class", 0)))
    variables = _variables(observer, instrument, chain, known, own["gain"].shape)
    return xr.Dataset(variables, prediction_coordinates(observer, motion, instrument))


def _sensed(
    felt: Felt, own: Own, axes: tuple[str, ...], at: np.ndarray, stamps: np.ndarray, half: float
) -> tuple[np.ndarray, dict[str, np.ndarray], np.ndarray | None]:
    """Along the sensing directions at the times `at`: the values, and their derivatives as `Chain` takes them."""
    mixing, by_direction = directions(own, axes, felt.axes)
    value = felt.sampled(felt.values, mixing, at)[..., 0]
    later = np.minimum(at + half, felt.times[-1])  # a rate over one sample's width: it jumps at the nodes
    rise = felt.sampled(felt.values, mixing, later) - felt.sampled(felt.values, mixing, at - half)
    lateness = rise[..., 0] / (at - half - later)[:, None]
    errors = {"clock_offset": lateness, "clock_rate": stamps[:, None] * lateness}
    errors |= {name: felt.sampled(felt.values, change, at)[..., 0] for name, change in by_direction.items()}
    if felt.by_point is not None:
        by_point = felt.sampled(felt.by_point, mixing, at)
        errors |= {f"position_{axis}": by_point[..., index] for index, axis in enumerate(AXES)}
    model = None if felt.sensitivity is None else felt.sampled(felt.sensitivity, mixing, at)
    return value, errors, model


def _variables(
    observer: Observer, instrument: xr.Dataset, chain: Chain, known: slice, channels: tuple[int, int]
) -> dict[str, xr.Variable]:
    """In the form of the recording; NaN at the time stamps that the motion does not tell of."""
    quantity, names = observer.quantity, [spec.name for spec in observer.errors]
    stamps = instrument.sizes["time"]
    errors = np.zeros((len(names), stamps, *channels))
    for name, column in chain.errors.items():
        errors[names.index(name), known] = column.reshape(-1, *channels)
    units = instrument.variables[quantity].attrs.get("units", "")
    variables = {
        quantity: xr.Variable(DIMS, _padded(chain.value, known, stamps, channels), {"units": units}),
        f"{quantity}_error_sensitivity": xr.Variable((*DIMS, "error"), np.moveaxis(errors, 0, -1)),
    }
    if chain.model is not None:
        model = _padded(chain.model, known, stamps, (*channels, chain.model.shape[2]))
        variables[f"{quantity}_sensitivity"] = xr.Variable((*DIMS, "parameter"), model)
    return variables


def _padded(columns: np.ndarray, known: slice, stamps: int, shape: tuple[int, ...]) -> np.ndarray:
    if len(columns) == stamps:
        return columns.reshape(stamps, *shape)
    padded = np.full((stamps, *shape), np.nan)
    padded[known] = columns.reshape(-1, *shape)
    return padded


def reconstruct_bodies(observer: Observer, instrument: xr.Dataset, variable: str) -> xr.Dataset:
    """The recorded quantity by body, `variable` (time, body, axis): the mean of the sensors on it, NaN where one has a gap.

    With `<variable>_std` (body), if the standard deviations of the sensors are stated.
    """
    carriers = instrument["sensor_body"].values
    bodies = list(dict.fromkeys(carriers.tolist()))
    recorded = instrument[observer.quantity].transpose(*DIMS)
    means = np.stack([recorded.values[:, carriers == body].mean(axis=1) for body in bodies], axis=1)
    attrs = {"units": recorded.attrs.get("units", "")}
    variables = {variable: xr.Variable(("time", "body", "axis"), means, attrs)}
    if f"{observer.quantity}_std" in instrument:
        variance = instrument[f"{observer.quantity}_std"].values ** 2
        stds = [np.sqrt(variance[carriers == body].sum()) / np.sum(carriers == body) for body in bodies]
        variables[f"{variable}_std"] = xr.Variable("body", stds, attrs)
    return xr.Dataset(variables, {"time": instrument["time"], "body": bodies, "axis": instrument["axis"]})
