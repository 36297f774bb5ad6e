"""What every question about a model needs."""

from collections.abc import Sequence

from attrs import frozen

from crashkit.diagnose.claims import Progress
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.rebuild import rebuild
from crashkit.diagnose.fitting.search import Search
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
    """

    workshop: Workshop
    given: Misfit
    base: Search
    progress: Progress

    def fit_with(self, rivals: Sequence[Rival], last: Search) -> Search | None:
        """The fit of the model with these findings, from the values that they were last given; None if one has no place."""
        return rebuild(self.workshop, self.base, rivals, last)
