"""Known causes where an estimated force leaves less than the leading one, begun beside that estimate."""

from crashkit.diagnose.fitting.evidence import UNEXPLAINED, Rival, is_unknown
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.imitate import with_imitations
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.rivals import CONCEALED

FAR_LESS = 0.1
"""Of what a known cause that leaves much leaves above the noise: an estimate that leaves less knows of a better one."""
LESS = 0.6
"""The same beside a finding, of a cause in its best form."""
BY_CHANCE = 2.0
"""Chi squared for each number of an estimate: what leaves less than another claim by no more may do so by chance."""


def with_causes_pointed_to(inquiry: Inquiry, look: Look) -> Look:
    """The look, if it convinces, with the known causes of the place to which an estimate points.

    Where the model's own numbers have made up for a cause, a fit of it begun at nothing only finds the little that is left, or
    is caught, as one that breaks far from where it does.
    """
    known = next((rival for rival in look.rivals if not is_unknown(rival)), None)
    estimate = min(filter(is_unknown, look.rivals), key=lambda rival: rival.search.deviance, default=None)
    if look.winner is None or known is None or estimate is None or not _points(estimate, known):
        return look
    return with_imitations(inquiry, look, estimate)


def with_better_pointed_to(inquiry: Inquiry, look: Look, told: Search) -> Look:
    """A look beside a finding with the known causes at the place of an estimate, where that leaves far less than what is told.

    Arguments:
        told: the fit with the winner of the look, in its best form.
    """
    estimate = min(filter(is_unknown, look.rivals), key=lambda rival: rival.search.deviance, default=None)
    if estimate is None or told.normalised < CONCEALED or estimate.search.excess > LESS * told.excess:
        return look
    return with_imitations(inquiry, look, estimate)


def _points(estimate: Rival, known: Rival) -> bool:
    """Whether it leaves next to nothing, and less, by more than chance, than a cause of another place that leaves little.

    Where the leading known cause leaves much, as its form may be off: whether it leaves next to nothing of that.
    """
    if known.search.normalised > CONCEALED:
        return estimate.search.excess < FAR_LESS * known.search.excess
    gained = known.search.deviance - estimate.search.deviance
    is_little = estimate.search.normalised < UNEXPLAINED
    return is_little and estimate.place != known.place and gained > BY_CHANCE * len(estimate.proposal.parameters)
