"""Which instruments are believed while the structure is questioned: those that kinematics contradicts come first or last."""

from collections.abc import Mapping, Sequence
from functools import partial

from attrs import evolve

from crashkit.diagnose.fitting.contest import Progress, propose_all
from crashkit.diagnose.fitting.evidence import FLOOR, probabilities, ranked_by_evidence
from crashkit.diagnose.fitting.in_time import in_time
from crashkit.diagnose.fitting.rebuild import rebuild
from crashkit.diagnose.fitting.reidentify import reidentify
from crashkit.diagnose.fitting.search import STEPS, Search, begin
from crashkit.diagnose.locate.aside import CLOCK, Suspect, late_clocks, on_time, suspects, without
from crashkit.diagnose.locate.consistency import by_run, check_instruments
from crashkit.diagnose.name.asked_first import asked_first
from crashkit.diagnose.name.explore import beside_reading, discovered
from crashkit.diagnose.name.look import Round, look_again
from crashkit.diagnose.name.rounds import Discovery
from crashkit.diagnose.name.settle import settled
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Proposal


def discover(workshop: Workshop, given: Misfit, base_search: Search, looks: Sequence[Round], progress: Progress) -> Discovery:
    """All findings that the evidence supports, each in the light of the others.

    Arguments:
        given: the misfit of the model at the values that the user gave.
        base_search: its best fit.
        looks: whose claims are asked first, if there are any.
    """
    found = asked_first(workshop, given, base_search, looks, progress)
    if found is not None:
        return found
    checks = check_instruments(by_run(given))
    if late := late_clocks(checks):
        found = _with_clock(workshop, given, base_search, late, progress)
    elif set_aside := suspects(given, checks):
        found = _beside(workshop, given, base_search, set_aside, progress)
    return found or discovered(workshop, given, base_search, progress)


def _beside(
    workshop: Workshop, given: Misfit, base_search: Search, set_aside: tuple[Suspect, ...], progress: Progress
) -> Discovery | None:
    """What the instruments that agree say of the structure, and then what is wrong with the others; None if that fails."""
    rest = workshop.first_misfit(given.model, without(given.recordings, set_aside)).with_prior(given.prior.std)
    if not rest.groups:
        return None
    structure = discovered(evolve(workshop, recorded={}), rest, reidentify(workshop, rest), progress)
    rounds = list(structure.rounds)
    search = rebuild(workshop, base_search, [look.rivals[0] for look in rounds], structure.search)
    if search is None:
        return None
    unbent, waiting = given.with_values_of(structure.search.fitted()), set_aside
    while waiting:
        found, concerns = [look.rivals[0] for look in rounds], partial(_concern, waiting)
        look = in_time(None, look_again, workshop, unbent, search.fitted(), found, progress, concerns)
        if look is None or (look.winner is None and search.normalised <= FLOOR):
            break
        if look.winner is None:
            return None
        waiting = tuple(one for one in waiting if not one.concerns(look.winner.proposal, look.before.model))
        rounds.append(in_time(look, settled, workshop, unbent, look, look.winner, found, progress))
        search = rounds[-1].rivals[0].search
    return Discovery(base_search.fitted(), search.fitted(), search, tuple(rounds))


def _concern(waiting: Sequence[Suspect], proposal: Proposal, model: Model) -> bool:
    """Whether a proposal says no more than what a sensor of one of these reads."""
    return any(suspect.concerns(proposal, model) for suspect in waiting)


def _with_clock(
    workshop: Workshop, given: Misfit, base_search: Search, late: Mapping[str, float], progress: Progress
) -> Discovery | None:
    """A clock that is wrong, and then what all instruments say of the structure once that is right; None if none is."""
    clock = _clock(workshop, given, base_search, late)
    return beside_reading(workshop, given, base_search, clock, progress) if clock.winner else None


def _clock(workshop: Workshop, given: Misfit, base_search: Search, late: Mapping[str, float]) -> Round:
    """Which of these clocks is wrong: the model is re-identified with the stamps of one or the other put right."""
    current = base_search.fitted()
    claims = [p for p in propose_all(workshop, current) if p.physics == CLOCK and p.location["instrument"] in late]
    fitted = []
    for claim in claims:
        instrument, (path,) = str(claim.location["instrument"]), claim.parameters
        right = workshop.first_misfit(given.model, on_time(given.recordings, instrument, late[instrument]))
        search = reidentify(workshop, right.with_prior(given.prior.std))
        values = {**search.misfit.values(search.point), path: late[instrument]}
        misfit = workshop.misfit(given, claim.model).with_values(values)
        fitted.append((claim, begin(workshop.identifier, misfit).advance(STEPS)))
    rivals = ranked_by_evidence(fitted, base_search.deviance)
    chances, nothing = probabilities(rivals, len(rivals))
    return Round(tuple(rivals), tuple(chances.tolist()), nothing, current)
