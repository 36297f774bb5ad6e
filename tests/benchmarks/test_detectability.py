"""Between which sizes an effect begins to be found."""

import numpy as np
import pytest

from benchmarks import detectability
from benchmarks.detectability import SIZES, Threshold, share_found, table, threshold


@pytest.mark.parametrize(
    ("least", "expected"),
    [(0.0, (0.0, SIZES[0])), (10.0, (8.0, 11.3)), (64.0, (45.0, 64.0)), (100.0, (SIZES[-1], np.inf))],
)
def test_it_begins_between_the_largest_that_is_missed_and_the_smallest_that_is_found(monkeypatch, least, expected):
    asked = []
    monkeypatch.setattr(detectability, "is_found", lambda physics, size, seed: asked.append(size) or size >= least)
    assert threshold("bias", (0, 1)) == Threshold("bias", *expected)
    assert len(asked) <= 4


def test_what_no_vehicle_shows_has_no_threshold(monkeypatch):
    monkeypatch.setattr(detectability, "is_found", lambda *_: None)
    assert threshold("tension", (0, 1)) is None


def test_shares_and_table_tell_every_vehicle():
    thresholds = [Threshold("bias", 4.0, 5.7), Threshold("bias", 64.0, np.inf), Threshold("rotation", 5.7, 8.0)]
    assert [share_found(thresholds, size) for size in (4.0, 5.7, 64.0)] == pytest.approx([0.0, 1 / 3, 2 / 3])
    assert "| bias | 5.7, more than 64 |" in table(thresholds)
