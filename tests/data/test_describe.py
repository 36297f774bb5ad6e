import re
from pathlib import Path

import pytest

from crashkit.data import instruments, read_recording
from crashkit.data.describe import describe, describe_dimensions
from crashkit.data.schemas import INITIAL, MOTION, RECORDING
from crashkit.model.dataset import MODEL
from crashkit.model.toml import read_model
from crashkit.registry import load

PAGE = Path(__file__).parents[2] / "docs" / "data.md"


def test_a_schema_as_tables(schemas):
    assert describe(schemas["accelerometer"]) == (
        "| variable | dims | units | meaning |\n"
        "| --- | --- | --- | --- |\n"
        "| `acceleration` | time, sensor, axis | m s-2 | of a sensor |\n"
        "| `sensor_body` | sensor | text | name of the body that carries it |\n"
        "| `sensor_point` | sensor, axis | m | its place in the body's frame, from the centre of mass |\n"
        "| `acceleration_std` | sensor | m s-2 | standard deviation of the samples as recorded, if known; optional; "
        "NaN where missing; above 0 |\n"
        "\n"
        "| attribute | values | meaning |\n"
        "| --- | --- | --- |\n"
        "| `channel_frequency_class` | 0, 60, 180, 600, 1000 | SAE J211 filter class of the samples; 0 for unfiltered |\n"
        '| `frame` | "body", "laboratory" | whether the axes turn with the body |\n'
        "| `maker` | any | who made it; optional |\n"
    )


@pytest.mark.parametrize("schema", [MOTION, RECORDING, INITIAL, MODEL], ids=lambda schema: schema.name)
def test_the_page_has_the_tables_that_are_checked(schema):
    assert describe(schema) in PAGE.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("page", "observer"),
    [("accelerometers", "accelerometer"), ("accelerometers", "load_cell"), ("cameras", "camera"), ("cameras", "film")],
)
def test_the_pages_of_the_instruments_have_the_tables_that_are_checked(page, observer):
    assert describe(load().observer(observer).schema) in PAGE.with_stem(page).read_text(encoding="utf-8")


def test_the_page_has_the_dimensions():
    assert describe_dimensions() in PAGE.read_text(encoding="utf-8")


def test_the_recording_of_the_page_is_one(tmp_path, monkeypatch, schemas):
    monkeypatch.chdir(tmp_path)
    exec(_example("python", "to_netcdf"), {})
    assert instruments(read_recording("run_1.nc", schemas)) == {"film": "film"}


def test_the_models_of_the_page_are_some(tmp_path):
    spring_laws = pytest.importorskip("crashkit_spring_laws", reason="the spring laws are not installed").SPRING_LAWS
    models = {}
    for name in ("sled", "car and trolley"):
        (tmp_path / "model.toml").write_text(_example("toml", f'name = "{name}"'), encoding="utf-8")
        models[name] = read_model(tmp_path / "model.toml", {law.name: law for law in spring_laws})
    assert models["sled"].joint("front").parameters["rate_exponent"].fixed is False
    assert models["car and trolley"].body("trolley").motion.orientation == ((0.0,), (0.0,), (0.1,))


def _example(language: str, content: str) -> str:
    """The example of the page that has this content."""
    examples = re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    (example,) = [example for example in examples if content in example]
    return example
