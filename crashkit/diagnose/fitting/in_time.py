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

    Attributes:
        is_over: whether a question was ended.
    """

    def __init__(self, seconds: float, show: Progress) -> None:
        self.is_over = False
        self.show = show
        self._seconds = seconds
        self._begun: float | None = None

    def __call__(self, doing: str, share: float) -> None:
        """Told what is being done; raises OutOfTimeError where there is no time for it."""
        self._begun = monotonic() if self._begun is None else self._begun
        if monotonic() > self._begun + self._seconds:
            self.is_over = True
            raise OutOfTimeError
        self.show(doing, share)


def in_time(
    otherwise: Otherwise, question: Callable[Given, Answer], *arguments: Given.args, **named: Given.kwargs
) -> Answer | Otherwise:
    """The answer to a question, or what stands without it where the time is up."""
    try:
        return question(*arguments, **named)
    except OutOfTimeError:
        return otherwise
