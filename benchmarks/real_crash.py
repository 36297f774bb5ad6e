"""A real frontal crash (NHTSA test 10146): what a diagnosis finds of an engine whose own sensors it never sees.

The tool is given a single rigid vehicle, the compartment's acceleration and the wall's force. The engine's accelerometers
(curve 95 on its top, 96 on its bottom) are opened only to compare. The recordings are in the folder that the environment
variable CRASHKIT_RECORDINGS names (else ../shared/recordings beside the checkout).
"""

import math
import os
import tempfile
import warnings
from collections.abc import Mapping
from pathlib import Path
from time import perf_counter

import numpy as np
import xarray as xr

from benchmarks import Row
from benchmarks._left_out import left_out
from crashkit.api import diagnose_files, load_model
from crashkit.data.channel_filter import filter_channel
from crashkit.data.recording import write_recording
from crashkit.diagnose import Diagnosis
from crashkit.mechanics import simulate
from crashkit.misfit.rating import rating
from crashkit.model import Model
from crashkit.registry import load

TEST = "nhtsa_v10146_camry_ncap_frontal"
CHOICE = {"window": "0:0.12", "channel_frequency_class": "60"}
SEEN = ["93+94+99+100=vehicle:compartment", "-107..632=barrier:wall"]
UNSEEN = ["95=engine:top", "96=engine:bottom"]
BOTTOM_ENDS = 0.066
"""s; the sensor on the bottom of the engine has no valid data later."""
GIVEN = Path(__file__).parent.parent / "docs" / "examples" / "real-crash" / "given.toml"
INTERVAL = 1e-4
BLOCK = 0.02
"""s, of the stretches that are left out in turn."""


def run() -> list[Row]:
    """The residuals of both channels, the load's mass, and its predicted motion against the engine's sensors."""
    with tempfile.TemporaryDirectory() as folder:
        start = perf_counter()
        answer = diagnosed(Path(folder))
        elapsed = perf_counter() - start
    rows = [*fit_rows(answer), *_left_out_rows(answer), *mass_rows(answer), *engine_rows(answer)]
    return [*rows, Row("diagnosis", "time", "s", elapsed, "", None)]


def recordings() -> Path:
    """Where the recordings are."""
    beside = Path(__file__).parent.parent.parent / "shared" / "recordings"
    return Path(os.environ.get("CRASHKIT_RECORDINGS", beside)) / TEST


def imported(channels: list[str]) -> xr.DataTree:
    """Some channels of the test, as the command line imports them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # two cells of the wall are known to be dead
        return load().importers["nhtsa"]().read(recordings(), channels, CHOICE)


def diagnosed(folder: Path, given: Path = GIVEN, seen: list[str] = SEEN, seconds: float = math.inf) -> Diagnosis:
    """The answer, from the model and recording that docs/real-crash.md describes."""
    write_recording(imported(seen), folder / "run.nc")
    return diagnose_files(given, [folder / "run.nc"], [], folder / "answer", lambda sentence: None, seconds)


def engine() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, and the accelerations of the engine's top and bottom, m s-2."""
    group = imported(UNSEEN).children["accelerometer"].to_dataset(inherit=False)
    top, bottom = group["acceleration"].values[:, :, 0].T
    return group["time"].values, top, bottom


def predicted(model: Model, times: np.ndarray, body: str) -> np.ndarray:
    """A body's acceleration, filtered as the channels are, with rest before the contact."""
    motion = simulate(model, times, load().spring_laws)
    acceleration = motion["acceleration"].sel(body=body).values[:, 0]
    return filter_channel(acceleration, times, float(CHOICE["channel_frequency_class"]), before=0.0)


def compared(recorded: np.ndarray, simulated: np.ndarray) -> Mapping[str, float]:
    """Relative residual of the acceleration, its ISO/TS 18571 rating, and the velocity's error (rms, m s-1)."""
    apart = np.cumsum(simulated - recorded) * INTERVAL
    size = float(np.sqrt(np.mean(recorded**2)))
    return {
        "relative residual": float(np.sqrt(np.mean((recorded - simulated) ** 2))) / size,
        "rating": rating(recorded, simulated, INTERVAL).total,
        "velocity error": float(np.sqrt(np.mean(apart**2))),
    }


def fit_rows(answer: Diagnosis) -> list[Row]:
    """What each channel leaves, with what was found and without."""
    before, after = (answer.fits["calibration"][when].channels["relative_rmse"] for when in ("before", "after"))
    return [
        Row(
            f"{name}: relative residual",
            "error",
            "1",
            float(after.sel(channel=name)),
            "re-identified",
            float(before.sel(channel=name)),
        )
        for name in after["channel"].values.tolist()
    ]


def _left_out_rows(answer: Diagnosis) -> list[Row]:
    """Blocks of time that are predicted from the rest, with the load and by the single mass."""
    given, recording = load_model(GIVEN), imported(SEEN)
    ours, theirs = (left_out(model, given, recording, BLOCK) for model in (answer.augmented_model, answer.base_model))
    told = f"in blocks of {1e3 * BLOCK:g} ms that were left out: relative residual"
    return [Row(f"{name} {told}", "error", "1", ours[name], "single mass", theirs[name]) for name in ours]


def mass_rows(answer: Diagnosis) -> list[Row]:
    """The masses of the loads that were found."""
    loads = [body for body in answer.augmented_model.bodies if body.carrier and body.mass is not None]
    return [
        Row(f"{b.name}: mass", "error", "kg", b.mass.value, "revealed by the engine's sensors", 367.0) for b in loads if b.mass
    ]


def engine_rows(answer: Diagnosis) -> list[Row]:
    """The load against the engine; the peer is to take the engine for a part of the compartment."""
    times, top, bottom = engine()
    model = answer.augmented_model
    load_name = next((body.name for body in model.bodies if body.carrier), None)
    if load_name is None:
        return []
    simulated, compartment = (predicted(model, times, name) for name in (load_name, "vehicle"))
    both = times <= BOTTOM_ENDS
    cases = {"top, 120 ms": (top, times <= times[-1]), "mean of top and bottom, 66 ms": (0.5 * (top + bottom), both)}
    rows = []
    for case, (recorded, part) in cases.items():
        ours, theirs = (compared(recorded[part], one[part]) for one in (simulated, compartment))
        rows += [
            Row(
                f"engine {case}: {name}",
                "rate" if name == "rating" else "error",
                "m s-1" if "vel" in name else "1",
                ours[name],
                "compartment",
                theirs[name],
            )
            for name in ours
        ]
    limit = compared(top[both], bottom[both])
    rows.append(Row("engine top against bottom, 66 ms: rating", "rate", "1", limit["rating"], "", None))
    return rows
