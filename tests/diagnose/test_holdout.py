"""What held-out runs say of what was found: contradicted, or only told less well."""

from types import SimpleNamespace

import pytest

from crashkit.diagnose import holdout
from crashkit.diagnose.holdout import is_contradicted


@pytest.fixture
def contradicted(monkeypatch):
    """Whether a finding is contradicted where a model without it left so much, and all runs with it leave so much."""
    monkeypatch.setattr(holdout, "normalised", lambda misfit, told_only: misfit if told_only else 1.0)

    def asked(base, together, findings=("one",)):
        return is_contradicted(SimpleNamespace(findings=findings, base=base), SimpleNamespace(fitted=lambda: together))

    return asked


def test_what_leaves_something_of_all_runs_is_contradicted(contradicted):
    assert contradicted(5.0, 1.3)
    assert not contradicted(5.0, 1.05)


def test_a_trace_of_what_is_gross_contradicts_nothing(contradicted):
    """No further finding could be told for so little."""
    assert not contradicted(18.0, 1.3)
    assert contradicted(18.0, 1.6)
    assert not contradicted(18.0, 1.6, findings=("one", "another"))
    assert contradicted(18.0, 1.9, findings=("one", "another"))
