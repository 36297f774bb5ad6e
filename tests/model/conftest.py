import os
from pathlib import Path

import pytest

from crashkit.errors import CrashkitError
from crashkit.model import Model
from crashkit.model.toml import read_model
from crashkit.protocols import ParameterSpec, SpringLaw


class Linear(SpringLaw):
    name = "linear"
    parameters = (
        ParameterSpec("stiffness", "N m-1", "slope", lower=1.0),
        ParameterSpec("unloading_stiffness", "N m-1", "slope of unloading", lower=1.0, default=0.0, null=0.0),
        ParameterSpec("tension", "1", "also pulls", lower=0.0, upper=1.0, default=0.0, free=False, null=0.0),
        ParameterSpec("preload", "N", "force at no deformation", default=5.0),
    )

    @staticmethod
    def force(d, ddot, d_max, stiffness, unloading_stiffness, tension, preload):
        return stiffness * d


class Curve(SpringLaw):
    name = "curve"
    parameters = (
        ParameterSpec("deformation", "m", "corners", lower=0.0, free=False, vector=True, increasing=True),
        ParameterSpec("force", "N", "force at the corners", vector=True, null=0.0),
    )

    @staticmethod
    def force(d, ddot, d_max, deformation, force):
        return force[0]


class Power(SpringLaw):
    name = "power"
    unit = "1"
    parameters = (
        ParameterSpec("amplitude", "1", "rise of the force", lower=0.0, upper=10.0, null=0.0),
        ParameterSpec("exponent", "1", "of the rate", lower=0.05, upper=2.0),
    )

    @staticmethod
    def force(d, ddot, d_max, amplitude, exponent):
        return 1.0 + amplitude


class Doubled(SpringLaw):
    name = "doubled"
    unit = "1"
    parameters = (ParameterSpec("stiffness", "1", "a name that the law has too"),)

    @staticmethod
    def force(d, ddot, d_max, stiffness):
        return stiffness


LAWS = {law.name: law for law in (Linear, Curve, Power)}

TEXT = """\
schema = "crashkit-model/1"
name = "sled"
axes = ["x"]

[[body]]
name = "barrier"
fixed = true
position = [0.0]

[[body]]
name = "engine"
mass = 280
position = [-0.55]
velocity = [15.6]

[[joint]]
name = "front"
bodies = ["barrier", "engine"]
law = "linear"
[joint.parameters]
stiffness = 1.1e6
"""


@pytest.fixture(scope="session")
def laws() -> dict[str, type[SpringLaw]]:
    return LAWS


@pytest.fixture(scope="session")
def clashing() -> type[SpringLaw]:
    return Doubled


@pytest.fixture(scope="session")
def text() -> str:
    """A small model that is as it should be."""
    return TEXT


@pytest.fixture(scope="session")
def cases() -> Path:
    folder = Path(os.environ.get("CRASHKIT_CASES", Path(__file__).parents[3] / "shared" / "cases"))
    if not folder.is_dir() and not os.environ.get("CI"):
        pytest.skip(f"no sample cases in {folder}; CRASHKIT_CASES names another folder")
    return folder


@pytest.fixture
def read(tmp_path, laws):
    """Reads a text as a model."""

    def read_text(text: str, **options) -> Model:
        (tmp_path / "model.toml").write_text(text, encoding="utf-8")
        return read_model(tmp_path / "model.toml", laws, **options)

    return read_text


@pytest.fixture
def faults(read, tmp_path):
    """The lines of the error that a text gives, without the file's name."""

    def faults_of_text(text: str, **options) -> list[str]:
        with pytest.raises(CrashkitError, match="model.toml: ") as caught:
            read(text, **options)
        return [line.removeprefix(f"{tmp_path / 'model.toml'}: ") for line in str(caught.value).splitlines()]

    return faults_of_text
