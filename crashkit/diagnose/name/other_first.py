"""Another beginning, where the findings leave something: the first in another form, or another claim in its place."""

from collections.abc import Iterable

from crashkit.diagnose.fitting.evidence import Rival, by_evidence, is_unknown, ranked_by_evidence
from crashkit.diagnose.name.forms import in_all_forms
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look, compared, look_again

MOST = 5
"""How many are tried, of which each costs a quick look."""
HOPEFUL = 4.0
"""Deviance that another beginning may leave, relative to what the first finding leaves."""


def begun_otherwise(inquiry: Inquiry, first: Look, least: float) -> tuple[Look, Look] | None:
    """A first finding that is not the winner of the first look, and the second that it brings; None if no two fit better.

    The form that suits one effect alone is not the one that it has beside another, nor need the claim be.

    Arguments:
        least: deviance that the two must stay below.
    """
    best = None
    for rival in _others(inquiry, first):
        second = look_again(inquiry, rival.search.fitted(), [rival], quick=True)
        winner = second.winner
        if winner is not None and not is_unknown(winner) and winner.search.deviance < least:
            rest = [other for other in first.rivals if other.identity != rival.identity]
            best, least = (compared(first, [rival, *rest]), second), winner.search.deviance
    return best


def _others(inquiry: Inquiry, first: Look) -> Iterable[Rival]:
    """The most evident of the winner's other forms and of the other claims."""
    winner, *others = first.rivals
    fitted = first.forms if first.formed is winner.search else in_all_forms(inquiry, winner, [], winner.search)
    ranked = ranked_by_evidence(fitted, winner.without)
    forms = {rival.proposal.form: rival for rival in reversed(ranked) if rival.proposal.form != winner.proposal.form}
    named = [rival for rival in others if not is_unknown(rival)]
    hopeful = [one for one in (*forms.values(), *named) if one.search.deviance < HOPEFUL * winner.search.deviance]
    return by_evidence(hopeful)[:MOST]
