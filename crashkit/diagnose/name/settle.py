"""A look settled: its winner re-identified, challenged by what says it in fewer numbers, and by what says it as well."""

from collections.abc import Mapping, Sequence

import numpy as np
from attrs import evolve

from crashkit.diagnose.claims import Progress, accuses_instrument, form_of, identity, is_same
from crashkit.diagnose.fitting.candidates import begin_candidates
from crashkit.diagnose.fitting.contest import heats, promising, scores
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
from crashkit.diagnose.name.forms import in_all_forms
from crashkit.diagnose.name.inquiry import Inquiry, open_claims
from crashkit.diagnose.name.look import Look, compared
from crashkit.diagnose.name.rivals import CONCEALED, HEATS
from crashkit.diagnose.result import UNKNOWN, place_of
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Proposal

CHALLENGERS = 2
"""How many of its rivals with fewer numbers challenge a winner."""
CLOSE = 1.1
"""Normalised residual of a rival in a plain form that another form may bring to the noise."""
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
    claims = _challengers(inquiry, look, found)
    return _contested(inquiry, _challenged(inquiry, look, claims) if claims else look, found)


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
        told = _challenged(inquiry, compared(evolve(look, before=without.fitted()), [present]), claims)
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


def _challengers(inquiry: Inquiry, look: Look, found: Sequence[Rival]) -> list[Proposal]:
    """The best rivals that have fewer numbers than the winner, all that the structure may have wrong in one, if it has more,
    and whatever else may act at its place, in plain forms."""
    winner, *others = look.rivals
    size, place = len(winner.proposal.parameters), winner.place
    rivals = [r.proposal for r in others if not is_unknown(r) and len(r.proposal.parameters) < size][:CHALLENGERS]
    claims = [p for p in open_claims(inquiry, look.before, [winner, *found]) if not p.refined and p.physics != UNKNOWN]
    further = [
        p for p in claims if place_of(p.location) == place or (len(p.parameters) == 1 < size and not accuses_instrument(p))
    ]
    return [*rivals, *(p for p in further if not any(is_same(p, rival) for rival in rivals))]


def _challenged(inquiry: Inquiry, look: Look, claims: Sequence[Proposal]) -> Look:
    """The look with other claims fitted from where its winner has driven the model's own numbers.

    A load on a stiff tie is a mass that is wrong, and says so in more numbers; the mass may only have stayed in a valley. And
    friction in proportion may have been on the way where a rate effect is not yet.
    """
    winner = look.leader
    workshop, present = inquiry.workshop.equipped([claim.model for claim in claims]), winner.search.fitted()
    origin = look.before.with_values_of(present)
    starts = _promising_starts(workshop, origin, claims, inquiry.progress)
    misfits = [
        workshop.misfit(origin, claim.model).with_values_of(origin).with_values({**start, **_with_loads(claim, present.model)})
        for claim, start in zip(claims, starts, strict=True)
    ]
    begun = begin_candidates(workshop.identifier, claims, misfits)
    everyone = (len(begun), HEATS[0][1])  # begun without their physics all are alike, and none is behind yet
    fitted = ranked_by_evidence(heats(begun, (everyone, *HEATS[1:]), inquiry.progress), winner.without)
    ranked = best_forms(by_evidence([*look.rivals, *fitted]))
    return compared(look, ranked) if not is_unknown(ranked[0]) else look


def _promising_starts(
    workshop: Workshop, origin: Misfit, claims: Sequence[Proposal], progress: Progress
) -> list[Mapping[str, float]]:
    """Where each claim begins: of several starts at that which promises most. A loss that begins elsewhere finds no way."""
    several = [claim for claim in claims if len(claim.starts) > 1]
    scored = scores(workshop, origin, several, 0.0, progress)
    best = {form_of(claim): start for claim, start in promising(scored, 1, lambda claim: -np.inf)}
    return [{path: v for path, v in best.get(form_of(c), {}).items() if path in c.parameters} for c in claims]


def _with_loads(claim: Proposal, present: Model) -> dict[str, float]:
    """The masses that a claim frees, with the loads on these bodies that the present model has and the claim's has not."""
    values, own = present.values(), {body.name for body in claim.model.bodies}
    loads = {f"body.{body.carrier}.mass": f"body.{body.name}.mass" for body in present.bodies if body.name not in own}
    return {path: values[path] + values[loads[path]] for path in claim.parameters if path in loads}


def _contested(inquiry: Inquiry, look: Look, found: Sequence[Rival]) -> Look:
    """The look with its winner, and what leaves hardly more at the same place, each in all forms.

    A damper and friction that is smooth, each in a plain form, may both reach the noise, and only in their best forms differ;
    and a sharp peak, which no plain form has, is imitated by folds.
    """
    winner, place = look.leader, look.leader.place
    here = [rival for rival in look.rivals if not is_unknown(rival) and rival.place == place]
    close = [rival for rival in here[: 1 + CHALLENGERS] if _is_close(rival, winner)]
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
