"""Claims from the values that the user gave, along the measured motion: each alone, and two at once."""

from collections.abc import Sequence
from functools import cached_property

from attrs import frozen

from crashkit.diagnose.claims import Progress
from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.couples import Couple, coupled, each_once, with_other_forms
from crashkit.diagnose.fitting.evidence import explains
from crashkit.diagnose.fitting.promises import Led, led, promising_couples
from crashkit.diagnose.fitting.regress import End, opened, regressed
from crashkit.diagnose.result import UNKNOWN
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

TRIED = 24
"""Couples that are regressed; of each two claims one in the forms that promise most."""
HOPEFUL = 0.5
"""Of what a single claim leaves above the noise: two that leave less may leave next to nothing in other forms."""
LEADING = 2
"""How many couples are then tried in these."""


@frozen(eq=False)
class FromGiven:
    """Questions that take long, and are answered once, whoever asks first.

    Attributes:
        given: the misfit of the model without the claims, at the values that the user gave.
        proposals: the claims, built on that model.
        progress: told what is being done and how far it is (0 to 1).
    """

    workshop: Workshop
    given: Misfit
    proposals: Sequence[Proposal]
    progress: Progress

    @cached_property
    def ends(self) -> list[End | None]:
        """Where short regressions lead each claim; None for one about an instrument."""
        return opened(self.workshop, self.given, self.proposals, self.progress)

    @cached_property
    def singles(self) -> list[Candidate]:
        """Searches from where longer ones lead the claims that leave least of the equations."""
        return regressed(self.workshop, self.given, self.proposals, self.ends, self.progress)

    def couples(self, least: float) -> list[Couple]:
        """The couples of claims that, fitted together, leave least, the most evident first, each two claims once.

        The first of two gross causes that is asked for alone has to make do for both, and drives the model's numbers where no
        second one is found. Along the measured motion what two of them leave together is known from what each does alone, to
        first order, so all couples can be asked.

        Arguments:
            least: what a single claim leaves above the noise.
        """
        couples = self._plain_couples
        if couples and couples[0].search.excess < HOPEFUL * least and not explains(couples[0].search):
            forms = [two for couple in couples[:LEADING] for two in with_other_forms(couple, self._led)]
            couples = [*couples, *coupled(self.workshop, self.given, forms, self.progress)]
        return each_once(couples)

    @cached_property
    def _led(self) -> list[Led]:
        """The known claims where short regressions lead them, and the equations about there."""
        ended = zip(self.proposals, self.ends, strict=True)
        return led(self.workshop, self.given, [(p, end) for p, end in ended if end is not None and p.physics != UNKNOWN])

    @cached_property
    def _plain_couples(self) -> list[Couple]:
        """Those that promise most."""
        claims = self._led
        self.progress(f"regressing the equations of motion for couples of {len(claims)} claims", 0.0)
        return coupled(self.workshop, self.given, promising_couples(claims, TRIED), self.progress)
