"""Effects come in twos: name the strongest, look again at what is left, then question each in the light of the others."""

from collections.abc import Mapping, Sequence

import numpy as np
from attrs import field, frozen

from crashkit.diagnose.name import Progress, Rival, best_forms, fit_rivals, identity, probabilities, propose_all
from crashkit.diagnose.search import Search, begin
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Proposal

MOST_FINDINGS = 3
CHANCE = 0.01
"""A finding is made when the probability that there is nothing falls below this."""
LEAST_DROP = 20.0
"""Chi squared that a finding must at least explain: among a hundred trials of noise the largest stays below it."""
STEPS = 60


@frozen
class Round:
    """One look at what is left: the rivals in order, their probabilities, and that of nothing."""

    rivals: tuple[Rival, ...]
    probabilities: tuple[float, ...]
    nothing: float
    before: Misfit

    @property
    def winner(self) -> Rival | None:
        """The rival that convinces, if one does."""
        convincing = bool(self.rivals) and self.nothing < CHANCE and self.rivals[0].drop > LEAST_DROP
        return self.rivals[0] if convincing else None


@frozen
class Discovery:
    """Everything that was found.

    Attributes:
        base: the misfit of the given model, re-identified.
        final: the misfit of the augmented model, at its best fit.
        search: that fit.
        rounds: for each finding, the round that it won in the light of all the others.
        last: the round that found nothing more.
    """

    base: Misfit
    final: Misfit
    search: Search
    rounds: tuple[Round, ...] = field(default=())
    last: Round | None = None


def discover(workshop: Workshop, given: Misfit, base_search: Search, progress: Progress) -> Discovery:
    """All findings that the evidence supports, each in the light of the others.

    Arguments:
        given: the misfit of the model at the values that the user gave.
        base_search: its best fit.
    """
    base = base_search.fitted()
    rounds: list[Round] = []
    current, search = base, base_search
    while True:
        look = _look(workshop, given, current, [r.rivals[0] for r in rounds], progress)
        if look.winner is None or len(rounds) == MOST_FINDINGS:
            break
        rounds.append(look)
        search = look.winner.search
        current = search.fitted()
    if len(rounds) > 1:
        rounds, search = _reconsider(workshop, given, base_search, rounds, progress)
    return Discovery(base, search.fitted(), search, tuple(rounds), look)


def _look(workshop: Workshop, given: Misfit, current: Misfit, found: Sequence[Rival], progress: Progress) -> Round:
    """Every hypothesis that has not been found already, at the places of the given model, against what is left."""
    known = {rival.identity for rival in found}
    everything = propose_all(workshop.hypotheses, current)
    proposals = [p for p in everything if identity(p) not in known and _is_given(given.model, p.location)]
    equipped = workshop.equipped([p.model for p in proposals])
    best = best_forms(fit_rivals(equipped, current, _as_given(current, given), proposals, progress))
    chances, nothing = probabilities(best, len({identity(p) for p in proposals}))
    return Round(tuple(best), tuple(chances.tolist()), nothing, current)


def _reconsider(
    workshop: Workshop, given: Misfit, base_search: Search, rounds: list[Round], progress: Progress
) -> tuple[list[Round], Search]:
    """Takes each finding away in turn, and lets all hypotheses compete again for its place beside the others."""
    kept = [r.rivals[0] for r in rounds]
    looks: list[Round] = []
    search = base_search
    for rival in [r.rivals[0] for r in rounds]:
        others = [other for other in kept if other is not rival]
        without = rebuild(workshop, base_search, others)
        look = _look(workshop, given, without.fitted(), others, progress)
        if look.winner is None:
            kept, search = others, without
            continue
        kept[kept.index(rival)] = look.winner
        looks.append(look)
        search = look.winner.search
    return looks, search


def rebuild(workshop: Workshop, base_search: Search, rivals: Sequence[Rival]) -> Search:
    """The given model with these findings, fitted, from the values that they were found at."""
    search = base_search
    for rival in rivals:
        current = search.fitted()
        proposal = next(p for p in propose_all(workshop.hypotheses, current) if _same(p, rival.proposal))
        found = rival.search.misfit.values(rival.search.point)
        equipped = workshop.equipped([proposal.model])
        misfit = equipped.misfit(current, proposal.model)
        start = {name: found[name] for name in misfit.names if name in found}
        search = begin(workshop.identifier, misfit.with_values(start)).advance(STEPS)
    return search


def _as_given(current: Misfit, given: Misfit) -> Misfit:
    """The current model with its first parameters back at the values that the user gave."""
    known = {name: parameter.value for name, parameter in given.model.free_parameters().items()}
    return current.with_values({name: value for name, value in known.items() if name in current.names})


def _is_given(model: Model, location: Mapping[str, object]) -> bool:
    """What a finding has added is not itself a place for further physics."""
    names = {"joint": [joint.name for joint in model.joints], "body": [body.name for body in model.bodies]}
    return all(location[kind] in known for kind, known in names.items() if kind in location)


def _same(first: Proposal, second: Proposal) -> bool:
    return identity(first) == identity(second) and first.form == second.form


def run_drops(before: Misfit, after: Misfit) -> dict[str, float]:
    """By how much chi squared drops in each run."""
    sums = [misfit.channel_sums(misfit.residual(misfit.start())) for misfit in (before, after)]
    runs = [channel.run for channel in before.channels]
    return {run: float(np.sum((sums[0] - sums[1])[[r == run for r in runs]])) for run in before.recordings}
