"""Recordings and models in files: imported, checked, compared, simulated."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from crashkit.api.files import File, Files, load_model, load_recordings, path_of, paths_of
from crashkit.data.files import folder_to_fill
from crashkit.data.motion import write_motion
from crashkit.data.netcdf import write_tree
from crashkit.data.recording import check_recording, write_recording
from crashkit.diagnose.result import run_name
from crashkit.errors import CrashkitError, raise_together
from crashkit.mechanics import simulate
from crashkit.misfit.cross_check import cross_check
from crashkit.misfit.together import check_together
from crashkit.model import Model
from crashkit.registry import load
from crashkit.report.cross_check import write_cross_check

SIMULATION_INTERVAL = 1e-4
"""s between the instants of a simulation that is written to a file."""
LONGEST = 100.0
"""s of such a simulation, far beyond any crash: a larger number is one in other units."""


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
    write_motion(simulate(load_model(model), times), path_of(output))
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
        with folder_to_fill(path_of(output)):
            write_tree(xr.DataTree(check), path_of(output) / "cross_check.nc")
            write_cross_check(check, run_name(path_of(recording)), path_of(output))
    return "\n".join([*check["sentence"].values.tolist(), *filter(None, [check.attrs["not_compared"]])])


def list_channels(name: str, source: File) -> str:
    """The channels that a source (a folder or a file) of an installed format holds, as a table to be printed."""
    table = load().importer(name)().channels(path_of(source))
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
    recording = load().importer(name)().read(path_of(source), channels, options or {})
    check_recording(recording, {kind: observer.schema for kind, observer in load().observers.items()}, str(source))
    write_recording(recording, path_of(output))
    return f"wrote {output}"


def check_files(paths: Files) -> str:
    """Validate recordings (netCDF) and models (TOML), each alone and then each model with all recordings.

    Returns:
        one line for each file that is as it should be.

    Raises CrashkitError with the faults of all files.
    """
    paths = paths_of(paths)
    models: dict[Path, Model] = {}
    recordings: dict[str, xr.DataTree] = {}
    raise_together([partial(_check, path, models, recordings) for path in paths])
    observers, pairs = load().observers, models.items() if recordings else ()
    raise_together([partial(check_together, model, recordings, observers, str(path)) for path, model in pairs])
    return "\n".join(f"{path}: as it should be" for path in paths)


def _check(path: Path, models: dict[Path, Model], recordings: dict[str, xr.DataTree]) -> None:
    """Check a file alone, and keep what it holds."""
    if path.suffix == ".toml":
        models[path] = load_model(path)
    else:
        recordings[str(path)] = next(iter(load_recordings([path]).values()))
