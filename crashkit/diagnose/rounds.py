"""Effects come in twos: name the strongest, look again at what is left, then question each in the light of the others."""

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from attrs import evolve, field, frozen

from crashkit.diagnose.aside import Suspect, suspects, without
from crashkit.diagnose.contest import Progress, identity
from crashkit.diagnose.name import FLOOR, Limit, Rival, again, best_forms, fit_rivals, probabilities, propose_all
from crashkit.diagnose.rebuild import rebuild, without_winner
from crashkit.diagnose.reidentify import reidentify
from crashkit.diagnose.result import UNKNOWN, place_of
from crashkit.diagnose.search import Search
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Proposal

MOST_FINDINGS = 3
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
NEEDED = 100.0
"""Chi squared that the loss of a finding must cost for it to be plainly needed."""
TIE = 10.0
"""Chi squared by which two explanations may differ and still count as equally good."""


@frozen
class Round:
    """One look at what is left: the rivals in order, their probabilities, that of nothing, the misfit before, how much of
    chi squared a finding must at least explain, and the smallest effects that would have been seen."""

    rivals: tuple[Rival, ...]
    probabilities: tuple[float, ...]
    nothing: float
    before: Misfit
    least: float = LEAST_DROP
    limits: tuple[Limit, ...] = field(default=())

    @property
    def winner(self) -> Rival | None:
        """The rival that convinces, if one does."""
        if not self.rivals or self.nothing >= CHANCE:
            return None
        first = self.rivals[0]
        is_of_readings = not {"sensor", "instrument"}.isdisjoint(first.proposal.location)
        least = max(LEAST_DROP, READINGS * self.least) if is_of_readings else self.least
        return first if first.drop > least else None


@frozen
class Discovery:
    """Everything that was found.

    Attributes:
        base: the misfit of the given model, re-identified.
        final: the misfit of the augmented model, at its best fit.
        search: that fit.
        rounds: for each finding, the round that it won in the light of all the others.
        last: the round that found nothing more.
    """

    base: Misfit
    final: Misfit
    search: Search
    rounds: tuple[Round, ...] = field(default=())
    last: Round | None = None


def discover(workshop: Workshop, given: Misfit, base_search: Search, progress: Progress) -> Discovery:
    """All findings that the evidence supports, each in the light of the others.

    Arguments:
        given: the misfit of the model at the values that the user gave.
        base_search: its best fit.
    """
    set_aside = suspects(given)
    found = _beside(workshop, given, base_search, set_aside, progress) if set_aside else None
    return found or _discovered(workshop, given, base_search, progress)


def _beside(
    workshop: Workshop, given: Misfit, base_search: Search, set_aside: tuple[Suspect, ...], progress: Progress
) -> Discovery | None:
    """What the instruments that agree say of the structure, and then what is wrong with the others; None if nothing is."""
    rest = workshop.first_misfit(given.model, without(given.recordings, set_aside)).with_prior(given.prior.std)
    if not rest.groups:
        return None
    structure = _discovered(workshop, rest, reidentify(workshop.identifier, workshop.finder, rest), progress)
    rounds = list(structure.rounds)
    search = rebuild(workshop, base_search, [look.rivals[0] for look in rounds], structure.search)
    if search is None:
        return None
    seen = structure.search.misfit.values(structure.search.point)
    unbent = given.with_values({name: seen[name] for name in given.names if name in seen})
    for suspect in set_aside:
        found = [look.rivals[0] for look in rounds]
        look = _look(workshop, unbent, search.fitted(), found, progress, suspect.concerns)
        if look.winner is None:
            return None
        rounds.append(_settled(workshop, unbent, look, look.winner, progress))
        search = rounds[-1].rivals[0].search
    return Discovery(base_search.fitted(), search.fitted(), search, tuple(rounds))


def _discovered(workshop: Workshop, given: Misfit, base_search: Search, progress: Progress) -> Discovery:
    """Round after round, with everything in sight."""
    base_search, look = _first_look(workshop, given, base_search, progress)
    rounds, look = _named_before_unknown(workshop, given, base_search, look, progress)
    search = base_search
    while look.winner is not None and not _corrects(look.winner, rounds):
        look = _settled(workshop, given, look, look.winner, progress)
        rounds.append(look)
        search = look.rivals[0].search
        if len(rounds) == MOST_FINDINGS or _is_estimated(rounds):
            break
        look = _look(workshop, given, search.fitted(), [r.rivals[0] for r in rounds], progress)
    if len(rounds) > 1:
        rounds, search = _reconsider(workshop, given, base_search, rounds, progress)
    last = look if look.winner is None else None
    return Discovery(base_search.fitted(), search.fitted(), search, tuple(rounds), last)


def _first_look(workshop: Workshop, given: Misfit, base_search: Search, progress: Progress) -> tuple[Search, Round]:
    """The first round, and the best fit of the model as it is, which the winner may show to have been a local optimum."""
    look = _look(workshop, given, base_search.fitted(), [], progress)
    if look.winner is None:
        return base_search, look
    better = without_winner(base_search, look.winner)
    gained = base_search.deviance - better.deviance
    if gained < TIE:
        return base_search, look
    is_plain = look.winner.drop > gained + NEEDED
    return better, look if is_plain else _look(workshop, given, better.fitted(), [], progress)


def _named_before_unknown(
    workshop: Workshop, given: Misfit, base_search: Search, look: Round, progress: Progress
) -> tuple[list[Round], Round]:
    """Nothing and the round; or, where an unknown force has won it, two named causes that fit better than its table.

    One table takes up much of two effects at once, but not all, where each of them alone leaves the other.
    """
    table = look.winner
    if table is None or not _is_unknown(table) or table.search.normalised < FLOOR:
        return [], look
    for first, second in _pairs(workshop, given, base_search, look, table, progress):
        other = second.winner
        if other is not None and not _is_unknown(other) and other.search.deviance < table.search.deviance:
            return [first], second
    return [], look


def _pairs(
    workshop: Workshop, given: Misfit, base_search: Search, look: Round, table: Rival, progress: Progress
) -> Iterator[tuple[Round, Round]]:
    """The best named cause, and what is left beside it; then the cause that stands out beside the table, likewise."""
    named = [rival for rival in look.rivals if not _is_unknown(rival)]
    chances, nothing = probabilities(named, len(named))
    first = evolve(look, rivals=tuple(named), probabilities=tuple(chances.tolist()), nothing=nothing)
    if first.winner is not None:
        first = _settled(workshop, given, first, first.winner, progress)
        yield first, _look(workshop, given, first.rivals[0].search.fitted(), [first.rivals[0]], progress)
    beside = _look(workshop, given, table.search.fitted(), [table], progress)
    if beside.winner is None or _is_unknown(beside.winner):
        return
    alone = rebuild(workshop, base_search, [beside.winner], beside.winner.search)
    if alone is not None:
        found = evolve(beside.winner, search=alone)
        first = evolve(beside, rivals=(found, *beside.rivals[1:]))
        yield first, _look(workshop, given, alone.fitted(), [found], progress)


def _is_unknown(rival: Rival) -> bool:
    return rival.proposal.physics == UNKNOWN


def _settled(workshop: Workshop, given: Misfit, look: Round, winner: Rival, progress: Progress) -> Round:
    """The round with its winner re-identified, where something is left."""
    if winner.search.normalised < FLOOR or _is_unknown(winner):
        return look
    found = again(workshop, given, winner, progress)
    gained = winner.search.deviance - found.deviance
    if not gained > 0.0:
        return look
    better = evolve(winner, search=found, drop=winner.drop + gained, evidence=winner.evidence + 0.5 * gained)
    return evolve(look, rivals=(better, *look.rivals[1:]))


def _corrects(winner: Rival, rounds: Sequence[Round]) -> bool:
    """A table at the place of a named finding says how far the form of that is off, not that there is more."""
    places = [place_of(look.rivals[0].proposal.location) for look in rounds]
    return _is_unknown(winner) and place_of(winner.proposal.location) in places


def _is_estimated(rounds: Sequence[Round]) -> bool:
    """Beside a force that is only estimated nothing more can be named: what is left is mostly how coarse the estimate is."""
    return bool(rounds) and _is_unknown(rounds[-1].rivals[0])


def _look(
    workshop: Workshop,
    given: Misfit,
    current: Misfit,
    found: Sequence[Rival],
    progress: Progress,
    concerns: Callable[[Proposal, Model], bool] | None = None,
) -> Round:
    """Every hypothesis that has not been found already, at the places of the given model, against what is left.

    Once something has been found, the model's own numbers have no more reason to hide the rest.

    Arguments:
        concerns: which proposals, built on the current model, are to be looked at; None: all.
    """
    known = {rival.identity for rival in found}
    everything = [p for p in propose_all(workshop.hypotheses, current) if concerns is None or concerns(p, current.model)]
    proposals = [p for p in everything if identity(p) not in known and _is_given(given.model, p.location)]
    equipped = workshop.equipped([p.model for p in proposals])
    afresh = not found or concerns is not None
    ranked, limits = fit_rivals(equipped, current, _as_given(current, given), proposals, afresh, progress)
    best = best_forms(ranked)
    chances, nothing = probabilities(best, len({identity(p) for p in proposals}))
    return Round(tuple(best), tuple(chances.tolist()), nothing, current, _least_drop(found), tuple(limits))


def _least_drop(found: Sequence[Rival]) -> float:
    """What a further finding must explain, in chi squared."""
    return (
        max(LEAST_DROP, FORM_ERRORS[min(len(found), len(FORM_ERRORS)) - 1] * sum(rival.drop for rival in found))
        if found
        else LEAST_DROP
    )


def _reconsider(
    workshop: Workshop, given: Misfit, base_search: Search, rounds: list[Round], progress: Progress
) -> tuple[list[Round], Search]:
    """Takes each finding away in turn, and lets all hypotheses compete again for its place beside the others.

    The first that was found had to make do for all of them, and is often only the best stand-in. Where everything is explained
    and nothing can be spared, there is nothing to question.
    """
    looks, search = list(rounds), rounds[-1].rivals[0].search
    for old in rounds:
        rest = [look for look in looks if look is not old]
        others = [look.rivals[0] for look in rest]
        without = rebuild(workshop, base_search, others, search)
        if without is None or (search.normalised < FLOOR and without.deviance > search.deviance + NEEDED):
            continue
        look = _look(workshop, given, without.fitted(), others, progress)
        if look.winner is None or _corrects(look.winner, rest):
            looks.remove(old)
            search = without
        elif look.winner.search.deviance < search.deviance + TIE:
            looks[looks.index(old)] = look
            search = look.winner.search
    return looks, search


def needed(
    workshop: Workshop, rounds: Sequence[Round], base: Search, final: Search
) -> tuple[tuple[Round, ...], Search, Search]:
    """The findings without which the fit is worse by more than their price, and the fits without any and with these.

    An early finding may only have led the search past a local optimum.
    """
    kept = list(rounds)
    for look in rounds:
        others = [one for one in kept if one is not look]
        base = min(base, without_winner(base, look.rivals[0]), key=lambda search: search.deviance)
        without = rebuild(workshop, base, [one.rivals[0] for one in others], final)
        if without is not None and without.deviance < final.deviance + price(look.rivals[0].proposal, final.misfit):
            kept, final = others, without
    return tuple(evolve(look, before=_without(workshop, look, kept, base, final)) for look in kept), base, final


def _without(workshop: Workshop, look: Round, kept: Sequence[Round], base: Search, final: Search) -> Misfit:
    """The fit with all other findings that were kept: when this one was made, others may have stood beside it."""
    others = [one.rivals[0] for one in kept if one is not look]
    model = (rebuild(workshop, base, others, final) or base).fitted().model
    return workshop.equipped([model]).misfit(look.before, model)


def price(proposal: Proposal, misfit: Misfit) -> float:
    """Chi squared that a finding must explain to be worth its parameters, as the evidence counts them (Schwarz 1978)."""
    return max(LEAST_DROP, len(proposal.parameters) * float(np.log(misfit.independent_samples)))


def _as_given(current: Misfit, given: Misfit) -> Misfit:
    """The current model with its first parameters back at the values that the user gave."""
    known = {name: parameter.value for name, parameter in given.model.free_parameters().items()}
    return current.with_values({name: value for name, value in known.items() if name in current.names})


def _is_given(model: Model, location: Mapping[str, object]) -> bool:
    """What a finding has added is not itself a place for further physics."""
    bodies, joints = {body.name for body in model.bodies}, {joint.name for joint in model.joints}
    named = {"joint": joints, "body": bodies, "bodies": bodies}
    return all(
        set(np.ravel(np.asarray(location[kind])).tolist()) <= known for kind, known in named.items() if kind in location
    )


def run_drops(before: Misfit, after: Misfit) -> dict[str, float]:
    """By how much chi squared drops in each run."""
    sums = [misfit.channel_sums(misfit.residual(misfit.start())) for misfit in (before, after)]
    runs = [channel.run for channel in before.channels]
    return {run: float(np.sum((sums[0] - sums[1])[[r == run for r in runs]])) for run in before.recordings}
