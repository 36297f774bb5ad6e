"""Claims under way: each with a search of the model that makes it."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from crashkit.diagnose.claims import price_of
from crashkit.diagnose.fitting.search import Search, advance_all, begin_all, weighed
from crashkit.misfit import Misfit
from crashkit.protocols import Identifier, Proposal


class Candidate(NamedTuple):
    """A claim, and a search of the model that makes it."""

    proposal: Proposal
    search: Search

    @property
    def priced(self) -> float:
        """Cost with the price of the numbers that were added: forms of one claim with more and more numbers would take the
        places of a simpler one that explains as much."""
        return float(self.search.state.cost) + 0.5 * price_of(self.proposal, self.search.misfit.independent_samples)


def begin_candidates(identifier: Identifier[Any], proposals: Sequence[Proposal], misfits: Sequence[Misfit]) -> list[Candidate]:
    """Claims at the values of the models that make them, on all cores."""
    return [Candidate(*one) for one in zip(proposals, begin_all(identifier, misfits), strict=True)]


def advance_candidates(
    candidates: Sequence[Candidate], steps: int, told: Callable[[int], None] = lambda done: None
) -> list[Candidate]:
    """At most so many steps further with each, on all cores."""
    return _with_searches(candidates, advance_all([one.search for one in candidates], steps, told))


def weigh_candidates(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Each with open noise levels at what it leaves of those channels."""
    return _with_searches(candidates, weighed([one.search for one in candidates]))


def _with_searches(candidates: Sequence[Candidate], searches: Sequence[Search]) -> list[Candidate]:
    return [Candidate(one.proposal, search) for one, search in zip(candidates, searches, strict=True)]
