"""Identifier: finds a model's free parameters from recordings, one step at a time."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from enum import Enum
from typing import Any, ClassVar, Generic, Protocol, TypeVar

import numpy as np
import xarray as xr
from attrs import field, frozen


class Status(Enum):
    """How an identification ended; the value is the sentence for people."""

    RUNNING = "still improving"
    CONVERGED = "converged: no step lowers the misfit any further"
    STEP_LIMIT = "not converged: the limit on steps was reached"
    STALLED = "not converged: no acceptable step was found, and the gradient is not zero"
    FAILED = "failed: the model could not be simulated at the start"


class Problem(Protocol):
    """What an identifier needs to know of a model and its recordings; `crashkit.misfit` makes it.

    `scaled` values are the search variables: the logarithm of a parameter whose lower bound is above 0, else the parameter
    itself.
    Residuals are divided by their standard deviation and by the correlation of the channel's noise.
    """

    names: tuple[str, ...]

    def start(self) -> np.ndarray: ...
    def bounds(self) -> tuple[np.ndarray, np.ndarray]: ...
    def residual(self, scaled: np.ndarray) -> np.ndarray: ...
    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]: ...
    def parameters(self, scaled: np.ndarray) -> np.ndarray: ...
    def scaling(self, scaled: np.ndarray) -> np.ndarray: ...


@frozen
class Identification:
    """The result of an identification.

    Attributes:
        parameters: Dataset over `parameter` with `value`, `std`, the 95 % interval `interval_lower` to `interval_upper`, the
            bounds `lower` and `upper`, `at_bound`, `identifiable`, `units`, and `covariance` (parameter, parameter_2);
            `std` is NaN where nothing is known of it. Attributes `normalised_residual` (root mean square over noise) and
            `remarks`; where readings were left out also `left_out` (their share, by channel) and
            `normalised_residual_of_all` (with them).
        status: how it ended.
        cost: half the sum of squared weighted residuals.
        unseen: combinations of parameters that the data do not see, as sentences.
        path: Dataset over `step` with `cost` and `value` (step, parameter).
    """

    parameters: xr.Dataset
    status: Status
    cost: float
    unseen: tuple[str, ...] = field(default=())
    path: xr.Dataset | None = None

    @property
    def values(self) -> Mapping[str, float]:
        """The identified values by parameter name."""
        table = self.parameters
        return dict(zip(table["parameter"].values.tolist(), table["value"].values.tolist(), strict=True))


State = TypeVar("State")


class Identifier(ABC, Generic[State]):
    """A method of identification with explicit state, so that it can be watched, stopped and resumed."""

    name: ClassVar[str]

    @abstractmethod
    def start(self, problem: Problem) -> State:
        """The state before the first step."""

    @abstractmethod
    def step(self, problem: Problem, state: State) -> State:
        """One step; a state carries `status`, and no step changes one that is not RUNNING."""

    @abstractmethod
    def finish(self, problem: Problem, state: State) -> Identification:
        """The result of a state, whether it converged or not."""


def advanced(identifier: Identifier[Any], problem: Problem, state: Any, steps: int) -> Any:
    """The state at most so many steps further."""
    for _ in range(steps):
        if state.status is not Status.RUNNING:
            break
        state = identifier.step(problem, state)
    return state


class Regression(Identifier[State]):
    """A capability: the method fits equations that hold at each instant by itself, so that what several models leave of them
    can be put together.
    """

    @abstractmethod
    def moved(self, problem: Problem, state: State, point: np.ndarray) -> State:
        """The state before the first step from another point; what the equations are made of is not made again."""

    @abstractmethod
    def equations(self, problem: Problem, state: State) -> Problem:
        """What is left of the equations, as a problem over the same search variables."""
