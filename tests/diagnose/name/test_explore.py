"""What explains the recordings near at hand is told at once; an instrument that is wrong is put right before all is asked."""

from types import SimpleNamespace

import pytest
from attrs import evolve

from crashkit.diagnose.fitting.couples import Couple
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name import explore
from crashkit.diagnose.name.discover import discover
from crashkit.diagnose.name.explore import _is_confirmed, _is_wrong_beside_more, _suffices, cheaper, explored
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.nearby import Nearby, _is_most
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint
from crashkit.protocols import Proposal

SENSOR = {"sensor": "front_sensor", "instrument": "accelerometer"}


def leaving(normalised, physics="fracture", location=None):
    """A look whose winner leaves so much."""
    point = SimpleNamespace(is_strained=lambda at: False, independent_samples=1000.0, channels=())
    square = normalised**2
    search = SimpleNamespace(normalised=normalised, excess=square - 1.0, deviance=1e3 * square, misfit=point, point=None)
    rival = Rival(Proposal(physics, "", location or {"joint": "front"}, None, (), {}), search, 9000.0, 4500.0)
    return Look((rival,), (1.0,), 0.0, None)


def found(normalised, physics=("fracture",), last=True):
    findings = tuple(leaving(normalised, one) for one in physics)
    return Discovery(None, None, findings[-1].leader.search, findings, leaving(1.0) if last else None)


@pytest.mark.parametrize(("given", "suffices"), [(9.0, True), (2.0, False)])
def test_one_cause_is_enough_if_a_second_could_explain_too_little_to_be_told(monkeypatch, given, suffices):
    """At 1.03 times the noise, where the model left so much."""
    monkeypatch.setattr(explore, "explains", lambda search: False)
    monkeypatch.setattr(explore, "is_sound", lambda search: True)
    monkeypatch.setattr(explore, "_is_told_by_most", lambda search: False)
    assert _suffices(found(1.03), leaving(given).leader.search) is suffices


@pytest.mark.parametrize(
    ("left", "physics", "last", "suffices"),
    [
        (1.08, ("fracture", "tension"), True, True),
        (1.2, ("fracture", "tension"), True, False),
        (1.14, ("fracture", "tension"), False, False),
        (1.08, ("fracture", "unknown"), True, False),
        (1.08, ("fracture", "tension", "bias"), True, False),
    ],
)
def test_two_causes_are_enough_if_they_leave_next_to_nothing_and_no_third_convinces(left, physics, last, suffices):
    """Where the model left five times the noise."""
    assert _suffices(found(left, physics, last), leaving(5.0).leader.search) is suffices


@pytest.mark.parametrize(("given", "suffices"), [(20.0, True), (15.0, False)])
def test_two_causes_may_leave_a_trace_of_what_is_gross(given, suffices):
    assert _suffices(found(1.7, ("fracture", "tension"), last=False), leaving(given).leader.search) is suffices


@pytest.mark.parametrize(("given", "suffices"), [(7.0, True), (5.0, False)])
def test_two_causes_that_leave_nothing_of_what_is_gross_are_enough(given, suffices):
    """No look is needed to know that a third would have to explain more than there is noise."""
    assert _suffices(found(1.0, ("fracture", "tension"), last=False), leaving(given).leader.search) is suffices


@pytest.mark.parametrize(("given", "last", "suffices"), [(20.0, True, True), (10.0, True, False), (20.0, False, False)])
def test_one_cause_may_leave_a_hundredth_of_what_is_gross_if_no_second_convinces(monkeypatch, given, last, suffices):
    monkeypatch.setattr(explore, "_is_told_by_most", lambda search: False)
    assert _suffices(found(1.7, last=last), leaving(given).leader.search) is suffices


def test_a_claim_that_leaves_next_to_nothing_of_what_is_gross_is_followed():
    """To a known one that explains half of what it leaves."""

    def is_most(left, base, then, physics="tension"):
        search, before = leaving(left).leader.search, leaving(base).leader.search
        return _is_most(search, before, leaving(then, physics))

    assert is_most(2.8, 33.0, 1.6)
    assert not is_most(2.8, 10.0, 1.6)
    assert not is_most(2.8, 33.0, 2.6)
    assert not is_most(2.8, 33.0, 1.6, "unknown")


def test_what_everything_in_sight_only_confirms_is_told():
    """By the same winner that leaves hardly less, above the noise or below."""
    assert _is_confirmed(found(1.12), leaving(1.11))
    assert _is_confirmed(found(0.966), leaving(0.964))
    assert not _is_confirmed(found(1.12), leaving(1.05))
    assert not _is_confirmed(found(0.99), leaving(0.96))
    assert not _is_confirmed(found(1.12), leaving(1.11, "tension"))
    assert not _is_confirmed(found(1.12), Look((), (), 1.0, None))
    assert not _is_confirmed(found(1.12, ("fracture", "fracture")), leaving(1.11))
    assert not _is_confirmed(found(1.3), leaving(1.29))


@pytest.mark.parametrize(("near", "estimate", "is_kept"), [(3.0, 18.0, True), (1.3, 1.5, False), (1.0, 1.5, True)])
def test_an_estimate_gives_way_to_what_explains_everything_or_leaves_far_less(monkeypatch, near, estimate, is_kept):
    """Where time was up before all was asked, the estimate that led at first is all that the wide look has to tell."""
    monkeypatch.setattr(explore, "price", lambda proposal, misfit: 10.0)
    nearby, wide = found(near, ("fracture", "tension")), found(estimate, ("unknown",))
    assert cheaper(nearby, wide) is (nearby if is_kept else wide)


def test_a_couple_with_everything_in_sight_confirms_the_same_two():
    """Where it leaves no less, and these leave nothing to speak of."""
    two = ("fracture", "tension")

    def look(left, physics):
        claims = (Proposal(one, "", {"joint": "front"}, None, (), {}) for one in physics)
        return evolve(leaving(9.0), couples=(Couple(*claims, leaving(left).leader.search),))

    assert _is_confirmed(found(1.02, two), look(1.4, two[::-1]))
    assert not _is_confirmed(found(1.02, two), look(1.0, two))
    assert not _is_confirmed(found(1.02, two), look(1.4, ("fracture", "bottoming")))
    assert not _is_confirmed(found(1.3, two), look(1.4, two))
    assert not _is_confirmed(found(1.02), look(1.4, two))


@pytest.mark.parametrize(("leaves", "asked"), [([5.0, 2.0, 1.1, 0.9], 3), ([5.0, 4.9, 1.0], 1), ([0.98, 0.5, 0.4], 1)])
def test_everything_is_asked_again_from_where_the_model_alone_leaves_half_as_much(monkeypatch, inquiry, leaves, asked):
    """But not of a model at the noise, whatever is left of that."""
    alone = [SimpleNamespace(normalised=one, excess=one**2 - 1.0, fitted=lambda one=one: one) for one in leaves]
    looked = []

    def look_again(inquiry, current, *others, **named):
        looked.append(current)
        return Look((), (), 1.0, None)

    monkeypatch.setattr(explore, "look_again", look_again)
    monkeypatch.setattr(explore, "alone_again", lambda search, misfits: alone[alone.index(search) + 1])
    monkeypatch.setattr(explore, "may_conceal", lambda misfit: False)
    monkeypatch.setattr(explore, "_won", lambda search, look: None)
    monkeypatch.setattr(explore, "_found_widely", lambda inquiry, *others: inquiry.base)
    monkeypatch.setattr(explore, "estimated_at_last", lambda inquiry, found: found)
    monkeypatch.setattr(explore, "_where_it_acts", lambda inquiry, found: found)
    monkeypatch.setattr(explore, "in_one_bump", lambda inquiry, found: found)
    monkeypatch.setattr(explore, "in_fewer_numbers", lambda inquiry, found: found)
    found = explore.explored(inquiry(alone[0], given=alone[0]))
    assert looked == leaves[:asked]
    assert found is alone[asked - 1]


def test_an_instrument_is_put_right_first_where_much_more_is_left():
    """What leaves next to nothing is all there is, and the structure is asked as it always was."""
    assert _is_wrong_beside_more(leaving(3.0, "gain_error", SENSOR))
    assert not _is_wrong_beside_more(leaving(1.1, "gain_error", SENSOR))
    assert not _is_wrong_beside_more(leaving(3.0))
    assert not _is_wrong_beside_more(Look((), (), 1.0, None))


@pytest.mark.parametrize(("again", "then"), [(1.1, "followed"), (2.5, "put right")])
def test_an_instrument_is_re_identified_before_more_is_sought_beside_it(monkeypatch, again, then):
    """From where the model without its error had been driven, it may seem to leave much."""
    for name in ("with_pulses", "with_causes_pointed_to"):
        monkeypatch.setattr(explore, name, lambda inquiry, near: near)
    monkeypatch.setattr(explore, "reidentified", lambda *_: leaving(again, "gain_error", SENSOR))
    monkeypatch.setattr(explore, "check_rate", lambda *_: None)
    monkeypatch.setattr(explore, "may_conceal", lambda misfit: True)
    monkeypatch.setattr(explore, "_suffices", lambda found, base: True)
    monkeypatch.setattr(explore, "followed_nearby", lambda inquiry, near: Nearby(near, ("followed", near)))
    monkeypatch.setattr(explore, "beside_reading", lambda inquiry, near: ("put right", near))
    inquiry = SimpleNamespace(base=SimpleNamespace(normalised=1.2, fitted=lambda: None))
    told, near = explore._near_then_wide(inquiry, leaving(3.0, "gain_error", SENSOR))
    assert (told, near.leader.search.normalised) == (then, again)


@pytest.mark.parametrize(
    ("form", "structure", "left", "is_told"),
    [
        ("rising", 2.0, 1.5, True),
        ("rising", 2.0, 1.98, False),
        ("constant", 2.0, 1.5, False),
        ("rising", 1.0, 0.9, False),
    ],
)
def test_a_reading_is_told_in_the_form_that_leaves_much_less_beside_the_structure(
    monkeypatch, inquiry, offered, form, structure, left, is_told
):
    """Alone it made do for what the structure lacks; where that hardly matters, the form is chosen at last."""
    look, base, final = offered(0.0)
    told = Proposal("gain_error", "constant", SENSOR, None, ("gain",), {})
    reading = Look((Rival(told, base, 100.0, 40.0), look.leader), (1.0, 0.0), 0.0, base.fitted())
    beside, other = leaving(structure).leader, evolve(leaving(left).leader, proposal=evolve(told, form=form))
    beside.search.deviance = 0.0
    monkeypatch.setattr(explore, "explains", lambda search: search.normalised < 1.05)
    monkeypatch.setattr(explore, "in_all_forms", lambda *_: [])
    monkeypatch.setattr(explore, "ranked_by_evidence", lambda forms, without: [other])
    monkeypatch.setattr(Inquiry, "fit_with", lambda inquiry, rivals, last: final)
    found = explore._told_beside(inquiry(base), reading, beside)
    assert (found is not reading) == is_told
    if is_told:
        assert found.leader.proposal.form == form
        assert found.leader.drop == pytest.approx(100.0 + base.deviance - final.deviance)
        assert found.rivals[1:] == reading.rivals[1:]


@pytest.fixture
def asked(workshop, inquiry, model, misfit, recorded):
    """What is found of a damped model without its dashpot whose accelerometer reads too little, of two claims."""
    dashpot = {name: Parameter(value, fixed=True) for name, value in {"damping": 800.0, "clearance": 0.0}.items()}
    true = with_joint(model, Joint("dashpot", ("wall", "front"), "viscous", dashpot))

    def too_little(dataset):
        return dataset.assign(acceleration=0.6 * dataset["acceleration"])

    def ask(how):
        both = {
            "slow": recorded(true, 0.9, 1, accelerometer=too_little),
            "fast": recorded(true, 1.2, 2, accelerometer=too_little),
        }
        few = {name: workshop.hypotheses[name] for name in ("viscous_damping", "gain_error")}
        return how(inquiry(begin(workshop.identifier, misfit(model, **both)).advance(40), hypotheses=few))

    return ask


@pytest.mark.parametrize(
    "how",
    [explored, lambda inquiry: discover(inquiry, ())],
    ids=["the structure is asked first", "kinematics is asked first"],
)
def test_an_instrument_that_is_wrong_and_what_the_structure_lacks_are_both_found(asked, how):
    told = asked(how)
    claims = {look.leader.identity for look in told.findings}
    assert claims == {("viscous_damping", "joint first"), ("gain_error", "sensor front_sensor")}
    assert told.search.normalised < 1.0
    values = told.search.misfit.values(told.search.point)
    assert values[next(name for name in values if name.endswith("gain"))] == pytest.approx(0.6, rel=0.01)
    assert values[next(name for name in values if name.endswith("damping"))] == pytest.approx(800.0, rel=0.05)


def test_what_nothing_but_the_wrong_instrument_shows_is_asked_no_further(monkeypatch, inquiry, offered):
    look, base, final = offered(0.0)
    reading = Look(
        (evolve(look.leader, proposal=Proposal("gain_error", "", SENSOR, None, (), {})),), (1.0,), 0.0, base.fitted()
    )
    asked = []
    monkeypatch.setattr(explore, "_near", lambda inquiry: leaving(1.3, "unknown"))
    monkeypatch.setattr(explore, "_told_beside", lambda inquiry, reading, structure: reading)
    monkeypatch.setattr(
        explore, "explored", lambda inquiry, near: asked.append(near) or Discovery.of(inquiry.base, inquiry.base)
    )
    monkeypatch.setattr(explore, "in_best_forms", lambda inquiry, findings, search: (findings, search))
    for is_alone in (True, False):
        monkeypatch.setattr(explore, "is_shown_alone", lambda first, second, alone=is_alone: alone)
        found = explore.beside_reading(inquiry(base), reading)
        assert found.findings == (reading,)
        assert len(asked) == (not is_alone)
