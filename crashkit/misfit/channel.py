"""The recorded channels of a test, each with its noise, lined up in one residual vector."""

from collections.abc import Iterator, Mapping

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.errors import CrashkitError
from crashkit.misfit.noise import Noise, channel_noise
from crashkit.protocols import Observer


@frozen
class Channel:
    """One recorded channel: one axis of one sensor or marker of one instrument in one run."""

    run: str
    instrument: str
    sensor: str
    axis: str
    noise: Noise
    samples: int

    @property
    def name(self) -> str:
        """`run/instrument/sensor`."""
        return f"{self.run}/{self.instrument}/{self.sensor}"

    @property
    def independent_samples(self) -> float:
        """How many independent readings the samples amount to."""
        return self.samples / self.noise.correlation


@frozen
class Group:
    """One instrument of one run, with its samples as (time, column) and one column for each channel."""

    run: str
    name: str
    observer: Observer
    dataset: xr.Dataset
    times: np.ndarray
    recorded: np.ndarray
    channels: tuple[Channel, ...]


def groups_of(
    run: str, recording: xr.DataTree, observers: Mapping[str, type[Observer]], bodies: frozenset[str]
) -> Iterator[Group]:
    """The instruments of a recording that watch the model's bodies.

    Raises:
        CrashkitError: an observer is not installed, or a sensor sits on a body that the model does not have.
    """
    for name, node in recording.children.items():
        if "observer" not in node.attrs:
            continue
        kind = str(node.attrs["observer"])
        if kind not in observers:
            raise CrashkitError(
                f"{run}: {name}: expected an installed observer ({', '.join(sorted(observers))}), found {kind}"
            )
        yield _group(run, name, observers[kind](), node.to_dataset(inherit=False), bodies)


def _group(run: str, name: str, observer: Observer, dataset: xr.Dataset, bodies: frozenset[str]) -> Group:
    _check_bodies(run, name, observer, dataset, bodies)
    times = dataset["time"].values.astype(float)
    recorded = dataset[observer.quantity].transpose("time", observer.channel, "axis").values.astype(float)
    labels = [(str(sensor), str(axis)) for sensor in dataset[observer.channel].values for axis in dataset["axis"].values]
    flat = recorded.reshape(len(times), -1)
    channels = tuple(
        Channel(
            run, name, sensor, axis, _noise(dataset, observer, column, flat, times, len(dataset["axis"])), _count(flat, column)
        )
        for column, (sensor, axis) in enumerate(labels)
    )
    return Group(run, name, observer, dataset, times, flat, channels)


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
