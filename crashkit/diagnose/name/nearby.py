"""What the best claim from the numbers as they are leads to."""

from collections.abc import Iterable, Iterator, Sequence

from attrs import evolve, field, frozen

from crashkit.diagnose.claims import identity
from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.couples import Couple
from crashkit.diagnose.fitting.evidence import (
    UNEXPLAINED,
    Rival,
    best_forms,
    by_evidence,
    explains,
    is_at_noise,
    is_strained,
    is_unknown,
    one_explains,
    ranked_by_evidence,
)
from crashkit.diagnose.fitting.in_time import in_time
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.follow import (
    ALMOST_ALL,
    LEFT,
    Discovery,
    complete,
    followed,
    is_but_a_trace,
    leave_no_third,
    leaves_no_second,
    with_one_more,
)
from crashkit.diagnose.name.forms import in_best_forms
from crashkit.diagnose.name.inquiry import Inquiry, claims_from_given, open_claims
from crashkit.diagnose.name.leaders import beside_what_gives_way, coupled_leaders, in_other_forms
from crashkit.diagnose.name.look import FORM_ERRORS, Look, compared, look_again
from crashkit.diagnose.name.pace import check_pace
from crashkit.diagnose.name.pairs import both, named_beside, named_instead
from crashkit.diagnose.name.rivals import CONCEALED, COUPLED
from crashkit.diagnose.name.settle import settled
from crashkit.diagnose.name.two_places import couples_at_two_places
from crashkit.diagnose.result import UNKNOWN

FOLLOWED = 0.5
"""Of what the model without it leaves above the noise: a claim that leaves more is not followed before all are asked."""
LEADERS = 6
"""How many known causes that lead are put beside each other."""
NEXT_TO_NOTHING = 0.05
"""Of what one cause alone leaves above the noise: two that leave less are hardly others, in whatever forms."""
HARDLY_MORE = 0.1
"""Of what another leaves above the noise: in other forms a cause that leaves no more than that may leave less."""
MANY_NUMBERS = 10
"""A cause that has so many imitates much, as a body that turns and acts back."""


@frozen
class Nearby:
    """What is found from the re-identified numbers.

    Attributes:
        look: from there, its best known claim at its best.
        found: what that claim leads to, if it may be all there is.
        beside: the look beside it, if one was made.
    """

    look: Look
    found: Discovery | None = field(default=None)
    beside: Look | None = field(default=None)


def followed_nearby(inquiry: Inquiry, near: Look) -> Nearby:
    """A look from the re-identified numbers, and what its best known claim leads to."""
    known = [rival for rival in near.rivals if not is_unknown(rival)]
    if not known:
        return Nearby(near)
    if known[0].search.excess > FOLLOWED * inquiry.base.excess:
        freed = in_time(near, _freed, inquiry, near, known[0])
        if freed is not near:
            return followed_nearby(inquiry, freed)
        named = in_time(near, _named_instead, inquiry, near, known[0])
        if named is not near:
            return followed_nearby(inquiry, named)
        # What an estimate at one place explains alone is not made of two causes at two.
        return Nearby(near, None if is_at_noise(near.leader.search) else _two_at_once(inquiry, near, known[0].search))
    if _is_pointed_away(near, known[0]) and in_time(False, lambda: one_explains(inquiry.from_given.singles)):
        return Nearby(near)
    estimates = tuple(filter(is_unknown, near.rivals))
    first, search = _at_its_best(inquiry, evolve(compared(near, known), estimates=estimates))
    near = compared(first, by_evidence([*first.rivals, *estimates]))
    winner = first.winner
    if winner is None:
        return Nearby(near)
    if search.normalised < CONCEALED:
        check_pace(inquiry, winner)
    two = _two_at_once(inquiry, near, search)
    if two is not None:
        return Nearby(near, two)
    if _is_one_of_few_numbers(inquiry, winner, search):
        return Nearby(near)
    return _with_a_second(inquiry, near, first if is_unknown(near.leader) else near, search)


def _is_pointed_away(near: Look, known: Rival) -> bool:
    """Whether an estimate at another place leaves far less than the best known cause, which leaves much: the one that is there
    may be caught where the model without it had been driven, and is soon told along the measured motion."""
    least = FOLLOWED * known.search.excess
    elsewhere = [rival for rival in near.rivals if is_unknown(rival) and rival.place != known.place]
    return known.search.normalised > CONCEALED and any(rival.search.excess < least for rival in elsewhere)


def _is_one_of_few_numbers(inquiry: Inquiry, winner: Rival, search: Search) -> bool:
    """Whether one cause explains everything from the given values, where one of many numbers does not: from where the model
    without it had been driven, that is not seen."""
    is_imitated = len(winner.proposal.parameters) >= MANY_NUMBERS and not explains(search)
    return is_imitated and in_time(False, lambda: one_explains(inquiry.from_given.singles))


def _freed(inquiry: Inquiry, near: Look, known: Rival) -> Look:
    """The look led by the best known cause, if it is followed and leaves less than the estimate that led, once the measured
    motion leads it from the given values: it may be caught where the model without it had been driven."""
    table, base = near.leader, inquiry.base
    if not is_unknown(table):
        return near
    claims = [claim for claim in open_claims(inquiry, base.fitted(), []) if identity(claim) == known.identity]
    forms = claims_from_given(inquiry, base.fitted(), claims).singles
    ranked = best_forms(by_evidence([*near.rivals, *ranked_by_evidence(forms, base.deviance)]))
    freed = next(rival for rival in ranked if rival.identity == known.identity)
    is_first = freed.search.excess < min(table.search.excess, FOLLOWED * base.excess)
    return compared(near, [freed, *(rival for rival in ranked if rival is not freed)]) if is_first else near


def _named_instead(inquiry: Inquiry, near: Look, known: Rival) -> Look:
    """The look led by a known cause at the place of its estimate, if that leaves far less than any known one and such a cause,
    begun beside it, no more: alone, a search may be caught where the model without the cause had been driven."""
    table = near.leader
    if not is_unknown(table) or table.search.excess > LEFT * known.search.excess:
        return near
    named = named_instead(inquiry, near, table)
    return compared(named, [*named.rivals, *filter(is_unknown, near.rivals)]) if named else near


def _with_a_second(inquiry: Inquiry, near: Look, first: Look, search: Search) -> Nearby:
    """What is found beside the first cause; where that leaves much, only what leaves next to nothing then.

    Where a second one could hardly be told, no more is asked than what leads from the numbers as they are.

    Arguments:
        search: the fit with the first.
    """
    is_quick = search.normalised > CONCEALED or leaves_no_second(search, inquiry.base)
    look = look_again(inquiry, search.fitted(), [first.leader], quick=is_quick)
    if look.winner is None and is_but_a_trace(search, inquiry.base):
        return Nearby(near, Discovery.of(inquiry.base, search, (first,), look), look)
    if search.normalised > CONCEALED:
        if _may_be_one(look, search):
            look = in_time(look, named_beside, inquiry, look, [first])
        if not (_completes(look, search) or _is_most(search, inquiry.base, look)):
            # From where the model has been driven, two others may seem to explain what one does from the given values.
            if in_time(True, lambda: _is_led_elsewhere(inquiry.from_given.singles, first, search)):
                return Nearby(near, None, look)
            found = in_time(None, _in_forms_together, inquiry, first, look, search)
            return Nearby(near, found or in_time(None, _two_of_all, inquiry, near, search), look)
    found, _ = followed(inquiry, [first], look)
    return Nearby(near, found, look)


def _is_led_elsewhere(singles: Sequence[Candidate], first: Look, search: Search) -> bool:
    """Whether from the given values one cause explains everything, or a known one other than the first leaves far less, by
    numbers that are not strained."""
    told = [one for one in singles if one.proposal.physics != UNKNOWN and identity(one.proposal) != first.leader.identity]
    ahead = [other.search for other in told if other.search.excess < FOLLOWED * search.excess]
    return one_explains(singles) or not all(map(is_strained, ahead))


def _in_forms_together(inquiry: Inquiry, first: Look, look: Look, search: Search) -> Discovery | None:
    """What the first cause and the known one that leads beside it come to, if each in its best form they leave next to
    nothing: in a form that is off, the right two may leave much."""
    known = _pointed_to_first(look)
    if not known or not _is_followed(look, known[0], search):
        return None
    findings, end = with_one_more(inquiry, [first], compared(look, known), known[0])
    if not complete(end, search):
        return None
    if not leave_no_third(findings, end, inquiry.base):
        look = look_again(inquiry, end.fitted(), [one.leader for one in findings])
    return followed(inquiry, [*findings[:-1], findings[-1].led_by(evolve(findings[-1].leader, search=end))], look)[0]


def _pointed_to_first(look: Look) -> list[Rival]:
    """The known causes, that at the place of the estimate that leads ahead of those that leave hardly less: one of many
    numbers imitates much beside a first cause in a form that is off."""
    known = [rival for rival in look.rivals if not is_unknown(rival)]
    if not known or not is_unknown(look.leader):
        return known
    most = (1.0 + HARDLY_MORE) * known[0].search.excess
    pointed = [rival for rival in known if rival.place == look.leader.place and rival.search.excess < most]
    return [*pointed, *(rival for rival in known if rival not in pointed)]


def _is_followed(look: Look, claim: Rival, without: Search) -> bool:
    """Whether a claim explains half of what is left, or an estimate at its place does: then it may in another form."""
    here = [rival.search.excess for rival in look.rivals if rival.place == claim.place]
    return min(here) <= FOLLOWED * without.excess


def _two_at_once(inquiry: Inquiry, near: Look, alone: Search) -> Discovery | None:
    """What two of the causes that lead, or that estimates point to, come to."""
    return _first_two(inquiry, near, alone, _leading(inquiry, near, alone)) if alone.normalised >= UNEXPLAINED else None


def _two_of_all(inquiry: Inquiry, near: Look, alone: Search) -> Discovery | None:
    """What two of all causes come to, where one alone does for most of what was left, as the others that lead then only do for
    its form: else these are asked later, after each alone."""
    if alone.excess >= FOLLOWED * inquiry.base.excess:
        return None
    return _first_two(inquiry, near, alone, _of_all(inquiry, near, alone))


def _of_all(inquiry: Inquiry, near: Look, alone: Search) -> Iterator[list[Couple]]:
    """Couples of all causes along the measured motion, and of the first one with what gives way, which that says little of."""
    yield inquiry.from_given.couples(alone.excess)
    first = next(rival for rival in near.rivals if not is_unknown(rival))
    yield beside_what_gives_way(inquiry, evolve(first, search=alone))


def _first_two(inquiry: Inquiry, near: Look, alone: Search, asked: Iterable[Sequence[Couple]]) -> Discovery | None:
    """What the first of these couples leads to that leaves nothing to speak of and far less than one cause alone."""
    for couples in asked:
        is_led = _are_all(couples, alone) and not _are_one_force(couples[0], near)
        begun = both(inquiry, evolve(near, couples=tuple(couples))) if is_led else None
        if begun is not None:
            return followed(inquiry, [begun[0]], begun[1])[0]
    return None


def _leading(inquiry: Inquiry, near: Look, alone: Search) -> Iterator[list[Couple]]:
    """Couples of the causes that lead, of those that estimates point to, and of the former in other forms."""
    couples = coupled_leaders(inquiry, [rival for rival in near.rivals if not is_unknown(rival)][:LEADERS])
    yield couples
    yield couples_at_two_places(inquiry, near, alone)
    yield in_other_forms(inquiry, couples, alone)


def _are_all(couples: Sequence[Couple], alone: Search) -> bool:
    """Whether the first of these leaves nothing to speak of, and far less than one cause alone."""
    first = couples[0].search if couples else alone
    return first.normalised <= UNEXPLAINED and first.excess <= COUPLED * alone.excess


def _are_one_force(couple: Couple, near: Look) -> bool:
    """Whether both act at a place where one estimated force alone leaves less: they imitate one that no law tells."""
    places = {place for _, place in couple.claims}
    estimates = [rival.search for rival in near.rivals if is_unknown(rival) and {rival.place} == places]
    return any(estimate.excess < couple.search.excess for estimate in estimates)


def _at_its_best(inquiry: Inquiry, look: Look) -> tuple[Look, Search]:
    """The look with its leader settled, and in its best form where hardly anything is left beside it."""
    first = settled(inquiry, look, look.leader, [])
    search = first.leader.search
    if search.excess > ALMOST_ALL * inquiry.base.excess:
        return first, search
    (first,), search = in_best_forms(inquiry, [first], search)
    return first, search


def _is_most(search: Search, base: Search, look: Look) -> bool:
    """Whether a claim leaves next to nothing of what was left, or a known one beside it, which explains half of that."""
    winner = look.winner
    if winner is None or is_unknown(winner) or winner.search.excess > FOLLOWED * search.excess:
        return False
    return search.excess < FORM_ERRORS[1] * base.excess or winner.search.excess < FORM_ERRORS[0] * base.excess


def _may_be_one(look: Look, without: Search) -> bool:
    """Whether a second cause at the place of what wins a look may leave next to nothing, where that is an estimate."""
    return look.winner is not None and look.winner.search.excess < LEFT * without.excess


def _completes(look: Look, without: Search) -> bool:
    """Whether a known claim leaves next to nothing, or of what there is without it, as forms may be a little off."""
    if look.winner is None or is_unknown(look.winner):
        return False
    left = look.winner.search
    return left.normalised < UNEXPLAINED or left.excess < NEXT_TO_NOTHING * without.excess
