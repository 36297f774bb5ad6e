"""The errors of sensors from a recording of a motion that is known: a sled, a drop, a reference sensor, a simulation."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from crashkit.data.channel_filter import correlation_samples, frequency_class
from crashkit.errors import CrashkitError
from crashkit.protocols import Observer, ParameterSpec, SensorErrors


class Calibration:
    """A problem for any identifier: which errors make the instrument record what it recorded?

    Its parameters are named "head.gain", "head/y.bias" for one axis of a sensor, and ".clock_offset" for the whole instrument.

    Arguments:
        observer: the instrument's, with the dims (time, channel, axis).
        motion: what the instrument saw, without sensitivities.
        instrument: the recording, with `<quantity>_std`.
        free: the errors to be found, by sensor; they start from their null.
        known: errors that are known.
    """

    def __init__(
        self,
        observer: Observer,
        motion: xr.Dataset,
        instrument: xr.Dataset,
        free: Mapping[str, Sequence[str]],
        known: SensorErrors | None = None,
    ) -> None:
        self.observer, self.motion, self.instrument = observer, motion, instrument
        self._places = [(place, name) for place, names in free.items() for name in names]
        self.names = tuple(f"{place}.{name}" for place, name in self._places)
        self._specs = [_spec(observer, name) for _, name in self._places]
        self._log = np.array([spec.lower > 0.0 for spec in self._specs], dtype=bool)
        self._known = {place: dict(given) for place, given in (known or {}).items()}
        self._recorded = instrument[observer.quantity].values
        self._seen = np.isfinite(self._recorded)
        self._weight = _weight(observer, instrument)

    def start(self) -> np.ndarray:
        """The known value of every error, else its null, as search variables."""
        values = [self._known.get(place, {}).get(name, spec.null) for (place, name), spec in self._entries()]
        return self._scaled(np.array(values, dtype=float))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds of the search variables."""
        lower, upper = ([getattr(spec, side) for spec in self._specs] for side in ("lower", "upper"))
        return self._scaled(np.array(lower)), self._scaled(np.array(upper))

    def parameters(self, scaled: np.ndarray) -> np.ndarray:
        """The errors in their own units."""
        return np.where(self._log, np.exp(np.where(self._log, scaled, 0.0)), scaled)

    def scaling(self, scaled: np.ndarray) -> np.ndarray:
        """d error / d search variable."""
        return np.where(self._log, self.parameters(scaled), 1.0)

    def errors(self, scaled: np.ndarray) -> dict[str, dict[str, float]]:
        """The errors as `Observer.predict` takes them."""
        errors = {place: dict(given) for place, given in self._known.items()}
        for (place, name), value in zip(self._places, self.parameters(scaled).tolist(), strict=True):
            errors.setdefault(place, {})[name] = value
        return errors

    def residual(self, scaled: np.ndarray) -> np.ndarray:
        """(recorded - predicted) / std of every sample, weighed by how many make one that is independent."""
        return self.residual_and_jacobian(scaled)[0]

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The residuals and their derivatives to the search variables."""
        quantity = self.observer.quantity
        predicted = self.observer.predict(self.motion, self.instrument, self.errors(scaled))
        residual = self._weight * np.nan_to_num(self._recorded - predicted[quantity].values)
        declared = [spec.name for spec in self.observer.errors]
        columns = [declared.index(name) for _, name in self._places]
        derivatives = predicted[f"{quantity}_error_sensitivity"].values[..., columns]
        jacobian = -self._weight[..., None] * derivatives * self._concerned() * self.scaling(scaled)
        return residual[self._seen], np.nan_to_num(jacobian)[self._seen]

    def _entries(self) -> list[tuple[tuple[str, str], ParameterSpec]]:
        return list(zip(self._places, self._specs, strict=True))

    def _scaled(self, values: np.ndarray) -> np.ndarray:
        return np.where(self._log, np.log(np.where(self._log, values, 1.0)), values)

    def _concerned(self) -> np.ndarray:
        """Which channels each error acts on, (channel, axis, error)."""
        channels, axes = self.instrument[self.observer.channel].values, self.instrument["axis"].values
        return np.array(
            [[[place in ("", c, f"{c}/{a}") for place, _ in self._places] for a in axes] for c in channels], dtype=float
        )


def _spec(observer: Observer, name: str) -> ParameterSpec:
    declared = {spec.name: spec for spec in observer.errors}
    if name not in declared:
        raise CrashkitError(f"{observer.name}: expected an error of {sorted(declared)}, found {name!r}")
    return declared[name]


def _weight(observer: Observer, instrument: xr.Dataset) -> np.ndarray:
    """One over the standard deviation, (channel, 1)."""
    stated = f"{observer.quantity}_std"
    if stated not in instrument:
        raise CrashkitError(f"{observer.name}: expected {stated}, without which nothing can be weighed, found none")
    interval = float(np.median(np.diff(instrument["time"].values)))
    cfc = frequency_class(instrument)
    return np.asarray(1.0 / instrument[stated].values[:, None] / np.sqrt(correlation_samples(cfc, interval)))
