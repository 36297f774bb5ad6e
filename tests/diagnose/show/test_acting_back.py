"""A body that turns and a load that swings on it at the same frequency are one finding."""

import math

import pytest

from crashkit.diagnose.result import Estimate, Finding
from crashkit.diagnose.show.acting_back import acting_back, loads_that_turn

FREQUENCY = 11.0
"""Hz, of the turning."""


def finding(physics, body="battery", runs=("a",), **values):
    return Finding(
        physics=physics,
        form="crush" if physics == "carried_load" else "rocking",
        sentence=f"body {body} does",
        probability=0.97,
        location={"body": body},
        runs=runs,
        time=(0.0, 0.1),
        phase="both",
        parameters={name: Estimate(value, 0.1 * value, "1") for name, value in values.items()},
        alternatives=(),
    )


def rocks(body="battery"):
    return finding(
        "rotation", body, **{"instrument.film..rocking_frequency": FREQUENCY, "instrument.film.m.rocking_share": 0.2}
    )


def load(frequency, body="battery", name="elastic_stiffness"):
    mass = 0.8
    return finding("carried_load", body, ("b",), mass=mass, **{name: mass * (2.0 * math.pi * frequency) ** 2})


@pytest.mark.parametrize("name", ["stiffness", "elastic_stiffness"])
def test_a_load_that_swings_as_the_body_turns_is_how_it_acts_back(name):
    turning, swinging = rocks(), load(1.1 * FREQUENCY, name=name)
    ((one, other),) = loads_that_turn([swinging, turning])
    told = acting_back(one, other)
    assert (told.physics, told.form, told.location) == ("rotation", "rocking, acting back", {"body": "battery"})
    assert told.sentence == "body battery does, and acts back on its joints as a load of 0.8 kg would that swings on it"
    assert told.parameters == {**turning.parameters, **swinging.parameters}
    assert told.runs == ("a", "b")


@pytest.mark.parametrize(
    "others",
    [
        [load(2.0 * FREQUENCY)],
        [load(FREQUENCY, "engine")],
        [finding("carried_load", mass=3.0)],
        [finding("joint_friction", mass=1.0, stiffness=4e3)],
    ],
)
def test_any_other_load_is_one(others):
    assert not loads_that_turn([rocks(), *others])


def test_a_body_that_turns_is_a_mass_that_carries_the_rest_of_it_on_a_spring():
    """As the equations of `loads_that_turn` say, at any frequency."""
    mass, inertia, spring, arm = 17.7, 0.237, 1208.0, 0.06
    ratio = 1.0 + mass * arm**2 / inertia
    carrier = mass / ratio
    rest = mass - carrier
    link = rest * spring / (inertia + mass * arm**2)
    for frequency in (3.0, 9.0, 12.0, 40.0):
        square = -((2.0 * math.pi * frequency) ** 2)
        turning = 1.0 / (mass * square) + arm**2 / (inertia * square + spring)
        carried = 1.0 / (square * (carrier + rest * link / (rest * square + link)))
        assert turning == pytest.approx(carried, rel=1e-9)
