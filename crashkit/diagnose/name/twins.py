"""Claims that take the numbers of a finding to another place: what no recording tells apart shares its odds."""

from collections.abc import Sequence

from attrs import evolve
from scipy.special import softmax

from crashkit.diagnose.claims import identity, propose_all
from crashkit.diagnose.fitting.candidates import Candidate, begin_candidates
from crashkit.diagnose.fitting.contest import heats
from crashkit.diagnose.fitting.evidence import (
    IN_TIME,
    Rival,
    best_forms,
    by_evidence,
    is_unknown,
    ranked_by_evidence,
    rival_of,
)
from crashkit.diagnose.fitting.rebuild import rebuild
from crashkit.diagnose.fitting.search import Search, begin
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.forms import with_form
from crashkit.diagnose.name.inquiry import is_given
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.result import own_name
from crashkit.diagnose.workshop import Workshop
from crashkit.model import Model

HEATS = ((30, 6), (3, 40))
"""How many enter each, and how many steps each gets there."""
ALIKE = 1.5, 1.0
"""After the first, what leaves more above the noise than so many times what a finding does, and so much, is no twin."""


def beside_twins(workshop: Workshop, discovery: Discovery) -> Discovery:
    """Every finding with its twins among the rivals.

    Another form of the same physics may have been the one that decided, and its twins were never asked in that: friction on
    the ground acts on a body like friction in its joint to the obstacle, in whatever form; so does a force of the time. The
    likeliest of them is told.
    """
    findings = tuple(_beside_twins(workshop, discovery, look) for look in discovery.findings)
    leading = [look.leader for look in findings]
    if [rival.identity for rival in leading] == [look.leader.identity for look in discovery.findings]:
        return evolve(discovery, findings=findings)
    search = rebuild(workshop, begin(workshop.identifier, discovery.base), leading, discovery.search)
    return discovery if search is None else evolve(discovery, findings=findings, search=search, final=search.fitted())


def _beside_twins(workshop: Workshop, discovery: Discovery, look: Look) -> Look:
    """The look with twins, which are weighed as the finding is now: what stands beside it may have got a better form."""
    winner = evolve(look.leader, search=discovery.search)
    if is_unknown(winner):
        if winner.proposal.estimate_of != IN_TIME:  # one of the motion is another at another place
            return look
        # Beside known laws an estimate counts less than it explains, and its twins are weighed beside none.
        winner = rival_of(winner.proposal, winner.search, winner.without)
    others = [one.leader for one in discovery.findings if one is not look]
    without = rebuild(workshop, begin(workshop.identifier, discovery.base), others, winner.search)
    twins = [] if without is None else _twins(workshop, discovery.base.model, without, winner, others)
    if without is None or not twins:
        return look
    most = ALIKE[0] * winner.search.excess + ALIKE[1]
    twins = [one for one in heats(twins, HEATS[:1], _untold) if one.search.excess < most]
    if not twins:
        return look
    fitted = ranked_by_evidence(heats(twins, HEATS[1:], _untold), winner.without)
    return _shared(evolve(look, before=without.fitted()), best_forms(by_evidence([winner, *fitted])))


def _shared(look: Look, twins: Sequence[Rival]) -> Look:
    """The look whose leader's odds its twins share, that among them. The other rivals keep theirs: they were weighed where the
    other findings had not been made."""
    known = {twin.identity for twin in twins}
    odds = list(zip(look.rivals, look.probabilities, strict=True))
    others = [(rival, chance) for rival, chance in odds if rival.identity not in known]
    together = sum(chance for rival, chance in odds if rival.identity in known)
    shares = together * softmax([twin.evidence for twin in twins])
    rivals, chances = zip(*zip(twins, shares.tolist(), strict=True), *others, strict=True)
    return evolve(look, rivals=rivals, probabilities=chances)


def _twins(workshop: Workshop, model: Model, without: Search, winner: Rival, others: Sequence[Rival]) -> list[Candidate]:
    """Searches of all claims of the same numbers at places of a model, from where they are, beside the other findings."""
    numbers = _numbers(winner)
    origin, known = without.misfit.with_values_of(winner.search.fitted()), {rival.identity for rival in (winner, *others)}
    alike = [p for p in propose_all(workshop, origin) if {own_name(path) for path in p.parameters} == set(numbers)]
    alike = [p for p in alike if p.estimate_of == winner.proposal.estimate_of]
    twins = [twin for twin in alike if identity(twin) not in known and is_given(model, twin.location)]
    equipped = workshop.equipped([twin.model for twin in twins])
    starts = [{path: numbers[own_name(path)] for path in twin.parameters} for twin in twins]
    misfits = [with_form(equipped, origin, twin, start) for twin, start in zip(twins, starts, strict=True)]
    return begin_candidates(workshop.identifier, twins, misfits)


def _untold(doing: str, share: float) -> None:
    """All questions have been asked."""


def _numbers(rival: Rival) -> dict[str, float]:
    """What a claim adds, by the names in its law."""
    values = rival.search.values
    return {own_name(path): values[path] for path in rival.proposal.parameters if path in values}
