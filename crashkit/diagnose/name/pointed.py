"""Known causes where an estimated force leaves less than a known cause elsewhere, begun beside that estimate."""

from crashkit.diagnose.fitting.evidence import Rival, is_unknown
from crashkit.diagnose.name.imitate import with_imitations
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.rivals import CONCEALED

BY_CHANCE = 2.0
"""Chi squared for each number of an estimate: what leaves less than another claim by no more may do so by chance."""


def with_causes_pointed_to(inquiry: Inquiry, look: Look) -> Look:
    """The look, if it convinces, with the known causes of the place where an estimate leaves less than the leading known
    cause of another, if that leaves little, by more than chance would.

    Where the model's own numbers have made up for a cause, a fit of it begun at nothing only finds the little that is left.
    """
    known = next((rival for rival in look.rivals if not is_unknown(rival)), None)
    estimate = min(filter(is_unknown, look.rivals), key=lambda rival: rival.search.deviance, default=None)
    if look.winner is None or known is None or estimate is None or not _points_elsewhere(estimate, known):
        return look
    return with_imitations(inquiry, look, estimate)


def _points_elsewhere(estimate: Rival, known: Rival) -> bool:
    """Where the known cause leaves much, as its form may be off, that says little."""
    gained = known.search.deviance - estimate.search.deviance
    is_chance = gained < BY_CHANCE * len(estimate.proposal.parameters)
    return known.search.normalised < CONCEALED and estimate.place != known.place and not is_chance
