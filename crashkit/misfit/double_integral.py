"""From the readings of accelerometers to what another instrument would have shown of the same body, and how sure that is."""

import numpy as np
import xarray as xr
from attrs import frozen
from scipy.interpolate import CubicSpline

from crashkit.data.channel_filter import frequency_class
from crashkit.misfit.noise import channel_noise
from crashkit.misfit.thin import search_interval
from crashkit.protocols import Observer

MODES = 12
"""Cosines of the noise: an integral over time leaves the faster ones a share of 1 / MODES^2 and less."""
ROTATION = ("orientation", "angular_velocity", "angular_acceleration")


@frozen(eq=False)
class Watcher:
    """An instrument, or those of its channels that watch one body."""

    observer: Observer
    group: xr.Dataset

    @property
    def bodies(self) -> list[str]:
        """Whom each channel watches."""
        return [str(body) for body in self.group[f"{self.observer.channel}_body"].values]

    @property
    def samples(self) -> np.ndarray:
        """Its readings, (time, column)."""
        values = self.group[self.observer.quantity].values.astype(float)
        return values.reshape(len(values), -1)

    @property
    def noise(self) -> np.ndarray:
        """The standard deviation of each column over as many samples as make one that is independent, (column,)."""
        shape = self.group[self.observer.quantity].shape[1:]
        place = list(self.group[self.observer.quantity].dims[1:]).index(self.observer.channel)
        channels = np.indices(shape)[place].ravel()
        times, samples = self.group["time"].values, self.samples
        noises = [
            channel_noise(self.group, self.observer.quantity, int(channel), samples[:, column], times)
            for column, channel in enumerate(channels)
        ]
        return np.array([noise.std * np.sqrt(noise.correlation) for noise in noises])

    def on(self, body: str) -> "Watcher":
        """The channels on one body."""
        return Watcher(self.observer, self.group.isel({self.observer.channel: [it == body for it in self.bodies]}))

    def thinned(self) -> "Watcher":
        """Fewer samples, evenly, the first and the last among them; no fewer than its filter class asks for."""
        times = self.group["time"].values
        wanted = search_interval(frequency_class(self.group))
        most = max(1, int(wanted / float(np.median(np.diff(times))) + 1e-6))
        step = max(step for step in range(1, most + 1) if (len(times) - 1) % step == 0)
        return Watcher(self.observer, self.group.isel(time=slice(None, None, step)))

    def with_samples(self, samples: np.ndarray) -> "Watcher":
        """The same instrument with other readings, (time, column)."""
        recorded = self.group.variables[self.observer.quantity]
        readings = xr.Variable(recorded.dims, samples.reshape(recorded.shape), recorded.attrs)
        return Watcher(self.observer, self.group.assign({self.observer.quantity: readings}))


@frozen(eq=False)
class Route:
    """From accelerometers on a body to what `film` would have shown of it.

    Arguments:
        film, accelerometer: their channels on the body.
        state: its `position` and `velocity` (body, axis) at t = 0, if known; else 0.
    """

    film: Watcher
    accelerometer: Watcher
    state: xr.Dataset | None

    def shown(self, samples: np.ndarray | None = None, faster: np.ndarray | float = 0.0) -> np.ndarray:
        """The film's columns, (time, column), NaN where the accelerometers do not tell.

        Arguments:
            samples: of the accelerometers, other than those recorded.
            faster: added to the velocity at t = 0, m s-1, (axis,).
        """
        source = self.accelerometer if samples is None else self.accelerometer.with_samples(samples)
        felt = source.observer.reconstruct(source.group)
        known = np.isfinite(felt["acceleration"].values).all(axis=(1, 2))
        motion = self._motion(felt if known.all() else felt.isel(time=known), faster)
        predicted = self.film.observer.predict(motion, self.film.group)[self.film.observer.quantity].values
        return np.asarray(predicted).reshape(len(predicted), -1)

    def noise(self) -> np.ndarray:
        """What a standard deviation of each cosine of the accelerometers' noise changes, (time, column, cosine).

        The cosines are slow, so that fewer samples show the same, with a noise that is less by the root of their number.
        """
        few = Route(self.film, self.accelerometer.thinned(), self.state)
        samples, base = few.accelerometer.samples, few.shown()
        count = len(samples)
        cosines = np.cos(np.pi * np.outer(np.arange(MODES), np.arange(count) + 0.5) / count)
        cosines /= np.linalg.norm(cosines, axis=1, keepdims=True)
        changes = []
        for column, std in enumerate(self.accelerometer.noise * np.sqrt(count / len(self.accelerometer.samples))):
            for cosine in cosines:
                noisy = samples.copy()
                noisy[:, column] += std * cosine
                changes.append(few.shown(noisy) - base)
        return np.stack(changes, axis=-1)

    @property
    def axes(self) -> int:
        """How many axes the body moves along."""
        return int(self.accelerometer.observer.reconstruct(self.accelerometer.group).sizes["axis"])

    def _motion(self, felt: xr.Dataset, faster: np.ndarray | float) -> xr.Dataset:
        """The double integral; before the first sample the motion is uniform."""
        times, acceleration = felt["time"].values, felt["acceleration"].values[:, 0]
        start, speed = (self._known(felt, name) for name in ("position", "velocity"))
        gained = CubicSpline(times, acceleration).antiderivative()
        velocity = speed + faster + gained(times)
        position = start + np.outer(times, speed + faster) + gained.antiderivative()(times)
        moved = {"position": position, "velocity": velocity}
        variables = {name: xr.Variable(("time", "body", "axis"), values[:, None]) for name, values in moved.items()}
        variables |= {name: felt.variables[name] for name in ("acceleration", *ROTATION) if name in felt}
        return xr.Dataset(variables, felt.coords)

    def _known(self, felt: xr.Dataset, name: str) -> np.ndarray:
        axes = felt["axis"].values
        if self.state is None:
            return np.zeros(len(axes))
        return self.state[name].sel(body=felt["body"].values[0]).reindex(axis=axes, fill_value=0.0).values
