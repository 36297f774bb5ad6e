"""Which instruments wait while the structure is questioned."""

from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name import discover
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.look import Look


def test_a_body_that_turns_is_asked_of_all_its_sensors(workshop, model, misfit, recorded, inquiry, claim, monkeypatch):
    """What some of them say of how high they are leaves out those that wait, which are not wrong."""
    base = begin(workshop.identifier, misfit(model, run=recorded(model)))
    turning = claim(base.misfit, "rotation", "rocking")
    found = Discovery.of(base, turning.search, (Look.of([turning], base.fitted()),))
    monkeypatch.setattr(discover, "without", lambda recordings, suspects: recordings)
    monkeypatch.setattr(discover, "reidentify", lambda workshop, misfit: base)
    monkeypatch.setattr(discover, "explored", lambda inquiry: found)
    assert discover._beside(inquiry(base), ()) is None
