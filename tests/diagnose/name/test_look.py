"""A look that goes on where an earlier one was keeps what that one had settled."""

from types import SimpleNamespace

import pytest

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.name.look import Look, _as_before, _is_error_of_form, least_drop
from crashkit.protocols import Proposal


def rival(physics, deviance, form="plain"):
    search = SimpleNamespace(deviance=deviance)
    return Rival(Proposal(physics, form, {"joint": "nose"}, None, (), {}), search, 9e3, 4e3)


@pytest.mark.parametrize(
    ("found", "is_kept"),
    [
        (rival("fracture", 99.5), True),
        (rival("fracture", 90.0), False),
        (rival("fracture", 99.5, "in steps"), False),
        (rival("clearance", 99.5), False),
    ],
)
def test_a_leader_that_is_hardly_fitted_better_stays_as_it_was_settled(found, is_kept):
    begun = Look((rival("fracture", 100.0), rival("peak_load", 300.0)), (1.0, 0.0), 0.0, None)
    other = rival("peak_load", 200.0)
    assert _as_before(begun, [found, other]) == [begun.leader if is_kept else found, other]


def test_a_look_that_begins_nowhere_tells_what_it_finds():
    found = [rival("fracture", 99.5)]
    assert _as_before(None, found) is found
    assert _as_before(Look((), (), 1.0, None), found) is found


@pytest.mark.parametrize(
    ("sensor", "drop", "read", "is_error"),
    [
        ("mark", 80.0, "mark.rocking_share", True),
        ("mark", 100.0, "mark.rocking_share", False),
        ("other", 80.0, "mark.rocking_share", False),
        ("mark", 80.0, "mark.gain", False),
    ],
)
def test_a_sensor_is_not_accused_of_how_far_the_form_of_a_turn_is_off(sensor, drop, read, is_error):
    """What an error of its own explains beside another one is no matter of a form."""
    path, place = f"instrument.film.{read}", {"sensor": "mark"} if read.endswith("gain") else {"body": "sled"}
    found = Rival(Proposal("found", "", place, None, (path,), {}), None, 3e3, 4e3)
    told = Proposal("bias", "", {"sensor": sensor}, None, (f"instrument.film.{sensor}.bias",), {})
    assert _is_error_of_form(Rival(told, None, drop, 1e3), [found]) is is_error


@pytest.mark.parametrize(
    ("place", "path", "least"),
    [
        ({"joint": "nose"}, "joint.nose.loss", 30.0),
        ({"body": "sled"}, "instrument.film.mark.rocking_share", 90.0),
        ({"sensor": "mark"}, "instrument.film.mark.gain", 20.0),
    ],
)
def test_beside_a_turn_more_must_be_explained_than_beside_a_law_and_least_beside_one_number_of_a_sensor(place, path, least):
    assert least_drop([Rival(Proposal("found", "", place, None, (path,), {}), None, 3e3, 1e3)]) == pytest.approx(least)
