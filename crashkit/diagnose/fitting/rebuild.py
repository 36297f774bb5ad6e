"""The given model with some findings and without others, fitted again."""

from collections.abc import Sequence

from crashkit.diagnose.claims import proposed_again
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.search import STEPS, Search, advance_all, begin, begin_all
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal


def alone_again(search: Search, misfits: Sequence[Misfit]) -> Search:
    """The model as it is, from where claims have moved its own numbers: one may have won by leaving a local optimum.

    Arguments:
        search: the best fit of the model so far.
        misfits: of the model with one claim each, at their best fits.
    """
    begun = begin_all(search.identifier, [search.misfit.with_values_of(misfit) for misfit in misfits])
    return min([search, *advance_all(begun, STEPS)], key=lambda one: one.deviance)


def rebuild(workshop: Workshop, base: Search, rivals: Sequence[Rival], last: Search) -> Search | None:
    """The given model with these findings, fitted, from the values that they were last given; None if one cannot be placed."""
    search, paths = base, dict[str, str]()
    for rival in rivals:
        current = search.fitted()
        proposal = proposed_again(workshop, current, rival.proposal)
        if proposal is None:
            return None
        paths |= _earlier_paths(proposal, rival.proposal)
        found = {**rival.search.values, **last.values}
        misfit = workshop.equipped([proposal.model]).misfit(current, proposal.model)
        before = {name: name if name in found else paths.get(name, "") for name in misfit.names}
        start = {name: found[path] for name, path in before.items() if path in found}
        search = begin(workshop.identifier, misfit.with_values(start)).advance(STEPS)
    return search


def _earlier_paths(proposal: Proposal, earlier: Proposal) -> dict[str, str]:
    """The paths that the numbers of a claim have had: it stands in the law of its joint or beside it, as others leave room.

    A claim about how high the sensors are has more numbers where more of them are believed, each at a path of its own.
    """
    new, old = proposal.parameters, earlier.parameters
    return dict(zip(new, old, strict=True)) if len(new) == len(old) else {}
