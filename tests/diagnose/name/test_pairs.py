"""Named causes instead of a table: in a better form, or two; whose look comes first, and when the table stays."""

from types import SimpleNamespace

import pytest
from attrs import evolve

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.name import imitate, pairs
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.result import UNKNOWN
from crashkit.protocols import Proposal


def rival(physics, deviance, normalised=1.5):
    search = SimpleNamespace(deviance=deviance, normalised=normalised, excess=normalised**2 - 1.0, fitted=lambda: None)
    return weighed(Proposal(physics, "", {"joint": "front"}, None, ("a",), {}), search, 5000.0)


def weighed(proposal, search, reference):
    drop = reference - search.deviance
    return Rival(proposal, search, drop, 0.5 * drop)


def won_by(*rivals):
    return Look(rivals, (1.0,) + (0.0,) * (len(rivals) - 1), 0.0, None)


@pytest.fixture
def named(monkeypatch, inquiry):
    """What stands in the place of a look that a table won, where later looks are these, a claim alone fits so well, and the
    best named cause in its best form so well."""

    def ask(look, later, alone=3000.0, formed=None, imitation=None, is_all=False):
        def better(findings):
            found = rival(findings[0].leader.proposal.physics, formed) if formed else findings[0].leader
            return [evolve(findings[0], rivals=(found, *findings[0].rivals[1:]))]

        looks = iter(later)
        monkeypatch.setattr(pairs, "explains", lambda search: is_all)
        imitations = [("fracture", imitation)] if imitation else []
        monkeypatch.setattr(imitate, "imitating", lambda *_: imitations)
        monkeypatch.setattr(imitate, "ranked_by_evidence", lambda found, reference: [rival(*one) for one in found])
        monkeypatch.setattr(pairs, "look_again", lambda *_, quick=False: next(looks))
        monkeypatch.setattr(pairs, "rival_of", weighed)
        monkeypatch.setattr(pairs, "settled", lambda inquiry, look, winner, found: look)
        monkeypatch.setattr(pairs, "in_best_forms", lambda inquiry, findings, search: (better(findings), search))
        monkeypatch.setattr(Inquiry, "fit_with", lambda inquiry, rivals, last: rival("alone", alone).search)
        first, then = pairs.named_before_unknown(inquiry(None), look)
        return [one.leader.proposal.physics for one in first], then.leader.proposal.physics

    return ask


TABLE = rival(UNKNOWN, 1000.0)
NOTHING = evolve(won_by(rival("bias", 990.0)), nothing=1.0)


def test_the_best_named_cause_and_one_beside_it_that_fit_better_than_the_table(named):
    look = won_by(TABLE, rival("fracture", 2000.0))
    assert named(look, [won_by(rival("clearance", 500.0))]) == (["fracture"], "clearance")


def test_a_cause_that_stands_out_only_beside_the_table(named):
    """The best named cause stood in for both, and nothing fits beside it."""
    look = won_by(TABLE, rival("carried_load", 2000.0))
    later = [NOTHING, won_by(rival("ground_friction", 600.0)), won_by(rival("progressive_folding", 500.0))]
    assert named(look, later) == (["ground_friction"], "progressive_folding")


@pytest.mark.parametrize(
    ("alone", "is_all", "told"), [(990.0, True, "gain_error"), (990.0, False, UNKNOWN), (3000.0, True, UNKNOWN)]
)
def test_a_cause_that_stands_out_beside_the_table_may_be_all_there_is(named, alone, is_all, told):
    """The model's own numbers had hidden it, and the table freed them. Alone it leaves so much, and nothing beside it."""
    look, later = won_by(TABLE, rival("carried_load", 2000.0)), [NOTHING, won_by(rival("gain_error", 600.0)), NOTHING]
    assert named(look, later, alone=alone, is_all=is_all) == ([], told)


@pytest.mark.parametrize(
    "later",
    [
        [NOTHING, NOTHING],
        [NOTHING, won_by(rival(UNKNOWN, 600.0))],
        [NOTHING, won_by(rival("ground_friction", 600.0)), NOTHING],
        [NOTHING, won_by(rival("ground_friction", 600.0)), won_by(rival("progressive_folding", 1500.0))],
        [NOTHING, won_by(rival("ground_friction", 600.0)), won_by(rival(UNKNOWN, 500.0))],
    ],
)
def test_otherwise_the_table_stays(named, later):
    assert named(won_by(TABLE, rival("carried_load", 2000.0)), later) == ([], UNKNOWN)


@pytest.mark.parametrize("normalised", [1.0, 1.5])
def test_one_named_cause_that_fits_better_once_it_has_its_best_form(named, normalised):
    look = won_by(rival(UNKNOWN, 1000.0, normalised), rival("fracture", 2000.0))
    assert named(look, [], formed=990.0) == ([], "fracture")


def test_a_table_at_the_noise_is_believed(named):
    look = won_by(rival(UNKNOWN, 1000.0, normalised=1.0), rival("fracture", 2000.0))
    assert named(look, [], formed=1010.0) == ([], UNKNOWN)


@pytest.mark.parametrize(
    ("is_all", "credit", "told"), [(True, 0.98, "fracture"), (False, 0.98, UNKNOWN), (True, 1.0, UNKNOWN)]
)
def test_a_cause_beside_which_nothing_is_left_needs_not_fit_better(named, is_all, credit, told):
    """If it is more evident; a table has more numbers and leaves a little less."""
    table = rival(UNKNOWN, 1000.0, normalised=1.0)
    table = evolve(table, evidence=credit * table.evidence)
    assert named(won_by(table, rival("fracture", 2000.0)), [], formed=1010.0, is_all=is_all) == ([], told)


def test_a_cause_that_imitates_the_table_and_fits_better_comes_first(named):
    assert named(won_by(TABLE, rival("relaxation", 2000.0)), [], imitation=990.0) == ([], "fracture")
    assert named(won_by(rival(UNKNOWN, 1000.0, normalised=1.0), rival("relaxation", 2000.0)), [], imitation=1100.0) == (
        [],
        UNKNOWN,
    )


@pytest.fixture
def beside(monkeypatch, inquiry):
    """What stands in the place of a look that a table won beside a finding, where what imitates the table fits so well."""

    def ask(place, imitation, is_all):
        monkeypatch.setattr(pairs, "explains", lambda search: is_all)
        monkeypatch.setattr(imitate, "imitating", lambda *_: [("fracture", imitation)])
        monkeypatch.setattr(imitate, "ranked_by_evidence", lambda found, reference: [rival(*one) for one in found])
        found = rival("clearance", 3000.0)
        first = won_by(evolve(found, proposal=evolve(found.proposal, location={"joint": place})))
        return pairs.named_beside(inquiry(None), won_by(TABLE), [first]).leader.proposal.physics

    return ask


@pytest.mark.parametrize(
    ("imitation", "is_all", "told"),
    [(990.0, False, "fracture"), (1100.0, False, UNKNOWN), (990.0, True, "fracture"), (1100.0, True, UNKNOWN)],
)
def test_beside_a_finding_a_known_cause_comes_before_an_estimate_of_it(beside, imitation, is_all, told):
    """Of one that leaves more, the evidence here is less."""
    assert beside("rear", imitation, is_all) == told


def test_an_estimate_at_the_place_of_a_finding_is_not_named(beside):
    assert beside("front", 990.0, True) == UNKNOWN
