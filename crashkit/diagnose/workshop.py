"""What a diagnosis works with: the installed plugins, an identifier, and one compiled engine for every model it tries."""

from collections.abc import Iterable, Mapping
from typing import Any

import xarray as xr
from attrs import evolve, frozen

from crashkit.mechanics import Engine, compile_engine, functions_of
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Hypothesis, Identifier, Observer, Smoother, SpringLaw


@frozen
class Workshop:
    """The plugins by name, the identifier, and the engine."""

    laws: Mapping[str, type[SpringLaw]]
    observers: Mapping[str, type[Observer]]
    hypotheses: Mapping[str, type[Hypothesis]]
    smoother: Smoother
    identifier: Identifier[Any]
    engine: Engine | None = None

    def misfit(self, base: Misfit, model: Model) -> Misfit:
        """The misfit of another model to the same recordings, weighed alike."""
        return base.with_model(model, self.laws, self.engine)

    def first_misfit(self, model: Model, recordings: Mapping[str, xr.DataTree]) -> Misfit:
        """The misfit of a model to some recordings."""
        return Misfit(model, recordings, self.laws, self.observers, self.engine)

    def equipped(self, models: Iterable[Model]) -> "Workshop":
        """The same with one engine that holds the laws of all these models: it is compiled once."""
        functions = {function for model in models for function in functions_of(model, self.laws)}
        return evolve(self, engine=compile_engine(functions))
