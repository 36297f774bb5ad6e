"""What a claim explains, less what its numbers and its freedom cost."""

from types import SimpleNamespace

import pytest

from crashkit.diagnose.fitting.evidence import best_forms, ranked_by_evidence
from crashkit.protocols import Proposal

REFERENCE = 1e6


def left(deviance, runs):
    """A fit that leaves so much of so many runs."""
    misfit = SimpleNamespace(independent_samples=5000.0, recordings=dict.fromkeys(range(runs)))
    normalised = (deviance / 5000.0) ** 0.5
    return SimpleNamespace(deviance=deviance, normalised=normalised, excess=normalised**2 - 1.0, misfit=misfit)


def estimate(of):
    """A table that depends on this."""
    return Proposal("unknown", of, {"joint": "front"}, None, ("heights",) * 24, {}, estimate_of=of)


@pytest.mark.parametrize(
    ("form", "runs", "told"), [("time", 3, "unknown"), ("time", 1, "peak_load"), ("deformation", 3, "peak_load")]
)
def test_only_a_force_of_the_time_in_several_runs_is_believed_nearly_as_it_fits(form, runs, told):
    """A known cause leaves 1.5 times the noise, a table of two dozen heights 1.1 times; a table of the deformation would."""
    table = estimate(form)
    peak = Proposal("peak_load", "bell", {"joint": "front"}, None, ("peak_force",), {})
    ranked = ranked_by_evidence([(table, left(6050.0, runs)), (peak, left(11250.0, runs))], 1e5)
    assert ranked[0].proposal.physics == told


@pytest.mark.parametrize(("known", "told"), [(51200.0, "unknown"), (14000.0, "peak_load")])
def test_a_table_that_leaves_a_tenth_of_what_known_causes_do_does_not_imitate(known, told):
    """It leaves 1.1 times the noise, they leave 3.2 or 1.7 times."""
    table = estimate("deformation")
    peak = Proposal("peak_load", "bell", {"joint": "front"}, None, ("peak_force",), {})
    ranked = ranked_by_evidence([(table, left(6050.0, 3)), (peak, left(known, 3))], REFERENCE)
    assert ranked[0].proposal.physics == told


@pytest.mark.parametrize(("left_over", "told"), [(11e3, "deformation"), (44e3, "time")])
def test_of_two_estimates_at_one_place_the_one_that_fits_is_told_with_the_evidence_of_the_other(left_over, told):
    """That a table of the deformation imitates known laws says nothing for one of the time that leaves three times the noise;
    where that leaves about as much, it does."""
    of_time, of_deformation = estimate("time"), estimate("deformation")
    ranked = ranked_by_evidence([(of_time, left(45e3, 3)), (of_deformation, left(left_over, 3))], REFERENCE)
    assert ranked[0].proposal is of_time
    (claim,) = best_forms(ranked)
    assert (claim.proposal.form, claim.evidence) == (told, ranked[0].evidence)


@pytest.mark.parametrize(("of", "told"), [("deformation", "unknown"), ("distance", "tension")])
def test_a_table_that_acts_from_afar_imitates_though_it_reaches_the_noise(of, told):
    """A joint that pulls up to a limit, as a line: 1.08 times the noise."""
    table = estimate(of)
    line = Proposal("tension", "own line", {"joint": "front"}, None, ("tension",), {})
    ranked = ranked_by_evidence([(table, left(5100.0, 3)), (line, left(5800.0, 3))], 1e4)
    assert ranked[0].proposal.physics == told
