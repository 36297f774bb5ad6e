"""Which instruments are believed while the structure is questioned: those that kinematics contradicts come first or last."""

from collections.abc import Mapping, Sequence
from functools import partial

from attrs import evolve

from crashkit.diagnose.claims import propose_all, sensors_read, turns
from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.evidence import FLOOR, UNEXPLAINED, Rival, explains, ranked_by_evidence
from crashkit.diagnose.fitting.in_time import in_time, sooner
from crashkit.diagnose.fitting.reidentify import reidentify
from crashkit.diagnose.fitting.search import STEPS, begin
from crashkit.diagnose.locate.aside import CLOCK, Suspect, late_clocks, on_time, suspects, without
from crashkit.diagnose.locate.consistency import by_run, check_instruments
from crashkit.diagnose.name.contradicted import asked_first, named_nevertheless
from crashkit.diagnose.name.explore import beside_reading, cheaper, explored
from crashkit.diagnose.name.follow import Discovery, followed, leaves_no_second
from crashkit.diagnose.name.forms import in_all_forms, in_best_forms
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import LEAST_DROP, Look, compared, look_again
from crashkit.diagnose.name.rivals import CONCEALED
from crashkit.diagnose.name.settle import in_one_number, settled
from crashkit.diagnose.name.vanished import told_by_vanished
from crashkit.protocols import Proposal

ALIKE = 3
"""How many other causes that explain what the instruments that agree say are asked beside what is wrong with the others."""
FOR_STRUCTURE = 0.6
"""Of the time for questions: what the instruments that agree may be asked before it is asked what is wrong with the others."""


def discover(inquiry: Inquiry, looks: Sequence[Look], stand: bool = False) -> Discovery:
    """All findings that the evidence supports, each in the light of the others, and at last in its best form.

    A plain form may leave no more than chance would, and another still be far more evident: what it foretells is better.

    Arguments:
        looks: whose claims are asked first, if there are any.
        stand: whether nothing contradicts these.
    """
    found = _instruments_first(inquiry, looks, stand)
    found = in_time(found, told_by_vanished, inquiry, found)
    if not explains(found.search):
        return found
    findings, search = list(found.findings), found.search
    if len(findings) > 1:
        findings, search = in_time((findings, search), in_one_number, inquiry, findings, search)
    findings, search = in_time((findings, search), in_best_forms, inquiry, findings, search, thorough=True)
    return evolve(found, findings=tuple(findings), search=search, final=search.fitted())


def _instruments_first(inquiry: Inquiry, looks: Sequence[Look], stand: bool) -> Discovery:
    found = asked_first(inquiry, looks, stand)
    if found is not None:
        return found
    checks = check_instruments(by_run(inquiry.given))
    if late := late_clocks(checks):
        found = _with_clock(inquiry, late)
    elif set_aside := suspects(inquiry.given, checks):
        found = _beside(inquiry, set_aside)
    found = found or explored(inquiry)
    return in_time(found, named_nevertheless, inquiry, looks, found)


def _beside(inquiry: Inquiry, set_aside: tuple[Suspect, ...]) -> Discovery | None:
    """What the instruments that agree say of the structure, and then what is wrong with the others; None if that fails.

    If they say what all of them read, as of a body that turns, all are asked of that.
    """
    workshop, given = inquiry.workshop, inquiry.given
    rest = workshop.first_misfit(given.model, without(given.recordings, set_aside)).with_prior(given.prior.std)
    if not rest.groups:
        return None
    base, progress = reidentify(workshop, rest), sooner(inquiry.progress, FOR_STRUCTURE)
    structure = in_time(Discovery.of(base, base), explored, Inquiry(workshop, rest, base, progress))
    told = _seen_by_all(inquiry, structure)
    if told is None:
        return None
    if any(map(_says_what_sensors_read, structure.findings)):
        return in_time(told, _read_by_all, inquiry, structure) or in_time(told, explored, inquiry)
    wrong = _with_what_is_wrong(inquiry, structure, told, set_aside)
    if wrong is None:
        return in_time(told, explored, inquiry)
    wrong = in_time(wrong, _or_another, inquiry, wrong, structure, set_aside)
    more = in_time(wrong, _with_more, inquiry, wrong)
    return in_time(more, _or_turning, inquiry, more, structure)


def _seen_by_all(inquiry: Inquiry, structure: Discovery) -> Discovery | None:
    """What the instruments that agree say, fitted to all of them; None if it has no place there."""
    search = inquiry.fit_with([look.leader for look in structure.findings], structure.search)
    return Discovery.of(inquiry.base, search, structure.findings) if search else None


def _or_another(inquiry: Inquiry, told: Discovery, structure: Discovery, waiting: tuple[Suspect, ...]) -> Discovery:
    """What was told, or, where that leaves something, with another cause that explains what the instruments that agree say:
    these may be too few to tell which it is."""
    if told.search.normalised < UNEXPLAINED or len(structure.findings) != 1:
        return told
    others = [rival for rival in structure.findings[0].rivals[1:] if explains(rival.search) and not turns(rival.proposal)]
    for rival in others[:ALIKE]:
        another = _led_by(structure, rival)
        seen = _seen_by_all(inquiry, another)
        other = _with_what_is_wrong(inquiry, another, seen, waiting) if seen else None
        told = cheaper(told, other) if other else told
    return told


def _led_by(structure: Discovery, rival: Rival) -> Discovery:
    """The same with its one finding led by a rival instead of the first, which leaves something of all instruments."""
    look = structure.findings[0]
    others = [one for one in look.rivals[1:] if one is not rival]
    return evolve(structure, search=rival.search, findings=(compared(look, [rival, *others]),))


def _with_more(inquiry: Inquiry, told: Discovery) -> Discovery:
    """What all instruments say of the structure once one is put right, where those that agree had said nothing of it and that
    leaves something: a film may see too little."""
    if len(told.findings) != 1 or told.search.normalised < UNEXPLAINED:
        return told
    more = beside_reading(inquiry, told.findings[0])
    return more if more.search.normalised < UNEXPLAINED else told


def _or_turning(inquiry: Inquiry, told: Discovery, structure: Discovery) -> Discovery:
    """What was told in several findings, or instead that a body turns, where the instruments that agree say that as well as
    what they told: the others may be wrong only in that they read it."""
    turning = _as_turning(structure) if len(told.findings) > 1 else None
    instead = turning and _read_by_all(inquiry, turning)
    return cheaper(told, instead) if instead else told


def _as_turning(structure: Discovery) -> Discovery | None:
    """The same with its one finding led by a body that turns, if that explains everything, too."""
    if len(structure.findings) != 1:
        return None
    rivals = structure.findings[0].rivals[1:]
    turning = [rival for rival in rivals if turns(rival.proposal) and explains(rival.search)]
    return _led_by(structure, turning[0]) if turning else None


def _with_what_is_wrong(
    inquiry: Inquiry, structure: Discovery, told: Discovery, waiting: tuple[Suspect, ...]
) -> Discovery | None:
    """What was told, and what is wrong with the sensors that wait; None where nothing is, and they still contradict that.

    They are asked where those that agree have led the model's numbers: a fit to all has bent them to what is wrong.

    Arguments:
        structure: what those that agree say, fitted to them.
        told: the same, fitted to all.
    """
    inquiry = evolve(inquiry, given=inquiry.given.with_values_of(structure.search.fitted()))
    findings, search = list(told.findings), told.search
    while waiting:
        found, concerns = [look.leader for look in findings], partial(_concern, waiting)
        look = in_time(None, look_again, inquiry, search.fitted(), found, concerns)
        # That they are wrong is certain: what they must explain is no matter of how far the form of a law may be off.
        look = look and evolve(look, least=LEAST_DROP)
        if look is None or (look.winner is None and search.normalised <= FLOOR):
            break
        if look.winner is None:
            return None
        is_told = any(one.told and one.concerns(look.winner.proposal) for one in waiting)
        findings.append(look if is_told else in_time(look, settled, inquiry, look, look.winner, found))
        search = findings[-1].leader.search
        waiting = _still_waiting(waiting, look)
    return Discovery.of(inquiry.base, search, tuple(findings))


def _read_by_all(inquiry: Inquiry, structure: Discovery) -> Discovery | None:
    """What is found beside a body that turns, once all its sensors say so; None where they do not.

    They are asked where those that agree have led the model's numbers: the fit of all of them without it is far from there.
    """
    turning = next(filter(_says_what_sensors_read, structure.findings))
    others = [look for look in structure.findings if look is not turning]
    rest = inquiry.fit_with([look.leader for look in others], structure.search)
    if rest is None:
        return None
    forms = in_all_forms(inquiry, turning.leader, [look.leader for look in others], structure.search)
    rivals = ranked_by_evidence(forms, rest.deviance)
    if not rivals or rivals[0].search.normalised > CONCEALED:
        return None
    findings = [*others, Look.of(rivals[:1], rest.fitted(), len(turning.rivals))]
    search = rivals[0].search
    is_quick = len(findings) == 1 and leaves_no_second(search, inquiry.base)
    look = in_time(None, look_again, inquiry, search.fitted(), [one.leader for one in findings], quick=is_quick)
    return followed(inquiry, findings, look)[0] if look else Discovery.of(inquiry.base, search, tuple(findings))


def _still_waiting(waiting: Sequence[Suspect], look: Look) -> tuple[Suspect, ...]:
    """Whom a finding does not clear."""
    still = [one.besides(look.leader.proposal) for one in waiting]
    return tuple(one for one in still if one is not None)


def _says_what_sensors_read(look: Look) -> bool:
    return bool(sensors_read(look.leader.proposal))


def _concern(waiting: Sequence[Suspect], proposal: Proposal) -> bool:
    """Whether a proposal says what a sensor of one of these reads."""
    return any(suspect.concerns(proposal) for suspect in waiting)


def _with_clock(inquiry: Inquiry, late: Mapping[str, float]) -> Discovery | None:
    """A clock that is wrong, and then what all instruments say of the structure once that is right; None if none is."""
    clock = _clock(inquiry, late)
    is_certain = len(late) == 1 and clock.rivals
    return beside_reading(inquiry, clock) if clock.winner or is_certain else None


def _clock(inquiry: Inquiry, late: Mapping[str, float]) -> Look:
    """Which of these clocks is wrong: the model is re-identified with the stamps of one or the other put right.

    Of a single one kinematics are certain, even where a model that something else is missing from bends to the wrong stamps.
    """
    workshop, given, current = inquiry.workshop, inquiry.given, inquiry.base.fitted()
    claims = [p for p in propose_all(workshop, current, CLOCK) if p.location["instrument"] in late]
    put_right = {instrument: _put_right(inquiry, instrument, lateness) for instrument, lateness in late.items()}
    fitted = []
    for claim in claims:
        instrument = str(claim.location["instrument"])
        values = {**put_right[instrument], claim.parameters[0]: late[instrument]}
        misfit = workshop.misfit(given, claim.model).with_values(values)
        fitted.append(Candidate(claim, begin(workshop.identifier, misfit).advance(STEPS)))
    ranked = ranked_by_evidence(fitted, inquiry.base.deviance)
    return Look(tuple(ranked[:1]), (1.0,), 0.0, current) if len(late) == 1 else Look.of(ranked, current)


def _put_right(inquiry: Inquiry, instrument: str, late: float) -> Mapping[str, float]:
    """The model's numbers as re-identified with the stamps of one instrument put right."""
    right = inquiry.workshop.first_misfit(inquiry.given.model, on_time(inquiry.given.recordings, instrument, late))
    search = reidentify(inquiry.workshop, right.with_prior(inquiry.given.prior.std))
    return search.values
