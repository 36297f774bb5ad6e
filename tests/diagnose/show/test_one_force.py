"""Several findings at one place, told as one force that they imitate."""

from types import SimpleNamespace

import pytest
from attrs import evolve

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.result import Estimate, Finding
from crashkit.diagnose.show.one_force import are_one_force
from crashkit.protocols import Proposal

JOINT = {"joint": "first"}


def leaving(normalised, *paths):
    misfit = SimpleNamespace(independent_samples=1e4)
    return SimpleNamespace(normalised=normalised, excess=normalised**2 - 1.0, misfit=misfit, values=dict.fromkeys(paths, 1.0))


def rival(physics, search, estimate_of="", location=JOINT):
    return Rival(Proposal(physics, "", location, None, (physics,), {}, estimate_of=estimate_of), search, 1e3, 500.0)


def finding(physics, value, std, identifiable=True):
    size = Estimate(value, std, "N", identifiable)
    return Finding(physics, "", "", 0.9, JOINT, (), (0.0, 0.1), "both", {"size": size})


TOLD = [finding("fracture", 5.0, 1.0), finding("peak_load", 3.0, 1.0)]
TWO = leaving(1.04, "fracture", "peak_load")


def looks(*estimates, put_aside=()):
    first = Look.of([rival("fracture", leaving(1.3, "fracture")), *estimates], None)
    first = Look(first.rivals, first.probabilities, first.nothing, None, estimates=tuple(put_aside))
    return [first, Look.of([rival("peak_load", TWO)], None)]


def test_two_that_are_told_by_their_sizes_are_two():
    assert not are_one_force(looks(), TOLD, TWO)


def test_one_alone_is_what_it_is():
    assert not are_one_force(looks()[:1], [finding("fracture", 1.0, 9.0)], leaving(1.3))


def test_two_errors_of_one_sensor_are_no_force():
    sensor = {"sensor": "s", "instrument": "accelerometer"}
    wrong = [Look.of([rival(error, TWO, location=sensor)], None) for error in ("gain_error", "bias")]
    assert not are_one_force(wrong, TOLD, leaving(1.06))


def test_two_that_leave_something_imitate_one():
    assert are_one_force(looks(), TOLD, leaving(1.06))


@pytest.mark.parametrize(("left", "is_one"), [(1.045, True), (1.2, False)])
def test_two_say_no_more_than_an_estimate_that_leaves_hardly_more(left, is_one):
    """Weighed against the first of them or put aside."""
    estimate = rival("unknown", leaving(left), "deformation")
    assert are_one_force(looks(estimate), TOLD, TWO) is is_one
    assert are_one_force(looks(put_aside=[estimate]), TOLD, TWO) is is_one


def test_an_estimate_of_another_kind_or_place_or_beside_one_of_them_says_nothing_of_that():
    elsewhere = rival("unknown", leaving(1.0), "deformation", {"joint": "second"})
    of_time, beside = rival("unknown", leaving(1.0), "time"), rival("unknown", leaving(1.0, "fracture"), "deformation")
    assert not are_one_force(looks(elsewhere, of_time, beside), TOLD, TWO)


@pytest.mark.parametrize("second", [finding("peak_load", 3.0, 40.0), finding("peak_load", 3.0, 1.0, identifiable=False)])
def test_two_of_which_neither_is_told_by_its_size_are_one(second):
    assert are_one_force(looks(), [finding("fracture", 1.0, 3.0), second], TWO)
    assert not are_one_force(looks(), [TOLD[0], second], TWO)
    assert are_one_force(looks(), [evolve(TOLD[0], parameters={}), second], TWO)
