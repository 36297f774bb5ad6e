"""A prediction with its derivatives, as a search asks for thousands: steps as long as the noise allows, beside steps that end
wherever an instrument is read; and records of what is read, beside records of everything.

Made-up vehicles with nothing concealed, their recordings as thin as a search sees them. Beside the times, what either differs
from steps of 20 us, in standard deviations of the noise, root mean square over all readings.
"""

import tempfile
from pathlib import Path
from unittest.mock import patch

import numpy as np

from benchmarks import Row, pair
from crashkit.misfit import Misfit, fine_step
from crashkit.misfit.predictor import Predictor
from crashkit.misfit.thin import thinned
from crashkit.model.toml import read_model
from crashkit.registry import load
from crashkit.testing.concealed import Case, make_case

SEEDS = range(1, 7)
EXACT = 2e-5
"""s, of a step."""


def run() -> list[Row]:
    """Times and errors, case by case."""
    return [row for seed in SEEDS for row in _rows(seed, make_case(seed, (), "middle"))]


def _rows(seed: int, case: Case) -> list[Row]:
    free = _misfit(case)
    free = free.with_step(fine_step(free))
    exact = free.with_step(EXACT)
    with patch.object(Predictor, "_steps_end_at_all", True):
        ending = _misfit(case)
        ending = ending.with_step(fine_step(ending))
        ending.residual(ending.start())  # its runs are made at the first
    with patch.object(Predictor, "_wanted", dict.fromkeys(free.recordings)):
        everything = free.with_step(free.step)
        everything.residual(everything.start())
    name, peer = f"vehicle {seed}, {len(free.names)} numbers", "steps end where anything is read"
    times = pair(lambda: _predict(free), lambda: _predict(ending), repeats=15)
    written = pair(lambda: _predict(free), lambda: _predict(everything), repeats=15)
    errors = [_rms(one.residual(one.start()) - exact.residual(exact.start())) for one in (free, ending)]
    return [
        Row(f"{name}: prediction with derivatives", "time", "s", times[0], peer, times[1]),
        Row(f"{name}: the same", "time", "s", written[0], "everything is written", written[1]),
        Row(f"{name}: error", "error", "std of the noise", errors[0], peer, errors[1]),
    ]


def _misfit(case: Case) -> Misfit:
    plugins = load()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.toml"
        file.write_text(case.model, encoding="utf-8")
        model = read_model(file, plugins.spring_laws)
    quantities = {name: observer.quantity for name, observer in plugins.observers.items()}
    runs = {f"run_{number}": thinned(run, quantities, {}) for number, run in enumerate(case.runs)}
    return Misfit(model, runs, plugins.spring_laws, plugins.observers)


def _predict(misfit: Misfit) -> None:
    misfit.residual_and_jacobian(misfit.start())


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))
