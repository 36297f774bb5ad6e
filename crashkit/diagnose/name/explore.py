"""From near to far: what explains the recordings from the numbers as they are, and then with everything in sight."""

from attrs import evolve

from crashkit.diagnose.claims import accuses_instrument
from crashkit.diagnose.fitting.evidence import (
    FLOOR,
    UNEXPLAINED,
    Rival,
    explains,
    is_sound,
    is_strained,
    ranked_by_evidence,
    rival_of,
)
from crashkit.diagnose.fitting.in_time import in_time
from crashkit.diagnose.fitting.leftover import is_all_told
from crashkit.diagnose.fitting.rebuild import alone_again
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.locate.free_force import free_forces, outstanding
from crashkit.diagnose.name.follow import (
    NEEDED,
    TIE,
    Discovery,
    followed,
    is_estimated,
    leave_no_third,
    leaves_no_second,
    reconsidered,
)
from crashkit.diagnose.name.forms import in_all_forms, in_best_forms
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.last_estimates import estimated_at_last
from crashkit.diagnose.name.look import FORM_ERRORS, Look, compared, led, look_again
from crashkit.diagnose.name.narrowed import as_bump, in_one_bump, with_pulses
from crashkit.diagnose.name.nearby import Nearby, followed_nearby
from crashkit.diagnose.name.needed import price
from crashkit.diagnose.name.other_first import begun_otherwise
from crashkit.diagnose.name.pace import check_rate
from crashkit.diagnose.name.pairs import both, named_before_unknown
from crashkit.diagnose.name.pointed import with_causes_pointed_to
from crashkit.diagnose.name.rivals import CONCEALED, may_conceal
from crashkit.diagnose.name.settle import reidentified
from crashkit.diagnose.name.shown_alone import is_shown_alone
from crashkit.diagnose.name.simpler import in_fewer_numbers
from crashkit.diagnose.result import UNKNOWN

LED = 3
"""How many of the leading claims may show that the model as it is was caught in a local optimum."""
LOCAL_OPTIMUM = 0.5
"""Of what the model as it is leaves above the noise: where it leaves less from where one of them has moved its numbers,
everything is asked from there."""
HARDLY_LESS = 0.2
"""Of what a claim leaves above the noise: what leaves less by no more than that is hardly another."""
BLAMED = 2.5
"""How much more an estimate may leave than what was found and gives way to it, residuals over noise."""


def explored(inquiry: Inquiry, near: Look | None = None) -> Discovery:
    """All findings that the evidence supports, each in the light of the others.

    From the re-identified numbers first: where one cause in its best form explains everything from there, or all but what no
    further finding could be told for, or two causes do, no wider search is made.

    Arguments:
        near: the look from there, if it was made already.
    """
    told = _near_then_wide(inquiry, near)
    told = in_time(told, in_one_bump, inquiry, told)
    return in_time(told, in_fewer_numbers, inquiry, told)


def _near_then_wide(inquiry: Inquiry, near: Look | None) -> Discovery:
    base = inquiry.base
    near = near or _near(inquiry)
    near = in_time(near, with_pulses, inquiry, near)
    bump = in_time(None, as_bump, inquiry, near)
    if bump is not None:
        return _won(base, bump)
    near = in_time(near, with_causes_pointed_to, inquiry, near)
    if base.normalised > CONCEALED:
        better = alone_again(base, [rival.search.fitted() for rival in near.rivals[:LED]])
        if better.excess < LOCAL_OPTIMUM * base.excess:
            return in_time(_won(base, near), _near_then_wide, evolve(inquiry, base=better), None)
    if _is_wrong_beside_more(near):
        # Caught where the model with that error unknown had been driven, it may seem to leave much.
        near = in_time(near, reidentified, inquiry, near, near.leader)
    if _is_wrong_beside_more(near):
        check_rate(inquiry, near.leader)
        return beside_reading(inquiry, near)
    nearby = Nearby(near)
    if may_conceal(base.fitted()):
        nearby = in_time(nearby, followed_nearby, inquiry, near)
    found = nearby.found
    if found is not None and _suffices(found, base):
        return found
    wide = in_time(_won(base, nearby.look), _found_widely, inquiry, nearby)
    told = wide if found is None else cheaper(found, wide)
    estimated = in_time(told, estimated_at_last, inquiry, told)
    return in_time(told, _where_it_acts, inquiry, told) if estimated is told else estimated


def _is_wrong_beside_more(near: Look) -> bool:
    """Whether an instrument plainly is wrong, but that leaves much: of that the equations of motion say nothing, and all that
    is asked of the structure is asked better once it is put right."""
    winner = near.winner
    return winner is not None and accuses_instrument(winner.proposal) and winner.search.normalised > CONCEALED


def beside_reading(inquiry: Inquiry, reading: Look) -> Discovery:
    """An instrument that is wrong, and what all of them say of the structure once it is put right.

    Arguments:
        reading: the look that said so.
    """
    put_right = _with_reading_right(inquiry, reading)
    near = in_time(None, _near, put_right)
    if near is not None and near.winner is not None:
        told = in_time(reading, _told_beside, inquiry, reading, near.winner)
        if told is not reading:
            reading, put_right, near = told, _with_reading_right(inquiry, told), None
    structure = Discovery.of(put_right.base, put_right.base)
    if near is None or near.winner is None or not is_shown_alone(reading.leader, near.winner):
        structure = in_time(structure, explored, put_right, near)
    findings, search = [reading, *structure.findings], structure.search
    findings, search = in_time((findings, search), in_best_forms, inquiry, findings, search)
    if structure.findings:
        findings, search = in_time((findings, search), reconsidered, inquiry, findings, search)
    return Discovery.of(inquiry.base, search, tuple(findings), structure.last)


def _near(inquiry: Inquiry) -> Look:
    """A look from the re-identified numbers."""
    return look_again(inquiry, inquiry.base.fitted(), [], quick=True)


def _with_reading_right(inquiry: Inquiry, reading: Look) -> Inquiry:
    """Into the model that says what an instrument has wrong."""
    search = reading.leader.search
    given = search.fitted().with_values_of(inquiry.given)
    return evolve(inquiry, unthinned={}, given=given, base=search)


def _told_beside(inquiry: Inquiry, reading: Look, structure: Rival) -> Look:
    """The look with what an instrument has wrong in the form that tells most beside the structure: alone, one that is a little
    off makes do for what that lacks, and beside it leaves what then seems to be still more."""
    if explains(structure.search):
        return reading
    claim, without = reading.leader, structure.search.deviance + reading.leader.drop
    forms = ranked_by_evidence(in_all_forms(inquiry, claim, [structure], structure.search), without)
    if not forms or not _is_much_better(forms[0], claim, structure):
        return reading
    search = inquiry.fit_with(forms[:1], forms[0].search)
    if search is None:
        return reading
    told = rival_of(forms[0].proposal, search, claim.without)
    return reading.led_by(told)


def _is_much_better(form: Rival, claim: Rival, structure: Rival) -> bool:
    """Whether it is another one than what was claimed, and leaves much less beside the structure."""
    is_other = form.proposal.form != claim.proposal.form
    return is_other and form.search.excess < (1.0 - HARDLY_LESS) * structure.search.excess


def _suffices(found: Discovery, base: Search) -> bool:
    """Whether one cause explains everything that most channels tell, or leaves less than a second one would have to explain,
    and next to nothing above the noise, or nothing convinces beside it; or two do that, whatever the noise, and nothing
    convinces beside them."""
    search = found.search
    if len(found.findings) == 1:
        is_last = search.normalised < FLOOR or found.last is not None
        is_little = is_last and leaves_no_second(search, base)
        return explains(search) or (is_little and is_sound(search)) or _is_told_by_most(search)
    is_little = search.normalised < UNEXPLAINED and search.excess < FORM_ERRORS[1] * base.excess
    is_all = found.last is not None and len(found.findings) == 2 and not is_estimated(found.findings)
    is_enough = leave_no_third(found.findings, search, base) or (is_all and is_little)
    return is_enough and not is_strained(search)


def _is_told_by_most(search: Search) -> bool:
    """Whether channels whose noise is told say that nothing is left, where that of others is only an estimate."""
    return is_all_told(search.fitted()) and not is_strained(search)


def cheaper(near: Discovery, wide: Discovery) -> Discovery:
    """What explains more for its numbers; an estimate only gives way to what explains everything, or leaves far less."""
    leaves_alike = wide.search.normalised < BLAMED * near.search.normalised
    if is_estimated(wide.findings) and leaves_alike and not explains(near.search):
        return wide
    return min(
        near, wide, key=lambda one: one.search.deviance + sum(price(r.leader.proposal, one.final) for r in one.findings)
    )


def _where_it_acts(inquiry: Inquiry, found: Discovery) -> Discovery:
    """What was found; where it leaves something, an estimated force at the one place that the equations of motion point to.

    A cause that no law tells, as a joint that another one weakens, is imitated best by laws at other places.
    """
    if not found.leaves_structure:
        return found
    inquiry.progress("looking for the one place at which a force acts", 0.0)
    pointer = outstanding(free_forces(inquiry.workshop, inquiry.given))
    place = pointer.first.place if pointer else None
    if place in (None, *(look.leader.place for look in found.findings)):
        return found
    look = found.findings[0]
    estimate = next((rival for rival in look.rivals if rival.identity == (UNKNOWN, place)), None)
    if estimate is None or estimate.search.normalised > BLAMED * found.search.normalised:
        return found
    others = [rival for rival in look.rivals if rival is not estimate]
    # What the equations say is in no evidence: that is of the recordings, and puts the estimate further down.
    first = led(compared(look, [estimate, *others]))
    return evolve(found, final=estimate.search.fitted(), search=estimate.search, findings=(first,), pointer=pointer)


def _won(base: Search, look: Look) -> Discovery:
    """What a single look says."""
    if look.winner is None:
        return Discovery.of(base, base, (), look)
    return Discovery.of(base, look.winner.search, (look,))


def _found_widely(inquiry: Inquiry, nearby: Nearby) -> Discovery:
    """Look after look, with everything in sight; begun otherwise where that leaves something.

    Where the first look only confirms what was found nearby, no more is asked.
    """
    base, first = _first_look(inquiry, nearby.look)
    inquiry = evolve(inquiry, base=base)
    if nearby.found is not None and _is_confirmed(nearby.found, first):
        return nearby.found
    couple = both(inquiry, first) if first.couples else None
    if couple is not None:
        findings, look = [couple[0]], couple[1]
    else:
        findings, look = in_time(([], first), named_before_unknown, inquiry, first)
    found, last = followed(inquiry, findings, look, nearby.beside)
    if not found.findings or is_estimated(found.findings) or found.search.normalised < UNEXPLAINED:
        return found
    least = min([found.search.deviance, *(rival.search.deviance for rival in last.rivals[:1])])
    beginning = in_time(None, begun_otherwise, inquiry, first, least)
    if beginning is None:
        return found
    other, _ = followed(inquiry, [beginning[0]], beginning[1])
    return min(found, other, key=lambda one: one.search.deviance)


def _is_confirmed(found: Discovery, look: Look) -> bool:
    """Whether a look with everything in sight has the same winner, and that leaves hardly less, or leads to the same two."""
    if look.couples:
        is_all = found.search.normalised < UNEXPLAINED and found.search.deviance < look.couples[0].search.deviance
        return is_all and look.couples[0].claims == {one.leader.identity for one in found.findings}
    if len(found.findings) != 1 or found.search.normalised > UNEXPLAINED or look.winner is None:
        return False
    is_same = look.winner.identity == found.findings[0].leader.identity
    wide, near = look.winner.search, found.search
    return is_same and (near.deviance - wide.deviance < TIE or wide.excess > (1.0 - HARDLY_LESS) * near.excess)


def _first_look(inquiry: Inquiry, near: Look) -> tuple[Search, Look]:
    """The first look, and the best fit of the model as it is, which the winner may show to have been a local optimum."""
    base = inquiry.base
    look = look_again(inquiry, base.fitted(), [], begun=near)
    if look.winner is None:
        return base, look
    better = alone_again(base, [look.winner.search.fitted()])
    gained = base.deviance - better.deviance
    if gained < TIE:
        return base, look
    is_plain = look.winner.drop > gained + NEEDED
    return better, look if is_plain else look_again(evolve(inquiry, base=better), better.fitted(), [])
