"""Re-identify first: the given model's own parameters, fitted to all calibration runs together."""

from typing import Any

from crashkit.diagnose.search import Search, begin
from crashkit.misfit import Misfit
from crashkit.protocols import Identifier

STEPS = 60
REWEIGHTINGS = 3


def reidentify(identifier: Identifier[Any], misfit: Misfit) -> Search:
    """The best fit of the model as it is; what then remains, no tuning of its parameters removes.

    Channels whose noise level is open are weighed by what the model leaves of them, which the fit itself changes: a few
    rounds settle that.
    """
    search = begin(identifier, misfit).advance(STEPS)
    if all(channel.noise.trusted for channel in misfit.channels):
        return search
    for _ in range(REWEIGHTINGS):
        search = begin(identifier, search.fitted().reweighted(search.point)).advance(STEPS)
    return search
