"""What the smoothing splines share: from a channel to values, derivatives, their uncertainty, and a sentence on the choice."""

import math

import xarray as xr
from attrs import frozen

from crashkit.errors import CrashkitError
from crashkit_smoothers.choice import Criterion
from crashkit_smoothers.contacts import fit_with_contacts_found, has_room
from crashkit_smoothers.curve import curve
from crashkit_smoothers.reading import Reading, read_channel
from crashkit_smoothers.smoothing_spline import Recipe, SplineFit, fit_spline

SURE = 4.0
"""Standard deviations by which the noise found must differ from the given one to be mentioned."""
FULL = 0.5
"""Share of the samples' freedom above which a fit can hardly tell noise from motion."""


@frozen
class SplineMethod:
    """One of the smoothing splines.

    Attributes:
        name: of the smoother.
        order: q of the derivative that is penalised.
        criterion: what chooses the smoothing.
        local: whether the stiffness follows the motion's own roughness.
    """

    name: str
    order: int
    criterion: Criterion
    local: bool = False

    def smooth(
        self, samples: xr.DataArray, std: float | xr.DataArray | None, contacts: tuple[float, ...], find_contacts: bool
    ) -> xr.Dataset:
        """Smooth one channel, as `Smoother.smooth` says.

        Arguments:
            contacts: s, instants at which the acceleration may jump.
            find_contacts: whether to look for more of them.
        """
        reading = read_channel(self.name, samples, std, 2 * self.order)
        score = self.criterion.unknown if std is None else self.criterion.known
        recipe = Recipe(self.order, score, self.local, self._places(contacts, reading))
        fitted = (fit_with_contacts_found if find_contacts else fit_spline)(reading, recipe)
        found = math.sqrt(fitted.fit.residual / (reading.count - fitted.fit.freedom))
        values, spreads = fitted.evaluated(reading.x)
        return curve(reading, values, spreads * (found if std is None else 1.0), self._attrs(reading, fitted, found))

    def _places(self, contacts: tuple[float, ...], reading: Reading) -> tuple[float, ...]:
        """The contacts on [0, 1], with room between them."""
        start, x = float(reading.time[0]), reading.x[reading.present]
        places = tuple(sorted((contact - start) / reading.duration for contact in contacts))
        if not has_room(x, places, self.order):
            raise CrashkitError(
                f"{self.name}: expected contacts with at least {self.order} samples before, between and after them, "
                f"found {', '.join(f'{contact:g} s' for contact in contacts)}"
            )
        return places

    def _attrs(self, reading: Reading, fitted: SplineFit, found: float) -> dict[str, object]:
        size = 1.0 if reading.std is None else reading.std
        unit = size**2 * reading.correlation * reading.duration ** (2 * self.order - 1)
        attrs = {
            "noise_std": found if reading.std is None else size,
            "smoothing_parameter": fitted.fit.smoothing * unit,
            "effective_degrees_of_freedom": fitted.fit.freedom,
            "choice": self._choice(reading, fitted, found),
        }
        if fitted.contacts:
            attrs["contacts"] = [float(reading.time[0]) + place * reading.duration for place in fitted.contacts]
        return attrs

    def _choice(self, reading: Reading, fitted: SplineFit, found: float) -> str:
        freedom, count = fitted.fit.freedom, reading.count
        words = self.criterion.words if reading.std is None else "the risk at the given noise"
        sentence = f"{words} chose {freedom:.1f} degrees of freedom for {len(reading.z)} samples"
        if reading.correlation > 1.0:
            sentence += f", {count:.0f} of them independent after the filter"
        if freedom > FULL * count:
            sentence += ": so many that noise and motion can hardly be told apart"
        if reading.std is not None and abs(found**2 - 1.0) > SURE * math.sqrt(2.0 / (count - freedom)):
            sentence += f"; what is left is {found:.2g} times the given noise"
        return sentence
