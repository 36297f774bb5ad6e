"""Diagnoses of models and recordings in files."""

import math
from collections.abc import Mapping
from contextlib import nullcontext

import xarray as xr
from attrs import evolve

from crashkit.api.files import File, Files, Show, check_given, heard, load_runs, path_of, paths_of, silent, told
from crashkit.data.files import folder_to_fill
from crashkit.data.silent import left_out_of
from crashkit.diagnose import Diagnosis, Workshop, diagnose
from crashkit.errors import CrashkitError
from crashkit.model import Model
from crashkit.model.toml import write_model
from crashkit.registry import Registry, load
from crashkit.report import write_curves, write_json, write_report


def workshop(
    registry: Registry | None = None,
    method: str = "sensitivity",
    finder: str = "multi_start",
    starter: str = "quick_state_form",
    locator: str = "state_form",
    smoother: str = "gcv_quintic",
) -> Workshop:
    """The installed plugins, ready for a diagnosis."""
    registry = registry or load()
    return Workshop(
        registry.spring_laws,
        registry.observers,
        registry.hypotheses,
        registry.smoother(smoother)(),
        registry.identifier(method)(),
        registry.identifier(finder)(),
        registry.regression(starter)(),
        registry.regression(locator)(),
    )


def diagnose_files(
    model: File,
    runs: Files,
    holdout: Files = (),
    output: File | None = None,
    progress: Show = silent,
    seconds: float = math.inf,
) -> Diagnosis:
    """Diagnose a model against recordings.

    Arguments:
        model: the model's file (TOML).
        runs: recordings to fit (netCDF).
        holdout: recordings that are predicted, not fitted, unless only more physics explains them.
        output: folder for index.html, diagnosis.json, curves.nc and augmented_model.toml, made if need be; None: nothing is
            written.
        progress: told what is being done.
        seconds: after which no further cause is asked for, above 0.

    Raises CrashkitError for files that cannot be used, with every fault.
    """
    given, recordings, unseen = load_runs(path_of(model), paths_of(runs), paths_of(holdout))
    folder = None if output is None else path_of(output)
    with folder_to_fill(folder) if folder else nullcontext():
        result = diagnose_recordings(given, recordings, unseen, progress, seconds)
        if folder:
            write_model(result.augmented_model, folder / "augmented_model.toml", load().spring_laws)
            write_report(result, folder)
            write_curves(result, folder / "curves.nc")
            write_json(result, folder / "diagnosis.json")
    return result


def diagnose_recordings(
    model: Model,
    recordings: Mapping[str, xr.DataTree],
    holdout: Mapping[str, xr.DataTree] | None = None,
    progress: Show = silent,
    seconds: float = math.inf,
) -> Diagnosis:
    """The same for a model and recordings in memory; `crashkit.report` writes what it says.

    Arguments:
        model: as the user believes it.
        recordings: to fit, by the names of their runs.
        holdout: to predict, likewise, under other names.
        progress, seconds: as above.

    Raises CrashkitError for a recording that breaks the data contract or does not suit the model, with every fault.
    """
    if not seconds > 0.0:
        raise CrashkitError(f"seconds: expected a number above 0, found {seconds}")
    check_given(model, recordings, holdout or {})
    fitted, predicted = heard(recordings), heard(holdout or {})
    result = diagnose(model, fitted, predicted, workshop(), told(progress), seconds)
    left_out = (sentence for run in (*fitted.values(), *predicted.values()) for sentence in left_out_of(run))
    return evolve(result, notes=(*result.notes, *left_out))


def run_demo(seed: int | None = None, output: File = "demo", open_page: bool = True, progress: Show = silent) -> str:
    """Conceal a piece of physics in made-up recordings, diagnose them without the secret, and open the seal.

    Arguments:
        seed: which secret; None: a new one each time.
        output: folder for everything.
        open_page: whether to show the page in a browser, if there is one.
        progress: told what is being done.

    Returns:
        the answer and whether it was right, to be printed.
    """
    from crashkit.demo import run

    return run(seed, path_of(output), open_page, progress)
