"""Smoother: noisy samples with real time stamps into values, derivatives and their uncertainty."""

from abc import ABC, abstractmethod
from typing import ClassVar

import xarray as xr


class Smoother(ABC):
    """Turns samples into values and derivatives, and says which smoothing it chose and why.

    Attributes:
        name: as users choose it.
        degree: the highest polynomial degree that it reproduces exactly.
        equal_samples: whether it takes only samples at equal steps that all have one standard deviation.
    """

    name: ClassVar[str]
    degree: ClassVar[int]
    equal_samples: ClassVar[bool] = False

    @abstractmethod
    def smooth(self, samples: xr.DataArray, std: float | xr.DataArray | None = None) -> xr.Dataset:
        """Smooth one channel.

        Arguments:
            samples: dims (time,), with its coordinate in s, strictly increasing; NaN where a sample is missing. The attribute
                `channel_frequency_class` says that the noise went through the filter of that class (SAE J211), and `units`
                what the derivatives are derivatives of.
            std: standard deviation of a sample if known, one for all or one for each (time,).

        Returns:
            Dataset over the same `time` with `value`, `first_derivative`, `second_derivative` and `<each>_std`; attributes
            `noise_std` (given, the median if they differ, or estimated), `smoothing_parameter`,
            `effective_degrees_of_freedom`, `choice` (a sentence).

        Raises CrashkitError where the samples are too few or not as the smoother needs them.
        """
