"""What nothing but an instrument that is wrong shows says how far the form of its error is off."""

import numpy as np

from crashkit.diagnose.fitting.evidence import Rival, is_unknown
from crashkit.diagnose.fitting.search import Search

SHOWN = 0.9
"""Of what an estimate explains: where the instrument that is wrong shows so much of it, nothing acts in the structure."""
MOST = 0.5
"""Of the independent samples: the other channels would show a force in the structure if they have more."""


def is_shown_alone(reading: Rival, structure: Rival) -> bool:
    """Whether a force that is only estimated explains hardly more than what a wrong instrument reads.

    `sum over its channels (D0 - D1) > 0.9 sum over all (D0 - D1)`, D the deviance of a channel without and with the force. A
    force between bodies moves several of them.

    Arguments:
        reading: what the instrument has wrong.
        structure: fitted beside that.
    """
    before, after = reading.search, structure.search
    accused = np.array([_is_accused(reading, *at) for at in _channels(before)])
    samples = np.array([channel.independent_samples for channel in before.misfit.channels])
    if not is_unknown(structure) or samples @ accused > MOST * samples.sum():
        return False
    gained = _deviances(before) - _deviances(after)
    return bool(gained @ accused > SHOWN * gained.sum())


def _is_accused(reading: Rival, instrument: str, sensor: str) -> bool:
    """Whether the claim is of this sensor, or of its whole instrument."""
    where = reading.proposal.location
    return where["instrument"] == instrument and where.get("sensor", sensor) == sensor


def _channels(search: Search) -> list[tuple[str, str]]:
    return [(channel.instrument, channel.sensor) for channel in search.misfit.channels]


def _deviances(search: Search) -> np.ndarray:
    return search.misfit.channel_deviances(search.misfit.residual(search.point))
