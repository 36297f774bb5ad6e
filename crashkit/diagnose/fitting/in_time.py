"""A limit to the time for questions: what has been found by then is told, and that not everything was asked."""

from collections.abc import Callable
from time import monotonic
from typing import ParamSpec, TypeVar

from crashkit.diagnose.claims import Progress

Answer = TypeVar("Answer")
Otherwise = TypeVar("Otherwise")
Given = ParamSpec("Given")


class OutOfTimeError(Exception):
    """The time for questions is up."""


class TimeLimit:
    """A progress that ends every question once the time is up.

    Arguments:
        seconds: from the first question on; what is compiled before does not count.
        show: told what is being done.
        whole: the limit that this one is a part of; where a question was ended, it is over as well.

    Attributes:
        is_over: whether a question was ended.
    """

    def __init__(self, seconds: float, show: Progress, whole: "TimeLimit | None" = None) -> None:
        self.is_over = False
        self.show = show
        self._seconds = seconds
        self._whole = whole
        self._begun: float | None = whole._begun if whole else None

    def __call__(self, doing: str, share: float) -> None:
        """Told what is being done; raises OutOfTimeError where there is no time for it."""
        self._begun = monotonic() if self._begun is None else self._begun
        if monotonic() > self._begun + self._seconds:
            self.end()
            raise OutOfTimeError
        self.show(doing, share)

    def end(self) -> None:
        """A question was ended."""
        self.is_over = True
        if self._whole:
            self._whole.end()

    def part(self, share: float) -> "TimeLimit":
        """A limit that began with this one, or begins both, and ends at a share of its time."""
        self._begun = monotonic() if self._begun is None else self._begun
        return TimeLimit(share * self._seconds, self.show, self)


def sooner(progress: Progress, share: float) -> Progress:
    """A progress that ends at a share of the time, if it is limited: what is asked next has the rest."""
    return progress.part(share) if isinstance(progress, TimeLimit) else progress


def in_time(
    otherwise: Otherwise, question: Callable[Given, Answer], *arguments: Given.args, **named: Given.kwargs
) -> Answer | Otherwise:
    """The answer to a question, or what stands without it where the time is up."""
    try:
        return question(*arguments, **named)
    except OutOfTimeError:
        return otherwise
