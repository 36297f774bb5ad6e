"""From what sensors feel to what they record, and back to the bodies."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import xarray as xr
from attrs import evolve, frozen
from xarray.core.indexing import LazilyIndexedArray

from crashkit.data.channel_filter import frequency_class, since_contact
from crashkit.data.instrument_errors import coordinates, error_values, positions, prediction_coordinates, true_times
from crashkit.errors import CrashkitError
from crashkit.protocols import Misread, Observer, Reading, SensorErrors, Shown
from crashkit_accelerometers.chain import Chain, Own
from crashkit_accelerometers.error_specs import AXES
from crashkit_accelerometers.lazy import Lazy
from crashkit_accelerometers.sampling import Felt
from crashkit_accelerometers.sensing import directions

DIMS = ("time", "sensor", "axis")


def own_errors(observer: Observer, instrument: xr.Dataset, errors: SensorErrors | None) -> Own:
    """Every error parameter as one value for each channel, (sensor, axis)."""
    sensors, axes = coordinates(instrument, DIMS[1:])
    return error_values(observer, sensors.tolist(), axes.tolist(), errors)


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


def plain_reading(instrument: xr.Dataset, quantity: str) -> Reading:
    """A quantity of the sensors' bodies, as it is."""
    axes = instrument.variables["axis"].values.tolist()
    carriers = instrument.variables["sensor_body"].values.tolist()
    bodies = tuple(body for body in carriers for _ in axes)
    return Reading(quantity, bodies, tuple(axes) * len(carriers), np.zeros(len(bodies)))


def predict_channels(observer: Observer, motion: xr.Dataset, instrument: xr.Dataset, own: Own, felt: Felt) -> xr.Dataset:
    """What the sensors record of what they feel.

    Arguments:
        observer: with the errors of `channel_errors`.
        motion: for its axes and the names of its parameters.
        instrument: with the time stamps, the axes and the attribute `channel_frequency_class`.
        own: error parameters, (sensor, axis).
        felt: without errors.

    Returns:
        The dataset that `Observer.predict` describes; derivatives to errors are computed only if they are looked at.
    """
    times, axes = coordinates(instrument, ("time", "axis"))
    channels = Channels(felt, own, tuple(axes.tolist()), times, frequency_class(instrument))
    positions(observer, motion, "axis", channels.axes)
    read = channels.misread(())
    quantity, names = observer.quantity, tuple(spec.name for spec in observer.errors)
    errors = Lazy((*read.value.shape, len(names)), partial(channels.by_errors, names))
    units = instrument.variables[quantity].attrs.get("units", "")
    variables = {
        quantity: xr.Variable(DIMS, read.value, {"units": units}),
        f"{quantity}_error_sensitivity": xr.Variable((*DIMS, "error"), LazilyIndexedArray(errors)),
    }
    if read.slope is not None:
        variables[f"{quantity}_sensitivity"] = xr.Variable((*DIMS, "parameter"), read.slope)
    return xr.Dataset(variables, prediction_coordinates(observer, motion, instrument))


def misread_channels(
    observer: Observer, shown: Shown, instrument: xr.Dataset, errors: SensorErrors, wanted: Sequence[str]
) -> Misread:
    """What sensors record, as `PlainObserver.misread` says."""
    times, sensors, axes = coordinates(instrument, DIMS)
    names = tuple(axes.tolist())
    own = error_values(observer, sensors.tolist(), names, errors)
    value = shown.value.reshape(-1, *own["gain"].shape)
    slope = None if shown.slope is None else shown.slope.reshape(*value.shape, -1)
    felt = Felt(shown.times, value, slope, None, np.arange(value.shape[1]), names)
    return Channels(felt, own, names, times, frequency_class(instrument)).misread(tuple(wanted))


@frozen(eq=False)
class Channels:
    """The channels of an instrument: their readings, and the derivatives of these.

    Arguments:
        felt: by sensors without errors.
        own: error parameters, (sensor, axis).
        axes: of the channels.
        times: s, time stamps.
        channel_frequency_class: of the filter.
    """

    felt: Felt
    own: Own
    axes: tuple[str, ...]
    times: np.ndarray
    channel_frequency_class: int

    def misread(self, names: tuple[str, ...]) -> Misread:
        """The readings and their derivatives, also to these errors; NaN where the motion does not tell of them."""
        felt, (at, stamps, known) = self.felt, self._at()
        mixing, by_direction = directions(self.own, self.axes, felt.axes)
        value = felt.sampled(felt.values, mixing, at)[..., 0]
        model = None if felt.sensitivity is None else felt.sampled(felt.sensitivity, mixing, at)
        errors = self._errors(names, mixing, by_direction, at, stamps) if names else None
        chain = Chain(value, errors, model, {name: values.ravel() for name, values in self.own.items()}, stamps, names)
        if len(value):
            chain.run(self.channel_frequency_class)
        slope = None if chain.model is None else self._padded(chain.model, known)
        return Misread(self._padded(chain.value, known), slope, self._table(names, chain.errors or {}, known))

    def by_errors(self, names: tuple[str, ...]) -> np.ndarray:
        """The derivatives to these errors alone, (time, sensor, axis, error)."""
        return evolve(self, felt=evolve(self.felt, sensitivity=None)).misread(names).by_error

    def _at(self) -> tuple[np.ndarray, np.ndarray, slice]:
        """When the samples were taken of which the motion tells, their stamps, and which they are.

        A record that begins after contact is preceded by the samples that it lacks, which filters and mounts remember.
        """
        at = true_times(self.times, self.own)
        known = self.felt.known(at)
        at, stamps = at[known], self.times[known]
        lacking = since_contact(at)
        if not len(lacking):
            return at, stamps, known
        pace = np.ptp(stamps) / np.ptp(at)
        return np.concatenate([lacking, at]), np.concatenate([stamps[:1] + pace * (lacking - at[:1]), stamps]), known

    def _errors(
        self, names: tuple[str, ...], mixing: np.ndarray, by_direction: Own, at: np.ndarray, stamps: np.ndarray
    ) -> dict[str, np.ndarray]:
        """What those of these errors that act before the chain change, (time, channel)."""
        felt = self.felt
        errors = {n: felt.sampled(felt.values, change, at)[..., 0] for n, change in by_direction.items() if n in names}
        if "clock_offset" in names or "clock_rate" in names:
            lateness = self._lateness(mixing, at)
            errors |= {"clock_offset": lateness, "clock_rate": stamps[:, None] * lateness}
        if felt.by_point is not None:
            by_point = felt.sampled(felt.by_point, mixing, at)
            errors |= {f"position_{axis}": by_point[..., index] for index, axis in enumerate(AXES)}
        return {name: column for name, column in errors.items() if name in names}

    def _lateness(self, mixing: np.ndarray, at: np.ndarray) -> np.ndarray:
        """What a later clock changes: minus the rate, over one sample's width, as it jumps at the nodes."""
        half = 0.5 * (self.times[-1] - self.times[0]) / max(len(self.times) - 1, 1)
        felt, later = self.felt, np.minimum(at + half, self.felt.times[-1])
        rise = felt.sampled(felt.values, mixing, later) - felt.sampled(felt.values, mixing, at - half)
        return np.asarray(rise[..., 0] / (at - half - later)[:, None])

    def _padded(self, columns: np.ndarray, known: slice) -> np.ndarray:
        """The columns of the samples that are known, without those before them, and NaN for the others."""
        shape = *self.own["gain"].shape, *columns.shape[2:]
        count = known.stop - known.start
        told = columns[len(columns) - count :].reshape(count, *shape)
        if count == len(self.times):
            return told
        padded = np.full((len(self.times), *shape), np.nan)
        padded[known] = told
        return padded

    def _table(self, names: tuple[str, ...], errors: Mapping[str, np.ndarray], known: slice) -> np.ndarray:
        """The derivatives to these errors, 0 where the motion does not tell of them, (time, sensor, axis, error)."""
        table = np.zeros((len(self.times), *self.own["gain"].shape, len(names)))
        for name, column in errors.items():
            own = table[known, ..., names.index(name)]
            own[...] = column[len(column) - len(own) :].reshape(own.shape)
        return table


def reconstruct_bodies(observer: Observer, instrument: xr.Dataset, variable: str) -> xr.Dataset:
    """The recorded quantity by body, `variable` (time, body, axis): the mean of the sensors on it, NaN where one has a gap.

    With `<variable>_std` (time, body, axis), if the standard deviations of the sensors are stated.
    """
    carriers = instrument["sensor_body"].values
    bodies = list(dict.fromkeys(carriers.tolist()))
    recorded = instrument[observer.quantity].transpose(*DIMS)
    means = np.stack([recorded.values[:, carriers == body].mean(axis=1) for body in bodies], axis=1)
    dims, attrs = ("time", "body", "axis"), {"units": recorded.attrs.get("units", "")}
    variables = {variable: xr.Variable(dims, means, attrs)}
    if f"{observer.quantity}_std" in instrument:
        variance = instrument[f"{observer.quantity}_std"].values ** 2
        stds = np.array([np.sqrt(variance[carriers == body].sum()) / np.sum(carriers == body) for body in bodies])
        variables[f"{variable}_std"] = xr.Variable(dims, np.where(np.isnan(means), np.nan, stds[:, None]), attrs)
    return xr.Dataset(variables, {"time": instrument["time"], "body": bodies, "axis": instrument["axis"]})
