"""Runs an identifier step by step, so that a diagnosis can drop a hopeless rival after a few steps."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from attrs import evolve, frozen

from crashkit.campaign import spread
from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.protocols import Identification, Identifier, Status

STEPS = 60
"""Within which most fits settle."""
FIRST_STEPS = 8
"""After which one that was begun again and leaves more than the fit is given up."""
SAME = 1e-3
"""Of what is left, by which the ends of several searches in one optimum may differ."""
REWEIGHTINGS = 3
LEAST_GAIN = 0.02
"""Half a chi squared that a further step must gain: a hundredth of what one parameter gains by chance is not worth a step."""
LEAST_SHARE = 1e-4
"""Of the cost above the noise that one of two steps in a row must gain: far above it, a fit that creeps is not worth its time.
What it would still have gained is hardly ever more than a hundredth."""


@frozen
class Search:
    """An identification under way.

    Attributes:
        misfit: the model and the recordings.
        state: of the identifier.
        settled: whether further steps gain next to nothing.
        crept: whether the last step gained little.
    """

    identifier: Identifier[Any]
    misfit: Misfit
    state: Any
    settled: bool = False
    crept: bool = False

    @property
    def point(self) -> np.ndarray:
        """Where the search stands, in search variables."""
        return np.asarray(self.state.point)

    @cached_property
    def values(self) -> dict[str, float]:
        """The numbers of the model there, by path."""
        return self.misfit.values(self.point)

    @cached_property
    def deviance(self) -> float:
        """Minus twice the log likelihood there; infinite where the model cannot be simulated."""
        if not np.isfinite(self.state.cost):
            return float("inf")
        try:
            return self.misfit.deviance(self.misfit.residual(self.point))
        except SimulationError:
            return float("inf")

    @property
    def normalised(self) -> float:
        """Root mean square residual over noise; 1 is the noise floor."""
        return float(np.sqrt(2.0 * self.state.cost / self.misfit.independent_samples))

    @property
    def excess(self) -> float:
        """Of the mean square residual, in units of noise, above the noise floor."""
        return self.normalised**2 - 1.0

    def advance(self, steps: int) -> "Search":
        """At most so many steps further."""
        search = self
        for _ in range(steps):
            if search.settled or search.state.status is not Status.RUNNING:
                break
            search = search._stepped(self.identifier.step(self.misfit, search.state))
        return search

    def _stepped(self, state: Any) -> "Search":
        gained = self.state.cost - state.cost
        crept = gained < LEAST_SHARE * (state.cost - 0.5 * self.misfit.independent_samples)
        return evolve(self, state=state, settled=gained < LEAST_GAIN or (crept and self.crept), crept=crept)

    def result(self) -> Identification:
        """The identification as it stands; one that has settled counts as converged."""
        outcome = self.identifier.finish(self.misfit, self.state)
        return evolve(outcome, status=Status.CONVERGED) if self.settled else outcome

    def unbelieving(self) -> "Search":
        """The same end, judged by the recordings alone, without what was believed of the model's numbers beforehand."""
        converged = self.settled or self.state.status is Status.CONVERGED
        return evolve(begin(self.identifier, self.fitted().with_prior(math.inf)), settled=converged)

    def fitted(self) -> Misfit:
        """The misfit with its model at the values found."""
        return self.misfit.with_values(self.values)


def begin(identifier: Identifier[Any], misfit: Misfit) -> Search:
    """A search at the model's own values."""
    return Search(identifier, misfit, identifier.start(misfit))


def begin_all(identifier: Identifier[Any], misfits: Sequence[Misfit]) -> list[Search]:
    """Searches at the values of these models, on all cores."""
    states = spread(identifier.start, misfits)
    return [Search(identifier, misfit, state) for misfit, state in zip(misfits, states, strict=True)]


def advance_all(searches: Sequence[Search], steps: int, told: Callable[[int], None] = lambda done: None) -> list[Search]:
    """At most so many steps further with each, on all cores."""

    def standing(search: Search) -> tuple[Any, bool, bool]:
        ahead = search.advance(steps)
        return ahead.state, ahead.settled, ahead.crept

    stood = spread(standing, searches, told)
    return [
        evolve(search, state=state, settled=settled, crept=crept)
        for search, (state, settled, crept) in zip(searches, stood, strict=True)
    ]


def begun_again(search: Search, starts: Iterable[Mapping[str, float]]) -> Search:
    """The fit, or a better one from other values of its numbers; what then leaves more after a few steps is given up."""
    begun = begin_all(search.identifier, [search.fitted().with_values(values) for values in starts])
    ahead = [one for one in advance_all(begun, FIRST_STEPS) if one.state.cost < search.state.cost]
    return min([search, *advance_all(ahead, STEPS)], key=lambda one: one.state.cost)


def weighed(searches: Sequence[Search]) -> list[Search]:
    """Each fit with open noise levels at what it leaves of those channels: a few rounds, as either changes the other."""
    if all(channel.noise.trusted for search in searches for channel in search.misfit.channels):
        return list(searches)
    for _ in range(REWEIGHTINGS):
        again = [search.fitted().reweighted(search.point) for search in searches]
        searches = advance_all(begin_all(searches[0].identifier, again), STEPS)
    return list(searches)


def meet(costs: Sequence[float]) -> bool:
    """Whether several searches have ended in what is hardly anything but one optimum."""
    return len(costs) > 1 and max(costs) - min(costs) < SAME * min(costs)
