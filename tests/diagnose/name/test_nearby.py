"""Two leading causes are put beside each other where one alone leaves much, and told where they leave next to nothing."""

from types import SimpleNamespace

import pytest
from attrs import evolve

from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.couples import Couple
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.name import nearby
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.nearby import (
    Nearby,
    _in_forms_together,
    _two_at_once,
    _two_of_all,
    _with_a_second,
    followed_nearby,
)
from crashkit.protocols import Proposal


def leaving(normalised):
    misfit = SimpleNamespace(independent_samples=1000.0, channels=(), is_strained=lambda point: False)
    return SimpleNamespace(normalised=normalised, excess=normalised**2 - 1.0, misfit=misfit, point=None)


def claim(physics, place="rails"):
    return Proposal(physics, "", {"joint": place}, None, (), {})


@pytest.fixture
def two(monkeypatch):
    """Whether two causes are told that leave so much, as the leaders, as two places, as the leaders in other forms, as all do,
    and as the first beside what gives way, where the best of them alone leaves so much; and who was asked for."""
    asked = []

    def answering(name, left):
        couples = [Couple(claim("peak_load"), claim("fracture"), leaving(one)) for one in left]
        return lambda *_: asked.append(name) or couples

    def told(alone, leaders, places=(), everyone=(), base=9.0, forms=(), rivals=(), free=()):
        for name, left in {
            "coupled_leaders": leaders,
            "couples_at_two_places": places,
            "in_other_forms": forms,
            "beside_what_gives_way": free,
        }.items():
            monkeypatch.setattr(nearby, name, answering(name, left))
        monkeypatch.setattr(nearby, "both", lambda inquiry, look: (look, evolve(look, couples=())))
        monkeypatch.setattr(nearby, "followed", lambda inquiry, begun, look: (begun[0].couples, look))
        claims = SimpleNamespace(couples=answering("from_given", everyone))
        inquiry = SimpleNamespace(base=leaving(base), from_given=claims)
        first = Rival(claim("joint_friction"), leaving(alone), 9.0, 9.0)
        question = inquiry, Look((first, *rivals), (), 1.0, None), leaving(alone)
        found = _two_at_once(*question) or _two_of_all(*question)
        return [couple.search.normalised for couple in found] if found else None

    told.asked = asked
    return told


def test_two_leaders_that_leave_next_to_nothing_are_followed(two):
    assert two(3.0, [1.05, 1.1], [1.0], [1.0]) == [1.05, 1.1]
    assert two.asked == ["coupled_leaders"]


@pytest.mark.parametrize(("place", "left", "is_told"), [("rails", 1.02, False), ("rails", 1.08, True), ("mounts", 1.02, True)])
def test_two_at_one_place_are_not_told_where_an_estimate_there_leaves_less(two, place, left, is_told):
    """Two functions of the deformation imitate any other one."""
    estimate = Rival(claim("unknown", place), leaving(left), 9.0, 9.0)
    assert two(3.0, [1.05], rivals=[estimate]) == ([1.05] if is_told else None)


def test_they_are_not_asked_for_where_one_alone_leaves_next_to_nothing(two):
    assert two(1.1, [1.0]) is None
    assert "coupled_leaders" not in two.asked


@pytest.mark.parametrize(
    ("alone", "together", "why"),
    [
        (3.0, [1.2], "they leave something"),
        (1.2, [1.13], "they leave hardly less than one alone"),
        (3.0, [], "there are no two"),
    ],
)
def test_else_those_at_two_places_are_and_then_those_of_all_and_what_gives_way(two, alone, together, why):
    assert two(alone, together, [1.01], [1.0]) == [1.01], why
    assert two(alone, together, together, [1.0]) == [1.0], why
    assert two(alone, together, together, together, free=[1.0]) == [1.0], why
    assert two(alone, together, together, together, free=together) is None, why
    everyone = ["coupled_leaders", "couples_at_two_places", "in_other_forms", "from_given", "beside_what_gives_way"]
    assert two.asked == [*everyone[:2], *everyone[:4], *everyone, *everyone]


def test_two_leaders_that_leave_next_to_nothing_in_other_forms_are_followed(two):
    assert two(3.0, [1.2], [], [1.0], forms=[1.01]) == [1.01]
    assert two.asked == ["coupled_leaders", "couples_at_two_places", "in_other_forms"]


def test_those_of_all_are_asked_later_where_one_alone_leaves_most(two):
    assert two(3.0, [], [], [1.0], base=3.5) is None
    assert "from_given" not in two.asked


@pytest.fixture
def second(monkeypatch):
    """What is asked beside a first cause that leaves so much, where a look then leaves this much, and with a known cause
    instead of an estimate that."""
    asked = []

    def look(normalised, physics):
        rival = SimpleNamespace(proposal=SimpleNamespace(physics=physics), search=leaving(normalised))
        return SimpleNamespace(winner=rival, rivals=(rival,))

    def asks(left, estimated, named, base=9.0, together=None, alone=()):
        def look_again(*_, quick):
            asked.append("quick" if quick else "wide")
            return look(estimated, "unknown")

        monkeypatch.setattr(nearby, "look_again", look_again)
        monkeypatch.setattr(nearby, "named_beside", lambda *_: asked.append("named") or look(named, "fracture"))
        monkeypatch.setattr(nearby, "_in_forms_together", lambda *_: asked.append("in forms") or together)
        monkeypatch.setattr(nearby, "_two_of_all", lambda *_: asked.append("of all"))
        monkeypatch.setattr(nearby, "followed", lambda *_: asked.append("followed") or (None, None))
        inquiry = SimpleNamespace(base=leaving(base), from_given=SimpleNamespace(singles=alone))
        search = SimpleNamespace(fitted=lambda: None, **vars(leaving(left)))
        first = Rival(Proposal("relaxation", "", {"joint": "pad"}, None, (), {}), search, 0.0, 0.0)
        _with_a_second(inquiry, None, SimpleNamespace(leader=first), search)
        return asked

    return asks


def test_where_the_first_leaves_but_a_trace_and_none_convinces_beside_it_nothing_more_is_asked(monkeypatch):
    """By a quick look: no second could explain as much as it would have to."""
    look = SimpleNamespace(winner=None, rivals=())
    monkeypatch.setattr(nearby, "look_again", lambda *_, quick: look)
    monkeypatch.setattr(nearby.Discovery, "of", lambda base, search, findings, last: (findings, last))
    monkeypatch.setattr(nearby, "_two_of_all", lambda *_: "of all")
    first, search = SimpleNamespace(leader=None), SimpleNamespace(fitted=lambda: None, **vars(leaving(2.0)))
    from_given = SimpleNamespace(singles=[])
    told = _with_a_second(SimpleNamespace(base=leaving(40.0), from_given=from_given), None, first, search)
    assert told.found == ((first,), look)
    asked_on = _with_a_second(SimpleNamespace(base=leaving(20.0), from_given=from_given), None, first, search)
    assert asked_on.found == "of all"


def test_a_known_cause_instead_of_an_estimate_completes_what_leaves_much(second):
    assert second(3.0, 1.4, named=1.02) == ["quick", "named", "followed"]


def test_what_completes_it_in_another_form_is_asked_before_couples_of_all_causes(second):
    assert second(3.0, 1.4, named=1.35, together="found") == ["quick", "named", "in forms"]


def test_couples_of_all_causes_are_asked_where_nothing_completes_it(second):
    assert second(3.0, 1.4, named=1.35) == ["quick", "named", "in forms", "of all"]


@pytest.mark.parametrize(
    ("physics", "normalised", "strained", "then"),
    [
        ("missing_contact", 1.04, False, []),
        ("missing_contact", 1.04, True, ["in forms", "of all"]),
        ("missing_contact", 2.2, False, []),
        ("missing_contact", 2.4, False, ["in forms", "of all"]),
        ("relaxation", 2.2, False, ["in forms", "of all"]),
        ("unknown", 1.04, False, ["in forms", "of all"]),
    ],
)
def test_no_two_are_asked_where_another_known_cause_explains_most_as_given(second, physics, normalised, strained, then):
    """And strains none of these."""
    search = leaving(normalised)
    search.misfit.is_strained = lambda point: strained
    alone = [Candidate(Proposal(physics, "", {"joint": "pad"}, None, (), {}), search)]
    assert second(3.0, 1.4, named=1.35, alone=alone) == ["quick", "named", *then]


def test_an_estimate_that_leaves_much_is_given_no_name_before_couples_are_asked(second):
    assert second(3.0, 2.0, named=1.0) == ["quick", "in forms", "of all"]


@pytest.mark.parametrize(("base", "next_asked"), [(20.0, ["followed"]), (10.0, ["in forms", "of all"])])
def test_a_second_cause_that_leaves_a_hundredth_of_all_is_followed_though_forms_are_off(second, base, next_asked):
    assert second(4.0, 1.6, named=1.5, base=base) == ["quick", "named", *next_asked]


def test_a_second_cause_that_leaves_a_twentieth_completes_it_though_forms_are_off(second):
    assert second(5.0, 1.5, named=1.4) == ["quick", "named", "followed"]


@pytest.mark.parametrize(("base", "look"), [(5.0, "wide"), (9.0, "quick")])
def test_what_leaves_little_is_followed_at_once(second, base, look):
    """After a quick look where a second could hardly be told."""
    assert second(1.2, 1.1, named=1.0, base=base) == [look, "followed"]


@pytest.fixture
def together(monkeypatch):
    """What comes of a first cause that leaves 3 times the noise and a second beside it that leaves so much, and both in their
    best forms so much; where a look has these rivals."""
    first = rival_at("rails", "relaxation", 3.0)

    def told(end, *others, base=9.0):
        look = Look(others, (), 0.0, None)
        search = SimpleNamespace(fitted=lambda: None, **vars(leaving(end)))
        asked = []
        monkeypatch.setattr(nearby, "with_one_more", lambda _, begun, look, claim: ([*begun, look.led_by(claim)], search))
        monkeypatch.setattr(nearby, "look_again", lambda _, fitted, found: asked.append([one.place for one in found]))
        monkeypatch.setattr(nearby, "followed", lambda _, begun, look: ([one.leader.search.normalised for one in begun], look))
        inquiry = SimpleNamespace(base=leaving(base))
        begun = Look((first,), (1.0,), 0.0, None)
        return _in_forms_together(inquiry, begun, look, first.search), asked

    return told


def rival_at(place, physics, normalised):
    search = SimpleNamespace(**vars(leaving(normalised)), deviance=1000.0 * normalised**2)
    return Rival(Proposal(physics, "", {"joint": place}, None, (), {}), search, 9000.0, 4500.0)


@pytest.mark.parametrize("place", ["nose", "rails"])
def test_two_causes_that_leave_nothing_in_their_best_forms_are_followed_from_there(together, place):
    """At two places or at one."""
    found, asked = together(1.05, rival_at("nose", "unknown", 1.5), rival_at(place, "clearance", 1.9), base=5.0)
    assert found == [3.0, 1.05]
    assert asked == [["joint rails", f"joint {place}"]]


@pytest.mark.parametrize(("pointed_to", "place"), [(1.93, "nose"), (2.2, "tail")])
def test_of_two_that_leave_about_as_much_the_one_that_an_estimate_points_to_is_followed(together, pointed_to, place):
    rivals = rival_at("nose", "unknown", 1.5), rival_at("tail", "rotation", 1.9), rival_at("nose", "tension", pointed_to)
    assert together(1.05, *rivals, base=5.0) == ([3.0, 1.05], [["joint rails", f"joint {place}"]])


def test_one_that_explains_little_is_put_in_its_best_form_where_an_estimate_at_its_place_explains_most(together):
    assert together(1.05, rival_at("rails", "unknown", 1.5), rival_at("rails", "clearance", 2.5))[0] == [3.0, 1.05]


@pytest.mark.parametrize(
    ("end", "other", "why"),
    [
        (1.6, rival_at("nose", "clearance", 1.9), "they leave something even so"),
        (1.05, rival_at("nose", "clearance", 2.5), "the second explains little before"),
        (1.05, rival_at("nose", "unknown", 1.9), "it is an estimate"),
    ],
)
def test_else_they_are_not(together, end, other, why):
    assert together(end, other)[0] is None, why


@pytest.mark.parametrize(("estimate", "found"), [(1.01, None), (1.3, "two")])
def test_two_causes_are_not_asked_for_where_an_estimate_at_one_place_leaves_nothing(monkeypatch, estimate, found):
    monkeypatch.setattr(nearby, "_two_at_once", lambda *_: "two")
    monkeypatch.setattr(nearby, "_freed", lambda inquiry, look, known: look)
    monkeypatch.setattr(nearby, "named_instead", lambda *_: None)
    near = Look((rival_at("nose", "unknown", estimate), rival_at("rails", "clearance", 8.0)), (1.0, 0.0), 0.0, None)
    assert followed_nearby(SimpleNamespace(base=leaving(9.0)), near).found == found


@pytest.mark.parametrize(("estimate", "asked"), [(1.5, ["nose"]), (4.0, [])])
def test_a_known_cause_at_the_place_of_an_estimate_that_leaves_far_less_than_any_is_followed(monkeypatch, estimate, asked):
    """Before two at once are asked for."""
    tension, places = rival_at("nose", "tension", 1.03), []
    near = Look((rival_at("nose", "unknown", estimate), rival_at("rails", "clearance", 8.0)), (1.0, 0.0), 0.0, None)

    def named_instead(inquiry, look, table):
        places.append(table.proposal.location["joint"])
        return Look((tension, look.rivals[1]), (1.0, 0.0), 0.0, None)

    monkeypatch.setattr(nearby, "named_instead", named_instead)
    monkeypatch.setattr(nearby, "_freed", lambda inquiry, look, known: look)
    monkeypatch.setattr(nearby, "_two_at_once", lambda inquiry, look, search: None if search is tension.search else "two")
    monkeypatch.setattr(nearby, "_at_its_best", lambda inquiry, look: (look, look.leader.search))
    monkeypatch.setattr(nearby, "check_pace", lambda *_: None)
    monkeypatch.setattr(nearby, "_with_a_second", lambda inquiry, look, first, search: Nearby(look, first.leader.identity))
    told = followed_nearby(SimpleNamespace(base=leaving(9.0)), near).found
    assert (told, places) == (("tension", "joint nose") if asked else "two", asked)


@pytest.mark.parametrize(
    ("estimate", "place", "known", "explains", "is_followed"),
    [
        (2.0, "nose", 4.0, True, False),
        (2.0, "nose", 4.0, False, True),
        (3.5, "nose", 4.0, True, True),
        (2.0, "rails", 4.0, True, True),
        (1.05, "nose", 1.25, True, True),
    ],
)
def test_the_best_known_cause_is_not_followed_where_an_estimate_elsewhere_leaves_far_less_and_another_explains_all_as_given(
    monkeypatch, estimate, place, known, explains, is_followed
):
    near = Look((rival_at("rails", "clearance", known), rival_at(place, "unknown", estimate)), (1.0, 0.0), 0.0, None)
    cause = rival_at("nose", "tension", 1.01 if explains else 3.0)
    claims = SimpleNamespace(singles=[Candidate(cause.proposal, cause.search)])
    monkeypatch.setattr(nearby, "_at_its_best", lambda inquiry, look: (look, look.leader.search))
    monkeypatch.setattr(nearby, "_two_at_once", lambda *_: "followed")
    monkeypatch.setattr(nearby, "check_pace", lambda *_: None)
    found = followed_nearby(SimpleNamespace(base=leaving(9.0), from_given=claims), near).found
    assert found == ("followed" if is_followed else None)


@pytest.mark.parametrize(
    ("leader", "freed", "is_first", "why"),
    [
        ("unknown", 2.0, True, "it was caught"),
        ("unknown", 3.2, False, "the estimate leaves less"),
        ("unknown", 3.9, False, "it leaves as much"),
        ("peak_load", 2.0, False, "no estimate leads"),
    ],
)
def test_the_best_known_cause_is_begun_from_the_given_values_where_an_estimate_leads(
    monkeypatch, leader, freed, is_first, why
):
    base = SimpleNamespace(fitted=lambda: None, deviance=1000.0, **vars(leaving(5.0)))
    motion, claims = rival_at("rails", "clearance", 4.0), []

    def claims_from_given(inquiry, current, proposals):
        claims.extend(proposal.physics for proposal in proposals)
        return SimpleNamespace(singles=[evolve(rival_at("rails", "clearance", freed), evidence=4900.0 - 100.0 * freed)])

    monkeypatch.setattr(nearby, "open_claims", lambda *_: [motion.proposal, rival_at("nose", "tension", 1.0).proposal])
    monkeypatch.setattr(nearby, "claims_from_given", claims_from_given)
    monkeypatch.setattr(nearby, "ranked_by_evidence", lambda ends, deviance: list(ends))
    near = Look((rival_at("nose", leader, 3.0), motion), (1.0, 0.0), 0.0, None)
    told = nearby._freed(SimpleNamespace(base=base), near, motion)
    assert (told is not near) == is_first, why
    if is_first:
        assert (told.leader.search.normalised, claims) == (freed, ["clearance"])


@pytest.mark.parametrize(
    ("numbers", "left", "other", "is_followed"),
    [(10, 1.1, 1.01, False), (10, 1.1, 1.09, True), (10, 1.01, 1.01, True), (9, 1.1, 1.01, True)],
)
def test_a_cause_of_many_numbers_is_not_followed_where_one_explains_all_as_given(
    monkeypatch, numbers, left, other, is_followed
):
    """A body that turns and acts back imitates much."""
    turning = evolve(claim("rotation"), parameters=tuple(map(str, range(numbers))))
    leader = evolve(rival_at("rails", "rotation", left), proposal=turning)
    single = rival_at("nose", "obstacle_motion", other)
    near = Look((leader, rival_at("rails", "added_mass", 1.12)), (1.0, 0.0), 0.0, None)
    monkeypatch.setattr(nearby, "_at_its_best", lambda inquiry, look: (look, look.leader.search))
    monkeypatch.setattr(nearby, "_two_at_once", lambda *_: None)
    monkeypatch.setattr(nearby, "check_pace", lambda *_: None)
    monkeypatch.setattr(nearby, "_with_a_second", lambda inquiry, near, *_: Nearby(near, "followed"))
    claims = SimpleNamespace(singles=[Candidate(single.proposal, single.search)])
    found = followed_nearby(SimpleNamespace(base=leaving(1.3), from_given=claims), near).found
    assert found == ("followed" if is_followed else None)
