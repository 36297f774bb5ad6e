"""What the command line does, as functions on files; each returns what is to be printed, or the result."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import xarray as xr

from crashkit.campaign import one_thread
from crashkit.data.motion import write_motion
from crashkit.data.netcdf import write_tree
from crashkit.data.recording import check_recording, read_recording, write_recording
from crashkit.diagnose import Diagnosis, Workshop, diagnose
from crashkit.diagnose.result import run_name
from crashkit.errors import CrashkitError
from crashkit.mechanics import simulate
from crashkit.misfit import Misfit, fine_step
from crashkit.misfit.bands import predicted_curves
from crashkit.misfit.cross_check import cross_check
from crashkit.model import Model
from crashkit.model.checks import check_recording_against_model
from crashkit.model.toml import read_model, write_model
from crashkit.protocols import Identification, Identifier, Status
from crashkit.registry import Registry, load
from crashkit.report import write_json, write_report
from crashkit.report.cross_check import write_cross_check
from crashkit.report.identification import as_text, write_identification

Show = Callable[[str], None]
SIMULATION_INTERVAL = 1e-4
"""s between the instants of a simulation that is written to a file."""
PROGRESS_INTERVAL = 2.0
"""s between two lines of progress on the same work."""


def load_model(path: Path) -> Model:
    """A model from its file, checked against the installed laws."""
    registry = load()
    return read_model(path, registry.spring_laws, registry.observers)


def load_recordings(paths: Iterable[Path]) -> dict[str, xr.DataTree]:
    """Recordings by run name (their file names; with the folder where two share a name)."""
    paths = list(paths)
    names = [run_name(path) for path in paths]
    schemas = {name: observer.schema for name, observer in load().observers.items()}
    unique = [name if names.count(name) == 1 else str(path) for name, path in zip(names, paths, strict=True)]
    return {name: read_recording(path, schemas) for name, path in zip(unique, paths, strict=True)}


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


def _load(
    model: Path, runs: Sequence[Path], others: Sequence[Path]
) -> tuple[Model, dict[str, xr.DataTree], dict[str, xr.DataTree]]:
    """A model, the recordings to fit and those that are only predicted, each checked against it."""
    given_twice = [path for path, count in Counter(path.resolve() for path in (*runs, *others)).items() if count > 1]
    if given_twice:
        raise CrashkitError(f"{given_twice[0]}: expected each run once, fitted or held out, found it twice")
    given, everything = load_model(model), load_recordings([*runs, *others])
    for name, recording in everything.items():
        check_recording_against_model(recording, given, name)
    pairs = list(everything.items())
    return given, dict(pairs[: len(runs)]), dict(pairs[len(runs) :])


def diagnose_files(
    model: Path,
    runs: Sequence[Path],
    holdout: Sequence[Path],
    output: Path,
    progress: Show,
    seconds: float = math.inf,
) -> Diagnosis:
    """Diagnose a model against recordings; writes diagnosis.json, augmented_model.toml and index.html.

    Arguments:
        seconds: after which no further cause is asked for.
    """
    given, recordings, unseen = _load(model, runs, holdout)
    _make_folder(output)
    result = diagnose(given, recordings, unseen, workshop(), _told(progress), seconds)
    write_model(result.augmented_model, output / "augmented_model.toml", load().spring_laws)
    write_report(result, output)
    write_json(result, output / "diagnosis.json")
    return result


@one_thread
def identify_files(
    model: Path,
    runs: Sequence[Path],
    method: str,
    progress: Show,
    predicted: Sequence[Path] = (),
    output: Path | None = None,
    document: Path | None = None,
    curves: Path | None = None,
) -> str:
    """Identify a model's free parameters on recordings: what was found, for people.

    Arguments:
        method: an installed identifier.
        progress: told what is being done.
        predicted: recordings that are predicted, not fitted.
        output: file for the identified model, if it is wanted.
        document: file for all that the result says, likewise.
        curves: file for the predicted curves with their bands, of all recordings, likewise.
    """
    registry = load()
    given, recordings, others = _load(model, runs, predicted)
    if not given.free_parameters():
        raise CrashkitError(f"{model}: expected a free parameter, found that all are fixed")
    misfit = Misfit(given, recordings, registry.spring_laws, registry.observers)
    misfit = misfit.with_step(fine_step(misfit))
    result = _identified(registry.identifier(method)(), misfit, progress)
    if output:
        write_model(given.with_values(result.values), output, registry.spring_laws)
    if document:
        write_identification(result, method, tuple(recordings), document)
    if not curves and not predicted:
        return as_text(result)
    shown = Misfit(given, recordings | others, registry.spring_laws, registry.observers, misfit.simulator.engine, misfit.step)
    bands = predicted_curves(misfit, shown, result)
    if curves:
        write_tree(bands, curves)
    return as_text(result, bands)


def _identified(identifier: Identifier[Any], misfit: Misfit, progress: Show) -> Identification:
    """From start to finish; raises CrashkitError where the model cannot be simulated at the start."""
    state = identifier.start(misfit)
    while state.status is Status.RUNNING:
        state = identifier.step(misfit, state)
        progress(f"cost {state.cost:.6g}")
    if state.status is Status.FAILED:
        raise CrashkitError(f"{identifier.name}: {Status.FAILED.value}")
    return identifier.finish(misfit, state)


def simulate_file(model: Path, duration: float, output: Path) -> str:
    """Simulate a model from its own initial state; writes the motion."""
    if not 0.0 < duration < np.inf:
        raise CrashkitError(f"duration: expected a positive number of seconds, found {duration}")
    times = np.linspace(0.0, duration, 1 + max(1, round(duration / SIMULATION_INTERVAL)))
    write_motion(simulate(load_model(model), times, load().spring_laws), output)
    return f"wrote {output}"


def cross_check_file(recording: Path, film: str, accelerometer: str, known_velocity: bool, output: Path) -> str:
    """Film against accelerometers of a recording; writes cross_check.nc and index.html, returns the verdicts."""
    tree = next(iter(load_recordings([recording]).values()))
    try:
        check = cross_check(tree, load().observers, film, accelerometer, known_velocity)
    except CrashkitError as error:
        raise CrashkitError(f"{recording}: {error}") from error
    _make_folder(output)
    write_tree(xr.DataTree(check), output / "cross_check.nc")
    write_cross_check(check, run_name(recording), output)
    return "\n".join(check["sentence"].values.tolist())


def list_channels(name: str, source: Path) -> str:
    """The channels that a source of some format holds, as a table."""
    table = load().importer(name)().channels(source)
    return table.to_dataframe().to_string()


def import_recording(name: str, source: Path, output: Path, channels: Sequence[str], options: Mapping[str, str]) -> str:
    """A laboratory's own files as a recording."""
    recording = load().importer(name)().read(source, channels, options)
    check_recording(recording, {kind: observer.schema for kind, observer in load().observers.items()}, str(source))
    write_recording(recording, output)
    return f"wrote {output}"


def check_files(paths: Iterable[Path]) -> str:
    """Validate recordings (netCDF) and models (TOML); one line for each that is as it should be."""
    return "\n".join(_check(path) for path in paths)


def run_demo(seed: int | None, output: Path, open_page: bool, progress: Show) -> str:
    """Conceal a piece of physics in made-up recordings, diagnose them without the secret, and open the seal."""
    from crashkit.demo import run

    return run(seed, output, open_page, progress)


def _check(path: Path) -> str:
    if path.suffix == ".toml":
        load_model(path)
    else:
        load_recordings([path])
    return f"{path}: as it should be"


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CrashkitError(f"{folder}: expected a folder to write to, found {error.strerror}") from error


def _told(progress: Show) -> Callable[[str, float], None]:
    """Progress in whole sentences: new work is told at once, then one line every few seconds."""
    last, told = "", 0.0

    def tell(doing: str, share: float) -> None:
        nonlocal last, told
        work, now = doing.split()[0], monotonic()
        if work != last or now - told > PROGRESS_INTERVAL:
            last, told = work, now
            progress(f"{doing} ({100 * share:.0f} %)" if share else doing)

    return tell
