"""Name the physics: every hypothesis at every place is scored, the promising ones are fitted, the fitted ones are ranked."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from attrs import frozen

from crashkit.diagnose.claims import Progress, Start, first_of_each, identity, is_same
from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.contest import GROWING, heats, promising, scores, scouted
from crashkit.diagnose.fitting.couples import Couple
from crashkit.diagnose.fitting.evidence import (
    FLOOR,
    UNEXPLAINED,
    Rival,
    explains,
    is_at_noise,
    one_explains,
    ranked_by_evidence,
)
from crashkit.diagnose.fitting.from_given import FromGiven
from crashkit.diagnose.fitting.leftover import BY_CHANCE
from crashkit.diagnose.fitting.reidentify import scattered
from crashkit.diagnose.fitting.score import Score
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.fitting.sensor_bound import sensor_of, that_may_reach
from crashkit.diagnose.result import UNKNOWN
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

STARTS = 3
"""How many starts of each form of a claim about a sensor are fitted, from the re-identified values only where they are not
more than enter the first heat: of several frequencies the best is hardly told from derivatives."""
HEATS = ((40, 5), (12, 8), (6, 40))
"""How many of them enter each heat of fits, and how many steps each gets there. Those from the given values have heats of
their own: they begin far above the others, and need more steps to show what they are worth."""
CONCEALED = 1.3
"""Normalised residual of the re-identified model above which it may have hidden physics in wrong values of its own; then the
hypotheses are also fitted from the values that the user gave."""
FORMS = 2
"""In how many forms every claim about the structure is tried first, those that promise most: all mostly leave as much."""
LEADING = 8
"""How many of the claims that are then ahead are tried in all their forms."""
POLISHED = 2
"""How many of the leading claims are then searched again."""
SCATTERED = 6
"""From how many starts each of their forms."""
POLISHING = ((24, 10), (5, 60))
"""The heats of that."""
LEAST_PROMISE = 1e-3
"""A drop in chi squared below this says that nothing of the effect is excited. More is not asked of a model that is above the
noise: its own parameters may hide an effect so well that its score is small."""
NOISE_PROMISE = 0.15
"""Share of the drop that a finding needs which is asked of a model at the noise, at its best fit."""
COUPLED = 0.2
"""Of what the best single claim leaves above the noise: two that leave less are told before any other is asked."""
SENSOR_SHARE = 0.5
"""Of what the best claim about the structure explains: an error of a sensor that cannot explain as much is not what was left
out, or is found next to that."""
SEEN = 4.5
"""Standard deviations from which an effect is found: its chi squared is then that of a finding."""


@frozen
class Limit:
    """The smallest effect that the recordings would have shown.

    Attributes:
        proposal: the physics, its form and place.
        smallest: value of its first parameter.
    """

    proposal: Proposal
    smallest: float


@frozen
class Further:
    """What is found from elsewhere.

    Attributes:
        rivals: single claims, the most evident first.
        couples: two claims at once that leave much less than any of them, the most evident first.
    """

    rivals: Sequence[Rival]
    couples: Sequence[Couple]


def nearest_rivals(
    workshop: Workshop, base: Misfit, proposals: Sequence[Proposal], least: Callable[[Proposal], float], progress: Progress
) -> tuple[list[Rival], list[Limit]]:
    """The fits from the best numbers of the model without the claims, the most evident first, and the smallest effects seen;
    of a model that leaves much none of these, as it is scored at few samples.

    Arguments:
        base: the misfit of that model, at its best fit.
        proposals: all of them built on that model.
        least: the drop in chi squared that a claim needs to be a finding.
        progress: told what is being done and how far it is (0 to 1).
    """
    normalised, strained = standing(base)
    plain, room = [proposal for proposal in proposals if not proposal.refined], _room(base, normalised)
    first = {identity(proposal): proposal for proposal in reversed(plain) if proposal.physics != UNKNOWN}
    asked = [p for p in plain if least(p) < room or first.get(identity(p)) is p]
    # Where much is left, a few samples tell as well where to begin.
    at_first = base if normalised < CONCEALED else base.coarse
    scored = scores(workshop, at_first, asked, 2.0 * _cost(workshop, at_first), progress)
    at_noise = normalised < FLOOR and not strained
    open_ = [(proposal, one) for proposal, one in scored if least(proposal) < room]
    chosen = promising(open_, STARTS, lambda proposal: NOISE_PROMISE * least(proposal) if at_noise else LEAST_PROMISE)
    ahead = _ahead(workshop, base, chosen, progress)
    reference = base.deviance(base.residual(base.start()))
    return ranked_by_evidence(heats(ahead, HEATS, progress), reference), _limits(scored) if at_first is base else []


def _room(base: Misfit, normalised: float) -> float:
    """Chi squared that a claim could still explain: what is left above the noise, where that is told, and what chance adds."""
    samples, is_told = base.independent_samples, all(channel.noise.trusted for channel in base.channels)
    is_little = is_told and normalised < UNEXPLAINED
    return (normalised**2 - 1.0) * samples + BY_CHANCE * np.sqrt(2.0 * samples) if is_little else np.inf


def _ahead(workshop: Workshop, base: Misfit, chosen: Sequence[Start], progress: Progress) -> list[Candidate]:
    """Short fits of the claims about the structure, and of those about a sensor that may explain half as much as the best."""
    astray, most = _astray(workshop, base), HEATS[0][0]
    structure, readings = ([one for one in chosen if (sensor_of(one[0]) is not None) is read] for read in (False, True))
    ahead = _in_leading_forms(workshop, base, first_of_each(structure, 1), astray, progress)
    cost = _cost(workshop, base)
    best = min((search.state.cost for _, search in ahead), default=cost)
    readings = readings if len(readings) <= most else first_of_each(readings, 1)
    further = that_may_reach(workshop.identifier, base, readings, cost - SENSOR_SHARE * (cost - best))
    return [*ahead, *scouted(workshop, base, further, (1.0,), most, astray, progress)]


def _in_leading_forms(
    workshop: Workshop, base: Misfit, starts: Sequence[Start], astray: float, progress: Progress
) -> list[Candidate]:
    """Short fits of each claim in the forms that promise most, and of those that are then ahead in all their forms."""
    first = first_of_each(starts, FORMS, identity)
    ahead = scouted(workshop, base, first, (1.0,), HEATS[0][0], astray, progress)
    leading = list(dict.fromkeys(identity(proposal) for proposal, _ in ahead))[:LEADING]
    rest = [one for one in starts if identity(one[0]) in leading and not any(one is other for other in first)]
    return [*ahead, *scouted(workshop, base, rest, (1.0,), HEATS[0][0], astray, progress)]


def further_rivals(
    workshop: Workshop,
    base: Misfit,
    from_given: FromGiven,
    proposals: Sequence[Proposal],
    nearest: Sequence[Rival],
    afresh: bool,
    progress: Progress,
) -> Further:
    """The nearest rivals, and what is fitted from elsewhere where they leave something.

    Arguments:
        base, proposals, progress: as for `nearest_rivals`.
        from_given: the plain ones of these claims at the values that the user gave.
        nearest: what that found.
        afresh: whether to look from the given values, where the base may hide physics.
    """
    deviance, astray = base.deviance(base.residual(base.start())), _astray(workshop, base)
    fitted = [Candidate(rival.proposal, rival.search) for rival in nearest]
    couples: list[Couple] = []
    if afresh and may_conceal(base) and not _any_explains(fitted):
        found, couples = _from_given(from_given, astray)
        fitted += found
    ranked = ranked_by_evidence(fitted, deviance)
    if ranked and not couples:
        fitted += _polished(workshop, from_given.given, ranked, proposals, astray, progress)
    return Further(ranked_by_evidence(fitted, deviance), couples)


def standing(base: Misfit) -> tuple[float, bool]:
    """The normalised residual of a model, and whether its numbers are strained."""
    residual = base.residual(base.start())
    return float(np.sqrt(residual @ residual / base.independent_samples)), base.is_strained(base.start())


def may_conceal(base: Misfit) -> bool:
    """Whether a fitted model may hide physics in wrong values of its own."""
    normalised, strained = standing(base)
    return strained or normalised > CONCEALED


def _astray(workshop: Workshop, base: Misfit) -> float:
    """What the model without any claim leaves at few instants."""
    return _cost(workshop, base.coarse)


def _cost(workshop: Workshop, misfit: Misfit) -> float:
    """Half the sum of squares that a model leaves at its own values."""
    return float(begin(workshop.identifier, misfit).state.cost)


def _from_given(claims: FromGiven, astray: float) -> tuple[list[Candidate], list[Couple]]:
    """Claims from the values that the user gave: along the measured motion, and where none explains everything, those that it
    says nothing about simulated; and couples of them, where no estimate does that, of which a couple would leave far less.
    """
    workshop, given, progress = claims.workshop, claims.given, claims.progress
    found = claims.singles
    if one_explains(found):
        return found, []
    least = min((search.excess for _, search in found), default=np.inf)
    is_one = any(proposal.physics == UNKNOWN and is_at_noise(search) for proposal, search in found)
    couples = [] if is_one else claims.couples(least)
    if couples and couples[0].search.excess < COUPLED * least:
        return found, couples
    rest = [proposal for proposal, end in zip(claims.proposals, claims.ends, strict=True) if end is None]
    rough = promising(scores(workshop, given.coarse, rest, np.inf, progress), STARTS, lambda _: LEAST_PROMISE)
    begun = scouted(workshop, given, rough, GROWING, HEATS[0][0], astray, progress)
    return [*found, *heats(begun, HEATS, progress)], []


def _any_explains(fitted: Iterable[Candidate]) -> bool:
    return any(explains(search) for _, search in fitted)


def _limits(scores: Iterable[tuple[Proposal, Score]]) -> list[Limit]:
    """Of every claim in its first form, at the start from which the recordings see best.

    Only of what was scored from nothing: elsewhere a deviation is not the smallest size that shows.
    """
    limits: dict[tuple[str, str], Limit] = {}
    for proposal, one in scores:
        path = proposal.parameters[0]
        if proposal.physics == UNKNOWN or one.values[path] != proposal.null.get(path):
            continue
        known = limits.setdefault(identity(proposal), Limit(proposal, np.inf))
        if proposal.form == known.proposal.form:
            limits[identity(proposal)] = Limit(known.proposal, min(known.smallest, SEEN * one.deviation))
    return list(limits.values())


def _polished(
    workshop: Workshop,
    given: Misfit,
    ranked: Sequence[Rival],
    proposals: Sequence[Proposal],
    astray: float,
    progress: Progress,
) -> list[Candidate]:
    """Every form of the leading claims, searched from many starts.

    Only where the winner has not reached the noise floor, or is an estimate: another form of its own, or of its closest
    rivals, may only have been caught in a local optimum. An estimate that reaches the noise gives way to what leaves less: of
    many fine forms, some nearly imitate any force.
    """
    winner = ranked[0]
    at_noise = winner.search.normalised <= FLOOR
    if at_noise and winner.proposal.physics != UNKNOWN:
        return []
    forms = [p for p in proposals if p.physics != UNKNOWN and _leads(p, ranked)]
    starts: list[Start] = []
    for proposal in forms:
        found = next((r.search for r in ranked if is_same(r.proposal, proposal)), None)
        known = found.values if found else {}
        new = {name: known[name] for name in proposal.parameters if name in known}
        origin = workshop.misfit(given, proposal.model).with_values_of(given)
        origins = [origin.with_values(start) for start in ([new] if new else proposal.starts[:SCATTERED])]
        misfits = [misfit for one in origins for misfit in scattered(one, SCATTERED // len(origins))]
        starts += [(proposal, misfit.values(misfit.start())) for misfit in misfits]
    ends = heats(scouted(workshop, given, starts, GROWING, POLISHING[0][0], astray, progress), POLISHING, progress)
    return [one for one in ends if not at_noise or one[1].deviance < winner.search.deviance]


def _leads(proposal: Proposal, ranked: Sequence[Rival]) -> bool:
    known = dict.fromkeys(identity(rival.proposal) for rival in ranked if rival.proposal.physics != UNKNOWN)
    return identity(proposal) in list(known)[:POLISHED]
