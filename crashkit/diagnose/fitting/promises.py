"""What two claims would leave together of the equations of motion, to first order, from what each does alone."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from attrs import frozen

from crashkit.campaign import spread
from crashkit.diagnose.claims import first_of_each, identity, price_of
from crashkit.diagnose.fitting.regress import End, residual_and_jacobian
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

LEADERS = 12
"""Claims beside each of which all others are tried."""
BEYOND = 1e100
"""Standard deviations, and their derivatives: more is beyond all measure, and has no square."""


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

    @property
    def left(self) -> float:
        """Half a chi squared that it leaves, with its price."""
        return 0.5 * float(self.residual @ self.residual) + self.price


Promise = tuple[float, Led, Led]
"""Half a chi squared that two claims leave together, to first order, with the price of their numbers."""


def led(workshop: Workshop, given: Misfit, claims: Sequence[tuple[Proposal, End]]) -> list[Led]:
    """Each claim where a regression has led it, but those that have other equations than the first."""
    found = [one for one in spread(partial(_led, workshop, given), claims) if one is not None]
    return [one for one in found if one.residual.shape == found[0].residual.shape]


def promising_couples(claims: Sequence[Led], most: int) -> list[tuple[Led, Led]]:
    """Two claims at once, the best first, each two in one of their forms: the leading ones beside all others."""
    ranked = sorted(((one.proposal, one) for one in claims), key=lambda claim: claim[1].left)
    leaders = [one for _, one in first_of_each(ranked, 1)][:LEADERS]
    promised = [promise for some in spread(lambda leader: promises_beside(leader, claims), leaders) for promise in some]
    best: dict[frozenset[tuple[str, str]], Promise] = {}
    for promise in sorted(promised, key=lambda promise: promise[0]):
        best.setdefault(frozenset(identity(claim.proposal) for claim in promise[1:]), promise)
    return [(first, second) for _, first, second in best.values()][:most]


def _led(workshop: Workshop, given: Misfit, claim: tuple[Proposal, End]) -> Led | None:
    """The equations about the end of a claim; None where they are not those of the model without it, or beyond all measure."""
    proposal, end = claim
    misfit = workshop.misfit(given, proposal.model).with_values(end[0])
    plain = given.with_values_of(misfit)
    with_claim, without = (residual_and_jacobian(workshop, one) for one in (misfit, plain))
    if with_claim is None or without is None or len(with_claim[0]) != len(without[0]):
        return None
    residual, jacobian = with_claim
    if not all(np.abs(part).max(initial=0.0) < BEYOND for part in (residual, jacobian, without[0])):
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


def promises_beside(leader: Led, others: Sequence[Led]) -> list[Promise]:
    """What the leader would leave beside each of the others, all numbers adjusted."""
    basis, _ = np.linalg.qr(_scaled(np.column_stack([leader.shared, leader.own[:, :-1]])))
    left = leader.residual - basis @ (basis.T @ leader.residual)
    rest = [other for other in others if identity(other.proposal) != identity(leader.proposal)]
    return [(left_beside(left, basis, other.own) + leader.price + other.price, leader, other) for other in rest]


def left_beside(left: np.ndarray, basis: np.ndarray, columns: np.ndarray) -> float:
    """Half of the sum of squares of `left` that neither the basis nor these columns take up."""
    beside = _scaled(columns - basis @ (basis.T @ columns))
    taken = np.linalg.lstsq(beside, left, rcond=1e-6)[0]
    return 0.5 * float(np.sum((left - beside @ taken) ** 2))


def _scaled(columns: np.ndarray) -> np.ndarray:
    """Columns of size 1, but those of nothing."""
    size = np.linalg.norm(columns, axis=0)
    return columns[:, size > 0.0] / size[size > 0.0]
