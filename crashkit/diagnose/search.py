"""Runs an identifier step by step, so that a diagnosis can drop a hopeless rival after a few steps."""

from typing import Any

import numpy as np
from attrs import evolve, frozen

from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.protocols import Identification, Identifier, Status

LEAST_DROP = 0.02
"""Half a chi squared that a further step must gain: a hundredth of what one parameter gains by chance is not worth a step."""


@frozen
class Search:
    """An identification under way.

    Attributes:
        misfit: the model and the recordings.
        state: of the identifier.
        settled: whether further steps gain next to nothing.
    """

    identifier: Identifier[Any]
    misfit: Misfit
    state: Any
    settled: bool = False

    @property
    def point(self) -> np.ndarray:
        """Where the search stands, in search variables."""
        return np.asarray(self.state.point)

    @property
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

    def advance(self, steps: int) -> "Search":
        """At most so many steps further."""
        search = self
        for _ in range(steps):
            if search.settled or search.state.status is not Status.RUNNING:
                break
            state = self.identifier.step(self.misfit, search.state)
            settled = search.state.cost - state.cost < LEAST_DROP
            search = evolve(search, state=state, settled=settled)
        return search

    def result(self) -> Identification:
        """The identification as it stands; one that has settled counts as converged."""
        outcome = self.identifier.finish(self.misfit, self.state)
        return evolve(outcome, status=Status.CONVERGED) if self.settled else outcome

    def fitted(self) -> Misfit:
        """The misfit with its model at the values found."""
        return self.misfit.with_values(self.misfit.values(self.point))


def begin(identifier: Identifier[Any], misfit: Misfit) -> Search:
    """A search at the model's own values."""
    return Search(identifier, misfit, identifier.start(misfit))
