"""The repository holds together: what is written in two places is the same in both."""

import re
import tomllib
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).parent.parent
PLUGINS = sorted(path.parent for path in CHECKOUT.glob("plugins/*/pyproject.toml"))


def project(folder: Path) -> dict:
    return tomllib.loads((folder / "pyproject.toml").read_text())["project"]


def test_the_lowest_versions_are_those_that_the_metadata_allow():
    core = project(CHECKOUT)
    bounds = {bound.replace(">=", "==") for bound in core["dependencies"] + core["optional-dependencies"]["test"]}
    lines = (CHECKOUT / ".ci" / "lowest.txt").read_text().splitlines()
    pinned = {line.split("#")[0].strip() for line in lines}
    assert bounds <= pinned


@pytest.mark.parametrize("folder", PLUGINS, ids=lambda folder: folder.name)
def test_a_plugin_is_named_alike_everywhere(folder):
    plugin, package = project(folder), folder.name.replace("-", "_")
    assert plugin["name"] == folder.name
    assert plugin["entry-points"]["crashkit"] == {folder.name: f"{package}.hooks"}
    assert (folder / package / "hooks.py").is_file()


def test_every_file_of_the_diagnosis_has_its_idea_in_the_table():
    package = CHECKOUT / "crashkit" / "diagnose"
    files = {str(path.relative_to(package)) for path in package.rglob("*.py") if path.name != "__init__.py"}
    table = (CHECKOUT / "docs" / "design" / "diagnosis.md").read_text()
    assert set(re.findall(r"^\| `([\w/]+\.py)` \|", table, re.MULTILINE)) == files


def test_the_readme_shows_the_command_that_ci_runs():
    commands = [line for line in (CHECKOUT / "README.md").read_text().splitlines() if line.startswith("python3 -m venv")]
    assert [command.split("/")[-1] for command in commands] == ["crashkit demo", "pytest -q -n 2 --dist loadfile"]
