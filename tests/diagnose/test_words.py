"""Numbers in the summary of a diagnosis."""

import math

import pytest

from crashkit.diagnose.result import Estimate
from crashkit.diagnose.words import number


@pytest.mark.parametrize(
    ("estimate", "expected"),
    [
        (Estimate(160200.0, 912.0, "N"), "1.602e+05 ± 9.1e+02 N"),
        (Estimate(0.25, 0.01, "1"), "0.25 ± 0.01"),
        (Estimate(0.02, math.nan, "m"), "0.02 m (no interval)"),
        (Estimate(0.02, math.inf, "m"), "0.02 m (no interval)"),
    ],
)
def test_a_number_is_told_with_its_deviation_if_it_has_one(estimate: Estimate, expected: str) -> None:
    assert number(estimate) == expected
