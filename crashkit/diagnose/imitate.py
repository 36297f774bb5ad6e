"""Named causes that act as an estimated force does, begun at the numbers that the model has beside that."""

from collections.abc import Mapping

import numpy as np

from crashkit.campaign import spread
from crashkit.diagnose.contest import Entrant, Progress, Start, first_of_each, heats, identity
from crashkit.diagnose.evidence import Rival
from crashkit.diagnose.name import propose_all
from crashkit.diagnose.result import UNKNOWN, place_of
from crashkit.diagnose.search import Search, begin, begin_all
from crashkit.diagnose.workshop import Workshop

SHARES = (1 / 3, 1.0)
"""Of the time recorded, looked at one after the other while only the numbers at the place move."""
ALONE = 10
"""Steps in each."""
FORMS = (16, 8)
"""How many forms go on with all numbers, and how many steps each gets."""
CLAIMS = (4, 60)
"""The same for the best form of each claim."""


def imitating(workshop: Workshop, base_search: Search, table: Rival, progress: Progress) -> list[Entrant]:
    """Fits of the known causes at the place of an estimated force.

    A cause that is not named drives the model's own numbers away, and a search that begins there may never come back. Beside
    the estimate they are about right, so that each cause only has to find its own, and those of its place.

    Arguments:
        base_search: the fit of the model without the estimate.
    """
    origin, place = base_search.misfit.with_values_of(table.search.fitted()), place_of(table.proposal.location)
    known = [p for p in propose_all(workshop.hypotheses, origin) if p.physics != UNKNOWN and place_of(p.location) == place]
    equipped = workshop.equipped([proposal.model for proposal in known])
    starts = [(proposal, {**proposal.null, **start}) for proposal in known for start in proposal.starts]
    here = tuple(f"{kind}.{name}." for kind, name in table.proposal.location.items())

    def end(start: Start) -> tuple[Mapping[str, float], float]:
        """Where the numbers at the place go while all others stay, and what they leave."""
        (proposal, values), cost = start, np.inf
        for early in (origin.coarse.up_to(share) for share in SHARES):
            misfit = equipped.misfit(early, proposal.model).with_values_of(origin)
            free = {name: name in proposal.parameters or name.startswith(here) for name in misfit.names}
            search = begin(equipped.identifier, misfit.with_values(values, free)).advance(ALONE)
            values, cost = {**values, **search.misfit.values(search.point)}, search.state.cost
        return values, cost

    progress(f"fitting {len(known)} causes to the force estimated at {place}", 0.0)
    ends = [(proposal, one) for (proposal, _), one in zip(starts, spread(end, starts), strict=True)]
    ahead = first_of_each(sorted(ends, key=lambda entrant: entrant[1][1]), 1)[: FORMS[0]]
    misfits = [equipped.misfit(origin, p.model).with_values_of(origin).with_values(values) for p, (values, _) in ahead]
    searches = begin_all(workshop.identifier, misfits)
    fitted = heats(list(zip((proposal for proposal, _ in ahead), searches, strict=True)), (FORMS,), progress)
    claims: dict[tuple[str, str], Entrant] = {}
    for proposal, search in sorted(fitted, key=lambda entrant: entrant[1].state.cost):
        claims.setdefault(identity(proposal), (proposal, search))
    return heats(list(claims.values()), (CLAIMS,), progress)
