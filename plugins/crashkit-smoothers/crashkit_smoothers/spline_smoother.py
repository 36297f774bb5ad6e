"""What the smoothing splines share: from a channel to values, derivatives, their uncertainty, and a sentence on the choice."""

import math

import xarray as xr
from attrs import evolve, frozen

from crashkit.errors import CrashkitError
from crashkit_smoothers.choice import Criterion
from crashkit_smoothers.contacts import fit_with_contacts_found, has_room
from crashkit_smoothers.curve import curve
from crashkit_smoothers.noise_level import FULL, doubt, exceeds
from crashkit_smoothers.reading import Reading, read_channel
from crashkit_smoothers.smoothing_spline import Recipe, SplineFit, fit_spline


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
        self,
        samples: xr.DataArray,
        std: float | xr.DataArray | None,
        contacts: tuple[float, ...] = (),
        find_contacts: bool = False,
    ) -> xr.Dataset:
        """Smooth one channel, as `Smoother.smooth` says.

        Arguments:
            contacts: s, instants at which the acceleration may jump.
            find_contacts: whether to look for more of them.
        """
        reading = read_channel(self.name, samples, std, 2 * self.order)
        recipe = Recipe(self.order, self.criterion.unknown, self.local, self._places(contacts, reading))
        fitted, level = _fit(reading, recipe, self.criterion, find_contacts)
        values, spreads = fitted.evaluated(reading.x)
        spreads *= level
        return curve(reading, values, spreads, self._attrs(reading, fitted, level))

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

    def _attrs(self, reading: Reading, fitted: SplineFit, level: float) -> dict[str, object]:
        size = 1.0 if reading.std is None else reading.std
        unit = size**2 * reading.correlation * reading.duration ** (2 * self.order - 1)
        attrs = {
            "noise_std": level * size,
            "smoothing_parameter": fitted.fit.smoothing * unit,
            "effective_degrees_of_freedom": fitted.fit.freedom,
            "choice": self._choice(reading, fitted, level),
        }
        if fitted.contacts:
            attrs["contacts"] = [float(reading.time[0]) + place * reading.duration for place in fitted.contacts]
        return attrs

    def _choice(self, reading: Reading, fitted: SplineFit, level: float) -> str:
        freedom, count = fitted.fit.freedom, reading.count
        words = "the risk at the given noise" if reading.std and level == 1.0 else self.criterion.words
        sentence = f"{words} chose {freedom:.1f} degrees of freedom for {len(reading.z)} samples"
        if reading.correlation > 1.0:
            sentence += f", {count:.0f} of them independent after the filter"
        if freedom > FULL * count:
            sentence += ": so many that noise and motion can hardly be told apart"
        return sentence + (doubt(level, found_noise(reading, fitted), count - freedom) if reading.std else "")


def _fit(reading: Reading, recipe: Recipe, criterion: Criterion, find_contacts: bool) -> tuple[SplineFit, float]:
    """The spline, and the standard deviation of the scaled samples.

    A given noise that is too small would be taken for a motion that is followed sample by sample: where the samples
    contradict it they are smoothed as if it were unknown but for the weights.
    """
    fit = fit_with_contacts_found if find_contacts else fit_spline
    if reading.std is None:
        unknown = fit(reading, recipe)
        return unknown, found_noise(reading, unknown)
    known = fit(reading, evolve(recipe, score=criterion.known))
    if known.fit.freedom < FULL * reading.count and not _exceeds_given(reading, known):
        return known, 1.0
    unknown = fit(reading, recipe)
    return (unknown, found_noise(reading, unknown)) if _exceeds_given(reading, unknown) else (known, 1.0)


def _exceeds_given(reading: Reading, fitted: SplineFit) -> bool:
    return exceeds(found_noise(reading, fitted), 1.0, reading.count - fitted.fit.freedom)


def found_noise(reading: Reading, fitted: SplineFit) -> float:
    """The standard deviation of the scaled samples by what the fit leaves, sqrt(|(I - A) z|^2 / tr(I - A))."""
    return math.sqrt(fitted.fit.residual / (reading.count - fitted.fit.freedom))
