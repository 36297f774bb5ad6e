"""Claims that act as an estimated force does, begun at the numbers that the model has beside that."""

from collections.abc import Callable
from functools import partial

from crashkit.campaign import spread
from crashkit.diagnose.claims import first_of_each, identity, propose_all
from crashkit.diagnose.fitting.candidates import Candidate, begin_candidates
from crashkit.diagnose.fitting.contest import heats
from crashkit.diagnose.fitting.evidence import Rival, best_forms, by_evidence, ranked_by_evidence
from crashkit.diagnose.name.forms import along, with_form
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look, compared
from crashkit.diagnose.result import UNKNOWN, place_of
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

SHARES = (1 / 3, 1.0)
"""Of the time recorded, looked at one after the other while only the numbers at the place move."""
FORMS = (16, 8)
"""How many forms go on with all numbers, and how many steps each gets."""
CLAIMS = (4, 60)
"""The same for the best form of each claim."""


def with_imitations(inquiry: Inquiry, look: Look, table: Rival) -> Look:
    """The look with what the known causes at the place of an estimate leave, begun beside that."""
    fitted = ranked_by_evidence(imitating(inquiry, table, look.before), table.without)
    return compared(look, best_forms(by_evidence([*look.rivals, *fitted])))


def imitating(inquiry: Inquiry, table: Rival, without: Misfit) -> list[Candidate]:
    """Fits of the known causes at the place of an estimated force."""
    return begun_beside(inquiry, table, without, lambda claim: claim.physics != UNKNOWN)


def begun_beside(inquiry: Inquiry, table: Rival, without: Misfit, wanted: Callable[[Proposal], bool]) -> list[Candidate]:
    """Fits of such claims at the place of an estimated force.

    A cause that is not named drives the model's own numbers away, and a search that begins there may never come back. Beside
    the estimate they are about right, so that each cause only has to find its own, and those of its place.

    Arguments:
        table: the estimate.
        without: the misfit of the model without it.
        wanted: whether a claim is to be fitted.
    """
    origin, place = without.with_values_of(table.search.fitted()), table.place
    known = [p for p in propose_all(inquiry.workshop, origin) if place_of(p.location) == place and wanted(p)]
    equipped = inquiry.workshop.equipped([proposal.model for proposal in known])
    here = tuple(f"{kind}.{name}." for kind, name in table.proposal.location.items())
    starts = [(proposal, {**proposal.null, **start}) for proposal in known for start in proposal.starts]
    told = partial(inquiry.progress, f"fitting {len(known)} claims to the force estimated at {place}")
    ends = spread(partial(along, equipped, origin, route=SHARES, here=here), starts, lambda done: told(done / len(starts)))
    ranked = sorted(zip((proposal for proposal, _ in starts), ends, strict=True), key=lambda one: one[1][1])
    ahead = first_of_each(ranked, 1)[: FORMS[0]]
    misfits = [with_form(equipped, origin, proposal, values) for proposal, (values, _) in ahead]
    forms = heats(begin_candidates(equipped.identifier, [p for p, _ in ahead], misfits), (FORMS,), inquiry.progress)
    best = first_of_each(sorted(forms, key=lambda one: one.priced), 1, identity)
    return heats(best, (CLAIMS,), inquiry.progress)
