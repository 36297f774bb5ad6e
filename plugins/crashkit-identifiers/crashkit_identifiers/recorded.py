"""What a method may need beyond residuals: the model, its laws, and when each residual was recorded."""

import numpy as np

from crashkit.errors import CrashkitError
from crashkit.mechanics import Engine
from crashkit.misfit import Misfit
from crashkit.protocols import Laws, Problem


def with_recordings(problem: Problem, method: str) -> Misfit:
    """The problem as the misfit of a model to recordings; raises CrashkitError where it is another kind of problem."""
    if isinstance(problem, Misfit):
        return problem
    raise CrashkitError(f"{method}: expected a misfit of a model to recordings, found {type(problem).__name__}")


def require_plain_line(misfit: Misfit, method: str) -> None:
    """Raise CrashkitError unless the model has one axis, and only its joints move its bodies."""
    model, others = misfit.model, "a method that simulates, for example sensitivity, takes any"
    if len(model.axes) != 1:
        raise CrashkitError(f"{method}: expected a model in one axis, found {', '.join(model.axes)}; {others}")
    driven = [body.name for body in model.bodies if body.motion is not None or body.force is not None]
    if driven or any(model.gravity):
        found = f"a given motion or force of {', '.join(driven)}" if driven else "gravity"
        raise CrashkitError(f"{method}: expected bodies that only joints move, found {found}; {others}")


def engine_of(misfit: Misfit) -> Engine:
    """What simulates the model."""
    return misfit.predictor.simulator.engine


def laws_of(misfit: Misfit) -> Laws:
    """The laws and factors of the model, by name."""
    return {function.law.name: function.law for function in engine_of(misfit).codes}


def row_times(misfit: Misfit) -> np.ndarray:
    """s, when each residual was recorded."""
    stamps = [np.repeat(group.times, group.recorded.shape[1]) for group in misfit.groups]
    present = [np.isfinite(group.recorded).ravel() for group in misfit.groups]
    return np.concatenate([times[mask] for times, mask in zip(stamps, present, strict=True)])
