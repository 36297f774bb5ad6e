"""What is told about a finding: when it acts, in which runs, and what would tell it from its rival."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.diagnose.show.finding import estimates, make_finding, stand_ins
from crashkit.diagnose.show.run_drops import run_drops
from crashkit.protocols import Identification, Proposal, Status

TIMES = np.arange(100) * 1e-3


def action(force, rate):
    return xr.Dataset({"modelled_force": ("time", force), "deformation_rate": ("time", rate)}, coords={"time": TIMES})


def found(workshop, action, drops, physics="viscous_damping"):
    rival = SimpleNamespace(proposal=Proposal(physics, "linear", {"joint": "front"}, None, (), {}), place="joint front")
    return make_finding(rival, workshop.hypotheses[physics], {}, 0.9, [], action, drops, 0.2)


@pytest.mark.parametrize(
    ("acts", "phase"), [(slice(10, 40), "loading"), (slice(60, 90), "unloading"), (slice(30, 70), "both")]
)
def test_when_it_acts_and_in_which_phase(workshop, acts, phase):
    force = np.zeros(100)
    force[acts] = 1e4
    finding = found(workshop, {"run": action(force, np.where(TIMES < 0.05, 5.0, -5.0))}, {"run": 100.0})
    assert finding.phase == phase
    assert finding.time == pytest.approx((TIMES[acts][0], TIMES[acts][-1]))


def test_it_acts_from_the_first_run_to_the_last(workshop):
    early, late = np.zeros(100), np.zeros(100)
    early[10:20], late[30:80] = 1e4, -9e3
    rate = np.full(100, 2.0)
    finding = found(workshop, {"a": action(early, rate), "b": action(late, rate)}, {"a": 100.0, "b": 100.0})
    assert finding.time == pytest.approx((0.010, 0.079))


def test_runs_are_named_in_which_it_shows(workshop):
    still = {"a": action(np.ones(100), np.ones(100))}
    assert found(workshop, still, {"a": 50.0, "b": 2.0, "c": 12.0}).runs == ("a", "c")
    assert found(workshop, still, {"a": 5.0, "b": 2.0}).runs == ("a", "b")


def test_an_instrument_acts_all_the_time(workshop):
    finding = found(workshop, {}, {"a": 50.0})
    assert finding.time == (0.0, 0.2)
    assert finding.sentence == "joint front is damped: part of its force opposes the deformation rate and grows with it"


def test_of_an_unknown_force_the_largest_is_told_and_where_it_acts(workshop):
    weak, strong = np.zeros(100), np.zeros(100)
    weak[40], strong[20] = 2e3, -1.25e4
    runs = {"a": action(weak, np.full(100, 3.0)), "b": action(strong, np.full(100, 4.0))}
    runs = {name: run.assign(deformation=("time", 5.0 * TIMES)) for name, run in runs.items()}
    told = found(workshop, runs, {"a": 50.0, "b": 50.0}, "unknown").sentence
    assert told.endswith("explains, strongest with -12.5 kN at 20 ms, a deformation of 100 mm and 4.0 m/s")


def test_the_drop_of_each_run_is_its_own(misfit, model, recorded):
    runs = {"good": recorded(model, 1.0, noise=0.0), "off": recorded(model, 1.2, noise=0.0, film=shifted)}
    before = misfit(model, **runs)
    wrong = before.with_values({"joint.first.crush_force": 2.5e4})
    drops = run_drops(wrong, before)
    sums = [m.channel_sums(m.residual(m.start())) for m in (wrong, before)]
    assert drops == pytest.approx({"good": (sums[0] - sums[1])[:2].sum(), "off": (sums[0] - sums[1])[2:].sum()})
    assert drops["good"] > 100.0


def test_where_a_model_cannot_be_simulated_without_a_finding_all_runs_show_it(misfit, model, recorded):
    after = misfit(model, slow=recorded(model, 0.9), fast=recorded(model, 1.2))
    before = after.with_values({"joint.first.elastic_stiffness": 1e308, "joint.first.crush_force": 1e308})
    assert run_drops(before, after) == {"slow": np.inf, "fast": np.inf}


def shifted(dataset):
    return dataset.assign(position=dataset["position"] + 2e-3)


def identified(names, values, stds, units):
    columns = {"value": values, "std": stds, "units": units, "identifiable": [std < 0.25 for std in stds]}
    columns |= {"lower": np.zeros(len(names)), "upper": np.full(len(names), 100.0)}
    return xr.Dataset({name: ("parameter", column) for name, column in columns.items()}, coords={"parameter": names})


def test_estimates_bear_the_short_names_of_the_parameters():
    names = ["joint.front.crush_force", "joint.front_peak.peak_force", "joint.front_peak.peak_deformation"]
    table = identified(names, [1.0, 2.0, 3.0], [0.1, 0.2, 0.3], ["N", "N", "m"])
    rival = SimpleNamespace(proposal=Proposal("peak_load", "bump", {}, None, tuple(names[1:]), {}), place="")
    told = estimates(rival, Identification(table, Status.CONVERGED, 0.0))
    assert {name: (e.value, e.std, e.units, e.identifiable) for name, e in told.items()} == {
        "peak_force": (2.0, 0.2, "N", True),
        "peak_deformation": (3.0, 0.3, "m", False),
    }


def test_a_number_that_may_be_off_by_more_than_its_bounds_allow_is_not_identifiable():
    table = identified(["joint.front.loss"], [1.0], [0.1], ["1"]).assign(upper=("parameter", [0.05]))
    rival = SimpleNamespace(proposal=Proposal("fracture", "", {}, None, ("joint.front.loss",), {}), place="")
    assert not estimates(rival, Identification(table, Status.CONVERGED, 0.0))["loss"].identifiable


def test_numbers_of_a_joint_are_found_where_another_finding_has_taken_their_place():
    names = ["joint.front.peak_force", "joint.front_peak_load.peak_force"]
    table = identified(names[:1], [1.0], [0.1], ["N"])
    rival = SimpleNamespace(proposal=Proposal("peak_load", "bump", {"joint": "front"}, None, (names[1],), {}))
    found = Identification(table, Status.CONVERGED, 0.0)
    assert estimates(rival, found)["peak_force"].value == 1.0
    assert estimates(rival, found, given=names[:1]) == {}


def test_imitations_at_one_place_are_told_as_one_unknown_force(workshop):
    force = np.zeros(100)
    force[10:30] = 1e4
    first = found(workshop, {"a": action(force, np.ones(100))}, {"a": 50.0, "b": 2.0})
    second = evolve(first, physics="fracture", time=(0.05, 0.09), runs=("b",), probability=1.0)
    told = stand_ins([first, second], workshop.hypotheses["unknown"].sentence)
    assert told.physics == "unknown"
    assert told.form == "imitated by viscous_damping + fracture"
    assert told.location == {"joint": "front"}
    assert told.time == pytest.approx((0.01, 0.09))
    assert told.runs == ("a", "b")
    assert told.sentence == "joint front carries a force that none of the known physics explains"
