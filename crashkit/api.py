"""What the command line does, as functions on files; each returns the result, or what is to be printed.

Files are named by text or by a `Path`. Where several are asked for, one alone stands for a list of it.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from functools import partial
from os import PathLike
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.campaign import one_thread
from crashkit.data.files import folder_to_fill
from crashkit.data.motion import write_motion
from crashkit.data.netcdf import write_tree
from crashkit.data.recording import check_recording, read_recording, write_recording
from crashkit.diagnose import Diagnosis, Workshop, diagnose
from crashkit.diagnose.result import run_name
from crashkit.errors import CrashkitError, raise_together
from crashkit.mechanics import simulate
from crashkit.misfit import Misfit, fine_step
from crashkit.misfit.bands import predicted_curves
from crashkit.misfit.cross_check import cross_check
from crashkit.misfit.together import check_runs, check_together
from crashkit.model import Model
from crashkit.model.toml import read_model, write_model
from crashkit.protocols import Identification, Identifier, Status
from crashkit.registry import Registry, load
from crashkit.report import write_curves, write_json, write_report
from crashkit.report.cross_check import write_cross_check
from crashkit.report.held import Held, held_in
from crashkit.report.identification import as_text, write_identification

__all__ = [
    "Identified",
    "check_files",
    "cross_check_file",
    "diagnose_files",
    "identify_files",
    "import_recording",
    "list_channels",
    "load_model",
    "load_recordings",
    "run_demo",
    "simulate",
    "simulate_file",
    "workshop",
]

File = str | PathLike[str]
Files = File | Iterable[File]
Show = Callable[[str], None]
SIMULATION_INTERVAL = 1e-4
"""s between the instants of a simulation that is written to a file."""
LONGEST = 100.0
"""s of such a simulation, far beyond any crash: a larger number is one in other units."""
PROGRESS_INTERVAL = 2.0
"""s between two lines of progress on the same work."""


def __dir__() -> list[str]:
    """What people see where they ask for completion."""
    return __all__


def _silent(message: str) -> None:
    """Progress that nobody follows."""


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


def load_model(path: File) -> Model:
    """A model from its file, checked against the installed laws; raises CrashkitError with every fault."""
    registry = load()
    return read_model(_path(path), registry.spring_laws, registry.observers)


def load_recordings(paths: Files) -> dict[str, xr.DataTree]:
    """Recordings by run name (their file names; with the folder where two share a name).

    Raises CrashkitError for a file that is no recording.
    """
    paths = _paths(paths)
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
    if not runs:
        raise CrashkitError("runs: expected at least one recording to fit, found none")
    counts = Counter(path.resolve() for path in (*runs, *others))
    given_twice = [path for path in (*runs, *others) if counts[path.resolve()] > 1]
    if given_twice:
        raise CrashkitError(f"{given_twice[0]}: expected each run once, fitted or held out, found it twice")
    given, everything = load_model(model), load_recordings([*runs, *others])
    check_runs(given, everything, load().observers)
    pairs = list(everything.items())
    return given, dict(pairs[: len(runs)]), dict(pairs[len(runs) :])


def diagnose_files(
    model: File,
    runs: Files,
    holdout: Files = (),
    output: File | None = None,
    progress: Show = _silent,
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
    if not seconds > 0.0:
        raise CrashkitError(f"seconds: expected a number above 0, found {seconds}")
    given, recordings, unseen = _load(_path(model), _paths(runs), _paths(holdout))
    folder = None if output is None else _path(output)
    with folder_to_fill(folder) if folder else nullcontext():
        result = diagnose(given, recordings, unseen, workshop(), _told(progress), seconds)
        if folder:
            write_model(result.augmented_model, folder / "augmented_model.toml", load().spring_laws)
            write_report(result, folder)
            write_curves(result, folder / "curves.nc")
            write_json(result, folder / "diagnosis.json")
    return result


@one_thread
def identify_files(
    model: File,
    runs: Files,
    method: str = "multi_start",
    progress: Show = _silent,
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
    given, recordings, others = _load(_path(model), _paths(runs), _paths(predicted))
    if not given.free_parameters():
        raise CrashkitError(f"{model}: expected a free parameter, found that all are fixed")
    misfit = Misfit(given, recordings, registry.spring_laws, registry.observers)
    misfit = misfit.with_step(fine_step(misfit))
    result = _identified(registry.identifier(method)(), misfit, progress)
    found, held = given.at(result.values), held_in(given, registry.spring_laws)
    if output:
        write_model(found, _path(output), registry.spring_laws)
    if document:
        write_identification(result, method, tuple(recordings), _path(document), held)
    if not curves and not others:
        return Identified(found, result, held=held)
    shown = Misfit(given, recordings | others, registry.spring_laws, registry.observers, misfit.simulator.engine, misfit.step)
    bands = predicted_curves(misfit, shown, result)
    if curves:
        write_tree(bands, _path(curves))
    return Identified(found, result, bands, held)


def _identified(identifier: Identifier[Any], misfit: Misfit, progress: Show) -> Identification:
    """From start to finish; raises CrashkitError where the model cannot be simulated at the start."""
    state, steps, tell = identifier.start(misfit), 0, _told(progress)
    while state.status is Status.RUNNING:
        state, steps = identifier.step(misfit, state), steps + 1
        tell(f"step {steps}: cost {state.cost:.6g}", 0.0)
    if state.status is Status.FAILED:
        raise CrashkitError(f"{identifier.name}: {Status.FAILED.value}")
    return identifier.finish(misfit, state)


def simulate_file(model: File, duration: float, output: File) -> str:
    """Simulate a model from its own initial state, and write the motion.

    Arguments:
        model: the model's file (TOML).
        duration: s, from t = 0.
        output: file for the motion (netCDF).

    Returns:
        what is to be printed.

    Raises CrashkitError for a file or a duration that cannot be used.
    """
    if not 0.0 < duration <= LONGEST:
        raise CrashkitError(f"duration: expected a positive number of seconds, at most {LONGEST:g}, found {duration:g}")
    times = np.linspace(0.0, duration, 1 + max(1, round(duration / SIMULATION_INTERVAL)))
    write_motion(simulate(load_model(model), times), _path(output))
    return f"wrote {output}"


def cross_check_file(
    recording: File,
    film: str = "film",
    accelerometer: str = "accelerometer",
    known_velocity: bool = False,
    output: File | None = None,
) -> str:
    """Film against accelerometers of a recording.

    Arguments:
        recording: its file (netCDF).
        film: the group that saw the displacements.
        accelerometer: the group that felt the accelerations.
        known_velocity: whether the velocity of the group `initial` holds; else it is free.
        output: folder for cross_check.nc and index.html, made if need be; None: nothing is written.

    Returns:
        the verdicts, to be printed.

    Raises CrashkitError for a recording that cannot be used.
    """
    tree = next(iter(load_recordings([recording]).values()))
    try:
        check = cross_check(tree, load().observers, film, accelerometer, known_velocity)
    except CrashkitError as error:
        raise CrashkitError(f"{recording}: {error}") from error
    if output is not None:
        with folder_to_fill(_path(output)):
            write_tree(xr.DataTree(check), _path(output) / "cross_check.nc")
            write_cross_check(check, run_name(_path(recording)), _path(output))
    return "\n".join([*check["sentence"].values.tolist(), *filter(None, [check.attrs["not_compared"]])])


def list_channels(name: str, source: File) -> str:
    """The channels that a source (a folder or a file) of an installed format holds, as a table to be printed."""
    table = load().importer(name)().channels(_path(source))
    return table.to_dataframe().to_string()


def import_recording(
    name: str, source: File, output: File, channels: Sequence[str], options: Mapping[str, str] | None = None
) -> str:
    """Write a laboratory's own files as a recording.

    Arguments:
        name: of an installed format, such as "nhtsa".
        source: folder or file.
        output: file for the recording (netCDF).
        channels: "CHANNEL=BODY:SENSOR", each a channel and the model's body that it sees.
        options: of the format.

    Returns:
        what is to be printed.

    Raises CrashkitError for a source that cannot be used.
    """
    recording = load().importer(name)().read(_path(source), channels, options or {})
    check_recording(recording, {kind: observer.schema for kind, observer in load().observers.items()}, str(source))
    write_recording(recording, _path(output))
    return f"wrote {output}"


def check_files(paths: Files) -> str:
    """Validate recordings (netCDF) and models (TOML), each alone and then each model with all recordings.

    Returns:
        one line for each file that is as it should be.

    Raises CrashkitError with the faults of all files.
    """
    paths = _paths(paths)
    models: dict[Path, Model] = {}
    recordings: dict[str, xr.DataTree] = {}
    raise_together([partial(_check, path, models, recordings) for path in paths])
    observers, pairs = load().observers, models.items() if recordings else ()
    raise_together([partial(check_together, model, recordings, observers, str(path)) for path, model in pairs])
    return "\n".join(f"{path}: as it should be" for path in paths)


def run_demo(seed: int | None = None, output: File = "demo", open_page: bool = True, progress: Show = _silent) -> str:
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

    return run(seed, _path(output), open_page, progress)


def _path(file: File) -> Path:
    if not isinstance(file, str | PathLike):
        raise CrashkitError(f"expected a path, found {file!r}")
    return Path(file)


def _paths(files: Files) -> list[Path]:
    return [_path(file) for file in ([files] if isinstance(files, str | PathLike) else files)]


def _check(path: Path, models: dict[Path, Model], recordings: dict[str, xr.DataTree]) -> None:
    """Check a file alone, and keep what it holds."""
    if path.suffix == ".toml":
        models[path] = load_model(path)
    else:
        recordings[str(path)] = next(iter(load_recordings([path]).values()))


def _told(progress: Show) -> Callable[[str, float], None]:
    """Progress in whole sentences: new work is told at once, then one line every few seconds."""
    last, told = "", 0.0

    def tell(doing: str, share: float) -> None:
        nonlocal last, told
        work, now = doing.split()[0], monotonic()
        if work != last or now - told > PROGRESS_INTERVAL:
            last, told = work, now
            progress(doing)

    return tell
