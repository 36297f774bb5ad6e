"""What the final fit can spare is not told, and what it cannot spare is."""

from types import SimpleNamespace

import numpy as np
import pytest
from attrs import evolve

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.holdout import leading_looks
from crashkit.diagnose.name import follow as questioned
from crashkit.diagnose.name import needed as needed_findings
from crashkit.diagnose.name.follow import (
    Discovery,
    _corrects,
    _freed,
    _is_one_too_many,
    _was_asked,
    followed,
    leave_a_trace,
    reconsidered,
)
from crashkit.diagnose.name.inquiry import Inquiry, is_given
from crashkit.diagnose.name.look import LEAST_DROP, Look, compared, least_drop
from crashkit.diagnose.name.needed import _asked, _spare, needed, price
from crashkit.diagnose.refining import _is_worthless
from crashkit.diagnose.show.left_out import left_out_sum
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_body, with_joint
from crashkit.protocols import Proposal


def test_a_finding_that_the_fit_can_spare_is_dropped(workshop, offered):
    look, base, final = offered(0.0)
    kept, _, without = needed(workshop, (look,), base, final, base.misfit)
    assert kept == ()
    assert without.misfit.names == base.misfit.names


def test_a_finding_that_the_fit_needs_is_kept(workshop, offered):
    look, base, final = offered(800.0)
    kept, *searches = needed(workshop, (look,), base, final, base.misfit)
    assert [one.rivals for one in kept] == [look.rivals]
    assert searches == [base, final]


@pytest.mark.parametrize(("explained", "is_told"), [(1.0, True), (1e9, False)])
def test_a_finding_at_the_place_of_another_must_explain_a_share_of_it(workshop, offered, explained, is_told):
    """The error of that one's form looks like a force there, and a force at another place is something else."""
    look, base, final = offered(800.0)
    here = evolve(look.leader)
    asked = _asked(look.leader, [(here, explained)], 0.0, final.misfit)
    assert asked == pytest.approx(max(LEAST_DROP, 0.05 * explained))
    assert (base.deviance - final.deviance > asked) is is_told
    moved = evolve(here, proposal=evolve(here.proposal, location={"joint": "elsewhere"}))
    assert _asked(look.leader, [(moved, explained)], 1e9, final.misfit) == LEAST_DROP


def test_one_of_three_is_asked_a_share_of_what_the_others_explained():
    """0.3 of 3 %, as a third one that leaves nothing; one that an instrument is accused in, a fifth of that."""
    rivals = [
        Rival(Proposal("any", "", place, None, ("a",), {}), None, drop, 0.0)
        for place, drop in (({"joint": "nose"}, 4e4), ({"joint": "rails"}, 6e4), ({"body": "cabin"}, 100.0))
    ]
    misfit = SimpleNamespace(independent_samples=1000.0)
    explained = [(rival, rival.drop) for rival in rivals]
    assert _asked(rivals[2], explained, 0.0, misfit) == pytest.approx(900.0)
    assert _asked(rivals[2], explained[1:], 0.0, misfit) == LEAST_DROP
    accused = evolve(rivals[2], proposal=evolve(rivals[2].proposal, location={"sensor": "s"}))
    assert _asked(accused, [*explained[:2], (accused, 100.0)], 0.0, misfit) == pytest.approx(180.0)


def test_what_the_final_fit_loses_decides_and_not_what_thinned_recordings_had_shown():
    """Of means a ringing sensor explained 691, and a gain of the same sensor 76."""
    ringing, gain = (
        Look((Rival(Proposal(physics, "", {"sensor": "s"}, None, ("a",), {}), None, drop, 0.0),), (1.0,), 0.0, None)
        for physics, drop in (("mounting_resonance", 691.0), ("gain_error", 76.0))
    )
    final = SimpleNamespace(deviance=0.0, misfit=SimpleNamespace(independent_samples=1000.0))
    for lost, spare in ((691.0, None), (80_000.0, gain)):
        without = {
            ringing.leader.identity: SimpleNamespace(deviance=lost),
            gain.leader.identity: SimpleNamespace(deviance=49.0),
        }
        base = SimpleNamespace(deviance=lost)
        assert _spare([ringing, gain], without, base, final) is spare


@pytest.mark.parametrize(("place", "together", "spare"), [("rib", 1e5, 1), ("rib", 2e4, None), ("rail", 1e5, None)])
def test_of_two_at_one_place_that_each_do_for_most_the_one_that_explains_less_beside_is_spared(place, together, spare):
    """A peak like a bell, and a fracture, each left 0.1 % of what they explained together."""
    fracture, peak = (
        Look((Rival(Proposal(physics, "", {"joint": joint}, None, ("a",), {}), None, 9.0, 0.0),), (1.0,), 0.0, None)
        for physics, joint in (("fracture", "rib"), ("peak_load", place))
    )
    base, final = (
        SimpleNamespace(deviance=left, misfit=SimpleNamespace(independent_samples=1000.0)) for left in (together, 0.0)
    )
    fits = {one.leader.identity: SimpleNamespace(deviance=left) for one, left in ((fracture, 500.0), (peak, 300.0))}
    assert _spare([fracture, peak], fits, base, final) is (None if spare is None else (fracture, peak)[spare])


def test_what_is_kept_is_seen_against_the_model_without_what_was_dropped(workshop, model, offered):
    """When it was found, a mass stood beside it that the final model does not have."""
    look, base, final = offered(800.0)
    loaded = with_body(model, evolve(model.body("front"), name="load", mass=Parameter(1.0, fixed=True), carrier="front"))
    (kept,), _, _ = needed(workshop, (evolve(look, before=workshop.misfit(look.before, loaded)),), base, final, base.misfit)
    assert kept.before.model == base.fitted().model
    assert kept.before.channels == look.before.channels


@pytest.mark.parametrize(("location", "is_begun"), [({"joint": "rail"}, True), ({"body": "front"}, False)])
def test_without_a_finding_the_numbers_of_its_joint_begin_as_given_too(monkeypatch, location, is_begun):
    """Beside others it may make up for what they have driven them to."""
    monkeypatch.setattr(needed_findings, "begun_at_given", lambda search, given, joint: (search, given, joint))
    rival = SimpleNamespace(proposal=SimpleNamespace(location=location))
    found = needed_findings._as_given("driven away", rival, "given")
    assert found == (("driven away", "given", "rail") if is_begun else "driven away")


@pytest.mark.parametrize("findings", [1, 2])
def test_that_is_asked_only_beside_others(monkeypatch, findings):
    monkeypatch.setattr(needed_findings, "rebuild", lambda workshop, base, others, final: f"beside {len(others)}")
    monkeypatch.setattr(needed_findings, "_as_given", lambda fit, rival, given: f"{fit}, {given}")
    kept = [SimpleNamespace(leader=SimpleNamespace(identity=("gap", str(place)))) for place in range(findings)]
    fits = needed_findings._without_each(None, kept, None, None, "as given")
    assert set(fits.values()) == ({"beside 0"} if findings == 1 else {"beside 1, as given"})


def test_what_all_samples_do_not_pay_for_is_worthless(offered):
    for damping, worthless in ((0.0, True), (800.0, False)):
        look, base, final = offered(damping)
        assert _is_worthless((look,), base.fitted(), final.fitted()) is worthless


def test_a_run_that_contradicts_is_asked_for_what_was_found_before_everything(offered):
    """For the rivals of a single look, also where its finding was dropped; for several findings if each was plain."""
    look, base, _ = offered(800.0)
    doubtful = evolve(look, probabilities=(0.6,))
    one, none, two, other = (
        Discovery(base.fitted(), base.fitted(), base, findings, last)
        for findings, last in (((look,), None), ((), look), ((look, look), None), ((look, doubtful), None))
    )
    assert leading_looks(one) == leading_looks(none) == (look,)
    assert leading_looks(two) == (look, look)
    assert leading_looks(other) == leading_looks(evolve(none, last=None)) == ()


def test_the_price_of_a_table_is_that_of_its_heights(misfit, model, recorded):
    """An early search may have ended in a valley, where a table helped; at the end it must be worth its heights there too."""
    one = misfit(model, run=recorded(model))
    samples = np.log(one.independent_samples)
    dashpot, table = (Proposal("any", "", {"joint": "first"}, model, ("a",) * count, {}) for count in (1, 25))
    assert price(dashpot, one) == LEAST_DROP
    assert price(table, one) == pytest.approx(25.0 * samples) and price(table, one) > 5.0 * LEAST_DROP


def test_a_table_corrects_a_law_that_was_named_at_its_place():
    def rival(physics, joint):
        return Rival(Proposal(physics, "", {"joint": joint}, None, (), {}), None, 100.0, 50.0)

    named = [Look((rival("peak_load", "front"),), (1.0,), 0.0, None)]
    assert _corrects(rival("unknown", "front"), named)
    assert not _corrects(rival("unknown", "rear"), named)
    assert not _corrects(rival("fracture", "front"), named)
    assert not _corrects(rival("unknown", "front"), [])


@pytest.mark.parametrize(
    ("physics", "drop", "told"), [("unknown", 99.0, False), ("unknown", 101.0, True), ("tension", 1.0, True)]
)
def test_an_estimate_beside_a_named_finding_must_explain_a_tenth_of_it(physics, drop, told):
    """Less is how far the form of that is off. Alone an estimate is a finding like others."""
    search = SimpleNamespace(normalised=1.0)
    named = [
        Look((Rival(Proposal("peak_load", "", {"joint": "front"}, None, (), {}), None, 1000.0, 50.0),), (1.0,), 0.0, None)
    ]
    winner = Rival(Proposal(physics, "", {"joint": "rear"}, None, (), {}), search, drop, 50.0)
    assert _is_one_too_many(winner, named) is not told
    assert not _is_one_too_many(winner, [])


def leaving(physics, left):
    """A look whose winner leaves so much of the noise."""
    search = SimpleNamespace(normalised=left, excess=left**2 - 1.0, fitted=lambda: None)
    return Look((Rival(Proposal(physics, "", {"joint": physics}, None, (), {}), search, 9e5, 4.5e5),), (1.0,), 0.0, None)


@pytest.mark.parametrize("left", [1.6, 1.04, 0.99])
def test_beside_two_that_leave_a_trace_of_what_is_gross_or_hardly_noise_no_third_is_looked_for(monkeypatch, inquiry, left):
    def look_again(*_):
        raise AssertionError("nothing more was to be asked")

    monkeypatch.setattr(questioned, "_freed", lambda *_: None)
    monkeypatch.setattr(questioned, "named_beside", lambda inquiry, look, findings: look)
    monkeypatch.setattr(questioned, "untied", lambda inquiry, findings, search: (findings, search))
    monkeypatch.setattr(questioned, "with_one_more", lambda _, findings, look, winner: ([*findings, look], winner.search))
    monkeypatch.setattr(questioned, "look_again", look_again)
    monkeypatch.setattr(questioned, "is_sound", lambda search: True)
    monkeypatch.setattr(questioned, "_questioned", lambda _, findings, search, last: (findings, search))
    base = leaving("nothing", 40.0).leader.search
    found, _ = followed(inquiry(base, given=True), [leaving("tension", 3.0)], leaving("fracture", left))
    assert [look.leader.proposal.physics for look in found.findings] == ["tension", "fracture"]


def test_two_may_leave_a_trace_of_what_is_gross():
    base = leaving("nothing", 40.0).leader.search
    found = Discovery(None, None, leaving("", 1.6).leader.search, (leaving("tension", 1.6), leaving("fracture", 1.6)))
    assert leave_a_trace(found.findings, found.search, base)
    assert not leave_a_trace(found.findings, found.search, leaving("nothing", 9.0).leader.search)
    assert not leave_a_trace(found.findings[:1], found.search, base)


@pytest.mark.parametrize(("left", "told"), [(1.01, 3), (1.6, 2)])
def test_a_third_cause_is_only_estimated_where_it_leaves_nothing(monkeypatch, inquiry, left, told):
    """Two forms that are off look like one."""
    looks = iter([leaving("unknown", left)])
    monkeypatch.setattr(questioned, "_freed", lambda *_: None)
    monkeypatch.setattr(questioned, "named_beside", lambda inquiry, look, findings: look)
    monkeypatch.setattr(questioned, "untied", lambda inquiry, findings, search: (findings, search))
    monkeypatch.setattr(questioned, "with_one_more", lambda _, findings, look, winner: ([*findings, look], winner.search))
    monkeypatch.setattr(questioned, "_questioned", lambda _, findings, search, last: (findings, search))
    monkeypatch.setattr(questioned, "look_again", lambda *_, **__: next(looks))
    monkeypatch.setattr(questioned, "explains", lambda search: False)
    base = leaving("nothing", 9.0).leader.search
    found, _ = followed(inquiry(base, given=True), [leaving("tension", 5.0)], leaving("fracture", 3.0))
    assert len(found.findings) == told


@pytest.mark.parametrize(("times", "is_begun"), [(1.0, True), (2.0, False)])
def test_a_look_that_was_made_near_is_not_made_again(monkeypatch, inquiry, offered, times, is_begun):
    """But where it was made at a worse fit, or at another model."""
    look, base, final = offered(800.0)
    (path,) = look.leader.proposal.parameters
    damping = times * final.misfit.values(final.point)[path]
    near = evolve(look, before=final.fitted().with_values({path: damping}))
    begun = []
    monkeypatch.setattr(questioned, "look_again", lambda *_, **named: begun.append(named["begun"]))
    questioned._look_beside(inquiry(base), final, [look], near)
    questioned._look_beside(inquiry(base), base, [], near)
    assert begun == [near if is_begun else None, None]


@pytest.mark.parametrize(
    ("alone", "without_it", "together", "left"),
    [
        (7000.0, 1.5, 1.4, ["fracture", "bias"]),
        (1150.0, 1.5, 1.4, ["bias"]),
        (1150.0, 1.5, 1.08, ["fracture", "bias"]),
        (1050.0, 1.1, 1.0, ["bias"]),
    ],
)
def test_a_finding_that_is_questioned_stays_unless_it_explains_too_little(
    monkeypatch, inquiry, alone, without_it, together, left
):
    """Nothing convinces in its place; without it the model leaves so much. It stays if next to nothing is left with it, where
    something plainly was."""

    def one(physics):
        proposal = Proposal(physics, "", {"joint": physics}, None, (), {})
        return Look((Rival(proposal, None, 9000.0, 4500.0),), (1.0,), 0.0, None)

    def without(inquiry, rivals, last):
        deviance = alone if [rival.proposal.physics for rival in rivals] == ["bias"] else 9000.0
        return SimpleNamespace(deviance=deviance, normalised=without_it, excess=without_it**2 - 1.0, fitted=lambda: None)

    nothing = Look((), (), 1.0, None, least=180.0)
    monkeypatch.setattr(questioned, "_was_asked", lambda look, without: False)
    monkeypatch.setattr(Inquiry, "fit_with", without)
    monkeypatch.setattr(questioned, "wakened", lambda workshop, search: search)
    monkeypatch.setattr(questioned, "in_best_forms", lambda inquiry, looks, search: (looks, search))
    monkeypatch.setattr(questioned, "look_again", lambda *_: nothing)
    monkeypatch.setattr(questioned, "explains", lambda search: search.normalised < 1.02)
    fit = SimpleNamespace(deviance=1000.0, normalised=together, excess=together**2 - 1.0)
    kept, _ = reconsidered(inquiry(SimpleNamespace(excess=1e9), given=True), [one("fracture"), one("bias")], fit)
    assert [look.leader.proposal.physics for look in kept] == left


@pytest.mark.parametrize(("share", "is_asked"), [(0.1, True), (0.3, False)])
def test_what_leaves_much_without_a_finding_is_not_asked_in_other_forms(monkeypatch, inquiry, share, is_asked):
    """Where with it nothing is left: a fifth of what the model as it is leaves is more than forms do."""
    asked = []
    without = SimpleNamespace(deviance=9000.0, normalised=10.0, excess=share * 400.0)
    monkeypatch.setattr(questioned, "_spared", lambda *_: without)
    monkeypatch.setattr(questioned, "in_best_forms", lambda inquiry, looks, search: asked.append(share) or (looks, search))
    monkeypatch.setattr(questioned, "explains", lambda search: True)
    finding = Rival(Proposal("fracture", "", {"joint": "rails"}, None, (), {}), None, 8000.0, 4000.0)
    together = SimpleNamespace(deviance=1000.0, normalised=1.0, excess=0.0)
    looks = [Look((finding,), (1.0,), 0.0, None)]
    kept, search = reconsidered(inquiry(SimpleNamespace(excess=400.0), given=True), looks, together)
    assert (kept, search) == (looks, together)
    assert bool(asked) is is_asked


@pytest.mark.parametrize(("left", "is_asked"), [(100.0, True), (1000.0, False)])
def test_what_all_but_next_to_nothing_hangs_on_is_not_questioned(monkeypatch, inquiry, left, is_asked):
    """Above the noise, too: of what is gross every form leaves something."""
    asked = []
    without = SimpleNamespace(deviance=9000.0, normalised=left**0.5, excess=left, fitted=lambda: None)
    monkeypatch.setattr(questioned, "_spared", lambda *_: without)
    monkeypatch.setattr(questioned, "_was_asked", lambda look, without: False)
    monkeypatch.setattr(questioned, "in_best_forms", lambda inquiry, looks, search: (looks, search))
    monkeypatch.setattr(questioned, "look_again", lambda *_: asked.append(left) or Look((), (), 1.0, None, least=180.0))
    finding = Rival(Proposal("fracture", "", {"joint": "rails"}, None, (), {}), None, 8000.0, 4000.0)
    monkeypatch.setattr(questioned, "explains", lambda search: False)
    together = SimpleNamespace(deviance=1000.0, normalised=2.0**0.5, excess=1.0)
    kept, _ = reconsidered(inquiry(None), [Look((finding,), (1.0,), 0.0, None)], together)
    assert len(kept) == 1
    assert bool(asked) is is_asked


def test_what_the_findings_explain_from_where_one_more_has_moved_them_is_not_one_more(workshop, offered):
    """They were caught in a local optimum: here, they were not yet searched."""
    look, base, final = offered(0.0)
    values = base.misfit.values(base.point)
    caught = begin(workshop.identifier, base.fitted().with_values({name: 1.1 * value for name, value in values.items()}))
    winner = evolve(look.leader, search=final, drop=caught.deviance - final.deviance)
    (freed,), search = _freed([look], caught, winner)
    assert search.deviance == pytest.approx(base.deviance, abs=1.0)
    assert freed.leader.search is search
    assert freed.leader.drop == pytest.approx(look.leader.drop + caught.deviance - search.deviance)
    assert freed.leader.evidence == pytest.approx(look.leader.evidence + 0.5 * (caught.deviance - search.deviance))


def test_what_is_left_out_is_one_more(offered):
    look, base, final = offered(800.0)
    assert base.deviance > final.deviance + LEAST_DROP
    assert _freed([look], base, evolve(look.leader, search=final, drop=base.deviance - final.deviance)) is None
    assert _freed([], base, look.leader) is None


def test_the_same_is_not_asked_twice(workshop, model, misfit, recorded):
    """Of a model in the same laws, at a fit that is no better than the one that was asked."""
    exact = misfit(model, run=recorded(model))
    path, stiffness = next(iter(model.free_parameters().items()))
    off = exact.with_values({path: 1.2 * stiffness.value})
    dashpot = with_joint(model, Joint("dashpot", ("wall", "front"), "viscous", {"damping": Parameter(0.0, fixed=True)}))
    same, worse, other = (
        begin(workshop.identifier, one) for one in (exact, off, workshop.equipped([dashpot]).misfit(exact, dashpot))
    )
    look = Look((), (), 1.0, exact)
    assert _was_asked(look, same)
    assert _was_asked(look, worse)
    assert not _was_asked(look, other)
    assert not _was_asked(Look((), (), 1.0, off), same)


def test_a_third_finding_must_explain_more_than_a_second():
    def rival(drop, kind="joint", numbers=("one",)):
        return Rival(Proposal("fracture", "", {kind: "front"}, None, numbers, {}), None, drop, 0.5 * drop)

    assert least_drop([]) == least_drop([rival(100.0)]) == LEAST_DROP
    assert least_drop([rival(1e5)]) == pytest.approx(1000.0)
    assert least_drop([rival(1e5), rival(1e4)]) == pytest.approx(3300.0)
    assert least_drop([rival(1e5, "instrument")]) == pytest.approx(100.0)
    assert least_drop([rival(1e5, "sensor", ("one", "two"))]) == pytest.approx(1000.0)


def test_what_a_finding_has_added_is_no_place_for_more(model):
    assert is_given(model, {"bodies": ["wall", "front"]}) and is_given(model, {"joint": model.joints[0].name})
    assert not is_given(model, {"bodies": ["wall", "front_load"]})
    assert not is_given(model, {"body": "front_load"}) and not is_given(model, {"joint": "front_friction"})


def test_physics_that_is_there_predicts_runs_that_were_left_out(offered):
    look, base, final = offered(800.0)
    without, there = (left_out_sum(final.identifier, search.fitted()) for search in (base, final))
    assert without - there > 0.5 * look.leader.drop > 100.0


def test_one_run_leaves_nothing_to_predict(offered):
    _, base, final = offered(800.0)
    assert np.isnan(left_out_sum(final.identifier, base.fitted().with_recordings(("slow",))))


@pytest.mark.parametrize(("place", "convinces"), [({"joint": "front"}, False), ({"sensor": "front", "instrument": "a"}, True)])
def test_a_claim_about_one_instrument_need_not_explain_as_much_as_the_error_of_a_form(place, convinces):
    rival = Rival(Proposal("any", "", place, None, (), {}), None, 250.0, 100.0)
    assert (Look((rival,), (1.0,), 0.0, None, least=1000.0).winner is rival) == convinces
    assert Look((rival,), (1.0,), 0.0, None, least=5000.0).winner is None


@pytest.mark.parametrize(("damping", "least", "convinces"), [(800.0, 2.0, True), (800.0, 10.0, False), (0.0, 2.0, False)])
def test_a_claim_after_which_nothing_is_left_need_not_explain_as_much_either(offered, damping, least, convinces):
    """Where plainly something was left before."""
    look, _, _ = offered(damping)
    assert (evolve(look, least=least * abs(look.leader.drop)).winner is not None) == convinces


def claimed(physics, joint, normalised, form=""):
    """A rival that leaves so much of a thousand samples, of which 3.0 times the noise were left before."""
    misfit = SimpleNamespace(independent_samples=1000.0)
    search = SimpleNamespace(normalised=normalised, excess=normalised**2 - 1.0, deviance=1e3 * normalised**2, misfit=misfit)
    drop = 9e3 - search.deviance
    return Rival(Proposal(physics, form, {"joint": joint}, None, ("a",), {}), search, drop, 0.5 * drop)


@pytest.mark.parametrize(("physics", "asked"), [("fracture", [("fracture", 1.1, 1)]), ("unknown", [])])
def test_a_second_finding_may_outrun_the_recordings_as_well(monkeypatch, inquiry, physics, asked):
    """Judged by the fit with both, each in its best form; an estimate is not asked."""
    told = []
    monkeypatch.setattr(questioned, "settled", lambda inquiry, look, *_: look)
    monkeypatch.setattr(questioned, "in_best_forms", lambda _, findings, search: (findings, claimed("", "", 1.1).search))
    monkeypatch.setattr(
        questioned,
        "check_pace",
        lambda _, found, beside: told.append((found.proposal.physics, found.search.normalised, len(beside))),
    )
    second = Look((claimed(physics, "second", 1.7),), (1.0,), 0.0, None)
    first = Look((claimed("tension", "first", 3.0),), (1.0,), 0.0, None)
    more, search = questioned.with_one_more(inquiry(None), [first], second, second.leader)
    assert (more, search.normalised) == ([first, second], 1.1)
    assert told == asked


@pytest.mark.parametrize(("left", "told"), [(1.2, "fracture"), (1.8, "progressive_folding"), (None, "progressive_folding")])
def test_an_estimate_may_point_to_a_better_second_finding(monkeypatch, inquiry, left, told):
    """Where a cause of its place leaves less than what was told in its best form; None: it was not asked, or knows of none."""
    monkeypatch.setattr(questioned, "settled", lambda inquiry, look, winner, found: compared(look, [winner]))
    monkeypatch.setattr(questioned, "in_best_forms", lambda inquiry, findings, search: (findings, search))
    monkeypatch.setattr(questioned, "in_its_stead", lambda inquiry, findings, search: (findings, search))
    monkeypatch.setattr(questioned, "check_pace", lambda *_: None)
    first = Look((claimed("tension", "first", 3.0),), (1.0,), 0.0, None)
    folds = Look((claimed("progressive_folding", "second", 1.5), claimed("unknown", "second", 1.3)), (0.9, 0.1), 0.0, None)
    pointed = compared(folds, [claimed("fracture", "second", left), *folds.rivals]) if left else folds
    monkeypatch.setattr(questioned, "with_better_pointed_to", lambda inquiry, look, search: pointed)
    more, search = questioned.with_one_more(inquiry(None), [first], folds, folds.leader)
    assert [look.leader.proposal.physics for look in more] == ["tension", told]
    assert [rival.proposal.physics for rival in more[1].rivals].count(told) == 1


@pytest.fixture
def completed(monkeypatch, inquiry):
    """Whether a claim of a look is told beside tension in the first joint, if the form that suits it leaves `then`."""

    def ask(claim, then, nothing=1.0):
        formed = claimed(claim.proposal.physics, claim.proposal.location["joint"], then, "formed")
        monkeypatch.setattr(questioned, "in_all_forms", lambda *_: [(formed.proposal, formed.search)])
        monkeypatch.setattr(questioned, "settled", lambda inquiry, look, *_: look)
        monkeypatch.setattr(questioned, "in_best_forms", lambda inquiry, findings, search: (findings, search))
        monkeypatch.setattr(questioned, "explains", lambda search: search.normalised < 1.02)
        found = Look((claimed("tension", "first", 3.0),), (1.0,), 0.0, None)
        table = claimed("unknown", "second", 1.5)
        look = Look((table, claim), (0.5, 0.5), nothing, None, least=1e6)
        return questioned._completed(inquiry(None), [found], found.leader.search, look)

    return ask


def test_a_second_cause_that_leaves_nothing_in_its_best_form_is_told_though_it_convinced_in_none_yet(completed):
    findings, search = completed(claimed("fracture", "second", 1.7), then=1.01)
    assert [look.leader.proposal.form for look in findings] == ["", "formed"]
    assert [rival.proposal.physics for rival in findings[1].rivals] == ["fracture", "unknown"]
    assert search.normalised == 1.01


def test_it_may_leave_a_little_of_what_was_left(completed):
    """Where 3.0 times the noise were left: the forms of what is gross are never quite right."""
    findings, search = completed(claimed("fracture", "second", 1.7), then=1.1)
    assert [look.leader.proposal.physics for look in findings] == ["tension", "fracture"]
    assert search.normalised == 1.1


@pytest.mark.parametrize(("joint", "left", "then"), [("second", 1.7, 1.2), ("second", 2.5, 1.01), ("first", 1.7, 1.01)])
def test_what_leaves_something_or_hardly_less_or_corrects_the_first_is_not(completed, joint, left, then):
    assert completed(claimed("fracture", joint, left), then) is None
