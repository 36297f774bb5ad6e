"""The program that changes members of the car of figure 3."""

import runpy

import pytest


@pytest.fixture(scope="module")
def program(examples):
    return runpy.run_path(str(examples / "perturbation" / "perturbation.py"))


@pytest.fixture(scope="module")
def table(program, model_of):
    variants = program["variants"](model_of("figure-3/orthogonal"))
    return {name: program["consequences"](model) for name, model in variants.items()}


def test_the_first_row_is_the_car_itself(program, model_of, motion_of, table):
    car = model_of("figure-3/orthogonal")
    assert program["variants"](car)["as it is"] == car
    assert table["as it is"]["yaw"] == pytest.approx(0.0, abs=1e-3)
    position = motion_of("figure-3/orthogonal")["position"].sel(body="compartment", axis="x")
    assert table["as it is"]["crush"] == pytest.approx(float((position - position[0]).max()), abs=1e-2)


def test_a_member_less_crushes_further_and_turns_the_car_to_the_other_side(table):
    assert table["left rail removed"]["crush"] > table["as it is"]["crush"] + 0.05
    assert table["left rail removed"]["yaw"] < -3.0


def test_stronger_rails_crush_less(table):
    assert table["both rails 30 % stronger"]["crush"] < table["as it is"]["crush"]
    assert table["both rails 30 % stronger"]["yaw"] == pytest.approx(0.0, abs=1e-3)


def test_one_stronger_rail_turns_the_car_to_its_side(table):
    assert 1.0 < table["left rail 30 % stronger"]["yaw"] < -table["left rail removed"]["yaw"]


def test_prints_the_table_of_the_page(program, capsys, examples):
    program["main"]()
    assert capsys.readouterr().out in (examples.parent / "mechanics.md").read_text(encoding="utf-8")
