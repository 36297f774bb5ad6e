"""Two causes at once: which two claims together leave least of the equations of motion of the measured bodies."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from attrs import evolve, frozen

from crashkit.campaign import spread
from crashkit.diagnose.claims import Progress, first_of_each, identity, price_of, proposed_again
from crashkit.diagnose.fitting.regress import OPENING, End, regression, residual_and_jacobian, simulated
from crashkit.diagnose.fitting.search import Search, advance_all
from crashkit.diagnose.result import UNKNOWN
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

LEADERS = 12
"""Claims beside each of which all others are tried."""
TRIED = 24
"""Couples that are regressed; of each two claims one in the forms that promise most."""
HEATS = ((6, 10), (2, 60))
"""How many of those that leave least of the equations are simulated, and how many more steps each gets."""


@frozen
class Couple:
    """Two claims, the second built on the model with the first, and the fit with both."""

    first: Proposal
    second: Proposal
    search: Search

    @property
    def cost(self) -> float:
        """Half a chi squared with the price of all numbers."""
        samples = self.search.misfit.independent_samples
        return float(self.search.state.cost) + 0.5 * (price_of(self.first, samples) + price_of(self.second, samples))


@frozen(eq=False)
class Led:
    """A claim where a regression has led it, and the equations about there.

    Attributes:
        values: by path.
        residual, shared: what is left, and its derivatives to the numbers of the model without the claim, with what was
            believed of these.
        own: its derivatives to the claim's own numbers, and all that the claim changes.
    """

    proposal: Proposal
    values: Mapping[str, float]
    residual: np.ndarray
    shared: np.ndarray
    own: np.ndarray

    @property
    def price(self) -> float:
        """Of its numbers, in half a chi squared."""
        return 0.5 * price_of(self.proposal, len(self.residual))


def coupled(
    workshop: Workshop, given: Misfit, proposals: Sequence[Proposal], ends: Sequence[End | None], progress: Progress
) -> list[Couple]:
    """The couples of claims that, fitted together, leave least, the most evident first.

    The first of two gross causes that is asked for alone has to make do for both, and drives the model's numbers where no
    second one is found. Along the measured motion what two of them leave together is known from what each does alone, to
    first order, so all couples can be asked.

    Arguments:
        given: the misfit of the model without them, at the values that the user gave.
        ends: where short regressions have led each proposal.
    """
    claims = [(p, end) for p, end in zip(proposals, ends, strict=True) if end is not None and p.physics != UNKNOWN]
    led = [one for one in spread(partial(_led, workshop, given), claims) if one is not None]
    alike = [one for one in led if one.residual.shape == led[0].residual.shape]
    progress(f"regressing the equations of motion for couples of {len(alike)} claims", 0.0)
    ranked = sorted(((one.proposal, one) for one in alike), key=lambda claim: _left_by(claim[1]))
    leaders = [one for _, one in first_of_each(ranked, 1)][:LEADERS]
    promises = [promise for some in spread(lambda leader: _promises(leader, alike), leaders) for promise in some]
    begun = spread(partial(_begun, workshop, given), _distinct(promises))
    return _simulated(workshop, [one for one in begun if one is not None], progress)


def _led(workshop: Workshop, given: Misfit, claim: tuple[Proposal, End]) -> Led | None:
    """The equations about the end of a claim; None where they are not those of the model without it, or beyond all measure."""
    proposal, end = claim
    misfit = workshop.misfit(given, proposal.model).with_values(end[0])
    plain = given.with_values_of(misfit)
    with_claim, without = (residual_and_jacobian(workshop, one) for one in (misfit, plain))
    if with_claim is None or without is None or len(with_claim[0]) != len(without[0]):
        return None
    residual, jacobian = with_claim
    if not (np.isfinite(residual).all() and np.isfinite(jacobian).all() and np.isfinite(without[0]).all()):
        return None
    belief, slopes = plain.belief(plain.start())
    own = [number for number, name in enumerate(misfit.names) if name in proposal.parameters]
    shared = np.zeros((len(residual), len(plain.names)))
    for number, name in enumerate(misfit.names):
        if name in plain.names and number not in own:
            shared[:, plain.names.index(name)] = jacobian[:, number]
    change = np.column_stack([jacobian[:, own], residual - without[0]])
    return Led(
        proposal,
        end[0],
        np.concatenate([residual, belief]),
        np.vstack([shared, slopes]),
        np.vstack([change, np.zeros((len(belief), change.shape[1]))]),
    )


Promise = tuple[float, Led, Led]
"""Half a chi squared that two claims leave together, to first order, with the price of their numbers."""


def _left_by(claim: Led) -> float:
    return 0.5 * float(claim.residual @ claim.residual) + claim.price


def _promises(leader: Led, others: Sequence[Led]) -> list[Promise]:
    """What the leader would leave beside each of the others, all numbers adjusted."""
    basis, _ = np.linalg.qr(_scaled(np.column_stack([leader.shared, leader.own[:, :-1]])))
    left = leader.residual - basis @ (basis.T @ leader.residual)
    rest = [other for other in others if identity(other.proposal) != identity(leader.proposal)]
    return [(_left_beside(left, basis, other.own) + leader.price + other.price, leader, other) for other in rest]


def _left_beside(left: np.ndarray, basis: np.ndarray, columns: np.ndarray) -> float:
    """Half of the sum of squares of `left` that neither the basis nor these columns take up."""
    beside = _scaled(columns - basis @ (basis.T @ columns))
    taken = np.linalg.lstsq(beside, left, rcond=1e-6)[0]
    return 0.5 * float(np.sum((left - beside @ taken) ** 2))


def _scaled(columns: np.ndarray) -> np.ndarray:
    """Columns of size 1, but those of nothing."""
    size = np.linalg.norm(columns, axis=0)
    return columns[:, size > 0.0] / size[size > 0.0]


def _distinct(promises: Sequence[Promise]) -> list[Promise]:
    """The best, each two claims in one of their forms."""
    best: dict[frozenset[tuple[str, str]], Promise] = {}
    for promise in sorted(promises, key=lambda promise: promise[0]):
        best.setdefault(frozenset(identity(claim.proposal) for claim in promise[1:]), promise)
    return list(best.values())[:TRIED]


@frozen(eq=False)
class _Begun:
    """A couple where the equations have led it."""

    first: Proposal
    second: Proposal
    misfit: Misfit
    left: float


def _begun(workshop: Workshop, given: Misfit, promise: Promise) -> _Begun | None:
    """The model with both claims where a short regression leads it; None where the second has no place beside the first, or
    its law there would have to be compiled first."""
    _, leader, other = promise
    alone = workshop.misfit(given, leader.proposal.model).with_values(leader.values)
    second = proposed_again(workshop, alone, other.proposal)
    if second is None or not workshop.holds(second.model):
        return None
    start = {name: other.values[name] for name in second.parameters if name in other.values}
    together = workshop.misfit(alone, second.model).with_values_of(alone).with_values(start)
    end = regression(workshop, together, rounds=OPENING)
    if end is None:
        return None
    return _Begun(leader.proposal, second, together.with_values(end[0]), end[1] + leader.price + other.price)


def _simulated(workshop: Workshop, begun: Sequence[_Begun], progress: Progress) -> list[Couple]:
    """Those that leave least, with simulations; the most evident first."""
    ahead = sorted(begun, key=lambda one: one.left)[: HEATS[0][0]]
    ends = spread(lambda one: regression(workshop, one.misfit), ahead)
    starts = [one.misfit if end is None else one.misfit.with_values(end[0]) for one, end in zip(ahead, ends, strict=True)]
    doing = f"showing the recordings to {len(ahead)} couples"
    searches = simulated(workshop.identifier, starts, [True] * len(starts), lambda share: progress(doing, share))
    couples = [Couple(one.first, one.second, search) for one, search in zip(ahead, searches, strict=True)]
    for size, steps in HEATS:
        couples = sorted(couples, key=lambda couple: couple.cost)
        searches = advance_all([couple.search for couple in couples[:size]], steps)
        couples[:size] = [evolve(couple, search=search) for couple, search in zip(couples, searches, strict=False)]
    return sorted(couples, key=lambda couple: couple.cost)
