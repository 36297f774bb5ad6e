"""A look settled: its winner re-identified, challenged by what says it in fewer numbers, and by what says it as well."""

from collections.abc import Sequence

from attrs import evolve

from crashkit.diagnose.claims import accuses_instrument, identity
from crashkit.diagnose.fitting.evidence import (
    FLOOR,
    Rival,
    best_forms,
    by_evidence,
    explains,
    is_strained,
    is_unknown,
    ranked_by_evidence,
    rival_of,
)
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.challenge import challenged, challengers
from crashkit.diagnose.name.forms import in_all_forms
from crashkit.diagnose.name.inquiry import Inquiry, open_claims
from crashkit.diagnose.name.look import Look, compared
from crashkit.diagnose.name.rivals import CONCEALED
from crashkit.diagnose.result import place_of
from crashkit.protocols import Proposal

CLOSE = 1.1
"""Normalised residual of a rival in a plain form that another form may bring to the noise."""
CLOSEST = 2
"""How many of these are asked for in all their forms."""
LITTLE = 0.05
"""Of chi squared without it: a winner that leaves less may be off in its form only, or be another at its place that is."""
NEARLY = 0.9
"""Of what a winner explains that leaves something: a rival that explains as much may explain more in another form."""


def settled(inquiry: Inquiry, look: Look, winner: Rival, found: Sequence[Rival]) -> Look:
    """The look with its winner re-identified, where something is left, or numbers are strained; then challenged by claims of
    fewer numbers and by those at its place, of which the closest are asked for in all forms. A first one that was settled, and
    put in its best form since, is not again.

    Arguments:
        found: what was found before.
    """
    if look.formed is winner.search and not found:
        return look
    look = reidentified(inquiry, look, winner)
    if is_unknown(look.leader):
        return look
    claims = challengers(inquiry, look, found)
    return _contested(inquiry, challenged(inquiry, look, claims) if claims else look, found)


def in_one_number(inquiry: Inquiry, findings: Sequence[Look], search: Search) -> tuple[list[Look], Search]:
    """Several findings, each challenged by the claims of one number at its place, and the fit with them.

    Of two that were found at once the first was chosen before either fit had settled, and never stood alone.

    Arguments:
        search: the fit with the findings.
    """
    looks = list(findings)
    for index, look in enumerate(findings):
        winner, others = look.leader, [other.leader for other in looks if other is not look]
        if is_unknown(winner) or accuses_instrument(winner.proposal) or len(winner.proposal.parameters) == 1:
            continue
        without = inquiry.fit_with(others, search)
        claims = _of_one_number(inquiry, winner, others, without) if without else []
        if without is None or not claims:
            continue
        present = rival_of(winner.proposal, search, without.deviance)
        told = challenged(inquiry, compared(evolve(look, before=without.fitted()), [present]), claims)
        if told.leader.identity != winner.identity:
            looks[index], search = told, told.leader.search
    return looks, search


def _of_one_number(inquiry: Inquiry, winner: Rival, others: Sequence[Rival], without: Search) -> list[Proposal]:
    """What the structure may have wrong in one number at the place of a winner, beside other findings."""
    claims = open_claims(inquiry, without.fitted(), [winner, *others])
    return [p for p in claims if place_of(p.location) == winner.place and len(p.parameters) == 1 and not p.refined]


def reidentified(inquiry: Inquiry, look: Look, winner: Rival) -> Look:
    """The look with its winner re-identified, where that leaves something and then less."""
    if explains(winner.search) or is_unknown(winner):
        return look
    found = inquiry.again(winner)
    gained = winner.search.deviance - found.deviance
    if not gained > 0.0:
        return look
    return look.led_by(winner.improved(found, gained))


def _contested(inquiry: Inquiry, look: Look, found: Sequence[Rival]) -> Look:
    """The look with its winner, and what leaves hardly more at the same place, each in all forms.

    A damper and friction that is smooth, each in a plain form, may both reach the noise, and only in their best forms differ;
    and a sharp peak, which no plain form has, is imitated by folds.
    """
    winner, place = look.leader, look.leader.place
    here = [rival for rival in look.rivals if not is_unknown(rival) and rival.place == place]
    close = [rival for rival in here[: 1 + CLOSEST] if _is_close(rival, winner)]
    leaves_little = winner.search.normalised <= CONCEALED or winner.search.deviance < LITTLE * winner.without
    if not leaves_little or len(close) < 2:
        return look
    fitted = [one for rival in close for one in in_all_forms(inquiry, rival, found, winner.search)]
    forms = ranked_by_evidence(fitted, winner.without)
    told = compared(look, best_forms(by_evidence([*look.rivals, *forms])))
    if not explains(told.leader.search):
        return told
    own = [one for one in fitted if identity(one.proposal) == told.leader.identity]
    return evolve(told, formed=told.leader.search, forms=tuple(own))


def _is_close(rival: Rival, winner: Rival) -> bool:
    """Whether another form of it may leave as little as the winner, or less."""
    if winner.search.normalised <= FLOOR and not is_strained(winner.search):
        return rival.search.normalised < CLOSE
    return rival.drop > NEARLY * winner.drop
