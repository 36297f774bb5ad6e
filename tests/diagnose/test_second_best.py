"""Where a further run contradicts an answer, the one of its rivals that explains all runs is told."""

import pytest
from attrs import evolve

from crashkit.diagnose.contest import propose_all
from crashkit.diagnose.evidence import rival_of
from crashkit.diagnose.search import begin
from crashkit.diagnose.second_best import second_best
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint


@pytest.fixture
def contradicted(workshop, model, misfit, recorded):
    """A model without its dashpot, fitted to two runs, and what chosen claims made of the slow one alone."""
    numbers = {"damping": 800.0, "clearance": 0.0, "engagement": 1e-3}
    true = with_joint(model, Joint("dashpot", ("wall", "front"), "viscous", {n: Parameter(v) for n, v in numbers.items()}))
    slow, fast = recorded(true, 0.9, 1), recorded(true, 1.2, 2)
    alone, both = misfit(model, slow=slow), misfit(model, slow=slow, fast=fast)
    base = begin(workshop.identifier, alone).advance(40)

    def ask(*claims):
        asked = evolve(workshop, hypotheses={name: workshop.hypotheses[name] for name in claims})
        proposals = propose_all(asked, base.fitted())
        first = {proposal.physics: proposal for proposal in reversed(proposals)}
        fits = [begin(workshop.identifier, workshop.misfit(base.fitted(), first[name].model)).advance(20) for name in claims]
        rivals = [rival_of(first[name], fit, base.deviance) for name, fit in zip(claims, fits, strict=True)]
        best = begin(workshop.identifier, both).advance(40)
        return second_best(workshop, both, best, rivals, lambda doing, share: None)

    return ask


def test_the_rival_that_explains_all_runs_is_told(contradicted):
    found = contradicted("clearance", "viscous_damping")
    assert [look.rivals[0].proposal.physics for look in found.rounds] == ["viscous_damping"]
    assert found.search.normalised == pytest.approx(1.0, abs=0.05)
    assert set(found.search.misfit.recordings) == {"slow", "fast"}


def test_where_none_does_everything_must_be_asked(contradicted):
    assert contradicted("clearance") is None


def test_without_rivals_too(contradicted):
    assert contradicted() is None
