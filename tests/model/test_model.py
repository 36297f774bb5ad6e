"""What a model gives by name and by path, what it refuses, and how Python shows it."""

import math
import re

import pytest
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit.model import Body, Joint, Model, Parameter

WALL = Body("wall", (0.0,), (0.0,), fixed=True)
CAR = Body("car", (-1.0,), (10.0,), Parameter(1000.0, fixed=True))
FRONT = {"stiffness": Parameter(1e5, 1e4, 1e6), "gap": Parameter(0.0, 1.0, 2.0, fixed=True)}
MODEL = Model("sled", ("x",), (WALL, CAR), (Joint("front", ("wall", "car"), "linear_stop", FRONT),))


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda: MODEL.body("caar"), 'model sled: expected one of the bodies, found "caar" (did you mean "car"?)'),
        (lambda: MODEL.body("x"), 'model sled: expected one of the bodies ("wall", "car"), found "x"'),
        (lambda: MODEL.joint("frnt"), 'model sled: expected one of the joints, found "frnt" (did you mean "front"?)'),
        (
            lambda: MODEL.with_values({"joint.front.stifness": 1e5}),
            'model sled: expected a parameter of the model, found "joint.front.stifness" '
            '(did you mean "joint.front.stiffness"?)',
        ),
        (
            lambda: MODEL.with_parameters({"mass": Parameter(1.0)}),
            'model sled: expected a parameter of the model, found "mass"',
        ),
        (
            lambda: MODEL.with_values({"body.car.velocity": 10.0}),
            'model sled: expected a parameter of the model, found "body.car.velocity" '
            "(states at t = 0 and points are given to the run: Simulator.run(times, values={...}))",
        ),
    ],
)
def test_what_it_does_not_have(ask, message):
    with pytest.raises(CrashkitError, match=f"^{re.escape(message)}$"):
        ask()


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("body.car.mass", -10.0, "expected a value above 0, found -10.0"),
        ("body.car.mass", math.nan, "expected a finite number, found nan"),
        ("body.car.mass", "heavy", 'expected a number, found "heavy"'),
        ("joint.front.stiffness", 2e6, "expected a value from 10000.0 to 1000000.0, found 2000000.0"),
    ],
)
def test_values_that_its_file_could_not_hold(path, value, message):
    with pytest.raises(CrashkitError, match=f"^model sled: {re.escape(path)}: {re.escape(message)}$"):
        MODEL.with_values({path: value})


def test_values_that_it_takes():
    changed = MODEL.with_values({"joint.front.stiffness": 2e5, "joint.front.gap": 0.0, "body.car.mass": 900})
    assert changed.parameters()["joint.front.stiffness"] == Parameter(2e5, 1e4, 1e6)
    assert changed.parameters()["body.car.mass"] == Parameter(900.0, fixed=True)
    assert changed.values() == {path: parameter.value for path, parameter in changed.parameters().items()}


def test_a_search_may_leave_the_bounds():
    assert MODEL.at({"joint.front.stiffness": 2e6}).parameters()["joint.front.stiffness"].value == 2e6
    with pytest.raises(CrashkitError, match='^model sled: expected a parameter of the model, found "mass"$'):
        MODEL.at({"mass": 1.0})


def test_python_shows_it_in_a_few_lines():
    assert repr(MODEL) == (
        'model "sled" in x: 2 bodies, 1 joint\n'
        "  body wall: fixed\n"
        "  body car: 1000 kg, at -1 m, 10 m s-1\n"
        "  joint front (wall - car): linear_stop, 1 of 2 numbers free"
    )


def test_of_many_parts_a_few_are_shown():
    bodies = (WALL, *(evolve(CAR, name=f"car {i}") for i in range(50)))
    lines = repr(evolve(MODEL, bodies=bodies)).splitlines()
    assert lines[0] == 'model "sled" in x: 51 bodies, 1 joint'
    assert lines[4] == "  ... and 48 more bodies"
    assert len(lines) <= 10
