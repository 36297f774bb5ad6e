"""The measuring chain behind the sensing element: mount, gain, linearity, hysteresis, saturation, offset, filter."""

from collections.abc import Callable, Container

import numpy as np
from scipy.constants import g

from crashkit.data.channel_filter import ChannelFilter
from crashkit.data.ringing import WHOLE, ringing, ringing_derivatives
from crashkit_accelerometers.hysteresis import branch

Own = dict[str, np.ndarray]
"""The value of every error parameter, by its name."""


def acts(own: Own, *names: str) -> bool:
    """Whether one of these errors is not 0; of few values `count_nonzero` tells that faster than `any`."""
    return any(np.count_nonzero(own[name]) for name in names)


class Chain:
    """Channels on their way through the chain, with their derivatives; an effect at its null leaves them alone.

    Arguments:
        value: (time, channel).
        errors: derivatives by the name of an error, (time, channel); None: those to errors are not asked for.
        model: derivatives to the model's parameters, (time, channel, parameter), if there are any.
        own: error parameters, (channel,).
        times: s, time stamps.
        wanted: errors whose derivatives are asked for.
    """

    def __init__(
        self,
        value: np.ndarray,
        errors: dict[str, np.ndarray] | None,
        model: np.ndarray | None,
        own: Own,
        times: np.ndarray,
        wanted: Container[str] = (),
    ) -> None:
        self.value = value
        self.errors = errors
        self.model = model
        self._own = own
        self._times = times
        self._wanted = wanted

    def run(self, channel_frequency_class: int) -> None:
        """Every effect, in the order of the chain."""
        for oscillator in ("rocking", "resonance"):
            if f"{oscillator}_share" in self._own and self._acts(f"{oscillator}_share"):
                self.ring(oscillator)
        if "lean" in self._own and self._acts("lean"):
            self.lean()
        self.amplify()
        if self._acts("quadratic", "cubic"):
            self.bend()
        if self._acts("hysteresis"):
            self.lag()
        self.soften()
        self.knee()
        self.clip()
        if self._acts("bias", "bias_drift"):
            self.offset()
        if self._acts("zero_shift"):
            self.shift()
        self.filter(channel_frequency_class)

    def ring(self, oscillator: str) -> None:
        """a + share (ringing(a) - a): part of the reading, or all of it, comes through a rocking body, a ringing mount."""
        share = self._own[f"{oscillator}_share"]
        path = self._own.get(f"{oscillator}_path", WHOLE)
        mount = self._times, self._own[f"{oscillator}_frequency"], self._own[f"{oscillator}_damping"], path
        column = self.value[..., None]
        change = (ringing(column, *mount) - column)[..., 0]
        if share.any():
            self._each(lambda columns: columns + share[:, None] * (ringing(columns, *mount) - columns))
            self.value = self.value + share * change
        if self.errors is None:
            return
        self.errors[f"{oscillator}_share"] = change
        if not share.any():
            return
        if self._asks(f"{oscillator}_frequency", f"{oscillator}_damping"):
            by_frequency, by_damping = ringing_derivatives(column, *mount)
            self.errors[f"{oscillator}_frequency"] = share * by_frequency[..., 0]
            self.errors[f"{oscillator}_damping"] = share * by_damping[..., 0]
        if self._asks(f"{oscillator}_path"):
            with_damper, without = (ringing(column, *mount[:3], part)[..., 0] for part in (WHOLE, 0.0 * WHOLE))
            self.errors[f"{oscillator}_path"] = share * (with_damper - without)

    def lean(self) -> None:
        """a cos(lean) + g sin(lean): behind the mount, to which gravity is no news."""
        lean, felt = self._own["lean"], self.value
        if lean.any():
            self._each(lambda columns: np.cos(lean)[:, None] * columns)
            self.value = np.cos(lean) * felt + g * np.sin(lean)
        if self.errors is not None:
            self.errors["lean"] = g * np.cos(lean) - np.sin(lean) * felt

    def amplify(self) -> None:
        """gain a."""
        gain, felt = self._own["gain"], self.value
        if (gain != 1.0).any():
            self._each(lambda columns: gain[:, None] * columns)
            self.value = gain * felt
        if self.errors is not None:
            self.errors["gain"] = felt

    def bend(self) -> None:
        """a + quadratic a^2 + cubic a^3."""
        quadratic, cubic = self._own["quadratic"], self._own["cubic"]
        square = self.value**2
        cube = square * self.value
        if quadratic.any() or cubic.any():
            slope = 1.0 + 2.0 * quadratic * self.value + 3.0 * cubic * square
            self._each(lambda columns: slope[..., None] * columns)
            self.value = self.value + quadratic * square + cubic * cube
        if self.errors is not None:
            self.errors |= {"quadratic": square, "cubic": cube}

    def lag(self) -> None:
        """a - hysteresis z, z between -1 where the reading falls and 1 where it rises."""
        hysteresis, travel, rising = self._own["hysteresis"], self._own["hysteresis_travel"], self.value
        now = branch(rising, travel)
        if hysteresis.any():
            self._each(lambda columns: columns - hysteresis[:, None] * now.along(columns))
            self.value = rising - hysteresis * now.position
        if self.errors is not None:
            self.errors |= {"hysteresis": -now.position, "hysteresis_travel": -hysteresis * now.by_travel(rising, travel)}

    def soften(self) -> None:
        """s tanh(a / s): bent towards -s and s."""
        limit = self._own["saturation_soft"]
        if np.isinf(limit).all():
            return
        share = self.value / limit
        bent = np.tanh(share)
        slope = 1.0 - bent**2
        self._each(lambda columns: slope[..., None] * columns)
        finite = np.where(np.isinf(limit), 0.0, limit)
        self.value = np.where(np.isinf(limit), self.value, finite * bent)
        if self.errors is not None:
            self.errors["saturation_soft"] = bent - share * slope

    def knee(self) -> None:
        """a / (1 + (|a| / s)^n)^(1 / n): bent towards -s and s in a knee."""
        limit, sharpness = self._own["saturation_knee"], self._own["knee_sharpness"]
        if np.isinf(limit).all():
            return
        share = np.maximum(np.abs(self.value) / limit, 1e-12)
        power = share**sharpness
        root = (1.0 + power) ** (-1.0 / sharpness)
        slope = root / (1.0 + power)
        self._each(lambda columns: slope[..., None] * columns)
        bent = root * self.value
        if self.errors is not None:
            by_sharpness = np.log1p(power) / sharpness**2 - power * np.log(share) / (sharpness * (1.0 + power))
            self.errors["saturation_knee"] = np.sign(self.value) * share * (root - slope)
            self.errors["knee_sharpness"] = bent * by_sharpness
        self.value = bent

    def clip(self) -> None:
        """a within -saturation and saturation, and what holds on one side; a clipped reading depends on nothing else."""
        both, above, below = (self._own[name] for name in ("saturation", "saturation_above", "saturation_below"))
        highest, lowest = np.minimum(both, above), -np.minimum(both, below)
        if np.isinf(highest).all() and np.isinf(lowest).all():
            return
        high, low = self.value >= highest, self.value <= lowest
        self._each(lambda columns: np.where((high | low)[..., None], 0.0, columns))
        if self.errors is not None:
            self.errors["saturation"] = 1.0 * (high & (both <= above)) - (low & (both <= below))
            self.errors["saturation_above"] = 1.0 * (high & (above < both))
            self.errors["saturation_below"] = -1.0 * (low & (below < both))
        self.value = np.clip(self.value, lowest, highest)

    def offset(self) -> None:
        """bias + bias_drift t + a."""
        stamps = np.broadcast_to(self._times[:, None], self.value.shape)
        self.value = self.value + self._own["bias"] + self._own["bias_drift"] * stamps
        if self.errors is not None:
            self.errors["bias_drift"] = stamps

    def shift(self) -> None:
        """zero_shift (1 + tanh((t - zero_shift_time) / zero_shift_rise)) / 2 + a."""
        shift, rise = self._own["zero_shift"], self._own["zero_shift_rise"]
        since = (self._times[:, None] - self._own["zero_shift_time"]) / rise
        step = 0.5 * (1.0 + np.tanh(since))
        self.value = self.value + shift * step
        if self.errors is not None:
            slope = -2.0 * shift * step * (1.0 - step) / rise
            self.errors |= {"zero_shift": step, "zero_shift_time": slope, "zero_shift_rise": slope * since}

    def filter(self, channel_frequency_class: int) -> None:
        """The filter, which a constant passes unchanged; before the first sample the sensor felt nothing but gravity."""
        if self.errors is not None:
            self.errors = {name: column for name, column in self.errors.items() if name in self._wanted}
        if channel_frequency_class and len(self._times) > 1:
            self._filter(ChannelFilter.of(self._times, channel_frequency_class))
        if self.errors is not None and "bias" in self._wanted:
            self.errors["bias"] = np.ones_like(self.value)

    def _filter(self, filter: ChannelFilter) -> None:
        """All that is small at once; only what an offset and gravity leave was there before the first sample."""
        columns = {"": self.value, **(self.errors or {})}
        gain, lean = self._own["gain"], self._own.get("lean", np.zeros(1))
        before = {
            "": gain * g * np.sin(lean) + self._own["bias"] + self._own["bias_drift"] * self._times[0],
            "lean": gain * g * np.cos(lean),
            "gain": g * np.sin(lean),
            "bias_drift": self._times[0],
        }
        starts = np.zeros((len(columns), self.value.shape[1]))
        for row, name in enumerate(columns):
            starts[row] = before.get(name, 0.0)
        block = filter.filtered(np.stack(list(columns.values()), axis=1), starts)
        self.value = block[:, 0]
        if self.errors is not None:
            self.errors = {name: block[:, 1 + row] for row, name in enumerate(self.errors)}
        if self.model is not None:
            self.model = filter.filtered(self.model, 0.0)

    def _acts(self, *names: str) -> bool:
        """Whether an effect changes the reading, or its derivatives are asked for."""
        return self._asks(*names) or acts(self._own, *names)

    def _asks(self, *names: str) -> bool:
        """Whether its derivatives are asked for."""
        return self.errors is not None and any(name in self._wanted for name in names)

    def _each(self, change: Callable[[np.ndarray], np.ndarray]) -> None:
        """Apply a linear map to every derivative; it takes and returns (time, channel, column)."""
        if self.errors is not None:
            self.errors = {name: change(column[..., None])[..., 0] for name, column in self.errors.items()}
        if self.model is not None:
            self.model = change(self.model)
