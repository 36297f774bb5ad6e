"""The recorded channels of a test, each with its noise, lined up in one residual vector."""

from collections.abc import Iterator, Mapping

import numpy as np
import xarray as xr
from attrs import evolve, frozen

from crashkit.data.channel_filter import frequency_class
from crashkit.data.filter_ends import unsettled
from crashkit.errors import CrashkitError, claimed_twice
from crashkit.misfit.noise import HALF, Noise, as_heard, channel_noise, filtered_std
from crashkit.model import Model
from crashkit.protocols import Observer

TENTH = 0.1
"""Of what a model leaves of a channel: what it lacks may be the rest."""
RESOLUTION = 1e-3
"""Of a channel's largest reading: what recorders tell, and more than the integration is off."""


@frozen
class Channel:
    """One recorded channel: one axis of one sensor or marker of one instrument in one run.

    Attributes:
        label: its sensor, followed by `/axis` where that has several.
    """

    run: str
    instrument: str
    sensor: str
    axis: str
    label: str
    noise: Noise
    samples: int

    @property
    def name(self) -> str:
        """`run/instrument/label`."""
        return f"{self.run}/{self.instrument}/{self.label}"

    @property
    def independent_samples(self) -> float:
        """How many independent readings the samples amount to."""
        return self.samples / self.noise.correlation


@frozen(eq=False)
class Group:
    """One instrument of one run, with its samples as (time, column) and one column for each channel."""

    run: str
    name: str
    observer: Observer
    dataset: xr.Dataset
    times: np.ndarray
    recorded: np.ndarray
    channels: tuple[Channel, ...]

    def without(self, sensor: str) -> "Group":
        """The same as if a sensor had recorded nothing."""
        hidden = [channel.sensor == sensor for channel in self.channels]
        channels = (evolve(one, samples=0) if gone else one for one, gone in zip(self.channels, hidden, strict=True))
        return evolve(self, recorded=np.where(hidden, np.nan, self.recorded), channels=tuple(channels))

    def curves(self, **more: np.ndarray) -> xr.Dataset:
        """What was recorded beside `more` (time, channel) of the same, by channel and in the instrument's unit, with the `std`
        (channel) of its noise."""
        units = str(self.dataset[self.observer.quantity].attrs.get("units", ""))
        stds = "channel", [channel.noise.std for channel in self.channels]
        curves = {name: (("time", "channel"), values) for name, values in {"recorded": self.recorded, **more}.items()}
        return xr.Dataset(
            {name: (*curve, {"units": units}) for name, curve in {**curves, "std": stds}.items()},
            {"time": ("time", self.times, {"units": "s"}), "channel": [channel.label for channel in self.channels]},
            {"quantity": self.observer.quantity, "units": units},
        )

    def motion(self) -> xr.Dataset | None:
        """Of the bodies that it watches, from its readings alone; None where these do not tell all of it, as those of one
        accelerometer on a body that may turn."""
        try:
            return self.observer.reconstruct(self.dataset)
        except CrashkitError:
            return None


def groups_of(run: str, recording: xr.DataTree, observers: Mapping[str, type[Observer]], model: Model) -> Iterator[Group]:
    """The instruments of a recording that watch the model's bodies; of those on a line, along that line.

    Raises:
        CrashkitError: an observer is not installed, a sensor sits on a body that the model does not have, or an instrument
            has none of the model's axes.
    """
    bodies = frozenset(body.name for body in model.bodies)
    for name, node in recording.children.items():
        if "observer" not in node.attrs:
            continue
        kind = str(node.attrs["observer"])
        if kind not in observers:
            found = f"{kind}{claimed_twice(kind, observers)}"
            raise CrashkitError(
                f"{run}: {name}: expected an installed observer ({', '.join(sorted(observers))}), found {found}"
            )
        observer = observers[kind]()
        dataset = _along(run, name, observer, node.to_dataset(inherit=False), model)
        yield _group(run, name, observer, dataset, bodies)


def reweighted(group: Group, column: int, left: np.ndarray) -> Channel:
    """A channel of a group with its open noise level set to what a model leaves of it: `left` (time,), in its unit.

    What is left shows the noise about the filter's corner better than the readings, in which the structure moves as well.
    """
    channel, noise, present = group.channels[column], group.channels[column].noise, left[np.isfinite(left)]
    if noise.trusted or not len(present):
        return channel
    interval, filter_class = float(np.median(np.diff(group.times))), frequency_class(group.dataset)
    level = float(np.sqrt(np.mean(present**2)))
    seen = min(HALF * filtered_std(present, interval, filter_class, noise.correlation), TENTH * level)
    resolved = RESOLUTION * float(np.nanmax(np.abs(group.recorded[:, column])))
    least = min(noise.least, max(seen, resolved))
    return evolve(channel, noise=evolve(noise, std=max(least, level), least=least))


def as_heard_of(group: Group, column: int, left: np.ndarray) -> Channel:
    """A channel of a group with as much noise as a model leaves of it, where that is white and the recording states less."""
    channel = group.channels[column]
    return evolve(channel, noise=as_heard(channel.noise, left))


def _along(run: str, name: str, observer: Observer, dataset: xr.Dataset, model: Model) -> xr.Dataset:
    """What an instrument reads along a line, where bodies do not turn; as it is in several axes."""
    if len(model.axes) > 1 or "axis" not in dataset[observer.quantity].dims:
        return dataset
    known = dataset["axis"].values.tolist()
    shared = [axis for axis in known if axis in model.axes]
    if not shared:
        raise CrashkitError(f"{run}: {name}/axis: expected the model's {model.axes[0]}, found {', '.join(known)}")
    return dataset if shared == known else dataset.sel(axis=shared)


def _group(run: str, name: str, observer: Observer, dataset: xr.Dataset, bodies: frozenset[str]) -> Group:
    _check_bodies(run, name, observer, dataset, bodies)
    times = dataset["time"].values.astype(float)
    recorded = dataset[observer.quantity].transpose("time", observer.channel, "axis").values.astype(float)
    labels = [(str(sensor), str(axis)) for sensor in dataset[observer.channel].values for axis in dataset["axis"].values]
    flat = np.where(_settled(dataset, observer, times)[:, None], recorded.reshape(len(times), -1), np.nan)
    axes = len(dataset["axis"])
    noises = [_noise(dataset, observer, column, flat, times, axes) for column in range(flat.shape[1])]
    channels = tuple(
        Channel(run, name, sensor, axis, sensor if axes == 1 else f"{sensor}/{axis}", noise, _count(flat, column))
        for column, ((sensor, axis), noise) in enumerate(zip(labels, noises, strict=True))
    )
    return Group(run, name, observer, dataset, times, flat, channels)


def _settled(dataset: xr.Dataset, observer: Observer, times: np.ndarray) -> np.ndarray:
    """Which samples the filter of an instrument has not made up."""
    ends = unsettled(dataset, observer.quantity)
    return (times >= times[0] + ends) & (times <= times[-1] - ends) if ends else np.ones(len(times), dtype=bool)


def _noise(dataset: xr.Dataset, observer: Observer, column: int, flat: np.ndarray, times: np.ndarray, axes: int) -> Noise:
    return channel_noise(dataset, observer.quantity, column // axes, flat[:, column], times)


def _count(flat: np.ndarray, column: int) -> int:
    return int(np.isfinite(flat[:, column]).sum())


def _check_bodies(run: str, name: str, observer: Observer, dataset: xr.Dataset, bodies: frozenset[str]) -> None:
    carriers = {str(body) for body in dataset[f"{observer.channel}_body"].values}
    unknown = sorted(carriers - bodies)
    if unknown:
        variable = f"{name}/{observer.channel}_body"
        raise CrashkitError(
            f"{run}: {variable}: expected a body of the model ({', '.join(sorted(bodies))}), found {unknown[0]}"
        )
