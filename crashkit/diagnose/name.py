"""Name the physics: every hypothesis at every place is scored, the promising ones are fitted, the fitted ones are ranked."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial

import numpy as np
from attrs import frozen

from crashkit.campaign import spread
from crashkit.diagnose.reidentify import scattered
from crashkit.diagnose.result import UNKNOWN, place_of
from crashkit.diagnose.score import Score, score
from crashkit.diagnose.search import Search, advance_all, begin, begin_all
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Hypothesis, Proposal

Progress = Callable[[str, float], None]
Entrant = tuple[Proposal, Search]

STARTS = 2
"""How many starts of each form of each claim are fitted from the given values; one is from the re-identified ones."""
HEATS = ((300, 3), (40, 5), (10, 8), (4, 40))
"""How many of them enter each heat of fits, and how many steps each gets there. Those from the given values have heats of
their own: they begin far above the others, and need more steps to show what they are worth."""
CONCEALED = 1.3
"""Normalised residual of the re-identified model above which it may have hidden physics in wrong values of its own; then the
hypotheses are also fitted from the values that the user gave."""
STRAINED = 9.0
"""The same for the chi squared of its departure from what the user gave."""
FLOOR = 1.05
"""Normalised residual above which the winner has not explained everything, and the search goes on."""
GENUINE = 0.95
"""Share of its drop that an estimated table is credited with: two dozen free heights imitate any force of the deformation, and
more closely than a known law whose form is slightly off."""
IMITATING = 0.85
"""The same while it leaves something unexplained."""
GROWING = (1 / 3, 2 / 3, 1.0)
"""Shares of the time recorded that are looked at one after the other where a search begins far from the recordings."""
SCOUTING = 5
"""Steps of a quick search in each."""
POLISHED = 2
"""How many of the leading claims are then searched again."""
SCATTERED = 6
"""From how many starts each of their forms."""
POLISHING = ((24, 10), (5, 60))
"""The heats of that."""
LEAST_PROMISE = 1e-3
"""A drop in chi squared below this says that nothing of the effect is excited. More is not asked of a model that is above the
noise: its own parameters may hide an effect so well that its score is small."""
NOISE_PROMISE = 3.0
"""That is asked of a model at the noise, at its best fit."""
SEEN = 4.5
"""Standard deviations from which an effect is found: its chi squared is then that of a finding."""
UNKNOWN_ODDS = 1e-2
"""Prior odds of an unheard-of force against a known one."""


@frozen
class Rival:
    """A fitted hypothesis.

    Attributes:
        proposal: the physics, its form and place.
        search: the fit of the model with it.
        drop: in deviance against the model without it.
        evidence: log evidence against the model without it (Schwarz 1978, doi:10.1214/aos/1176344136): half of
            drop - parameters x ln(independent samples).
    """

    proposal: Proposal
    search: Search
    drop: float
    evidence: float

    @property
    def identity(self) -> tuple[str, str]:
        """What it claims, whatever its form."""
        return identity(self.proposal)


@frozen
class Limit:
    """The smallest effect that the recordings would have shown.

    Attributes:
        proposal: the physics, its form and place.
        smallest: value of its first parameter.
    """

    proposal: Proposal
    smallest: float


def identity(proposal: Proposal) -> tuple[str, str]:
    """What a proposal claims, whatever its form: the physics and the place."""
    return proposal.physics, place_of(proposal.location)


def propose_all(hypotheses: Mapping[str, type[Hypothesis]], base: Misfit) -> list[Proposal]:
    """Every hypothesis at every place of the model, in every form."""
    values = {name: parameter.value for name, parameter in base.model.free_parameters().items()}
    motions = [base.predictor.motion(run, values) for run in base.recordings]
    recordings = list(base.recordings.values())
    return [p for kind in hypotheses.values() for p in kind().propose(base.model, motions, recordings)]


def fit_rivals(
    workshop: Workshop, base: Misfit, given: Misfit, proposals: Sequence[Proposal], progress: Progress
) -> tuple[list[Rival], list[Limit]]:
    """The fitted hypotheses, the most evident first, and of each claim the smallest effect that would have been seen.

    Arguments:
        base: the misfit of the model without them, at its best fit.
        given: the same at the values that the user gave.
        proposals: all of them built on that model.
        progress: told what is being done and how far it is (0 to 1).
    """
    residual = base.residual(base.start())
    reference = float(residual @ residual)
    scores = _scores(workshop, base, proposals, reference, progress)
    normalised = float(np.sqrt(reference / base.independent_samples))
    strained = base.departure(base.start()) > STRAINED
    at_noise = normalised < FLOOR and not strained
    chosen = _promising(scores, 1, NOISE_PROMISE if at_noise else LEAST_PROMISE)
    fitted = _heats(
        _scouted(workshop, base, [(p, promise.values) for p, promise in chosen], (1.0,), HEATS[0][0]), HEATS, progress
    )
    if (strained or normalised > CONCEALED) and not any(_explains(search) for _, search in fitted):
        rough = _promising(_scores(workshop, given.coarse, proposals, np.inf, progress), STARTS, LEAST_PROMISE)
        fitted += _heats(
            _scouted(workshop, given, [(p, promise.values) for p, promise in rough], GROWING, HEATS[0][0]), HEATS, progress
        )
    rivals = [_rival(proposal, search, base.deviance(residual)) for proposal, search in fitted]
    ranked = sorted(rivals, key=lambda rival: -rival.evidence)
    if ranked and ranked[0].search.normalised > FLOOR:
        ranked += _polished(workshop, given, ranked, proposals, base.deviance(residual), progress)
    return sorted(ranked, key=lambda rival: -rival.evidence), _limits(scores)


def _explains(search: Search) -> bool:
    """Whether nothing is left that another claim could explain better, and no number had to be strained for it."""
    chance = 1.0 / np.sqrt(2.0 * search.misfit.independent_samples)
    told = all(channel.noise.trusted for channel in search.misfit.channels)
    return bool(told and search.normalised < 1.0 + 2.0 * chance and search.misfit.departure(search.point) < STRAINED)


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


def probabilities(ranked: Sequence[Rival], tried: int) -> tuple[np.ndarray, float]:
    """The probability of each rival, and that there is nothing, from the evidence.

    "Nothing" has even odds beforehand; the other half is shared by all the places and kinds that were tried.
    """
    prior = np.array([UNKNOWN_ODDS if r.proposal.physics == UNKNOWN else 1.0 for r in ranked]) / max(tried, 1)
    log_weights = np.append(np.array([r.evidence for r in ranked]) + np.log(prior), 0.0)
    weights = np.exp(log_weights - log_weights.max())
    weights /= weights.sum()
    return weights[:-1], float(weights[-1])


def best_forms(ranked: Iterable[Rival]) -> list[Rival]:
    """The most evident form of each physics at each place."""
    best: dict[tuple[str, str], Rival] = {}
    for rival in ranked:
        best.setdefault(rival.identity, rival)
    return list(best.values())


def _polished(
    workshop: Workshop,
    given: Misfit,
    ranked: Sequence[Rival],
    proposals: Sequence[Proposal],
    reference: float,
    progress: Progress,
) -> list[Rival]:
    """Every form of the leading claims, and of all claims where an unknown force leads to, searched from many starts.

    The winner has not reached the noise floor, and another form of its own or of its closest rivals may only have been caught
    in a local optimum.
    """
    forms = [p for p in proposals if p.physics != UNKNOWN and _leads(p, ranked)]
    starts: list[tuple[Proposal, Mapping[str, float]]] = []
    for proposal in forms:
        found = next((r.search for r in ranked if r.proposal is proposal), None)
        known = found.misfit.values(found.point) if found else {}
        new = {name: known[name] for name in proposal.parameters if name in known} or dict(proposal.starts[0])
        misfits = scattered(workshop.misfit(given, proposal.model).with_values(new), SCATTERED)
        starts += [(proposal, misfit.values(misfit.start())) for misfit in misfits]
    entrants = _scouted(workshop, given, starts, GROWING, POLISHING[0][0])
    return [_rival(proposal, search, reference) for proposal, search in _heats(entrants, POLISHING, progress)]


def _leads(proposal: Proposal, ranked: Sequence[Rival]) -> bool:
    first = ranked[0].proposal
    known = dict.fromkeys(identity(rival.proposal) for rival in ranked if rival.proposal.physics != UNKNOWN)
    at_unknown = first.physics == UNKNOWN and place_of(proposal.location) == place_of(first.location)
    return at_unknown or identity(proposal) in list(known)[:POLISHED]


def _rival(proposal: Proposal, search: Search, reference: float) -> Rival:
    drop = reference - search.deviance
    price = float(len(proposal.parameters) * np.log(search.misfit.independent_samples))
    credit = 1.0 if proposal.physics != UNKNOWN else GENUINE if search.normalised < FLOOR else IMITATING
    return Rival(proposal, search, drop, 0.5 * (credit * drop - price))


def _scores(
    workshop: Workshop, origin: Misfit, proposals: Sequence[Proposal], reference: float, progress: Progress
) -> list[tuple[Proposal, Score]]:
    """Of every proposal from each of its starts, the model's own parameters at their values in `origin`."""

    def scored(proposal: Proposal) -> list[Score | None]:
        misfit = workshop.misfit(origin, proposal.model)
        return [score(proposal, dict(start), misfit, reference) for start in proposal.starts]

    def told(done: int) -> None:
        progress(f"scoring {proposals[done].physics} at {place_of(proposals[done].location)}", done / len(proposals))

    found = zip(proposals, spread(scored, proposals, told), strict=True)
    return [(proposal, one) for proposal, scores in found for one in scores if one is not None]


def _promising(scores: Sequence[tuple[Proposal, Score]], most: int, least: float) -> list[tuple[Proposal, Score]]:
    """The best starts of every form of every claim that promises a drop of `least`."""
    promising = [(proposal, one) for proposal, one in scores if one.drop > least or not proposal.null]
    return _first_of_each(sorted(promising, key=lambda one: -one[1].drop), most)


def _scouted(
    workshop: Workshop,
    origin: Misfit,
    starts: Sequence[tuple[Proposal, Mapping[str, float]]],
    shares: Sequence[float],
    most: int,
) -> list[Entrant]:
    """Searches from where quick ones at few instants end, of which the best go on.

    In growing shares of the time a search seldom jumps over a threshold; instruments have none.
    """
    slices = [early for early in (origin.coarse.up_to(share) for share in shares) if early.groups]

    def scouted(start: tuple[Proposal, Mapping[str, float]]) -> tuple[Mapping[str, float], float]:
        proposal, values = start
        for early in slices[-1:] if workshop.hypotheses[proposal.physics].sensor else slices:
            misfit = workshop.misfit(early, proposal.model).with_values(values)
            search = begin(workshop.identifier, misfit).advance(SCOUTING)
            values = misfit.values(search.point)
        return values, search.state.cost

    found = zip(starts, spread(scouted, starts), strict=True)
    ahead = sorted(((proposal, *end) for (proposal, _), end in found), key=lambda one: one[2])[:most]
    misfits = [workshop.misfit(origin, proposal.model).with_values(values) for proposal, values, _ in ahead]
    return list(zip((proposal for proposal, *_ in ahead), begin_all(workshop.identifier, misfits), strict=True))


def _first_of_each(ranked: Sequence[tuple[Proposal, Score]], most: int) -> list[tuple[Proposal, Score]]:
    """The best few of each claim in each form."""
    seen: Counter[tuple[str, ...]] = Counter()
    chosen = []
    for one in ranked:
        key = (*identity(one[0]), one[0].form)
        seen[key] += 1
        if seen[key] <= most:
            chosen.append(one)
    return chosen


def _heats(entrants: Sequence[Entrant], heats: Sequence[tuple[int, int]], progress: Progress) -> list[Entrant]:
    """Successive halving: a few steps for all, then many steps for the few that are ahead."""
    for size, steps in heats:
        ahead = sorted(entrants, key=lambda entrant: entrant[1].state.cost)[:size]
        proposals = [proposal for proposal, _ in ahead]
        told = partial(_told, progress, proposals)
        entrants = list(zip(proposals, advance_all([search for _, search in ahead], steps, told), strict=True))
    return list(entrants)


def _told(progress: Progress, proposals: Sequence[Proposal], done: int) -> None:
    progress(f"fitting {proposals[done].physics} at {place_of(proposals[done].location)}", done / len(proposals))
