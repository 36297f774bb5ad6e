"""What a diagnosis works with: the installed plugins, an identifier, and one compiled engine for every model it tries."""

import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from attrs import evolve, field, frozen

from crashkit.campaign import spread
from crashkit.diagnose.proposed import check_models, proposed_by
from crashkit.errors import CrashkitError, SimulationError
from crashkit.mechanics import Engine, Simulator, can_be_derived, compile_engine, functions_of
from crashkit.misfit import Misfit
from crashkit.misfit.predictor import STEP
from crashkit.model import Model
from crashkit.protocols import Hypothesis, Identifier, Observer, Proposal, Regression, Smoother, SpringLaw
from crashkit.registry import load


@frozen
class Workshop:
    """The plugins by name, an identifier for every fit, one that looks everywhere for a first, two that need no simulation, to
    find a start and a place, the engine and its step, s; the hypotheses that failed, which are not asked again by any workshop
    that is made of this one."""

    laws: Mapping[str, type[SpringLaw]]
    observers: Mapping[str, type[Observer]]
    hypotheses: Mapping[str, type[Hypothesis]]
    smoother: Smoother
    identifier: Identifier[Any]
    finder: Identifier[Any]
    starter: Regression[Any]
    locator: Regression[Any]
    engine: Engine | None = field(default=None)
    step: float = STEP
    failed: set[str] = field(factory=set, eq=False, repr=False)

    def misfit(self, base: Misfit, model: Model) -> Misfit:
        """The misfit of another model to the same recordings, weighed alike."""
        return base.with_model(model, self.laws, self.engine)

    def first_misfit(self, model: Model, recordings: Mapping[str, xr.DataTree]) -> Misfit:
        """The misfit of a model to some recordings."""
        return Misfit(model, recordings, self.laws, self.observers, self.engine, self.step)

    def holds(self, model: Model) -> bool:
        """Whether the engine holds all laws of a model."""
        return self.engine is not None and functions_of(model, self.laws) <= self.engine.codes.keys()

    def equipped(self, models: Iterable[Model]) -> "Workshop":
        """The same with an engine that also holds the laws of these models."""
        models = list(models)
        known = frozenset(self.engine.codes) if self.engine else frozenset()
        functions = known.union(*(functions_of(model, self.laws) for model in models))
        return self if functions == known else evolve(self, engine=compile_engine(functions, len(models[0].axes)))

    def rehearsed(self, model: Model, recordings: Iterable[xr.DataTree]) -> "Workshop":
        """The same with an engine for the model and for every law that a hypothesis may bring to it.

        Compiling takes seconds, so it is done once: the hypotheses are asked beforehand, with a motion that excites all.
        """
        motion, recordings = [_lively_motion(model)], list(recordings)
        proposals = self.proposals(model, motion, recordings)
        for physics in self.hypotheses:
            with self._leaving_out(physics):
                check_models((one for one in proposals if one.physics == physics), model, self.laws)
        models = [model, *(proposal.model for proposal in proposals if proposal.physics not in self.failed)]
        models += [_side_by_side(one) for one in models]
        # On a new computer one core compiles the kernel while another compiles the laws: what either leaves on disk is found.
        spread(lambda compile_on_disk: compile_on_disk(), [partial(self._run, model), partial(self._compile, models)])
        return self.equipped(models)

    def proposals(
        self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree], physics: str | None = None
    ) -> list[Proposal]:
        """What the hypotheses, or that of one physics, say may be left out of a model, where the laws that it takes give
        sensitivities: a long curve has no room for all that others have. One that fails is left out, with a warning."""
        own, usable = functions_of(model, self.laws), []
        for name in (one for one in self.hypotheses if one not in self.failed and physics in (None, one)):
            with self._leaving_out(name):
                proposed = proposed_by(self.hypotheses[name], model, motion, recordings)
                usable += [p for p in proposed if all(map(can_be_derived, functions_of(p.model, self.laws) - own))]
        return usable

    def _run(self, model: Model) -> None:
        """A first simulation, which compiles the kernel."""
        with suppress(SimulationError):
            Simulator(model, self.laws, self.equipped([model]).engine).record(np.array([0.0, 1e-6]))

    def _compile(self, models: Sequence[Model]) -> None:
        self.equipped(models)

    @contextmanager
    def _leaving_out(self, physics: str) -> Iterator[None]:
        """A hypothesis that does something wrong is not asked again, and that is told once."""
        try:
            yield
        except CrashkitError as error:
            self.failed.add(physics)
            source = load().source_of(self.hypotheses[physics])
            warnings.warn(f"hypothesis {physics} of {source}: {error}; left out", stacklevel=2)


def _side_by_side(model: Model) -> Model:
    """Sums of laws taken apart: a second finding at a joint stands beside the first."""
    joints = [evolve(j, name=f"{j.name}{n}", law=law) for j in model.joints for n, law in enumerate(j.law.split(" + "))]
    return evolve(model, joints=tuple(joints))


def _lively_motion(model: Model) -> xr.Dataset:
    """Every joint is compressed and stretched, every body moves and comes nearer to all others; the sizes mean nothing."""
    joints, bodies = [joint.name for joint in model.joints], [body.name for body in model.bodies]
    ramp = np.array([0.0, 0.1, -0.1])
    start = np.array([body.position for body in model.bodies], dtype=float)
    position = np.array([(1.0 - 0.3 * i) * start + 0.1 * i * np.arange(1, start.shape[1] + 1) for i in range(3)])
    by_joint = (("time", "joint"), np.tile(ramp[:, None], (1, len(joints))))
    return xr.Dataset(
        {
            "position": (("time", "body", "axis"), position),
            "velocity": (("time", "body", "axis"), np.gradient(position, 0.1, axis=0)),
            "deformation": by_joint,
            "deformation_rate": by_joint,
            "force": by_joint,
        },
        coords={"time": [0.0, 0.1, 0.2], "joint": joints, "body": bodies, "axis": list(model.axes)},
    )
