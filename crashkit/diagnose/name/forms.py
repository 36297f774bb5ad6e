"""Every finding in its best form: one that was found first had to make do for those that came after it."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np
from attrs import evolve

from crashkit.campaign import spread
from crashkit.diagnose.claims import Start, first_of_each, identity, propose_all
from crashkit.diagnose.fitting.back_to_given import begun_from_given
from crashkit.diagnose.fitting.candidates import Candidate, advance_candidates, begin_candidates, weigh_candidates
from crashkit.diagnose.fitting.evidence import Rival, explains, is_at_noise, is_unknown, ranked_by_evidence, rival_of
from crashkit.diagnose.fitting.search import Search, begin, meet
from crashkit.diagnose.name.force_matching import most_alike
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

End = tuple[Mapping[str, float], float]
"""Where numbers go, and what they leave there."""
SHARES = (1 / 6, 1 / 3, 2 / 3, 1.0)
"""Of the time recorded, looked at one after the other while only a form's own numbers move."""
ALONE = 10
"""Steps in each."""
MOVED = 0.5
"""Of what is left above the noise: a form that leaves less has moved all numbers, and others may fit from there."""
FURTHER = 4
"""Forms that are then searched for further, where their own numbers have not met: those that leave least."""
HEATS = ((None, 4, 8), (8, 2, 10), (4, 1, 30))
"""How many forms enter each, from how many starts, and how many steps each gets."""


def in_best_forms(
    inquiry: Inquiry, findings: Sequence[Look], search: Search, thorough: bool = False
) -> tuple[list[Look], Search]:
    """The findings, each in the form that is most evident beside the others, and the fit with them.

    Arguments:
        search: the fit with them.
        thorough: whether forms are questioned where that leaves nothing, too; those that were for this fit are not again.
    """
    looks = list(findings)
    for index, look in enumerate(findings):
        if is_unknown(look.leader) or look.formed is search or (explains(search) and not thorough):
            continue
        others = [other.leader for other in looks if other is not look]
        best, forms = _best_form(inquiry, look.leader, others, search)
        if best.search.excess < MOVED * search.excess and not is_at_noise(best.search):
            best, forms = _best_form(inquiry, best, others, best.search)
        if best.evidence > look.leader.evidence:
            seen = _as_seen(inquiry.workshop, look, best)
            look, search = look.led_by(seen), best.search
        looks[index] = evolve(look, formed=search, forms=tuple(forms))
    return looks, search


def _best_form(inquiry: Inquiry, rival: Rival, others: Sequence[Rival], search: Search) -> tuple[Rival, list[Candidate]]:
    """A claim in its best form beside others, and the fits of all."""
    without = search.deviance + rival.drop
    forms = in_all_forms(inquiry, rival, others, search)
    present = Candidate(rival.proposal, search)
    return _eased(inquiry, ranked_by_evidence([*forms, present], without)[0], without), forms


def _eased(inquiry: Inquiry, rival: Rival, without: float) -> Rival:
    """The rival, or, where it leaves something, from where the numbers of some joint are as they were given."""
    search = rival.search if explains(rival.search) else begun_from_given(rival.search, inquiry.given)
    return rival if search is rival.search else rival_of(rival.proposal, search, without)


def _as_seen(workshop: Workshop, look: Look, rival: Rival) -> Rival:
    """The rival fitted to what its look was made at, from which instruments may have been set aside that are now believed."""
    names, before = ([channel.name for channel in one.channels] for one in (rival.search.misfit, look.before))
    if names == before:
        return rival
    fitted = rival.search.fitted()
    misfit = workshop.equipped([fitted.model]).misfit(look.before, fitted.model)
    return evolve(rival, search=begin(workshop.identifier, misfit).advance(ALONE))


def in_all_forms(inquiry: Inquiry, rival: Rival, others: Sequence[Rival], search: Search) -> list[Candidate]:
    """Fits of a claim in all its forms, from where its present one, or what stands in for it, has driven all other numbers."""
    doing = f"fitting all forms of {rival.proposal.physics}"
    inquiry.progress(doing, 0.0)
    without = inquiry.fit_with(others, search)
    if without is None:
        return []
    origin, found = without.misfit.with_values_of(search.fitted()), search.values
    proposed = propose_all(inquiry.workshop, origin, rival.proposal.physics)
    forms = [proposal for proposal in proposed if identity(proposal) == rival.identity]
    if len(forms) < 2 and all(path in found for form in forms for path in form.parameters):
        return []
    equipped = inquiry.workshop.equipped([form.model for form in forms])
    starts = [(form, {**form.null, **start}) for form in forms for start in _starts(form, rival.proposal, found)]
    told = partial(inquiry.progress, doing)
    ahead = _ahead(equipped, origin, search.fitted(), starts, told)
    misfits = [with_form(equipped, origin, form, values) for (form, _), values in zip(starts, ahead, strict=True)]
    return _fitted(begin_candidates(equipped.identifier, [form for form, _ in starts], misfits))


def _ahead(
    workshop: Workshop, origin: Misfit, present: Misfit, starts: Sequence[Start], told: Callable[[float], None]
) -> list[Mapping[str, float]]:
    """Where the own numbers of forms go from each start while all others stay: of all quickly, of those that then leave least
    further."""
    half = 0.5 / len(starts)
    near = spread(partial(_alone, workshop, origin, present), starts, lambda done: told(half * done))
    leading = _leading(starts, near)

    def further(one: tuple[Start, list[End]]) -> list[End]:
        start, ends = one
        return _by_and_by(workshop, origin, start, ends) if start[0].form in leading else ends

    far = spread(further, list(zip(starts, near, strict=True)), lambda done: told(0.5 + half * done))
    return [min(ends, key=lambda end: end[1])[0] for ends in far]


def _leading(starts: Sequence[Start], ends: Sequence[Sequence[End]]) -> list[str]:
    """The forms that leave least."""
    costs: dict[str, float] = {}
    for (form, _), each in zip(starts, ends, strict=True):
        costs[form.form] = min(costs.get(form.form, np.inf), *(cost for _, cost in each))
    return sorted(costs, key=lambda form: costs[form])[:FURTHER]


def _fitted(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Each form from the best of its starts: in a common heat, those of one form would take all places."""
    for forms, starts, steps in HEATS:
        ranked = _apart(sorted(candidates, key=lambda one: one.priced))
        leading = list(dict.fromkeys(one.proposal.form for one in ranked))[:forms]
        ahead = first_of_each([one for one in ranked if one.proposal.form in leading], starts)
        candidates = advance_candidates(ahead, steps)
    return weigh_candidates(candidates)


def _apart(ranked: Sequence[Candidate]) -> list[Candidate]:
    """One of those of one form that meet in one optimum."""
    apart: list[Candidate] = []
    for one in ranked:
        alike = [other for other in apart if other.proposal.form == one.proposal.form]
        if not any(meet([other.search.state.cost, one.search.state.cost]) for other in alike):
            apart.append(one)
    return apart


def _starts(form: Proposal, present: Proposal, found: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
    """Of the present form also where it stands; numbers of the same name may lead another form back to what this one does."""
    stands = form.form == present.form and found.keys() >= set(form.parameters)
    return [*form.starts, found] if stands else form.starts


def _alone(workshop: Workshop, origin: Misfit, present: Misfit, start: Start) -> list[End]:
    """Where a form's own numbers go while all others stay: from its start, and, where the bodies are the same, from where it
    acts most like the present form."""
    form, values = start
    begun = [values]
    if {body.name for body in form.model.bodies} == {body.name for body in present.model.bodies}:
        other = with_form(workshop, origin, form, values)
        begun.append(most_alike(present, other, form.parameters, workshop.laws))
    return [along(workshop, origin, (form, one), SHARES[-1:]) for one in begun]


def _by_and_by(workshop: Workshop, origin: Misfit, start: Start, ends: Sequence[End]) -> list[End]:
    """Besides, if these ends do not meet, as far as the first instants tell the form's numbers, and on; and with those of its
    joint."""
    form, _ = start
    here = tuple(f"joint.{name}." for key, name in form.location.items() if key == "joint")
    further = [] if meet([cost for _, cost in ends]) else [along(workshop, origin, start, SHARES)]
    return [*ends, *further, *([along(workshop, origin, start, SHARES[-1:], here)] if here else [])]


def along(workshop: Workshop, origin: Misfit, start: Start, route: Sequence[float], here: tuple[str, ...] = ()) -> End:
    """Where a form's own numbers go, and those whose paths begin with `here`, and what they leave there."""
    (form, values), cost = start, np.inf
    for early in (origin.coarse.up_to(share) for share in route):
        if early.groups:
            misfit = with_form(workshop, early, form, values)
            alone = misfit.with_values({}, free={n: n in form.parameters or n.startswith(here) for n in misfit.names})
            search = begin(workshop.identifier, alone).advance(ALONE)
            values, cost = {**values, **alone.values(search.point)}, search.state.cost
    return values, cost


def with_form(workshop: Workshop, origin: Misfit, form: Proposal, values: Mapping[str, float]) -> Misfit:
    """The misfit of a form at these values, and at those of `origin` for the rest."""
    misfit = workshop.misfit(origin, form.model).with_values_of(origin)
    return misfit.with_values({name: value for name, value in values.items() if name in misfit.names})
