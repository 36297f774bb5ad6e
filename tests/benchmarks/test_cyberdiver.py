"""The CyberDiver drops: what their files say without a diagnosis, and that a diagnosis finds the damper."""

import pytest

from benchmarks import cyberdiver
from benchmarks.cyberdiver import PROGRAMMED, diagnosed, late_damping, mass, read, static_stiffness


@pytest.fixture(autouse=True)
def _found(recordings, monkeypatch):
    monkeypatch.setattr(cyberdiver, "recordings", lambda: recordings / cyberdiver.TEST)


def test_the_files_agree_with_what_was_programmed():
    undamped, damped = read("undamped"), read("damped")
    assert (undamped.attrs["damping"], damped.attrs["damping"]) == pytest.approx((0.0, 23.4))
    assert static_stiffness() == pytest.approx(PROGRAMMED, rel=0.02)
    assert abs(late_damping(undamped)) < 2.0
    assert late_damping(damped) == pytest.approx(23.4, rel=0.1)
    assert mass(undamped) == pytest.approx(mass(damped), rel=0.1)


def test_a_drop_is_followed_until_the_coil_is_at_its_limit():
    record = read("undamped")
    followed = record.sel(time=slice(0.0, record.attrs["limit"]))
    error = followed["force"] - PROGRAMMED * followed["deformation"]
    assert float(abs(error).max()) < 0.03 * float(followed["force"].max())
    assert float(abs(record["force"] - PROGRAMMED * record["deformation"]).max()) > float(record["force"].max())


@pytest.mark.long
def test_the_damper_is_found_in_the_damped_drop():
    record = read("damped")
    answer = diagnosed(record, static_stiffness())
    told = {one.physics: dict(one.location) for one in answer.findings}
    assert told == {"viscous_damping": {"joint": "structure"}, "clock_offset": {"instrument": "load_cell"}}
    (finding,) = (one for one in answer.findings if one.physics == "viscous_damping")
    assert finding.parameters["damping"].value == pytest.approx(record.attrs["damping"], rel=0.1)
    assert finding.parameters["exponent"].value == pytest.approx(1.0, abs=0.03)
