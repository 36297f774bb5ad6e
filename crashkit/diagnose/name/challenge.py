"""What may challenge the winner of a look: other claims, fitted from where it has driven the model's own numbers."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from crashkit.campaign import spread
from crashkit.diagnose.claims import Progress, Start, accuses_instrument, is_same
from crashkit.diagnose.fitting.candidates import Candidate, begin_candidates
from crashkit.diagnose.fitting.contest import heats, promising, scores
from crashkit.diagnose.fitting.evidence import Rival, best_forms, by_evidence, explains, is_unknown, ranked_by_evidence
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.force_matching import most_alike
from crashkit.diagnose.name.forms import with_form
from crashkit.diagnose.name.inquiry import Inquiry, open_claims
from crashkit.diagnose.name.look import Look, compared
from crashkit.diagnose.name.rivals import HEATS
from crashkit.diagnose.result import UNKNOWN, place_of
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Proposal

CHALLENGERS = 2
"""How many of its rivals with fewer numbers challenge a winner."""


def challengers(inquiry: Inquiry, look: Look, found: Sequence[Rival]) -> list[Proposal]:
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


def challenged(inquiry: Inquiry, look: Look, claims: Sequence[Proposal]) -> Look:
    """The look with other claims fitted from where its winner has driven the model's own numbers.

    A load on a stiff tie is a mass that is wrong, and says so in more numbers; the mass may only have stayed in a valley. And
    friction in proportion may have been on the way where a rate effect is not yet.
    """
    winner = look.leader
    workshop = inquiry.workshop.equipped([claim.model for claim in claims])
    origin = look.before.with_values_of(winner.search.fitted())
    begun = _promising(workshop, origin, winner, claims, inquiry.progress)
    if not explains(winner.search):
        begun += _alike(workshop, origin, winner, claims, inquiry.progress)
    everyone = (len(begun), HEATS[0][1])  # begun without their physics all are alike, and none is behind yet
    fitted = ranked_by_evidence(heats(begun, (everyone, *HEATS[1:]), inquiry.progress), winner.without)
    ranked = best_forms(by_evidence([*look.rivals, *fitted]))
    return compared(look, ranked) if not is_unknown(ranked[0]) else look


def _promising(
    workshop: Workshop, origin: Misfit, winner: Rival, claims: Sequence[Proposal], progress: Progress
) -> list[Candidate]:
    """Each claim at the one of its starts that promises most, or where the model is. A loss that begins elsewhere finds no
    way."""
    several = [claim for claim in claims if len(claim.starts) > 1]
    best = promising(scores(workshop, origin, several, 0.0, progress), 1, lambda claim: -np.inf)
    others: list[Start] = [(p, {}) for p in claims if not any(is_same(p, claim) for claim, _ in best)]
    present = winner.search.fitted().model
    starts = [
        (p, {path: start[path] for path in p.parameters if path in start} | masses)
        for p, start in [*best, *others]
        for masses in _masses(p, present)
    ]
    misfits = [with_form(workshop, origin, p, start) for p, start in starts]
    return begin_candidates(workshop.identifier, [p for p, _ in starts], misfits)


def _masses(claim: Proposal, present: Model) -> list[dict[str, float]]:
    """The masses that a claim frees where the present model loads them: as they are there, and with the loads, which may move
    with them or be left behind; of another claim none."""
    values, own = present.values(), {body.name for body in claim.model.bodies}
    loads = {f"body.{body.carrier}.mass": f"body.{body.name}.mass" for body in present.bodies if body.name not in own}
    freed = [path for path in claim.parameters if path in loads]
    laden = {path: values[path] + values[loads[path]] for path in freed}
    return [laden, {path: values[path] for path in freed}] if freed else [{}]


def _alike(
    workshop: Workshop, origin: Misfit, winner: Rival, claims: Sequence[Proposal], progress: Progress
) -> list[Candidate]:
    """The claims at the place of a winner, each where it acts most like that, which is about right along the recorded motion.

    Where the winner has driven the joint's own numbers off, no derivative there tells where another cause begins.
    """
    present, bodies = winner.search.fitted(), {body.name for body in winner.search.misfit.model.bodies}
    at_place = [p for p in claims if place_of(p.location) == winner.place and {b.name for b in p.model.bodies} == bodies]
    doing = f"matching {len(at_place)} claims to {winner.proposal.physics} at {winner.place}"
    return spread(
        partial(_most_alike, workshop, origin, present), at_place, lambda done: progress(doing, done / len(at_place))
    )


def _most_alike(workshop: Workshop, origin: Misfit, present: Misfit, claim: Proposal) -> Candidate:
    """That of several starts from which it then leaves least, its own numbers and those of its joint moved."""
    here = tuple(f"{kind}.{name}." for kind, name in claim.location.items())
    begun = []
    for start in claim.starts:
        misfit = with_form(workshop, origin, claim, {**claim.null, **start})
        names = [name for name in misfit.names if name in claim.parameters or name.startswith(here)]
        alike = misfit.with_values(most_alike(present, misfit, names, workshop.laws))
        begun.append(begin(workshop.identifier, alike))
    return Candidate(claim, min(begun, key=lambda search: search.state.cost))
