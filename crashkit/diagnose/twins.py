"""Claims that take the numbers of a finding to another place: what no recording tells apart shares its odds."""

from attrs import evolve

from crashkit.diagnose.contest import identity
from crashkit.diagnose.evidence import Rival, best_forms, ranked_by_evidence
from crashkit.diagnose.forms import with_form
from crashkit.diagnose.look import Round, between, is_unknown
from crashkit.diagnose.name import propose_all
from crashkit.diagnose.rebuild import rebuild
from crashkit.diagnose.rounds import Discovery
from crashkit.diagnose.search import advance_all, begin, begin_all, weighed
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit

HEATS = ((30, 6), (3, 40))
"""How many enter each, and how many steps each gets there."""


def beside_twins(workshop: Workshop, discovery: Discovery) -> Discovery:
    """Every finding with its twins among the rivals.

    Another form of the same physics may have been the one that decided, and its twins were never asked in that: friction on
    the ground acts on a body like friction in its joint to the obstacle, in whatever form.
    """
    return evolve(discovery, rounds=tuple(_beside_twins(workshop, discovery, look) for look in discovery.rounds))


def _beside_twins(workshop: Workshop, discovery: Discovery, look: Round) -> Round:
    winner = look.rivals[0]
    search, numbers = winner.search, _numbers(winner)
    others = [one.rivals[0] for one in discovery.rounds if one is not look]
    here = [other for other in others if _is_in(other, search.misfit) and not _is_in(other, look.before)]
    without = rebuild(workshop, begin(workshop.identifier, look.before), here, search)
    if without is None or is_unknown(winner):
        return look
    origin = without.misfit.with_values_of(search.fitted())
    told = [other.rivals[0].identity for other in discovery.rounds]
    everything = propose_all(workshop.hypotheses, origin)
    twins = [p for p in everything if identity(p) not in told and {_short(path) for path in p.parameters} == set(numbers)]
    if not twins:
        return look
    equipped = workshop.equipped([twin.model for twin in twins])
    starts = [{path: numbers[_short(path)] for path in twin.parameters} for twin in twins]
    misfits = [with_form(equipped, origin, twin, start) for twin, start in zip(twins, starts, strict=True)]
    entrants = list(zip(twins, begin_all(workshop.identifier, misfits), strict=True))
    for size, steps in HEATS:
        ahead = sorted(entrants, key=lambda entrant: entrant[1].state.cost)[:size]
        entrants = list(zip((p for p, _ in ahead), advance_all([s for _, s in ahead], steps), strict=True))
    fitted = zip((p for p, _ in entrants), weighed([s for _, s in entrants]), strict=True)
    rivals = [*look.rivals[1:], *ranked_by_evidence(fitted, search.deviance + winner.drop)]
    return between(look, [winner, *best_forms(sorted(rivals, key=lambda rival: -rival.evidence))])


def _numbers(rival: Rival) -> dict[str, float]:
    """What a claim adds, by the names in its law."""
    values = rival.search.misfit.values(rival.search.point)
    return {_short(path): values[path] for path in rival.proposal.parameters if path in values}


def _is_in(rival: Rival, misfit: Misfit) -> bool:
    """Whether what a claim adds is free in a model."""
    return set(rival.proposal.parameters) <= set(misfit.names)


def _short(path: str) -> str:
    return path.rsplit(".", 1)[-1]
