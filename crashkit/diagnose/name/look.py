"""One look at what a model leaves: every hypothesis that has not been found already is fitted to it and weighed."""

from collections.abc import Callable, Sequence
from functools import partial

from attrs import evolve, field, frozen

from crashkit.diagnose.claims import accuses_instrument, identity, is_same, sensors_read, turns
from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.couples import Couple
from crashkit.diagnose.fitting.evidence import UNEXPLAINED, Rival, best_forms, explains, probabilities
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.inquiry import Inquiry, claims_from_given, open_claims
from crashkit.diagnose.name.rivals import Limit, further_rivals, nearest_rivals, standing
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

CHANCE = 0.01
"""A finding is made when the probability that there is nothing falls below this."""
LEAST_DROP = 20.0
"""Chi squared that a finding must at least explain: among a hundred trials of noise the largest stays below it."""
FORM_ERRORS = (0.01, 0.03)
"""Share of what was explained already that a second and a third finding must at least explain: the form of a law is never
quite right, and a form that is wrong by 10 % of its effect leaves the first. Three effects at once are rare, two forms that
are wrong are not."""
READINGS = 0.2
"""How much of that a claim about one instrument must explain: the error of a form shows in all of them."""
EXACT = 0.1
"""How much of what such a claim explained itself counts, if it has but one number: an offset has hardly a form to be wrong."""
TURNED = 3.0
"""The same of a body that turns: its form has no law behind it."""
COMPLETING = 0.3
"""How much of that a claim must explain after which nothing is left, where plainly something was: the error of a form is
hardly another law."""
FITTED = 1.0
"""Chi squared by which two fits of one claim may differ that end in one optimum."""


@frozen
class Look:
    """One look at what is left.

    Attributes:
        rivals: the most evident first.
        probabilities: of each.
        nothing: probability that there is nothing.
        before: the misfit that it was made at.
        least: how much of chi squared a finding must at least explain.
        limits: the smallest effects that would have been seen.
        couples: of claims that leave much less than any rival.
        is_wide: whether it was made with everything in sight, and not only from the current numbers.
        formed: the fit for which the leader was last asked in all its forms, if it was.
        forms: the fits of these.
        estimates: forces that no list has and that were put aside, where a known cause is told though they lead.
    """

    rivals: tuple[Rival, ...]
    probabilities: tuple[float, ...]
    nothing: float
    before: Misfit
    least: float = LEAST_DROP
    limits: tuple[Limit, ...] = field(default=())
    couples: tuple[Couple, ...] = field(default=())
    is_wide: bool = False
    formed: Search | None = None
    forms: tuple[Candidate, ...] = ()
    estimates: tuple[Rival, ...] = ()

    @classmethod
    def of(cls, rivals: Sequence[Rival], before: Misfit, tried: int = 0) -> "Look":
        """One that these are the rivals of, the first ahead, among so many claims that were tried; 0: no others."""
        chances, nothing = probabilities(rivals, tried or len(rivals))
        return cls(tuple(rivals), tuple(chances.tolist()), nothing, before)

    @property
    def leader(self) -> Rival:
        """The most evident rival: the finding, of a look that one was made in."""
        return self.rivals[0]

    def led_by(self, rival: Rival) -> "Look":
        """The same with its leader fitted better, or in another form: what it claims is as probable as it was."""
        return evolve(self, rivals=(rival, *self.rivals[1:]))

    @property
    def winner(self) -> Rival | None:
        """The rival that convinces, if one does."""
        if not self.rivals or self.nothing >= CHANCE:
            return None
        first = self.leader
        least = least_of(first.proposal, self.least)
        is_enough = first.drop > least or (first.drop > COMPLETING * least and self._is_completed_by(first))
        return first if is_enough else None

    def _is_completed_by(self, rival: Rival) -> bool:
        """Whether something plainly was left before, and nothing is left with this one."""
        return standing(self.before)[0] > UNEXPLAINED and explains(rival.search)


def look_again(
    inquiry: Inquiry,
    current: Misfit,
    found: Sequence[Rival],
    concerns: Callable[[Proposal], bool] | None = None,
    quick: bool = False,
    begun: Look | None = None,
) -> Look:
    """Every hypothesis that has not been found already, at the places of the given model, against what is left.

    Once something has been found, the model's own numbers have no more reason to hide the rest.

    Arguments:
        current: the misfit of the model with what was found; where nothing was, the inquiry's model at its best fit.
        concerns: which proposals are to be looked at; None: all.
        quick: whether to stop at what is found from the current numbers.
        begun: the look that did.
    """
    proposals = [p for p in open_claims(inquiry, current, found) if concerns is None or concerns(p)]
    equipped = inquiry.workshop.equipped([p.model for p in proposals])
    least, couples = least_drop(found), tuple[Couple, ...]()
    if begun is None:
        ranked, limits = nearest_rivals(equipped, current, proposals, partial(least_of, least=least), inquiry.progress)
    else:
        ranked, limits = list(begun.rivals), list(begun.limits)
    if not quick:
        afresh = not found or concerns is not None
        claims = claims_from_given(inquiry, current, proposals) if found or concerns is not None else inquiry.from_given
        further = further_rivals(equipped, current, claims, proposals, ranked, afresh, inquiry.progress)
        ranked, couples = list(further.rivals), tuple(further.couples)
    ranked = [rival for rival in ranked if not _is_error_of_form(rival, found)]
    best = _as_before(begun, best_forms(ranked))
    look = Look.of(best, current, len({identity(p) for p in proposals}))
    look = evolve(look, least=least, limits=tuple(limits), couples=couples, is_wide=not quick)
    return evolve(look, formed=begun.formed, forms=begun.forms) if begun else look


def _is_error_of_form(rival: Rival, found: Sequence[Rival]) -> bool:
    """Whether it accuses a sensor of little beside what a body that turns makes it read: how that turns is hardly told in the
    right form."""
    return accuses_instrument(rival.proposal) and any(
        rival.drop < TURNED * FORM_ERRORS[0] * one.drop and sensors_read(rival.proposal) & sensors_read(one.proposal)
        for one in found
        if turns(one.proposal)
    )


def _as_before(begun: Look | None, best: list[Rival]) -> list[Rival]:
    """The rivals, the leader as an earlier look had it where it is hardly fitted better: it may have been settled since."""
    if begun is None or not begun.rivals or not is_same(begun.leader.proposal, best[0].proposal):
        return best
    is_better = best[0].search.deviance < begun.leader.search.deviance - FITTED
    return best if is_better else [begun.leader, *best[1:]]


def least_drop(found: Sequence[Rival]) -> float:
    """What a further finding must explain, in chi squared."""
    if not found:
        return LEAST_DROP
    explained = sum(rival.drop * _inexactness(rival.proposal) for rival in found)
    return max(LEAST_DROP, FORM_ERRORS[min(len(found), len(FORM_ERRORS)) - 1] * explained)


def _inexactness(proposal: Proposal) -> float:
    """How far off its form may be, where that of a law of the structure counts 1."""
    if is_exact(proposal):
        return EXACT
    return TURNED if turns(proposal) else 1.0


def is_exact(proposal: Proposal) -> bool:
    """Whether it is one number of an instrument."""
    return accuses_instrument(proposal) and len(proposal.parameters) == 1


def least_of(proposal: Proposal, least: float) -> float:
    """What this claim must explain where `least` is asked of one about the structure."""
    return max(LEAST_DROP, READINGS * least) if accuses_instrument(proposal) else least


def compared(look: Look, rivals: Sequence[Rival]) -> Look:
    """The look as these rivals, the first ahead, would have it among themselves."""
    told = Look.of(rivals, look.before)
    return evolve(look, rivals=told.rivals, probabilities=told.probabilities, nothing=told.nothing)


def led(look: Look) -> Look:
    """The look whose first rival is told for other reasons than its evidence, and has the best chances."""
    return evolve(look, probabilities=tuple(sorted(look.probabilities, reverse=True)))
