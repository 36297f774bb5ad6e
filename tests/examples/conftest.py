"""The example files of the documentation, simulated over the time that each one's own comment says, by one engine."""

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from crashkit.mechanics import Engine, Simulator, compile_engine, functions_of
from crashkit.model import Model
from crashkit.model.toml import read_model
from crashkit.registry import load

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
INTERVAL = 1e-4


@pytest.fixture(scope="session")
def examples() -> Path:
    return EXAMPLES


@pytest.fixture(scope="session")
def model_of() -> Callable[[str], Model]:
    """A model by its path below the examples, without ".toml"."""
    return cache(lambda name: read_model(EXAMPLES / f"{name}.toml", load().spring_laws))


@pytest.fixture(scope="session")
def run(model_of) -> Callable[..., xr.Dataset]:
    """The motion of an example, or of a model like it."""
    engines: dict[int, Engine] = {}

    def motion(model: Model, duration: float) -> xr.Dataset:
        axes = len(model.axes)
        if axes not in engines:
            laws = load().spring_laws
            models = [model_of(name) for name in names()]
            needed = {function for other in models if len(other.axes) == axes for function in functions_of(other, laws)}
            engines[axes] = compile_engine(needed, axes)
        times = np.linspace(0.0, duration, 1 + round(duration / INTERVAL))
        return Simulator(model, load().spring_laws, engines[axes]).run(times)

    return motion


@pytest.fixture(scope="session")
def motion_of(model_of, run) -> Callable[[str], xr.Dataset]:
    """The motion of an example by its path, over the duration that its first comment tells users to simulate."""
    return cache(lambda name: run(model_of(name), duration_of(name)))


@pytest.fixture(scope="session")
def yaw() -> Callable[[xr.Dataset, str], np.ndarray]:
    """Degrees about the vertical by which a body is turned from its start, by time."""

    def degrees(motion: xr.Dataset, body: str) -> np.ndarray:
        w, _, _, z = motion["orientation"].sel(body=body).transpose("quaternion", "time").values
        angle = np.degrees(np.unwrap(2.0 * np.arctan2(z, w)))
        return angle - angle[0]

    return degrees


@pytest.fixture(scope="session")
def command_of() -> Callable[[str], list[str]]:
    return _command_of


def names() -> list[str]:
    """Every example but those of the real crash, which have their own."""
    found = (path.relative_to(EXAMPLES).with_suffix("").as_posix() for path in EXAMPLES.glob("*/*.toml"))
    return sorted(name for name in found if not name.startswith("real-crash"))


def _command_of(name: str) -> list[str]:
    """The command that the first comment of an example gives."""
    (line,) = re.findall(r"^# +(crashkit simulate .*)$", (EXAMPLES / f"{name}.toml").read_text(), re.MULTILINE)
    return line.split()


def duration_of(name: str) -> float:
    command = _command_of(name)
    return float(command[command.index("--duration") + 1])


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """A test with the argument `example` runs for each of them."""
    if "example" in metafunc.fixturenames:
        metafunc.parametrize("example", names())
