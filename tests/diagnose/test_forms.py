"""A finding in a poor form is told in a better one, and one that leaves nothing stays as it is."""

import pytest

from crashkit.diagnose.forms import in_best_forms
from crashkit.diagnose.look import Round
from crashkit.diagnose.name import Rival
from crashkit.diagnose.search import begin
from crashkit.model import Parameter
from crashkit.model.edit import with_factor

RISE = {"rate_amplitude": 0.25, "rate_exponent": 0.25}


@pytest.fixture
def found(workshop, model, misfit, recorded):
    """A rate effect that is a power of the rate, found in one of its forms: the fit without it, and the round."""
    true = with_factor(model, "first", "rate_power", {name: Parameter(v, fixed=True) for name, v in RISE.items()})
    given = misfit(model, slow=recorded(true, 0.6, 1), middle=recorded(true, 1.0, 2), fast=recorded(true, 1.8, 3))
    base = begin(workshop.identifier, given).advance(40)
    motion = [given.predictor.motion(run, given.values(base.point)) for run in given.recordings]
    forms = workshop.hypotheses["rate_dependence"]().propose(base.fitted().model, motion, list(given.recordings.values()))

    def find(form):
        proposal = next(one for one in forms if one.form == form)
        start = workshop.misfit(base.fitted(), proposal.model).with_values({proposal.parameters[0]: 0.01})
        search = begin(workshop.identifier, start).advance(60)
        drop = base.deviance - search.deviance
        return base, Round((Rival(proposal, search, drop, 0.5 * drop),), (1.0,), 0.0, base.fitted())

    return find


def test_a_better_form_takes_the_place_of_a_poor_one(workshop, found):
    base, look = found("linear")
    poor = look.rivals[0].search
    (better,), search = in_best_forms(workshop, base, [look], poor, lambda doing, share: None)
    assert poor.normalised > 1.05
    assert better.rivals[0].proposal.form == "power"
    assert better.rivals[0].search is search
    assert search.normalised == pytest.approx(1.0, abs=0.03)
    assert better.rivals[0].drop == pytest.approx(base.deviance - search.deviance)
    values = search.misfit.values(search.point)
    assert values["joint.first.rate_exponent"] == pytest.approx(RISE["rate_exponent"], abs=0.1)


def test_a_form_that_leaves_nothing_is_not_questioned(workshop, found):
    base, look = found("power")
    assert in_best_forms(workshop, base, [look], look.rivals[0].search, pytest.fail) == ([look], look.rivals[0].search)
