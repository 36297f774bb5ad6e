"""How evident a fitted claim is: what it explains less the price of its numbers."""

from collections.abc import Iterable, Sequence

import numpy as np
from attrs import evolve, frozen

from crashkit.diagnose.claims import identity, price_of
from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.result import UNKNOWN, place_of
from crashkit.protocols import Proposal

FLOOR = 1.05
"""Normalised residual above which the winner has not explained everything, and the search goes on."""
UNEXPLAINED = 1.15
"""Normalised residual above which a model is not called consistent, and findings are not the whole explanation."""
GENUINE = 0.98
"""Share of its drop that an estimated table is credited with: two dozen free heights imitate any law, and more closely than a
known one whose form is off by a seventh."""
IMITATING, REACHING = 0.85, 1.09
"""The same of a table that anything is imitated by, and the normalised residual below which it does more than imitate."""
IMITATION = 0.1
"""Of what the best known claim leaves above the noise: nor does one that leaves less than that only imitate."""
FROM_AFAR = "distance"
"""What depends on it imitates more than laws of the deformation, as a joint that pulls: to reach the noise says little."""
OF_DEFORMATION = ("deformation", FROM_AFAR, "travel")
IN_TIME = "time"
"""What estimates depend on that imitate: most known laws are of the deformation, and in a single run each is a force of the
time. In several, a force of the deformation comes at another time in each."""
FAR_LESS = 0.5
"""Of what is left above the noise: a table that leaves less than that of what another of its place does is told instead."""
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
            drop - parameters x ln(independent samples), with the odds of its form.
    """

    proposal: Proposal
    search: Search
    drop: float
    evidence: float

    @property
    def identity(self) -> tuple[str, str]:
        """What it claims, whatever its form."""
        return identity(self.proposal)

    @property
    def place(self) -> str:
        """Where, for people."""
        return place_of(self.proposal.location)

    @property
    def without(self) -> float:
        """Deviance of the model without the claim."""
        return self.search.deviance + self.drop

    def improved(self, search: Search, gained: float) -> "Rival":
        """The same claim at a fit that explains so much more, in chi squared."""
        return evolve(self, search=search, drop=self.drop + gained, evidence=self.evidence + 0.5 * gained)


def is_unknown(rival: Rival) -> bool:
    """Whether it claims a force that no list has."""
    return rival.proposal.physics == UNKNOWN


def by_evidence(rivals: Iterable[Rival]) -> list[Rival]:
    """The most evident first."""
    return sorted(rivals, key=lambda rival: -rival.evidence)


def ranked_by_evidence(fitted: Iterable[Candidate], reference: float) -> list[Rival]:
    """Fits weighed against the deviance of the model without any claim, the most evident first."""
    fitted = list(fitted)
    known = min((search.excess for proposal, search in fitted if proposal.physics != UNKNOWN), default=0.0)
    rivals = (rival_of(proposal, search, reference, known) for proposal, search in fitted)
    return by_evidence(rivals)


def rival_of(proposal: Proposal, search: Search, reference: float, known: float = 0.0) -> Rival:
    """A fit weighed against the deviance of the model without the claim.

    Arguments:
        known: what the best known claim leaves above the noise.
    """
    drop = reference - search.deviance
    price = price_of(proposal, search.misfit.independent_samples)
    credit = _credit(proposal, search, known)
    return Rival(proposal, search, drop, 0.5 * (credit * drop - price) + float(np.log(proposal.odds)))


def _credit(proposal: Proposal, search: Search, known: float) -> float:
    """The share of its drop that a claim is credited with."""
    if proposal.physics != UNKNOWN:
        return 1.0
    of = proposal.estimate_of
    imitates = of in OF_DEFORMATION or (of == IN_TIME and len(search.misfit.recordings) == 1)
    reaches = search.excess < IMITATION * known or (search.normalised < REACHING and of != FROM_AFAR)
    return IMITATING if imitates and not reaches else GENUINE


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
    """The most evident form of each physics at each place; of an estimate the one that fits, with the evidence of that.

    That a table may imitate known laws says nothing against it where another of the same place leaves far more.
    """
    best: dict[tuple[str, str], Rival] = {}
    for rival in ranked:
        first = best.setdefault(rival.identity, rival)
        if rival.proposal.physics == UNKNOWN and rival.search.excess < FAR_LESS * first.search.excess:
            best[rival.identity] = evolve(rival, evidence=first.evidence)
    return list(best.values())


def by_chance(samples: float) -> float:
    """Normalised residual that chance leaves of so many independent samples, two standard deviations above 1."""
    return float(1.0 + 2.0 / np.sqrt(2.0 * samples))


def is_at_noise(search: Search) -> bool:
    """Whether no more is left than chance would leave."""
    return search.normalised < by_chance(search.misfit.independent_samples)


def explains(search: Search) -> bool:
    """Whether nothing is left that another claim could explain better, and no number had to be strained for it."""
    return is_at_noise(search) and is_sound(search)


def one_explains(fitted: Iterable[Candidate]) -> bool:
    """Whether a known claim alone leaves nothing to speak of, and no number had to be strained for it."""
    known = [search for proposal, search in fitted if proposal.physics != UNKNOWN]
    return any(search.normalised <= FLOOR and not is_strained(search) for search in known)


def is_sound(search: Search) -> bool:
    """Whether the noise is told, and no number had to be strained for the fit."""
    told = all(channel.noise.trusted for channel in search.misfit.channels)
    return told and not is_strained(search)


def is_strained(search: Search) -> bool:
    """Whether the model's own numbers are so far from what the user gave that they may make up for physics."""
    return search.misfit.is_strained(search.point)
