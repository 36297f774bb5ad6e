"""Two causes at once: which two claims together leave least of the equations of motion, and then of the recordings."""

from collections.abc import Sequence
from functools import partial

from attrs import evolve, frozen

from crashkit.campaign import spread
from crashkit.diagnose.claims import Progress, identity, price_of, proposed_again
from crashkit.diagnose.fitting.promises import Led
from crashkit.diagnose.fitting.regress import OPENING, regression, simulated
from crashkit.diagnose.fitting.search import Search, advance_all, begin_all
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

NEAR = 1.5
"""Times what the best couple leaves of the equations: among those that leave no more, a few steps of simulation choose."""
SCOUTING = 8
"""So many."""
HEATS = ((6, 10), (2, 60))
"""How many are simulated at length, and how many more steps each gets."""


@frozen
class Couple:
    """Two claims, the second built on the model with the first, and the fit with both."""

    first: Proposal
    second: Proposal
    search: Search

    @property
    def claims(self) -> frozenset[tuple[str, str]]:
        """What the two claim, whatever their forms."""
        return frozenset((identity(self.first), identity(self.second)))

    @property
    def cost(self) -> float:
        """Half a chi squared with the price of all numbers."""
        samples = self.search.misfit.independent_samples
        return float(self.search.state.cost) + 0.5 * (price_of(self.first, samples) + price_of(self.second, samples))


def coupled(workshop: Workshop, given: Misfit, couples: Sequence[tuple[Led, Led]], progress: Progress) -> list[Couple]:
    """Those of these that leave least of the equations, fitted together, the most evident first.

    Arguments:
        given: the misfit of the model without them, at the values that the user gave.
    """
    return _simulated(workshop, _begun(workshop, given, couples), progress)


def in_heats(couples: Sequence[Couple], heats: Sequence[tuple[int | None, int]]) -> list[Couple]:
    """Successive halving; those that fall behind stay as they are.

    Arguments:
        heats: how many enter each, and how many steps each gets there.
    """
    for size, steps in heats:
        ranked = sorted(couples, key=lambda couple: couple.cost)
        ahead = ranked[:size]
        searches = advance_all([couple.search for couple in ahead], steps)
        advanced = [evolve(couple, search=search) for couple, search in zip(ahead, searches, strict=True)]
        couples = [*advanced, *ranked[len(ahead) :]]
    return list(couples)


def each_once(couples: Sequence[Couple]) -> list[Couple]:
    """Each two claims in their best forms, the most evident first."""
    best: dict[frozenset[tuple[str, str]], Couple] = {}
    for couple in sorted(couples, key=lambda couple: couple.cost):
        best.setdefault(couple.claims, couple)
    return list(best.values())


def with_other_forms(couple: Couple, claims: Sequence[Led]) -> list[tuple[Led, Led]]:
    """Every other form of the one claim with the other as it is: of a form that is off, the other has to make up for that."""
    firsts, seconds = (
        [one for one in claims if identity(one.proposal) == identity(claim)] for claim in (couple.first, couple.second)
    )
    forms = couple.first.form, couple.second.form
    pairs = [(first, second) for first in firsts for second in seconds]
    return [(one, two) for one, two in pairs if (one.proposal.form == forms[0]) != (two.proposal.form == forms[1])]


@frozen(eq=False)
class _Begun:
    """A couple where the equations have led it.

    Attributes:
        left: half a chi squared that it leaves of them, with the price of its numbers.
        price: that price.
    """

    first: Proposal
    second: Proposal
    misfit: Misfit
    left: float
    price: float


def _begun(workshop: Workshop, given: Misfit, couples: Sequence[tuple[Led, Led]]) -> list[_Begun]:
    """The couples that can be begun, those first that leave least of the equations."""
    begun = [one for one in spread(partial(_begun_one, workshop, given), couples) if one is not None]
    return sorted(begun, key=lambda one: one.left)


def _begun_one(workshop: Workshop, given: Misfit, couple: tuple[Led, Led]) -> _Begun | None:
    """The model with both claims where a short regression leads it; None where the second has no place beside the first, or
    its law there would have to be compiled first."""
    leader, other = couple
    alone = workshop.misfit(given, leader.proposal.model).with_values(leader.values)
    second = proposed_again(workshop, alone, other.proposal)
    if second is None or not workshop.holds(second.model):
        return None
    start = {name: other.values[name] for name in second.parameters if name in other.values}
    together = workshop.misfit(alone, second.model).with_values_of(alone).with_values(start)
    end = regression(workshop, together, rounds=OPENING)
    if end is None:
        return None
    price = leader.price + other.price
    return _Begun(leader.proposal, second, together.with_values(end[0]), end[1] + price, price)


def _simulated(workshop: Workshop, begun: Sequence[_Begun], progress: Progress) -> list[Couple]:
    """Those that are ahead, with simulations."""
    ahead = _ahead(workshop, begun, HEATS[0][0])
    ends = spread(lambda one: regression(workshop, one.misfit), ahead)
    starts = [one.misfit if end is None else one.misfit.with_values(end[0]) for one, end in zip(ahead, ends, strict=True)]
    doing = f"showing the recordings to {len(ahead)} couples"
    searches = simulated(workshop.identifier, starts, [True] * len(starts), lambda share: progress(doing, share))
    couples = [Couple(one.first, one.second, search) for one, search in zip(ahead, searches, strict=True)]
    return sorted(in_heats(couples, HEATS), key=lambda couple: couple.cost)


def _ahead(workshop: Workshop, begun: Sequence[_Begun], count: int) -> Sequence[_Begun]:
    """Those that leave least of the equations; where more leave hardly more, those of them that simulate best.

    One cause may leave next to nothing of the equations, which then say nothing of what is beside it.
    """
    near = [one for one in begun if one.left < NEAR * begun[0].left]
    if len(near) <= count:
        return begun[:count]
    searches = advance_all(begin_all(workshop.identifier, [one.misfit for one in near]), SCOUTING)
    order = sorted(range(len(near)), key=lambda one: searches[one].state.cost + near[one].price)
    return [near[one] for one in order[:count]]
