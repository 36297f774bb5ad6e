"""What was hardly told from a finding while it stood alone is asked again beside a second one."""

from types import SimpleNamespace

import pytest

from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.name import tied
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.tied import untied
from crashkit.protocols import Proposal


def rival(physics, left, deviance=1000.0, place="rails"):
    """A claim that leaves so much above the noise."""
    misfit = SimpleNamespace(independent_samples=1000.0)
    search = SimpleNamespace(excess=left, deviance=deviance, normalised=(left + 1.0) ** 0.5, misfit=misfit)
    return Rival(Proposal(physics, "", {"joint": place}, None, (), {}), search, 9000.0, 4500.0)


@pytest.fixture
def asked(monkeypatch):
    """Friction that alone leaves 10, beside a mass; what else a look has, and what that leaves beside the mass."""

    def told(others, beside, before=("mass",), together=0.0):
        forms = {name: rival(name, 0.0, deviance) for name, deviance in beside.items()}
        monkeypatch.setattr(
            tied, "in_all_forms", lambda inquiry, one, *_: [Candidate(one.proposal, forms[one.proposal.physics].search)]
        )
        base = SimpleNamespace(misfit=SimpleNamespace(names=("mass",)))
        inquiry = SimpleNamespace(base=base, fit_with=lambda rivals, last: rival("joint_friction", 10.0).search)
        friction, mass = rival("joint_friction", together), rival("added_mass", together)
        first = SimpleNamespace(names=before)
        looks = [Look((friction, *others), (1.0,), 0.0, first), Look((mass,), (1.0,), 0.0, None)]
        found, search = untied(inquiry, looks, friction.search)
        assert found[1] is looks[1]
        return [one.proposal.physics for one in found[0].rivals], found[0].probabilities, search.deviance, found[0] is looks[0]

    return told


def test_what_was_tied_and_explains_more_beside_the_second_is_told(asked):
    physics, (first, *_), left, _ = asked([rival("viscous_damping", 10.2)], {"viscous_damping": 950.0})
    assert (physics[0], left) == ("viscous_damping", 950.0)
    assert first > 0.999


def test_what_is_still_tied_is_told_as_a_rival(asked):
    physics, (first, second), left, _ = asked([rival("viscous_damping", 10.2)], {"viscous_damping": 1004.0})
    assert (physics, left) == (["joint_friction", "viscous_damping"], 1000.0)
    assert second / first == pytest.approx(0.135, abs=0.001)


def test_a_finding_stays_beside_what_leaves_more_there(asked):
    assert asked([rival("viscous_damping", 10.2)], {"viscous_damping": 1200.0})[3]


@pytest.mark.parametrize(
    "other", [rival("viscous_damping", 11.0), rival("unknown", 9.0), rival("viscous_damping", 10.2, place="bumper")]
)
def test_what_was_told_from_it_or_is_an_estimate_or_elsewhere_is_not_asked_again(asked, other):
    assert asked([other], {})[3]


@pytest.mark.parametrize(("together", "is_asked"), [(0.1, False), (1.0, True)])
def test_where_both_leave_something_what_was_told_from_the_first_by_less_than_double_is_asked(asked, together, is_asked):
    physics, *_ = asked([rival("tension", 19.0), rival("fracture", 21.0)], {"tension": 950.0}, together=together)
    assert physics[0] == ("tension" if is_asked else "joint_friction")


def test_rivals_that_were_fitted_beside_another_finding_are_not_asked_again(asked):
    """As those of two that were found at once."""
    assert asked([rival("viscous_damping", 9.0)], {}, before=("mass", "damping"))[3]
