"""What a proposal claims, whatever its form, and all that may be claimed of a model."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from crashkit.diagnose.result import place_of
from crashkit.diagnose.workshop import Workshop
from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

Found = TypeVar("Found", bound=tuple[Proposal, Any])
Progress = Callable[[str, float], None]
Start = tuple[Proposal, Mapping[str, float]]
"""A proposal, and values by path to begin at."""


def identity(proposal: Proposal) -> tuple[str, str]:
    """What a proposal claims, whatever its form: the physics and the place."""
    return proposal.physics, place_of(proposal.location)


def is_same(first: Proposal, second: Proposal) -> bool:
    """Whether two proposals, perhaps built on different models, claim the same in the same form."""
    return identity(first) == identity(second) and first.form == second.form


def form_of(proposal: Proposal) -> tuple[str, ...]:
    """What a proposal claims, and in which form."""
    return *identity(proposal), proposal.form


def price_of(proposal: Proposal, samples: float) -> float:
    """Of a claim's numbers, in chi squared: k ln n (Schwarz 1978, doi:10.1214/aos/1176344136)."""
    return float(len(proposal.parameters) * np.log(samples))


def accuses_instrument(proposal: Proposal) -> bool:
    """Whether it says no more than what an instrument reads; that a body turns is said of the body."""
    return not {"sensor", "instrument"}.isdisjoint(proposal.location)


def sensors_read(proposal: Proposal) -> set[str]:
    """The sensors, or instruments, of which it says what they read, by the beginning of their paths."""
    return {path.rpartition(".")[0] for path in proposal.parameters if path.startswith("instrument.")}


def turns(proposal: Proposal) -> bool:
    """Whether it says of a body what its sensors read: how it turns."""
    return bool(sensors_read(proposal)) and not accuses_instrument(proposal)


def propose_all(workshop: Workshop, base: Misfit, physics: str | None = None) -> list[Proposal]:
    """Every hypothesis, or that of one physics, at every place of the model, in every form that can be fitted; none where it
    cannot be simulated, as with numbers that only the equations of motion have led."""
    try:
        motions = [base.predictor.motion(run, base.model.values()) for run in base.recordings]
    except SimulationError:
        return []
    return workshop.proposals(base.model, motions, list(base.recordings.values()), physics)


def proposed_again(workshop: Workshop, base: Misfit, claim: Proposal) -> Proposal | None:
    """The same claim in the same form, built on another model; None where it has no place there."""
    return next((p for p in propose_all(workshop, base, claim.physics) if is_same(p, claim)), None)


def first_of_each(ranked: Sequence[Found], most: int, kind: Callable[[Proposal], tuple[str, ...]] = form_of) -> list[Found]:
    """The best few of each claim in each form, or of another kind."""
    seen: Counter[tuple[str, ...]] = Counter()
    chosen = []
    for one in ranked:
        seen[kind(one[0])] += 1
        if seen[kind(one[0])] <= most:
            chosen.append(one)
    return chosen
