"""Whether several findings at one place are one force that no list has, which they imitate together."""

from collections.abc import Sequence

from crashkit.diagnose.claims import accuses_instrument
from crashkit.diagnose.fitting.evidence import FLOOR, OF_DEFORMATION, Rival, is_at_noise, is_unknown
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.result import Finding

AS_MUCH = 1.5
"""Times what findings leave above the noise together: an estimate that alone leaves no more says as much as they do."""


def are_one_force(looks: Sequence[Look], findings: Sequence[Finding], search: Search) -> bool:
    """Whether these findings at one place of the structure together leave something; or say no more than one force that
    depends on the deformation, as two functions of that imitate any third; or none of them is told by its size.

    Arguments:
        looks: in which each finding was made.
        findings: the same, as they are told.
        search: the fit with everything that was found.
    """
    if len(looks) < 2 or any(accuses_instrument(look.leader.proposal) for look in looks):
        return False
    return search.normalised > FLOOR or _says_as_much(looks) or not any(map(_has_a_size, findings))


def _says_as_much(looks: Sequence[Look]) -> bool:
    """Whether an estimate that was made beside none of the findings does."""
    own = {path for look in looks for path in look.leader.proposal.parameters}
    asked = [(look.leader.place, rival) for look in looks for rival in (*look.rivals[1:], *look.estimates)]
    estimates = [rival.search for place, rival in asked if _estimates_force_at(place, rival)]
    alone = [search for search in estimates if own.isdisjoint(search.values)]
    most = AS_MUCH * min(look.leader.search.excess for look in looks)
    return any(is_at_noise(search) or search.excess < most for search in alone)


def _estimates_force_at(place: str, rival: Rival) -> bool:
    return is_unknown(rival) and rival.place == place and rival.proposal.estimate_of in OF_DEFORMATION


def _has_a_size(finding: Finding) -> bool:
    """Whether the first of its numbers, which says how large it is, is told better than that it is there."""
    size = next(iter(finding.parameters.values()), None)
    return size is not None and size.identifiable and abs(size.value) > size.std
