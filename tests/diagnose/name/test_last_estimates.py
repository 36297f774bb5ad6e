"""What one joint's deformation does in another joint, and a narrow dent: asked for where something is left, and told where it
leaves far less."""

from types import SimpleNamespace

import numpy as np
import pytest
from attrs import evolve

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.last_estimates import estimated_at_last
from crashkit.diagnose.name.look import Look, look_again
from crashkit.diagnose.result import place_of
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint
from crashkit.protocols import Proposal
from crashkit.testing import toys

DENT = (1e4, 0.3, 0.03)
"""N, m and m: force, place and width."""


@pytest.fixture(scope="module")
def asked(workshop, misfit, recorded, simulated, inquiry):
    """Two masses; the first joint's deformation also drives the two apart by a wedge that nobody believes in. The inquiry, and
    the true motion of the fast run."""
    believed = toys.two_degrees()
    push = {"stiffness": Parameter(0.05 * believed.parameters()["joint.first.elastic_stiffness"].value, fixed=True)}
    wedge = Joint("wedge", ("wall", "front"), "linear_stop", push | {"stop_deformation": Parameter(0.05, fixed=True)})
    true = with_joint(believed, evolve(wedge, acts_on=("front", "rear")))
    given = misfit(believed, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2)).with_prior(0.3)
    base = begin(workshop.identifier, given).advance(40)
    few = {name: workshop.hypotheses[name] for name in ("viscous_damping", "unknown")}
    return inquiry(base, given, few), simulated(true, 1.2)


def of(inquiry, physics):
    """The best claim of this kind, as a discovery."""
    look = look_again(inquiry, inquiry.base.fitted(), [], concerns=lambda p: p.physics == physics, quick=True)
    search = look.leader.search
    return Discovery(inquiry.base.fitted(), search.fitted(), search, (look,))


def test_it_is_told_with_its_place_and_what_drives_it_and_with_its_force(asked):
    inquiry, fast = asked
    wrong = of(inquiry, "viscous_damping")
    told = estimated_at_last(inquiry, wrong)
    (claim,) = [look.leader for look in told.findings]
    assert (place_of(claim.proposal.location), claim.proposal.form) == ("joint second", "deformation of first")
    assert told.search.normalised < 1.1 < wrong.search.normalised
    assert told.findings[0].probabilities[0] == max(told.findings[0].probabilities)
    assert wrong.findings[0].leader.proposal.physics in [rival.proposal.physics for rival in told.findings[0].rivals]
    assert told.final.model.joints[-1].acts_on == ("front", "rear")
    felt, true = (motion["contact_force"].sel(body="rear").values for motion in (predicted(told), fast))
    np.testing.assert_allclose(felt, true, atol=0.03 * np.abs(true).max())


def predicted(told):
    return told.final.predictor.motion("fast", told.search.misfit.values(told.search.point))


def test_what_leaves_little_or_accuses_an_instrument_stays(asked):
    inquiry, _ = asked
    wrong = of(inquiry, "viscous_damping")
    at_noise = evolve(wrong, search=SimpleNamespace(normalised=1.1))
    assert estimated_at_last(inquiry, at_noise) is at_noise
    sensor = evolve(wrong.findings[0].leader.proposal, location={"sensor": "front", "instrument": "accelerometer"})
    look = evolve(wrong.findings[0], rivals=(evolve(wrong.findings[0].leader, proposal=sensor),))
    accused = evolve(wrong, findings=(look,))
    assert estimated_at_last(inquiry, accused) is accused
    nothing = Discovery(wrong.base, wrong.base, inquiry.base, (), Look((), (), 1.0, wrong.base))
    assert estimated_at_last(inquiry, nothing) is nothing


@pytest.fixture
def dented(workshop, misfit, recorded, inquiry, model):
    """A narrow dent in the force of the only joint."""
    joint = model.joints[0]
    dent = {"bump_force": -DENT[0], "bump_deformation": DENT[1], "bump_width": DENT[2]}
    law = {**joint.parameters, **{name: Parameter(value) for name, value in dent.items()}}
    true = evolve(model, joints=(evolve(joint, law=f"{joint.law} + bump", parameters=law),))
    given = misfit(model, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2)).with_prior(0.3)
    return inquiry(begin(workshop.identifier, given).advance(40), given, {"unknown": workshop.hypotheses["unknown"]})


@pytest.mark.parametrize(("left", "is_asked"), [(3.0, True), (0.0, False)])
def test_a_narrow_dent_is_told_as_one_bump_where_all_else_leaves_something(dented, left, is_asked):
    claim = Rival(Proposal("fracture", "", {"joint": "first"}, None, (), {}), dented.base, 9.0, 4.0)
    look = Look((claim,), (1.0,), 0.0, dented.base.fitted())
    search = SimpleNamespace(normalised=(1.0 + left) ** 0.5, excess=left)
    found = Discovery(dented.base.fitted(), dented.base.fitted(), search, (look,))
    told = estimated_at_last(dented, found)
    if not is_asked:
        assert told is found
        return
    leader = told.findings[0].leader
    assert leader.proposal.form.startswith("bump") and leader.place == "joint first"
    sizes = [leader.search.values[name] for name in leader.proposal.parameters]
    np.testing.assert_allclose(np.abs(sizes), DENT, rtol=0.1)
