"""What every function on files needs: models and recordings by their files, and progress in sentences."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from os import PathLike
from pathlib import Path
from time import monotonic

import xarray as xr

from crashkit.data.recording import check_recording, read_recording
from crashkit.data.silent import without_silent
from crashkit.diagnose.result import run_name
from crashkit.errors import CrashkitError, raise_together
from crashkit.misfit.together import check_runs
from crashkit.model import Model
from crashkit.model.toml import read_model
from crashkit.registry import load

File = str | PathLike[str]
Files = File | Iterable[File]
Show = Callable[[str], None]
PROGRESS_INTERVAL = 2.0
"""s between two lines of progress on the same work."""


def load_model(path: File) -> Model:
    """A model from its file, checked against the installed laws; raises CrashkitError with every fault."""
    registry = load()
    return read_model(path_of(path), registry.spring_laws, registry.observers)


def load_recordings(paths: Files) -> dict[str, xr.DataTree]:
    """Recordings by run name: their file names; with the folder where two share a name. As they are `heard`.

    Raises CrashkitError for a file that is no recording.
    """
    paths = paths_of(paths)
    names = [run_name(path) for path in paths]
    schemas = {name: observer.schema for name, observer in load().observers.items()}
    unique = [name if names.count(name) == 1 else str(path) for name, path in zip(names, paths, strict=True)]
    return heard({name: read_recording(path, schemas) for name, path in zip(unique, paths, strict=True)})


def heard(recordings: Mapping[str, xr.DataTree]) -> dict[str, xr.DataTree]:
    """Recordings, by the names of their runs, without sensors that recorded nothing, of which a warning tells."""
    return {run: without_silent(run, recording, load().observers) for run, recording in recordings.items()}


def load_runs(
    model: Path, runs: Sequence[Path], others: Sequence[Path]
) -> tuple[Model, dict[str, xr.DataTree], dict[str, xr.DataTree]]:
    """A model, the recordings to fit and those that are only predicted, each checked against it."""
    counts = Counter(path.resolve() for path in (*runs, *others))
    given_twice = [path for path in (*runs, *others) if counts[path.resolve()] > 1]
    if given_twice:
        raise CrashkitError(f"{given_twice[0]}: expected each run once, fitted or held out, found it twice")
    pairs = list(load_recordings([*runs, *others]).items())
    given, fitted, predicted = load_model(model), dict(pairs[: len(runs)]), dict(pairs[len(runs) :])
    check_given(given, fitted, predicted)
    return given, fitted, predicted


def check_given(model: Model, recordings: Mapping[str, xr.DataTree], others: Mapping[str, xr.DataTree]) -> None:
    """Whether recordings to fit and to predict, by the names of their runs, keep the data contract and suit a model.

    Raises CrashkitError with every fault of the recordings, or of what they share with the model.
    """
    if not recordings:
        raise CrashkitError("runs: expected at least one recording to fit, found none")
    if both := sorted(set(recordings) & set(others)):
        raise CrashkitError(f"{both[0]}: expected each run once, fitted or held out, found it twice")
    everything, observers = {**recordings, **others}, load().observers
    schemas = {name: observer.schema for name, observer in observers.items()}
    raise_together([partial(check_recording, tree, schemas, run) for run, tree in everything.items()])
    check_runs(model, everything, observers)


def path_of(file: File) -> Path:
    """The path of a file; raises CrashkitError for what is none."""
    if not isinstance(file, str | PathLike):
        raise CrashkitError(f"expected a path, found {file!r}")
    return Path(file)


def paths_of(files: Files) -> list[Path]:
    """The paths of several files, or of one."""
    return [path_of(file) for file in ([files] if isinstance(files, str | PathLike) else files)]


def silent(message: str) -> None:
    """Progress that nobody follows."""


def told(progress: Show) -> Callable[[str, float], None]:
    """Progress in whole sentences: new work is told at once, then one line every few seconds."""
    last, when = "", 0.0

    def tell(doing: str, share: float) -> None:
        nonlocal last, when
        work, now = doing.split()[0], monotonic()
        if work != last or now - when > PROGRESS_INTERVAL:
            last, when = work, now
            progress(doing)

    return tell
