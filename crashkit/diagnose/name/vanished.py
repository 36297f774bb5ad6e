"""Numbers of the model that have vanished: they make room for what the model lacks at that joint."""

from attrs import evolve

from crashkit.campaign import spread
from crashkit.diagnose.claims import identity
from crashkit.diagnose.fitting.candidates import begin_candidates
from crashkit.diagnose.fitting.contest import heats
from crashkit.diagnose.fitting.evidence import best_forms, ranked_by_evidence
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.follow import MOST_FINDINGS, Discovery, is_estimated
from crashkit.diagnose.name.forms import SHARES, along, with_form
from crashkit.diagnose.name.inquiry import Inquiry, open_claims
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.result import UNKNOWN
from crashkit.misfit import Misfit

VANISHED = 0.1
"""Of what the user gave. A force that comes out near 0 makes a gap of the way before it, and the fit may be as good as with a
gap: that number alone tells."""
IMPROBABLE = 59.0
"""Chi squared of that, for numbers that are known to 30 %: (ln 10 / 0.3)^2."""
HEATS = ((40, 6), (6, 10), (2, 60))
"""How many claims enter each heat, and how many steps each gets there."""


def told_by_vanished(inquiry: Inquiry, found: Discovery) -> Discovery:
    """What was found, and what else explains the recordings as well without numbers that have vanished."""
    for joint in vanished_at(inquiry.given, found.search):
        inquiry.progress(f"looking behind numbers of joint {joint} that have vanished", 0.0)
        if len(found.findings) == MOST_FINDINGS or is_estimated(found.findings):
            break
        look = _look_behind(inquiry, found, joint)
        if look.winner is not None and joint not in vanished_at(inquiry.given, look.winner.search):
            search = look.winner.search
            found = evolve(found, final=search.fitted(), search=search, findings=(*found.findings, look))
    return found


def vanished_at(given: Misfit, search: Search) -> list[str]:
    """The joints that have a number that is a tenth of the given one or less, or has the other sign."""
    known = {path: value for path, value in given.values(given.start()).items() if path.startswith("joint.") and value}
    gone = [path for path, value in known.items() if path in search.values and search.values[path] / value < VANISHED]
    return list(dict.fromkeys(path.split(".")[1] for path in gone))


def _look_behind(inquiry: Inquiry, found: Discovery, joint: str) -> Look:
    """All that may act at a joint, its own numbers begun as they were given."""
    own = {
        path: value
        for path, value in inquiry.given.values(inquiry.given.start()).items()
        if path.startswith(f"joint.{joint}.")
    }
    origin = found.final.with_values(own)
    claims = [
        claim
        for claim in open_claims(inquiry, origin, [look.leader for look in found.findings])
        if claim.location.get("joint") == joint and claim.physics != UNKNOWN and not claim.refined
    ]
    workshop = inquiry.workshop.equipped([claim.model for claim in claims])
    starts = [(claim, {**claim.null, **start}) for claim in claims for start in claim.starts]
    ends = spread(lambda start: along(workshop, origin, start, SHARES)[0], starts)
    misfits = [with_form(workshop, origin, claim, end) for (claim, _), end in zip(starts, ends, strict=True)]
    begun = begin_candidates(workshop.identifier, [claim for claim, _ in starts], misfits)
    fitted = ranked_by_evidence(heats(begun, HEATS, inquiry.progress), found.search.deviance + IMPROBABLE)
    return Look.of(best_forms(fitted), found.final, len({identity(claim) for claim in claims}))
