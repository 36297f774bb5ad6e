"""The options of an import, parsed from text."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from attrs import field, frozen

from crashkit.errors import CrashkitError

FILTER_CLASSES = (0, 60, 180, 600, 1000)


@frozen
class Options:
    """How the chosen channels become a recording.

    Arguments:
        window: s, start and end of what is kept.
        channel_frequency_class: SAE J211 class that the channels are filtered to; 0 leaves them as recorded.
        zero: s, start and end of the part whose mean is the channels' offset; None keeps the offset.
        speed: m s-1, initial velocity by body; "" for every body of the vehicle.
        position: m, initial position by body; "" for every body.
    """

    window: tuple[float, float] = (0.0, math.inf)
    channel_frequency_class: int = 0
    zero: tuple[float, float] | None = (-0.05, -0.01)
    speed: Mapping[str, float] = field(factory=dict)
    position: Mapping[str, float] = field(factory=dict)


def parse_options(texts: Mapping[str, str]) -> Options:
    """The options from what the user wrote; raises CrashkitError."""
    parsers: dict[str, Callable[[str, str], Any]] = {
        "window": _interval,
        "channel_frequency_class": _filter_class,
        "zero": lambda name, text: None if text == "off" else _interval(name, text),
        "speed": _by_body,
        "position": _by_body,
    }
    unknown = sorted(set(texts) - set(parsers))
    if unknown:
        raise CrashkitError(f"expected the options {', '.join(parsers)}, found {', '.join(unknown)}")
    return Options(**{name: parsers[name](name, text.strip()) for name, text in texts.items()})


def _interval(name: str, text: str) -> tuple[float, float]:
    start, separator, end = text.partition(":")
    first, last = _number(name, start or "-inf"), _number(name, end or "inf")
    if not separator or not first < last:
        raise CrashkitError(f"option {name}: expected START:END in seconds, found {text!r}")
    return first, last


def _filter_class(name: str, text: str) -> int:
    if text not in map(str, FILTER_CLASSES):
        raise CrashkitError(f"option {name}: expected one of {', '.join(map(str, FILTER_CLASSES))}, found {text!r}")
    return int(text)


def _by_body(name: str, text: str) -> dict[str, float]:
    """{"vehicle": 15.8} of "vehicle:15.8"; {"": 15.8} of "15.8"."""
    parts = (entry.rpartition(":") for entry in text.split(","))
    return {body.strip(): _number(name, value) for body, _, value in parts}


def _number(name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise CrashkitError(f"option {name}: expected a number, found {text!r}") from None
    if math.isnan(value):
        raise CrashkitError(f"option {name}: expected a number, found {text!r}")
    return value
