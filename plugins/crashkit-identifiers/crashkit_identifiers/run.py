"""A whole identification."""

from typing import Any

from crashkit.campaign import one_thread
from crashkit.protocols import Identification, Identifier, Problem, Status


@one_thread
def run(identifier: Identifier[Any], problem: Problem) -> Identification:
    """From start to finish."""
    state = identifier.start(problem)
    while state.status is Status.RUNNING:
        state = identifier.step(problem, state)
    return identifier.finish(problem, state)
