"""Importer: reads a laboratory's own format into a recording."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import ClassVar

import xarray as xr


class Importer(ABC):
    """Reads a folder or file of one format.

    Attributes:
        name: as users choose it, for example "nhtsa".
    """

    name: ClassVar[str]

    @abstractmethod
    def channels(self, source: Path) -> xr.Dataset:
        """What the source holds: a Dataset over `channel` with what the format says of each, for users to choose from."""

    @abstractmethod
    def read(self, source: Path, channels: Sequence[str], options: Mapping[str, str]) -> xr.DataTree:
        """The chosen channels as a recording.

        Arguments:
            source: folder or file.
            channels: each "CHANNEL[+CHANNEL...]=BODY[:SENSOR]"; the format says how channels joined by + become one; the body
                is the model's name.
            options: of the format, for example {"window": "0:0.12", "channel_frequency_class": "60"}.
        """
