"""Effects come in twos: name the strongest, look again at what is left, then question each in the light of the others."""

from collections.abc import Sequence

from attrs import evolve, field, frozen

from crashkit.diagnose.claims import accuses_instrument
from crashkit.diagnose.fitting.evidence import (
    FLOOR,
    UNEXPLAINED,
    Rival,
    explains,
    is_sound,
    is_unknown,
    ranked_by_evidence,
    rival_of,
)
from crashkit.diagnose.fitting.in_time import in_time
from crashkit.diagnose.fitting.rebuild import alone_again
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.fitting.thresholds import wakened
from crashkit.diagnose.locate.free_force import Pointer
from crashkit.diagnose.name.exchange import exchanged, in_its_stead
from crashkit.diagnose.name.forms import in_all_forms, in_best_forms
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import FORM_ERRORS, READINGS, Look, compared, look_again
from crashkit.diagnose.name.pace import check_pace
from crashkit.diagnose.name.pairs import named_beside
from crashkit.diagnose.name.pointed import with_better_pointed_to
from crashkit.diagnose.name.settle import settled
from crashkit.diagnose.name.tied import untied
from crashkit.misfit import Misfit
from crashkit.model import Model

MOST_FINDINGS = 3
FREED = 0.5
"""Of what one more finding explains: where those before it, freed by it, do that as well, it is none."""
COMPLETING = 0.5
"""Of what is left above the noise: a claim that leaves more has hardly found its form."""
LEFT = 0.15
"""Of what is left above the noise: a second claim that leaves less of it tells more than a form that is off."""
ESTIMATE_SHARE = 0.1
"""Of what the findings explain: an estimate that explains less beside them imitates how far their forms are off."""
TRACE = 0.003
"""Of what is left above the noise without a finding, or without any: no form of what is gross is quite right."""
LEAST_THIRD = READINGS * FORM_ERRORS[1]
"""Of what was explained: the least that any third finding must explain."""
ALMOST_ALL = 0.2
"""Of what is left above the noise: a claim that leaves more of it is hardly all there is, in whatever form."""
NEEDED = 100.0
"""Chi squared that the loss of a finding must cost for it to be plainly needed."""
TIE = 10.0
"""Chi squared by which two explanations may differ and still count as equally good."""


@frozen
class Discovery:
    """Everything that was found.

    Attributes:
        base: the misfit of the given model, re-identified.
        final: the misfit of the augmented model, at its best fit.
        search: that fit.
        findings: for each finding, the look that it won in the light of all the others.
        last: the look that found nothing more.
        pointer: to the place of an estimated force, where the equations of motion told it.
    """

    base: Misfit
    final: Misfit
    search: Search
    findings: tuple[Look, ...] = field(default=())
    last: Look | None = None
    pointer: Pointer | None = None

    @classmethod
    def of(cls, base: Search, search: Search, findings: tuple[Look, ...] = (), last: Look | None = None) -> "Discovery":
        """What was found, where the fits of the given and of the augmented model end."""
        return cls(base.fitted(), search.fitted(), search, findings, last)

    @property
    def leaves_structure(self) -> bool:
        """Whether findings about the structure alone plainly leave something: along the measured motion there is more to ask.
        About instruments that are wrong the equations of motion say nothing."""
        claims = [look.leader.proposal for look in self.findings]
        return bool(claims) and self.search.normalised >= UNEXPLAINED and not any(map(accuses_instrument, claims))


def followed(inquiry: Inquiry, begun: Sequence[Look], look: Look, near: Look | None = None) -> tuple[Discovery, Look]:
    """What is found from a beginning on, and the last look.

    Arguments:
        near: a look beside a single finding from its numbers, if one was made already; where it was at just this model, the
            next look begins with it.
    """
    findings, search = list(begun), begun[-1].leader.search if begun else inquiry.base
    look = in_time(look, named_beside, inquiry, look, findings)
    while look.winner is not None and _is_another(look.winner, findings) and not _are_enough(findings, search, inquiry.base):
        freed = _freed(findings, search, look.winner)
        findings, search = freed or with_one_more(inquiry, findings, look, look.winner)
        if _are_enough(findings, search, inquiry.base):
            break
        further = in_time(None, _look_beside, inquiry, search, findings, near)
        if further is None:
            break
        look = in_time(further, named_beside, inquiry, further, findings)
        completed = in_time(None, _completed, inquiry, findings, search, look)
        if completed is not None:
            findings, search = completed
            break
    if len(findings) == 2 and not is_estimated(findings):
        findings, search = in_time((findings, search), untied, inquiry, findings, search)
    if len(findings) > 1 and not leave_a_trace(findings, search, inquiry.base):
        findings, search = in_time((findings, search), _questioned, inquiry, findings, search, look)
    last = look if look.winner is None else None
    return Discovery.of(inquiry.base, search, tuple(findings), last), look


def _look_beside(inquiry: Inquiry, search: Search, findings: Sequence[Look], near: Look | None) -> Look:
    """A look at what is left beside the findings; one that was made near there is not made again."""
    is_there = near is not None and near.before.names == search.misfit.names and _was_asked(near, search)
    if near is not None and is_there and near.is_wide:
        return near
    return look_again(inquiry, search.fitted(), [one.leader for one in findings], begun=near if is_there else None)


def _are_enough(findings: Sequence[Look], search: Search, base: Search) -> bool:
    """Whether no further finding is looked for beside these."""
    return len(findings) == MOST_FINDINGS or is_estimated(findings) or leave_no_third(findings, search, base)


def leave_a_trace(findings: Sequence[Look], search: Search, base: Search) -> bool:
    """Whether two named findings leave but a trace of what is gross, from which no third could be told: so much is forms."""
    is_trace = search.normalised > FLOOR and search.excess < LEAST_THIRD * base.excess
    return len(findings) == 2 and not is_estimated(findings) and is_trace


def leave_no_third(findings: Sequence[Look], search: Search, base: Search) -> bool:
    """Whether a third finding could not be told beside two named ones, of which the form of one may be off or not."""
    return leave_a_trace(findings, search, base) or _are_all(findings, search, base)


def _are_all(findings: Sequence[Look], search: Search, base: Search) -> bool:
    """Whether two named findings leave at most what is hardly above the noise, of what is so gross that it has no room for as
    much as a third would have to explain."""
    is_gross = FLOOR**2 - 1.0 < TRACE * base.excess
    return len(findings) == 2 and not is_estimated(findings) and is_gross and search.normalised <= FLOOR and is_sound(search)


def is_but_a_trace(search: Search, base: Search) -> bool:
    """Whether a fit leaves less of what another leaves than a claim beside it would have to explain."""
    return search.excess < TRACE * base.excess


def leaves_no_second(search: Search, base: Search) -> bool:
    """Whether one finding leaves less of what was left without it than a second one would have to explain."""
    return search.excess < FORM_ERRORS[0] * base.excess


def _freed(findings: Sequence[Look], search: Search, winner: Rival) -> tuple[list[Look], Search] | None:
    """The findings fitted from where one more has moved their numbers, if they then explain most of what that does.

    What is caught in a local optimum leaves something that any second cause would seem to explain.
    """
    if not findings:
        return None
    better = alone_again(search, [winner.search.fitted()])
    gained = search.deviance - better.deviance
    if gained < FREED * winner.drop:
        return None
    last = findings[-1]
    return [*findings[:-1], last.led_by(last.leader.improved(better, gained))], better


def with_one_more(inquiry: Inquiry, findings: Sequence[Look], look: Look, winner: Rival) -> tuple[list[Look], Search]:
    """The findings with the winner of a look, settled, and each in its best form; or with a better one that an estimate points
    to, where that leaves far less."""
    more, search = _with_winner(inquiry, findings, look, winner)
    pointed = in_time(look, with_better_pointed_to, inquiry, look, search) if findings else look
    better = pointed.winner
    if pointed is look or better is None or is_unknown(better) or better.search.deviance > search.deviance:
        return more, search
    return _with_winner(inquiry, findings, pointed, better)


def _with_winner(inquiry: Inquiry, findings: Sequence[Look], look: Look, winner: Rival) -> tuple[list[Look], Search]:
    found = [one.leader for one in findings]
    more = [*findings, in_time(look, settled, inquiry, look, winner, found)]
    search = more[-1].leader.search
    more, search = in_time((more, search), in_its_stead, inquiry, more, search)
    beside = _forms_of(more[:-1])
    more, search = in_time((more, search), in_best_forms, inquiry, more, search)
    if _forms_of(more[:-1]) != beside:
        more, search = in_time((more, search), _settled_again, inquiry, more, search)
    if not is_estimated(more):
        check_pace(inquiry, evolve(more[-1].leader, search=search), more[:-1])
    return more, search


def _forms_of(findings: Sequence[Look]) -> list[str]:
    return [look.leader.proposal.form for look in findings]


def _settled_again(inquiry: Inquiry, findings: Sequence[Look], search: Search) -> tuple[list[Look], Search]:
    """The findings with the last settled beside the others as they are now.

    Beside a first cause in a form that is off, the wrong one of two alike may have made up for that.
    """
    *others, last = findings
    found = [look.leader for look in others]
    without = inquiry.fit_with(found, search)
    if without is None or is_unknown(last.leader):
        return list(findings), search
    present = rival_of(last.leader.proposal, search, without.deviance)
    look = settled(inquiry, compared(evolve(last, before=without.fitted()), [present]), present, found)
    if look.leader.identity == last.leader.identity:
        return list(findings), search
    return in_best_forms(inquiry, [*others, look], look.leader.search)


def _completed(inquiry: Inquiry, findings: Sequence[Look], search: Search, look: Look) -> tuple[list[Look], Search] | None:
    """The findings and the best known claim of a look that convinced of none, if together, each in its best form, they leave
    next to nothing; None if not.

    Beside a gross effect a second one in a form that is off explains too little to convince.
    """
    found = [one.leader for one in findings]
    known = {rival.place for rival in found}
    claim = next((rival for rival in look.rivals if not is_unknown(rival)), None)
    if look.winner is not None or claim is None or search.normalised < UNEXPLAINED:
        return None
    if claim.place in known or claim.search.excess > COMPLETING * search.excess:
        return None
    forms = ranked_by_evidence(in_all_forms(inquiry, claim, found, claim.search), search.deviance)
    best = max([claim, *forms], key=lambda rival: rival.evidence)
    others = [rival for rival in look.rivals if rival.identity != best.identity]
    tried = settled(inquiry, compared(look, [best, *others]), best, found)
    more, end = in_best_forms(inquiry, [*findings, tried], tried.leader.search)
    return (more, end) if complete(end, search) else None


def complete(end: Search, without: Search) -> bool:
    """Whether a fit leaves nothing, or next to nothing, where another plainly left something: a law elsewhere hardly tells how
    far a form is off as well as that, however little it is beside the first finding."""
    is_little = end.normalised < UNEXPLAINED and end.excess < LEFT * without.excess
    return without.normalised >= UNEXPLAINED and (is_little or explains(end))


def _questioned(inquiry: Inquiry, findings: list[Look], search: Search, last: Look) -> tuple[list[Look], Search]:
    """Several findings, each in the light of the others."""
    begun = findings
    findings, search = exchanged(inquiry, findings, search, last) or (findings, search)
    findings, search = reconsidered(inquiry, findings, search)
    if [id(look) for look in findings] == [id(look) for look in begun]:
        return findings, search
    return in_best_forms(inquiry, findings, search)


def reconsidered(inquiry: Inquiry, findings: list[Look], search: Search) -> tuple[list[Look], Search]:
    """Takes each finding away in turn, and lets all hypotheses compete again for its place beside the others.

    The first that was found had to make do for all of them, and is often only the best stand-in. Where everything is explained
    and nothing can be spared, there is nothing to question; nor is the same asked twice.
    """
    looks = list(findings)
    for claim in [look.leader.identity for look in findings]:
        place = [look.leader.identity for look in looks].index(claim)
        rest = [*looks[:place], *looks[place + 1 :]]
        without = _spared(inquiry, [look.leader for look in rest], search)
        if without is None:
            continue
        if explains(search) and without.excess > ALMOST_ALL * inquiry.base.excess:
            continue
        rest, without = in_best_forms(inquiry, rest, without)
        is_all = search.normalised < FLOOR or search.excess < TRACE * without.excess
        is_needed = is_all and without.deviance > search.deviance + NEEDED
        if is_needed or _was_asked(looks[place], without):
            continue
        look = look_again(inquiry, without.fitted(), [one.leader for one in rest])
        if look.winner is None or _corrects(look.winner, rest):
            if without.deviance < search.deviance + look.least and not complete(search, without):
                looks, search = rest, without
        elif look.winner.search.deviance < search.deviance + TIE:
            looks, search = [*rest[:place], look, *rest[place:]], look.winner.search
    return looks, search


def _spared(inquiry: Inquiry, rest: Sequence[Rival], search: Search) -> Search | None:
    """The fit with the other findings alone, which may reach thresholds that one that stood in for them had kept asleep."""
    near = inquiry.fit_with(rest, search)
    return near if near is None or not rest else wakened(inquiry.workshop, near)


def _is_another(winner: Rival, findings: Sequence[Look]) -> bool:
    """Whether the winner of a look is one more finding, and no estimate of how far the forms of the others are off."""
    return not _corrects(winner, findings) and not _is_one_too_many(winner, findings)


def _corrects(winner: Rival, findings: Sequence[Look]) -> bool:
    """A table at the place of a named finding says how far the form of that is off, not that there is more."""
    places = [look.leader.place for look in findings]
    return is_unknown(winner) and winner.place in places


def _is_one_too_many(winner: Rival, findings: Sequence[Look]) -> bool:
    """Whether it is an estimate beside named findings that explains but a little beside them, or that is the third and leaves
    something even so: forms that are off look like a further cause, and a table imitates them best."""
    if not findings or not is_unknown(winner):
        return False
    is_little = winner.drop < ESTIMATE_SHARE * sum(look.leader.drop for look in findings)
    return is_little or (len(findings) == MOST_FINDINGS - 1 and winner.search.normalised > UNEXPLAINED)


def is_estimated(findings: Sequence[Look]) -> bool:
    """Beside a force that is only estimated nothing more can be named: what is left is mostly how coarse the estimate is."""
    return bool(findings) and is_unknown(findings[-1].leader)


def _was_asked(look: Look, without: Search) -> bool:
    """Whether the look was made at just this model, at a fit that is as good."""
    before = look.before
    is_same = _anatomy(before.model) == _anatomy(without.misfit.model)
    return is_same and before.deviance(before.residual(before.start())) < without.deviance + TIE


def _anatomy(model: Model) -> list[tuple[str, tuple[str, ...], list[str]]]:
    """The joints of a model and their laws, whatever their numbers."""
    return [(joint.name, (joint.law, *joint.factors), sorted(joint.parameters)) for joint in model.joints]
