"""What is found is weighed on all samples, and what was believed of the numbers counts there as it did before."""

import math

import pytest

from crashkit.diagnose import refining
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.refining import refined


@pytest.fixture
def refine(workshop, model, offered, monkeypatch):
    """What is told of a dashpot, and the misfits that say whether all samples pay for it."""

    def refine(damping):
        look, base, final = offered(damping)
        asked = []
        worth = refining._is_worthless
        monkeypatch.setattr(refining, "_is_worthless", lambda looks, *two: asked.extend(two) or worth(looks, *two))
        discovery = Discovery.of(base, final, (look,))
        return refined(workshop, discovery, model, base.misfit.recordings), asked

    return refine


def test_what_was_believed_counts_when_all_samples_are_asked(refine, model):
    told, (base, _) = refine(800.0)
    assert [look.leader.proposal.physics for look in told.findings] == ["viscous_damping"]
    given = base.with_values({path: number.value for path, number in model.parameters().items() if path in base.names})
    assert base.residual(base.start()).size == base.sample_count + len(base.names)
    assert given.residual(given.start())[given.sample_count :] == pytest.approx(0.0)
    assert told.base.residual(told.base.start()).size == told.base.sample_count


@pytest.mark.parametrize(("belief", "is_worthless"), [(0.3, False), (math.inf, True)])
def test_a_number_that_nobody_would_give_hides_nothing(offered, belief, is_worthless):
    """The recordings alone show no difference: at both values no run reaches that threshold."""
    look, base, _ = offered(0.0)
    threshold = "joint.first.densification_deformation"
    believing = base.fitted().with_prior(belief)
    driven, near = (believing.with_values({threshold: times * base.values[threshold]}) for times in (40.0, 5.0))
    assert refining._is_worthless((look,), driven, near) is is_worthless
