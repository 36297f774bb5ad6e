"""Name the physics: every hypothesis at every place is scored, the promising ones are fitted, the fitted ones are ranked."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TypeVar

import numpy as np
from attrs import frozen

from crashkit.diagnose.result import place_of
from crashkit.diagnose.score import Score, score
from crashkit.diagnose.search import Search, begin
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Hypothesis, Proposal

Progress = Callable[[str, float], None]
Runner = TypeVar("Runner")

HEATS = ((28, 3), (12, 6), (6, 40))
"""How many rivals enter each heat of fits, and how many steps each of them gets there."""
LEAST_PROMISE = 6.0
"""A drop in chi squared below this is not worth a fit: the evidence asks for more of a single parameter."""
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


def identity(proposal: Proposal) -> tuple[str, str]:
    """What a proposal claims, whatever its form: the physics and the place."""
    return proposal.physics, place_of(proposal.location)


def propose_all(hypotheses: Mapping[str, type[Hypothesis]], base: Misfit) -> list[Proposal]:
    """Every hypothesis at every place of the model, in every form."""
    values = {name: parameter.value for name, parameter in base.model.free_parameters().items()}
    motions = [base.predictor.motion(run, values) for run in base.recordings]
    recordings = list(base.recordings.values())
    return [p for kind in hypotheses.values() for p in kind().propose(base.model, motions, recordings)]


def fit_rivals(workshop: Workshop, base: Misfit, proposals: Sequence[Proposal], progress: Progress) -> list[Rival]:
    """The fitted hypotheses, the most evident first.

    Arguments:
        base: the misfit of the model without them, at its best fit.
        proposals: all of them built on that model.
        progress: told what is being done and how far it is (0 to 1).
    """
    residual = base.residual(base.start())
    scores = _scores(workshop, base, proposals, float(residual @ residual), progress)
    searches = _heats(workshop, base, scores, progress)
    ranked = [_rival(proposal, search, base.deviance(residual)) for proposal, search in searches]
    return sorted(ranked, key=lambda rival: -rival.evidence)


def probabilities(ranked: Sequence[Rival], tried: int) -> tuple[np.ndarray, float]:
    """The probability of each rival, and that there is nothing, from the evidence.

    "Nothing" has even odds beforehand; the other half is shared by all the places and kinds that were tried.
    """
    prior = np.array([UNKNOWN_ODDS if r.proposal.physics == "unknown" else 1.0 for r in ranked]) / max(tried, 1)
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


def _rival(proposal: Proposal, search: Search, reference: float) -> Rival:
    drop = reference - search.deviance
    price = len(proposal.parameters) * np.log(search.misfit.independent_samples)
    return Rival(proposal, search, drop, 0.5 * (drop - float(price)))


def _scores(
    workshop: Workshop, base: Misfit, proposals: Sequence[Proposal], reference: float, progress: Progress
) -> list[Score]:
    tasks = [(proposal, dict(start)) for proposal in proposals for start in proposal.starts]
    scores = []
    for done, (proposal, start) in enumerate(tasks):
        progress(f"scoring {proposal.physics} at {place_of(proposal.location)}", done / len(tasks))
        scores.append(score(proposal, start, workshop.misfit(base, proposal.model), reference))
    return [one for one in scores if one is not None]


def _heats(workshop: Workshop, base: Misfit, scores: Sequence[Score], progress: Progress) -> list[tuple[Proposal, Search]]:
    """Successive halving: a few steps for many, then many steps for the few that are ahead."""
    promising = sorted((s for s in scores if s.drop > LEAST_PROMISE), key=lambda s: -s.drop)
    chosen = _spread(promising, lambda s: identity(s.proposal), HEATS[0][0])
    runners = [
        (s.proposal, begin(workshop.identifier, workshop.misfit(base, s.proposal.model).with_values(s.values))) for s in chosen
    ]
    for size, steps in HEATS:
        ahead = sorted(runners, key=lambda runner: runner[1].state.cost)
        ahead = _spread(ahead, lambda runner: identity(runner[0]), size)
        runners = []
        for done, (proposal, search) in enumerate(ahead):
            progress(f"fitting {proposal.physics} at {place_of(proposal.location)}", done / len(ahead))
            runners.append((proposal, search.advance(steps)))
    return runners


def _spread(ranked: Sequence[Runner], claim: Callable[[Runner], tuple[str, str]], size: int) -> list[Runner]:
    """The first `size`, those after the third of one claim last."""
    seen: Counter[tuple[str, str]] = Counter()
    first, rest = [], []
    for one in ranked:
        seen[claim(one)] += 1
        (first if seen[claim(one)] <= 3 else rest).append(one)
    return (first + rest)[:size]
