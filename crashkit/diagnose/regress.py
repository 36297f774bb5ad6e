"""Where the equations of motion lead each claim along the motion that was measured: nothing is simulated, or leads astray."""

from collections.abc import Mapping, Sequence

from crashkit.campaign import spread
from crashkit.diagnose.contest import Entrant, Progress, Start, first_of_each, heats
from crashkit.diagnose.search import begin_all
from crashkit.diagnose.workshop import Workshop
from crashkit.errors import CrashkitError
from crashkit.misfit import Misfit
from crashkit.protocols import Status

STEPS = 25
HEATS = ((16, 10), (5, 60))
"""How many of the forms that leave least of the equations are then simulated, and how many steps each gets."""

End = tuple[Mapping[str, float], float]
"""Values by path, and what they leave of the equations."""


def regressed(workshop: Workshop, given: Misfit, starts: Sequence[Start], progress: Progress) -> list[Entrant]:
    """Searches from where a regression of the measured accelerations leads each claim, with the model's own numbers.

    An acceleration depends on what acts on that body at that instant, and not on what was wrong before or elsewhere. A claim
    about an instrument, a law with a memory or a body that nothing sees has no such equation, and is left out.
    """
    # This also measures the motion, before copies of this process would each do so.
    if regression(workshop, given) is None:
        return []
    told = [start for start in starts if not workshop.hypotheses[start[0].physics].sensor]

    def end(start: Start) -> End | None:
        proposal, values = start
        return regression(workshop, workshop.misfit(given, proposal.model).with_values(values))

    progress(f"regressing the equations of motion for {len(told)} claims", 0.0)
    ends = zip(told, spread(end, told), strict=True)
    ranked = sorted(((start[0], one) for start, one in ends if one is not None), key=lambda entrant: entrant[1][1])
    ahead = first_of_each(ranked, 1)[: HEATS[0][0]]
    misfits = [workshop.misfit(given, proposal.model).with_values(values) for proposal, (values, _) in ahead]
    searches = begin_all(workshop.identifier, misfits)
    return heats(list(zip((proposal for proposal, _ in ahead), searches, strict=True)), HEATS, progress)


def regression(workshop: Workshop, misfit: Misfit) -> End | None:
    """Where a regression from the misfit's values ends; None where there are no such equations."""
    try:
        state = workshop.starter.start(misfit)
        for _ in range(STEPS):
            if state.status is not Status.RUNNING:
                break
            state = workshop.starter.step(misfit, state)
    except CrashkitError:
        return None
    return misfit.values(state.point), state.cost
