"""The measuring chain behind the sensing element: mount, gain, linearity, hysteresis, saturation, offset, filter."""

from collections.abc import Callable

import numpy as np

from crashkit.data.channel_filter import filter_channel
from crashkit_accelerometers.hysteresis import branch
from crashkit_accelerometers.ringing import ringing, ringing_derivatives

Own = dict[str, np.ndarray]
"""The value of every error parameter, by its name."""


class Chain:
    """Channels on their way through the chain, with their derivatives; each effect at its null leaves them alone.

    Arguments:
        value: (time, channel).
        errors: derivatives by the name of an error, (time, channel).
        model: derivatives to the model's parameters, (time, channel, parameter), or None.
        own: error parameters, (channel,).
        times: s, time stamps.
    """

    def __init__(
        self, value: np.ndarray, errors: dict[str, np.ndarray], model: np.ndarray | None, own: Own, times: np.ndarray
    ) -> None:
        self.value = value
        self.errors = errors
        self.model = model
        self._own = own
        self._times = times

    def run(self, channel_frequency_class: int) -> None:
        """Every effect, in the order of the chain."""
        self.ring()
        self.amplify()
        self.bend()
        self.lag()
        self.clip()
        self.offset()
        self.filter(channel_frequency_class)

    def ring(self) -> None:
        """a + share (ringing(a) - a): part of the reading, or all of it, comes through a mount that rings."""
        share = self._own["resonance_share"]
        mount = self._times, self._own["resonance_frequency"], self._own["resonance_damping"]
        column = self.value[..., None]
        change = (ringing(column, *mount) - column)[..., 0]
        if share.any():
            self._each(lambda columns: columns + share[:, None] * (ringing(columns, *mount) - columns))
            by_shape = ringing_derivatives(column, *mount)
            for name, columns in zip(("resonance_frequency", "resonance_damping"), by_shape, strict=True):
                self.errors[name] = share * columns[..., 0]
            self.value = self.value + share * change
        self.errors["resonance_share"] = change

    def amplify(self) -> None:
        """gain a."""
        gain = self._own["gain"]
        if (gain != 1.0).any():
            self._each(lambda columns: gain[:, None] * columns)
        self.errors["gain"] = self.value
        self.value = gain * self.value

    def bend(self) -> None:
        """a + quadratic a^2 + cubic a^3."""
        quadratic, cubic = self._own["quadratic"], self._own["cubic"]
        square = self.value**2
        cube = square * self.value
        if quadratic.any() or cubic.any():
            slope = 1.0 + 2.0 * quadratic * self.value + 3.0 * cubic * square
            self._each(lambda columns: slope[..., None] * columns)
            self.value = self.value + quadratic * square + cubic * cube
        self.errors["quadratic"], self.errors["cubic"] = square, cube

    def lag(self) -> None:
        """a - hysteresis z, z between -1 where the reading falls and 1 where it rises."""
        hysteresis = self._own["hysteresis"]
        now = branch(self.value, self._own["hysteresis_travel"])
        if hysteresis.any():
            self._each(lambda columns: columns - hysteresis[:, None] * now.along(columns))
            self.errors["hysteresis_travel"] = -hysteresis * now.by_travel(self.value, self._own["hysteresis_travel"])
            self.value = self.value - hysteresis * now.position
        self.errors["hysteresis"] = -now.position

    def clip(self) -> None:
        """a within -saturation and saturation; a reading that clips no longer depends on anything else."""
        limit = self._own["saturation"]
        if np.isinf(limit).all():
            return
        clipped = np.abs(self.value) >= limit
        self._each(lambda columns: np.where(clipped[..., None], 0.0, columns))
        self.errors["saturation"] = clipped * np.sign(self.value)
        self.value = np.clip(self.value, -limit, limit)

    def offset(self) -> None:
        """bias + bias_drift t + a."""
        stamps = np.broadcast_to(self._times[:, None], self.value.shape)
        self.errors["bias_drift"] = stamps
        self.value = self.value + self._own["bias"] + self._own["bias_drift"] * stamps

    def filter(self, channel_frequency_class: int) -> None:
        """The filter, which a constant passes unchanged; before the first sample the sensor felt nothing."""
        self.errors["bias"] = np.ones_like(self.value)
        if not channel_frequency_class:
            return
        names = [name for name in self.errors if name != "bias"]
        before = np.zeros((1 + len(names), self.value.shape[1]))
        before[0] = self._own["bias"] + self._own["bias_drift"] * self._times[0]
        before[1 + names.index("bias_drift")] = self._times[0]
        block = np.stack([self.value, *(self.errors[name] for name in names)], axis=1)
        block = filter_channel(block, self._times, channel_frequency_class, before=before)
        self.value = block[:, 0]
        self.errors |= {name: block[:, 1 + index] for index, name in enumerate(names)}
        if self.model is not None:
            self.model = filter_channel(self.model, self._times, channel_frequency_class, before=0.0)

    def _each(self, change: Callable[[np.ndarray], np.ndarray]) -> None:
        """Apply a linear map to every derivative; it takes and returns (time, channel, column)."""
        self.errors = {name: change(column[..., None])[..., 0] for name, column in self.errors.items()}
        if self.model is not None:
            self.model = change(self.model)
