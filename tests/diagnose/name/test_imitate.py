"""A cause is found from where the force that stands for it was estimated."""

import pytest

from crashkit.diagnose.claims import identity, propose_all
from crashkit.diagnose.fitting.evidence import is_unknown, rival_of
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.imitate import imitating
from crashkit.model import Parameter
from crashkit.model.edit import with_factor

TORN = {"softening_deformation": 0.3, "softening_length": 0.2, "loss": 0.4}


@pytest.fixture(scope="module")
def base(workshop, model, recorded, misfit):
    """The fit of a model without its fracture, at two speeds."""
    true = with_factor(model, "first", "softening", {name: Parameter(value, fixed=True) for name, value in TORN.items()})
    runs = {"slow": recorded(true), "fast": recorded(true, speed=1.4, seed=1)}
    return begin(workshop.identifier, misfit(model, **runs)).advance(60)


@pytest.fixture(scope="module")
def table(workshop, base):
    """The force that is missing, estimated as a table of the deformation."""
    proposal = next(p for p in propose_all(workshop, base.fitted()) if p.form == "deformation")
    search = begin(workshop.identifier, workshop.misfit(base.fitted(), proposal.model)).advance(60)
    return rival_of(proposal, search, base.deviance)


def test_the_cause_is_found_with_its_numbers(inquiry, base, table):
    assert is_unknown(table) and table.search.normalised < 0.5 * base.normalised
    proposal, search = min(imitating(inquiry(base), table, base.misfit), key=lambda one: one.priced)
    assert identity(proposal) == ("fracture", "joint first")
    assert search.normalised == pytest.approx(1.0, abs=0.03)
    values = search.misfit.values(search.point)
    for name, value in TORN.items():
        assert values[f"joint.first.{name}"] == pytest.approx(value, rel=0.05)


def test_each_claim_comes_once_and_is_about_the_same_place(inquiry, base, table):
    claims = [identity(proposal) for proposal, _ in imitating(inquiry(base), table, base.misfit)]
    assert len(set(claims)) == len(claims) > 1
    assert {place for _, place in claims} == {"joint first"}
    assert not {physics for physics, _ in claims} & {"unknown"}
