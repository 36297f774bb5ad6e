"""Smoother: noisy samples with real time stamps into values, derivatives and their uncertainty."""

from abc import ABC, abstractmethod
from typing import ClassVar

import xarray as xr


class Smoother(ABC):
    """Turns samples into values and derivatives, and says which smoothing it chose and why.

    Attributes:
        name: as users choose it.
        degree: the highest polynomial degree that it reproduces exactly.
    """

    name: ClassVar[str]
    degree: ClassVar[int]

    @abstractmethod
    def smooth(self, samples: xr.DataArray, std: float | None = None) -> xr.Dataset:
        """Smooth one channel.

        Arguments:
            samples: dims (time,), with its coordinate in s, strictly increasing; NaN where a sample is missing.
            std: standard deviation of a sample, if known.

        Returns:
            Dataset over the same `time` with `value`, `first_derivative`, `second_derivative` and `<each>_std`; attributes
            `noise_std` (given or estimated), `smoothing_parameter`, `effective_degrees_of_freedom`, `choice` (a sentence).
        """
