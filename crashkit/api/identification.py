"""Identification of models on recordings in files."""

from collections.abc import Sequence
from typing import Any

import xarray as xr
from attrs import frozen

from crashkit.api.files import File, Files, Show, load_runs, path_of, paths_of, silent, told
from crashkit.campaign import one_thread
from crashkit.data.netcdf import write_tree
from crashkit.errors import CrashkitError
from crashkit.misfit import Misfit, fine_step
from crashkit.misfit.bands import predicted_curves
from crashkit.model import Model
from crashkit.model.toml import write_model
from crashkit.protocols import Identification, Identifier, Status
from crashkit.registry import load
from crashkit.report.held import Held, held_in
from crashkit.report.identification import as_text, write_identification


@frozen(repr=False)
class Identified:
    """What was found for a model's free parameters; printed, it is the text of the command line.

    Attributes:
        model: with the values that were found.
        result: the values with their covariance, what the recordings do not see, the path.
        curves: predicted curves with their bands, where they were asked for.
        held: the numbers of the model that were not sought.
    """

    model: Model
    result: Identification
    curves: xr.DataTree | None = None
    held: Sequence[Held] = ()

    def __str__(self) -> str:
        return as_text(self.result, self.curves, self.held)

    __repr__ = __str__


@one_thread
def identify_files(
    model: File,
    runs: Files,
    method: str = "multi_start",
    progress: Show = silent,
    predicted: Files = (),
    output: File | None = None,
    document: File | None = None,
    curves: File | None = None,
) -> Identified:
    """Identify a model's free parameters on recordings.

    Arguments:
        model: the model's file (TOML).
        runs: recordings to fit (netCDF).
        method: an installed identifier.
        progress: told what is being done.
        predicted: recordings that are predicted, not fitted.
        output: file for the identified model; None: it is not written.
        document: file for all that the result says (JSON), likewise.
        curves: file for the predicted curves with their bands, of all recordings (netCDF), likewise.

    Raises CrashkitError for files that cannot be used, and where the model cannot be simulated at the start.
    """
    registry = load()
    given, recordings, others = load_runs(path_of(model), paths_of(runs), paths_of(predicted))
    if not given.free_parameters():
        raise CrashkitError(f"{model}: expected a free parameter, found that all are fixed")
    misfit = Misfit(given, recordings, registry.spring_laws, registry.observers)
    misfit = misfit.with_step(fine_step(misfit))
    result = _identified(registry.identifier(method)(), misfit, progress)
    found, held = given.at(result.values), held_in(given, registry.spring_laws)
    if output:
        write_model(found, path_of(output), registry.spring_laws)
    if document:
        write_identification(result, method, tuple(recordings), path_of(document), held)
    if not curves and not others:
        return Identified(found, result, held=held)
    shown = Misfit(given, recordings | others, registry.spring_laws, registry.observers, misfit.simulator.engine, misfit.step)
    bands = predicted_curves(misfit, shown, result)
    if curves:
        write_tree(bands, path_of(curves))
    return Identified(found, result, bands, held)


def _identified(identifier: Identifier[Any], misfit: Misfit, progress: Show) -> Identification:
    """From start to finish; raises CrashkitError where the model cannot be simulated at the start."""
    state, steps, tell = identifier.start(misfit), 0, told(progress)
    while state.status is Status.RUNNING:
        state, steps = identifier.step(misfit, state), steps + 1
        tell(f"step {steps}: cost {state.cost:.6g}", 0.0)
    if state.status is Status.FAILED:
        raise CrashkitError(f"{identifier.name}: {Status.FAILED.value}")
    return identifier.finish(misfit, state)
