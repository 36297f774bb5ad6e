"""What every question about a model needs."""

from collections.abc import Mapping, Sequence

import xarray as xr
from attrs import field, frozen

from crashkit.diagnose.claims import Progress
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.rebuild import rebuild
from crashkit.diagnose.fitting.reidentify import understood
from crashkit.diagnose.fitting.search import Search, weighed
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit


@frozen
class Inquiry:
    """A model as it was given and as it fits best, and the means to ask what it leaves out.

    Attributes:
        workshop: the plugins to work with.
        given: the misfit of the model at the values that the user gave.
        base: the best fit of the model as it is.
        progress: told what is being done and how far it is (0 to 1).
        unthinned: the recordings as they are, by name, where what is found may outrun thinned ones; empty where it may not.
    """

    workshop: Workshop
    given: Misfit
    base: Search
    progress: Progress
    unthinned: Mapping[str, xr.DataTree] = field(factory=dict)

    def fit_with(self, rivals: Sequence[Rival], last: Search) -> Search | None:
        """The fit of the model with these findings, from the values that they were last given; None if one has no place."""
        return rebuild(self.workshop, self.base, rivals, last)

    def again(self, rival: Rival) -> Search:
        """The model with a claim, re-identified from where the user gave its own numbers.

        Its fit began where the model without it had been driven, and may have stayed in that valley.
        """
        self.progress(f"re-identifying with {rival.proposal.physics}", 0.0)
        return weighed([understood(self.workshop, rival.search.fitted().with_values_of(self.given))])[0]
