"""Which instruments wait while the structure is questioned."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.in_time import OutOfTimeError
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.locate.aside import Suspect
from crashkit.diagnose.name import discover
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.look import Look
from crashkit.protocols import Proposal


@pytest.fixture
def turning(workshop, model, misfit, recorded, claim):
    """What the instruments that agree say: a body turns."""
    base = begin(workshop.identifier, misfit(model, run=recorded(model)))
    rival = claim(base.misfit, "rotation", "rocking")
    return Discovery.of(base, rival.search, (Look.of([rival], base.fitted()),))


@pytest.fixture
def beside(turning, inquiry, monkeypatch):
    """What is told of all instruments, where exploring with those that agree says that a body turns."""
    base = begin(turning.search.identifier, turning.base)

    def told(exploring_all):
        explorations = iter([lambda: turning, exploring_all])
        monkeypatch.setattr(discover, "without", lambda recordings, suspects: recordings)
        monkeypatch.setattr(discover, "reidentify", lambda workshop, misfit: base)
        monkeypatch.setattr(discover, "explored", lambda inquiry: next(explorations)())
        return discover._beside(inquiry(base), ())

    return told


def test_where_not_all_sensors_of_a_body_say_that_it_turns_all_are_asked(beside, turning, monkeypatch):
    """What some of them say of how high they are leaves out those that wait, which are not wrong."""
    monkeypatch.setattr(discover, "CONCEALED", 0.0)
    everything = Discovery.of(begin(turning.search.identifier, turning.base), turning.search)
    assert beside(lambda: everything) is everything


def test_a_body_of_which_all_sensors_say_that_it_turns_is_told_to(beside):
    told = beside(lambda: pytest.fail("nothing else is asked"))
    assert [look.leader.proposal.physics for look in told.findings] == ["rotation"]


def test_a_body_that_turns_is_told_where_there_is_no_time_to_ask_all(beside):
    def too_late():
        raise OutOfTimeError

    assert [look.leader.proposal.physics for look in beside(too_late).findings] == ["rotation"]


@pytest.fixture
def turned(workshop, model, misfit, recorded, claim):
    """What film and accelerometer record of a body that turns."""
    still = misfit(model, run=recorded(model))
    sizes = {"rocking_share": 0.5, "rocking_frequency": 8.0, "rocking_damping": 0.1}
    turning = claim(still, "rotation", "rocking", **sizes).search.misfit
    read, plain = (one.predictor.predict_at(one.parameters(one.start())) for one in (turning, still))
    recording = still.recordings["run"]
    for group, after, before in zip(still.groups, read, plain, strict=True):
        instrument = recording.children[group.name].to_dataset(inherit=False)
        quantity = group.observer.quantity
        change = np.nan_to_num(after.samples - before.samples).reshape(instrument[quantity].shape)
        recording = recording.assign({group.name: xr.DataTree(instrument.assign({quantity: instrument[quantity] + change}))})
    return recording


@pytest.fixture
def told_by_all(turned, workshop, model, misfit, claim, inquiry):
    """What all sensors say of a body that its film says to turn, with so much added to what the accelerometer reads."""

    def tell(added):
        felt = turned["accelerometer"].to_dataset(inherit=False)
        beats = added * np.sin(300.0 * felt["time"]) * np.sign(np.sin(77.0 * felt["time"]))
        spoiled = turned.assign({"accelerometer": xr.DataTree(felt.assign(acceleration=felt["acceleration"] + beats))})
        film = misfit(model, run=turned.drop_nodes("accelerometer"))
        base = begin(workshop.identifier, misfit(model, run=spoiled)).advance(20)
        found = claim(film, "rotation", "rocking", rocking_share=0.5, rocking_frequency=8.0, rocking_damping=0.1)
        structure = Discovery.of(begin(workshop.identifier, film), found.search, (Look.of([found], film),))
        asked = inquiry(base, hypotheses={"rotation": workshop.hypotheses["rotation"]})
        return base, found, discover._read_by_all(asked, structure)

    return tell


def test_a_body_that_turns_is_told_where_all_its_sensors_say_so(told_by_all):
    base, found, told = told_by_all(0.0)
    assert base.normalised > 2.0
    assert told.search.normalised < 1.1
    assert [look.leader.identity for look in told.findings] == [found.identity]
    assert set(found.proposal.parameters) < set(told.findings[0].leader.proposal.parameters)


def test_it_is_told_where_there_is_no_time_to_look_for_more(told_by_all, monkeypatch):
    """No wide look is made: that leaves less than a second finding would have to explain."""
    asked = []

    def too_late(*_, quick):
        asked.append(quick)
        raise OutOfTimeError

    monkeypatch.setattr(discover, "look_again", too_late)
    told = told_by_all(0.0)[-1]
    assert asked == [True]
    assert told.search.normalised < 1.1
    assert [look.leader.proposal.physics for look in told.findings] == ["rotation"]


def test_where_they_do_not_everything_is_asked(told_by_all):
    assert told_by_all(20.0)[-1] is None


@pytest.fixture
def asked_of_a_suspect(workshop, model, misfit, recorded, claim, inquiry, monkeypatch):
    """What is told of a suspect's sensor, whose gain wins the look, if as much is asked of it as of a first finding, and which
    settling would say rings."""

    def ask(told):
        base = begin(workshop.identifier, misfit(model, run=recorded(model)))
        forms = ("gain_error", "constant"), ("mounting_resonance", "element")
        gain, ringing = (claim(base.fitted(), *form) for form in forms)
        look, settled = (evolve(Look.of([rival], base.fitted()), least=1e9) for rival in (gain, ringing))
        sensor = gain.proposal.location["sensor"]
        monkeypatch.setattr(discover, "without", lambda recordings, suspects: recordings)
        monkeypatch.setattr(discover, "reidentify", lambda workshop, misfit: base)
        monkeypatch.setattr(discover, "explored", lambda inquiry: Discovery.of(base, base))
        monkeypatch.setattr(discover, "look_again", lambda *_: look)
        monkeypatch.setattr(discover, "settled", lambda *_: settled)
        found = discover._beside(inquiry(base), (Suspect("front", gain.proposal.location["instrument"], (sensor,), told),))
        return [look.leader.proposal.physics for look in found.findings]

    return ask


@pytest.mark.parametrize(("told", "physics"), [("gain_error", "gain_error"), ("", "mounting_resonance")])
def test_what_kinematics_tell_of_a_sensor_is_not_challenged_by_other_errors(asked_of_a_suspect, told, physics):
    assert asked_of_a_suspect(told) == [physics]


@pytest.mark.parametrize(("left", "after", "is_asked", "is_taken"), [(1.4, 1.0, 1, 1), (1.4, 1.3, 1, 0), (1.1, 1.0, 0, 0)])
def test_where_an_instrument_put_right_leaves_something_all_are_asked_of_the_structure(
    monkeypatch, left, after, is_asked, is_taken
):
    asked = []
    more = SimpleNamespace(search=SimpleNamespace(normalised=after))
    monkeypatch.setattr(discover, "beside_reading", lambda inquiry, reading: asked.append(reading) or more)
    told = SimpleNamespace(findings=("saturation",), search=SimpleNamespace(normalised=left))
    assert discover._with_more(None, told) is (more if is_taken else told)
    assert asked == ["saturation"] * is_asked


def test_what_leaves_something_beside_a_finding_of_those_that_agree_is_told_as_it_is(monkeypatch):
    monkeypatch.setattr(discover, "beside_reading", lambda *_: pytest.fail("nothing more is asked"))
    told = SimpleNamespace(findings=("fracture", "saturation"), search=SimpleNamespace(normalised=1.4))
    assert discover._with_more(None, told) is told


ONE, TWO = {"recorder": 1e-3}, {"recorder": 1e-3, "film": -1e-3}


@pytest.mark.parametrize(("late", "rivals", "told"), [(ONE, ("clock",), "beside"), (ONE, (), None), (TWO, ("clock",), None)])
def test_a_single_late_clock_is_put_right_whatever_a_model_that_lacks_more_says(monkeypatch, late, rivals, told):
    """If a hypothesis speaks of it."""
    monkeypatch.setattr(discover, "_clock", lambda *_: Look(rivals, (1.0,), 1.0, None))
    monkeypatch.setattr(discover, "beside_reading", lambda inquiry, clock: "beside")
    assert discover._with_clock(None, late) == told


@pytest.mark.parametrize(
    ("rivals", "findings", "left", "is_taken"),
    [
        (("obstacle", "turning"), 2, 1.0, True),
        (("obstacle", "turning"), 2, 1.2, False),
        (("obstacle", "turning"), 2, None, False),
        (("obstacle", "turning"), 1, 1.0, False),
        (("obstacle", "obstacle"), 2, 1.0, False),
    ],
)
def test_a_body_that_turns_is_told_instead_of_two_causes(
    monkeypatch, workshop, model, misfit, recorded, claim, rivals, findings, left, is_taken
):
    """If the instruments that agree say so as well as what they told, and all of them together for less."""
    base = begin(workshop.identifier, misfit(model, run=recorded(model)))
    known = {"obstacle": ("obstacle_motion", "sprung"), "turning": ("rotation", "rocking")}
    look = Look.of([claim(base.fitted(), *known[one]) for one in rivals], base.fitted())
    instead = None if left is None else SimpleNamespace(search=SimpleNamespace(normalised=left))
    asked = []
    monkeypatch.setattr(discover, "_read_by_all", lambda inquiry, turning: asked.append(turning.findings[0].leader) or instead)
    monkeypatch.setattr(discover, "cheaper", lambda told, other: other if other.search.normalised < 1.1 else told)
    told = SimpleNamespace(findings=(look,) * findings)
    structure = Discovery.of(base, look.leader.search, (look,))
    assert discover._or_turning(None, told, structure) is (instead if is_taken else told)
    assert [one.proposal.physics for one in asked] == ["rotation"] * (findings == 2 and "turning" in rivals)


@pytest.mark.parametrize(
    ("first", "second", "told"),
    [
        (1.3, 1.0, ["carried_load", "gain_error"]),
        (1.1, 1.0, ["relaxation", "gain_error"]),
        (1.3, None, ["relaxation", "gain_error"]),
    ],
)
def test_another_cause_is_told_that_leaves_less_once_what_is_wrong_is_put_right(monkeypatch, first, second, told):
    """The instruments that agree were too few to tell the two apart."""

    def claimed(physics, normalised=1.0):
        search = SimpleNamespace(normalised=normalised, deviance=1e3 * normalised**2)
        return Rival(Proposal(physics, "", {"joint": "first"}, None, (physics,), {}), search, 100.0, 50.0)

    def with_gain(inquiry, structure, begun, waiting):
        if second is None:
            return None
        gain = claimed("gain_error", first if begun.findings[0].leader.proposal.physics == "relaxation" else second)
        return SimpleNamespace(findings=(*begun.findings, Look((gain,), (1.0,), 0.0, None)), search=gain.search, final=None)

    monkeypatch.setattr(discover, "explains", lambda search: True)
    monkeypatch.setattr(discover, "_with_what_is_wrong", with_gain)
    monkeypatch.setattr(discover, "cheaper", lambda *both: min(both, key=lambda one: one.search.deviance))
    monkeypatch.setattr(discover, "_seen_by_all", lambda inquiry, structure: structure)
    look = Look.of([claimed("relaxation"), claimed("carried_load")], None)
    gain = claimed("gain_error", first)
    wrong = SimpleNamespace(findings=(look, Look((gain,), (1.0,), 0.0, None)), search=gain.search)
    found = discover._or_another(None, wrong, Discovery(None, None, look.leader.search, (look,)), ())
    assert [one.leader.proposal.physics for one in found.findings] == told
    assert [rival.proposal.physics for rival in found.findings[0].rivals] == ["carried_load"] or found is wrong


def test_what_is_wrong_is_asked_where_the_instruments_that_agree_have_led_the_numbers(
    workshop, model, misfit, recorded, inquiry, monkeypatch
):
    """A fit to all of them has bent the numbers to what is wrong."""
    given = misfit(model, run=recorded(model))
    force = next(name for name in given.names if name.endswith("force"))
    unbent, bent = (begin(workshop.identifier, given.with_values({force: value})) for value in (7e4, 9e4))
    asked = []
    monkeypatch.setattr(discover, "look_again", lambda inquiry, *_: asked.append(inquiry.given.model.values()[force]))
    structure, told = Discovery.of(unbent, unbent), Discovery.of(bent, bent)
    discover._with_what_is_wrong(inquiry(bent), structure, told, (Suspect("front", "film", ("s",), False),))
    assert asked == [pytest.approx(7e4)]
