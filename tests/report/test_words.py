"""Numbers, units and probabilities as people write them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from crashkit.report import words


@pytest.mark.parametrize(
    ("units", "expected"),
    [
        ("m s-2", "m/s²"),
        ("N m-1", "N/m"),
        ("N s m-1", "N s/m"),
        ("kg m2", "kg m²"),
        ("N m-1 s-1", "N/(m s)"),
        ("s-1", "1/s"),
        ("1", ""),
        ("", ""),
        ("pixel", "pixel"),
    ],
)
def test_units(units: str, expected: str) -> None:
    assert words.unit(units) == expected


@pytest.mark.parametrize(
    ("value", "std", "expected"),
    [
        (0.2104, 0.0123, "0.210 ± 0.012"),
        (160200.0, 900.0, "160\u202f200 ± 900"),
        (1.09e6, 2.1e4, "(1.090 ± 0.021)×10⁶"),
        (1.2e-5, 3e-6, "(1.20 ± 0.30)×10⁻⁵"),
        (-0.05, 0.2, "\u22120.05 ± 0.20"),
        (4.9e6, 8.0e6, "(4.9 ± 8.0)×10⁶"),
        (0.0, 0.099, "0.000 ± 0.099"),
        (2.5, math.nan, "2.500 (no interval)"),
        (2.5, 0.0, "2.500"),
        (math.nan, 1.0, "–"),
    ],
)
def test_an_estimate_shows_the_digits_that_its_deviation_leaves(value: float, std: float, expected: str) -> None:
    assert words.estimate(value, std) == expected


@given(value=st.floats(-1e12, 1e12), std=st.floats(1e-9, 1e12))
def test_an_estimate_is_always_a_short_text(value: float, std: float) -> None:
    assert len(words.estimate(value, std)) < 60


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0, "0"),
        (1.016, "1.02"),
        (9.999, "10.0"),
        (1600, "1\u202f600"),
        (2.3e7, "2.30×10⁷"),
        (-3.1e-6, "\u22123.10×10⁻⁶"),
        (math.inf, "–"),
    ],
)
def test_numbers_have_three_significant_digits(value: float, expected: str) -> None:
    assert words.number(value) == expected


@pytest.mark.parametrize(
    ("probability", "percent", "likelihood"),
    [
        (1.0, "> 99.9 %", "practically certain"),
        (0.994, "99.4 %", "practically certain"),
        (0.972, "97 %", "very likely"),
        (0.7, "70 %", "likely"),
        (0.5, "50 %", "about as likely as not"),
        (0.021, "2.1 %", "unlikely"),
        (0.0, "< 0.1 %", "unlikely"),
        (math.nan, "–", "not rated"),
    ],
)
def test_a_probability_never_claims_certainty(probability: float, percent: str, likelihood: str) -> None:
    assert words.percent(probability) == percent
    assert words.likelihood(probability) == likelihood


@pytest.mark.parametrize(
    ("rating", "word"), [(0.95, "excellent"), (0.9, "good"), (0.6, "fair"), (0.58, "poor"), (math.nan, "")]
)
def test_grades_are_those_of_the_standard(rating: float, word: str) -> None:
    assert words.grade(rating) == word


def test_a_verdict_that_is_not_known_speaks_for_itself() -> None:
    assert words.verdict_of("not_yet_known", False).headline == "Not yet known"
    assert "no known physics" in words.verdict_of("unexplained", False).headline
    assert "in the time" in words.verdict_of("unexplained", True).headline
