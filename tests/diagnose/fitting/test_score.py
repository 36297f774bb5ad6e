"""The score test and the odds that follow from it."""

import numpy as np
import pytest
from attrs import evolve, frozen

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.evidence import Rival, best_forms, probabilities
from crashkit.diagnose.fitting.quadratic import Extended, tangent
from crashkit.diagnose.fitting.score import score
from crashkit.diagnose.fitting.search import begin
from crashkit.misfit import Misfit
from crashkit.model import Parameter
from crashkit.protocols import Proposal


def offset(by):
    return lambda dataset: dataset.assign(acceleration=dataset["acceleration"] + by)


def fixed(model):
    return model.with_parameters({path: evolve(p, fixed=True) for path, p in model.free_parameters().items()})


def bias_of(workshop, base):
    motion = [base.predictor.motion(run, base.values(base.start())) for run in base.recordings]
    proposals = workshop.hypotheses["bias"]().propose(base.model, motion, list(base.recordings.values()))
    return next(p for p in proposals if p.location["instrument"] == "accelerometer")


def scored(workshop, base, proposal):
    residual = base.residual(base.start())
    return score(
        proposal, {}, Extended(workshop.misfit(base, proposal.model), proposal.parameters), float(residual @ residual)
    )


def test_where_everything_is_linear_the_promise_is_kept(workshop, model, recorded, misfit):
    base = misfit(fixed(model), run=recorded(model, accelerometer=offset(0.7)))
    residual = base.residual(base.start())
    felt = residual[-base.channels[1].samples :]
    bias = bias_of(workshop, base)
    promise = scored(workshop, base, bias)
    assert promise.drop == pytest.approx(len(felt) * felt.mean() ** 2, rel=1e-6)
    search = begin(workshop.identifier, workshop.misfit(base, bias.model)).advance(20)
    assert base.deviance(residual) - search.deviance == pytest.approx(promise.drop, rel=1e-6)


def test_what_the_models_own_parameters_can_mend_is_not_promised(workshop, model, recorded, misfit):
    off = model.with_values({"joint.first.crush_force": 2.45e4})
    run = recorded(model, noise=0.0)
    rigid, free = (misfit(one, run=run) for one in (fixed(off), off))
    promises = [scored(workshop, base, bias_of(workshop, base)).drop for base in (rigid, free)]
    search = begin(workshop.identifier, free).advance(60).fitted()
    assert scored(workshop, search, bias_of(workshop, search)).drop < 1e-3 * promises[0]


def test_a_promise_stops_at_the_bounds(workshop, model, recorded, misfit):
    base = misfit(fixed(model), run=recorded(model, noise=0.0, accelerometer=offset(5.0)))
    bias = bias_of(workshop, base)
    path = bias.parameters[0]
    narrow = evolve(bias, model=bias.model.with_parameters({path: Parameter(0.0, -1.0, 1.0)}))
    count = base.channels[1].samples
    assert scored(workshop, base, narrow).drop == pytest.approx(count * (5.0**2 - 4.0**2), rel=1e-5)


def test_what_is_known_of_the_model_without_the_physics_changes_no_score(workshop, model, recorded, misfit):
    base = misfit(model, run=recorded(model, accelerometer=offset(0.7))).with_prior(0.1)
    known, proposals = tangent(base, base.start()), propose_all(workshop, base)
    equipped = workshop.equipped([model, *(proposal.model for proposal in proposals)])
    joined = 0
    for proposal in proposals:
        larger = equipped.misfit(base, proposal.model)
        whole, quick = (Extended(larger, proposal.parameters, one) for one in (None, known))
        for start in proposal.starts:
            one, other = (score(proposal, start, extended, known.square.value) for extended in (whole, quick))
            assert other.drop == pytest.approx(one.drop, rel=1e-5, abs=1e-5)
            assert other.deviation == pytest.approx(one.deviation, rel=1e-5)
            assert other.values == one.values
        joined += quick._joined(known, larger.start_at({**proposal.null, **proposal.starts[0]})) is not None
    assert joined > 0.6 * len(proposals)


@frozen
class Claim:
    """Stands for a rival: what the odds need of it."""

    proposal: Proposal
    evidence: float

    identity = Rival.identity


def claim(physics, evidence, joint="first", form="line"):
    return Claim(Proposal(physics, form, {"joint": joint}, None, (), {}), evidence)


def test_the_odds_are_those_of_bayes():
    chances, nothing = probabilities([claim("clearance", 3.0), claim("peak_load", 1.0)], tried=10)
    weights = np.array([np.exp(3.0) / 10, np.exp(1.0) / 10, 1.0])
    assert [*chances, nothing] == pytest.approx(weights / weights.sum())


def test_without_evidence_there_is_nothing():
    chances, nothing = probabilities([claim("clearance", -3.0)], tried=50)
    assert nothing > 0.99 and chances.sum() + nothing == pytest.approx(1.0)
    assert probabilities([], tried=0)[1] == 1.0


def test_known_physics_comes_before_a_force_that_nobody_knows():
    chances, _ = probabilities([claim("unknown", 20.0), claim("clearance", 20.0)], tried=2)
    assert chances[1] == pytest.approx(100.0 * chances[0])


def test_overwhelming_evidence_does_not_overflow():
    chances, nothing = probabilities([claim("clearance", 1e5), claim("peak_load", 9e4)], tried=2)
    assert chances.tolist() == [1.0, 0.0] and nothing == 0.0


def test_of_several_forms_the_most_evident_stands_for_the_claim():
    ranked = [claim("rate", 9.0, form="power"), claim("rate", 8.0, form="linear"), claim("rate", 7.0, joint="second")]
    assert best_forms(ranked) == [ranked[0], ranked[2]]


def test_the_smallest_bias_that_shows_is_that_of_the_mean_of_all_samples(workshop, model, recorded, misfit):
    base = misfit(fixed(model), run=recorded(model))
    count = base.channels[1].samples
    assert scored(workshop, base, bias_of(workshop, base)).deviation == pytest.approx(count**-0.5, rel=1e-6)


def test_what_the_models_own_parameters_imitate_shows_less(workshop, model, recorded, misfit):
    run = recorded(model)
    rigid, free = (misfit(one, run=run) for one in (fixed(model), model))
    alone, hidden = (scored(workshop, base, bias_of(workshop, base)).deviation for base in (rigid, free))
    assert hidden > 1.005 * alone


@pytest.mark.parametrize("huge", [1e200, np.inf, np.nan])
def test_what_blows_up_promises_nothing(workshop, model, recorded, misfit, monkeypatch, huge):
    base = misfit(model, run=recorded(model, accelerometer=offset(0.7)))
    bias = bias_of(workshop, base)
    sound = Misfit.residual_and_jacobian

    def blown_up(self, scaled):
        residual, jacobian = sound(self, scaled)
        jacobian[0, 0] = huge
        return residual, jacobian

    monkeypatch.setattr(Misfit, "residual_and_jacobian", blown_up)
    assert scored(workshop, base, bias) is None


def test_the_deviation_of_a_number_that_is_searched_in_its_logarithm_is_in_its_unit(workshop, model, recorded, misfit):
    path, base = "joint.first.crush_force", misfit(fixed(model), run=recorded(model))
    freed = base.model.with_parameters({path: model.parameters()[path]})
    stronger = Proposal("strength", "constant", {"joint": "first"}, freed, (path,), null={path: freed.values()[path]})
    told = scored(workshop, base, stronger).deviation
    found = begin(workshop.identifier, workshop.misfit(base, freed)).advance(20).result()
    assert told == pytest.approx(float(found.parameters["std"].sel(parameter=path)), rel=0.1)
