"""Engines are kept, shared and safe to make side by side."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from crashkit.mechanics import LawFunction, compile_engine, functions_of
from crashkit.mechanics.cache import folder

SCRIPT = """
from crashkit_spring_laws import TensionSpring
from crashkit.mechanics import LawFunction, Simulator, compile_engine
from crashkit.model import Body, Joint, Model, Parameter
bodies = (Body("a", (0.0,), (0.0,), fixed=True), Body("b", (1.0,), (1.0,), Parameter(1.0)))
joint = Joint("j", ("a", "b"), "tension_spring", {"stiffness": Parameter(1.0)})
model = Model("m", ("x",), bodies, (joint,))
simulator = Simulator(model, {"tension_spring": TensionSpring})
print(simulator.run([1.0])["position"].values[0, 1, 0], sum(simulator.engine.module.integrate.stats.cache_hits.values()))
"""


def test_the_same_functions_give_the_same_engine(laws):
    functions = [LawFunction(laws["coulomb"]), LawFunction(laws["viscous"])]
    assert compile_engine(functions) is compile_engine(reversed(functions))


def test_engines_for_other_laws_share_a_kernel_and_what_both_hold(laws):
    one, other = (compile_engine([LawFunction(laws[name]) for name in names]) for names in (("coulomb",), ("coulomb", "dahl")))
    assert one.module is other.module
    assert one.codes[LawFunction(laws["coulomb"])] == other.codes[LawFunction(laws["coulomb"])]


def test_functions_of_a_model(laws, against_wall, plateau):
    table = {"deformation": [0.1, 0.2], "force": [1.0, 2.0], "rate_coefficient": 0.1}
    model = against_wall("piecewise_affine", table, factors=("rate_linear",))
    expected = {LawFunction(laws["piecewise_affine"], (2, 2)), LawFunction(laws["rate_linear"])}
    assert functions_of(model, laws) == expected


def test_the_source_is_the_same_in_every_process():
    """Else nothing that one process compiled would serve another."""
    script = (
        "from crashkit_spring_laws import CrushPlateau, PiecewiseAffine; from crashkit.mechanics import LawFunction; "
        "from crashkit.mechanics.laws.emit import emit; "
        "print(emit(LawFunction(CrushPlateau)) + emit(LawFunction(PiecewiseAffine, (5, 5))))"
    )
    sources = {
        subprocess.run(
            [sys.executable, "-c", script], env=os.environ | {"PYTHONHASHSEED": seed}, capture_output=True, check=True
        ).stdout
        for seed in "123"
    }
    assert len(sources) == 1


def start(cache: Path) -> subprocess.Popen:
    environment = os.environ | {"CRASHKIT_CACHE": str(cache)}
    return subprocess.Popen([sys.executable, "-c", SCRIPT], env=environment, stdout=subprocess.PIPE, text=True)


@pytest.mark.slow
def test_processes_side_by_side_share_one_folder_and_later_ones_compile_nothing(tmp_path):
    together = [start(tmp_path) for _ in range(2)]
    results = [process.communicate()[0].split() for process in together]
    later = start(tmp_path).communicate()[0].split()
    assert {result[0] for result in (*results, later)} == {results[0][0]}
    assert later[1] == "1"
    assert len(list(tmp_path.glob("crashkit_engine_*.py"))) == len(list(tmp_path.glob("crashkit_law_*.o"))) == 1
    assert not list(tmp_path.glob(".*"))  # as drafts are called


def test_a_folder_that_cannot_be_written_is_replaced_by_a_temporary_one(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("CRASHKIT_CACHE", str(blocked))
    assert folder() != blocked
    assert folder().is_dir()


def test_the_folder_is_the_one_asked_for(tmp_path, monkeypatch):
    monkeypatch.setenv("CRASHKIT_CACHE", str(tmp_path / "new"))
    assert folder() == tmp_path / "new"
