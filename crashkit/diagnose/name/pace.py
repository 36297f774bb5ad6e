"""What is found may outrun the recordings as they were thinned, or the step, and then has to be judged by finer ones."""

from collections.abc import Sequence

from attrs import evolve

from crashkit.diagnose.claims import accuses_instrument
from crashkit.diagnose.fitting.evidence import Rival, is_at_noise, is_unknown
from crashkit.diagnose.fitting.search import STEPS, begin
from crashkit.diagnose.fitting.sharpen import in_the_light_of, sharpened
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look
from crashkit.misfit import bears_step

THINNED = 0.5
"""Share of what a finding leaves above the noise that is due to thinning, if the finding outruns it."""


class OutrunError(Exception):
    """What was found moves faster than the thinned recordings or the step can show, and has to be judged by finer ones.

    Attributes:
        found: that claim, fitted to those.
        beside: the findings that it was found beside.
    """

    def __init__(self, found: Rival, beside: Sequence[Look] = ()) -> None:
        super().__init__(found.identity)
        self.found = found
        self.beside = tuple(beside)


def check_pace(inquiry: Inquiry, found: Rival, beside: Sequence[Look] = ()) -> None:
    """Raises OutrunError where most of what a finding leaves above the noise was made by thinning, or by steps too long.

    One about readings, as of a sensor that rings, may leave nothing of the means, which hardly show it: its rate decides.

    Arguments:
        found: the last finding, its search with all of them.
        beside: those before it.
    """
    left = found.search
    if accuses_instrument(found.proposal):
        check_rate(inquiry, found, beside)
    if not inquiry.unthinned or is_unknown(found) or is_at_noise(left):
        return
    if not bears_step(left.fitted()):
        raise OutrunError(found, beside)
    equipped = inquiry.workshop.equipped([left.misfit.model])
    finer = sharpened(equipped, inquiry.given.model, inquiry.unthinned, left)
    if finer.excess < THINNED * left.excess:
        raise OutrunError(evolve(found, search=finer), beside)


def check_rate(inquiry: Inquiry, found: Rival, beside: Sequence[Look] = ()) -> None:
    """Raises OutrunError where readings that a finding explains change faster than the thinned recordings show.

    However much else is left: the means that these consist of have taken away part of what rings.
    """
    left = found.search
    if not inquiry.unthinned:
        return
    equipped = inquiry.workshop.equipped([left.misfit.model])
    finer = in_the_light_of(equipped, inquiry.given.model, inquiry.unthinned, left.fitted())
    if finer.sample_count > left.misfit.sample_count:
        search = begin(equipped.identifier, equipped.misfit(finer, left.fitted().model)).advance(STEPS)
        raise OutrunError(evolve(found, search=search), beside)
