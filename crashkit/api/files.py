"""What every function on files needs: models and recordings by their files, and progress in sentences."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from os import PathLike
from pathlib import Path
from time import monotonic

import xarray as xr

from crashkit.data.recording import read_recording
from crashkit.diagnose.result import run_name
from crashkit.errors import CrashkitError
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
    """Recordings by run name (their file names; with the folder where two share a name).

    Raises CrashkitError for a file that is no recording.
    """
    paths = paths_of(paths)
    names = [run_name(path) for path in paths]
    schemas = {name: observer.schema for name, observer in load().observers.items()}
    unique = [name if names.count(name) == 1 else str(path) for name, path in zip(names, paths, strict=True)]
    return {name: read_recording(path, schemas) for name, path in zip(unique, paths, strict=True)}


def load_runs(
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


def path_of(file: File) -> Path:
    if not isinstance(file, str | PathLike):
        raise CrashkitError(f"expected a path, found {file!r}")
    return Path(file)


def paths_of(files: Files) -> list[Path]:
    return [path_of(file) for file in ([files] if isinstance(files, str | PathLike) else files)]


def silent(message: str) -> None:
    """Progress that nobody follows."""


def told(progress: Show) -> Callable[[str, float], None]:
    """Progress in whole sentences: new work is told at once, then one line every few seconds."""
    last, told = "", 0.0

    def tell(doing: str, share: float) -> None:
        nonlocal last, told
        work, now = doing.split()[0], monotonic()
        if work != last or now - told > PROGRESS_INTERVAL:
            last, told = work, now
            progress(doing)

    return tell
