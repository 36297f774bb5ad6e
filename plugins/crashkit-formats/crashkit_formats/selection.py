"""The user's choice of channels: "[-]CURVE[+CURVE...]=BODY[:SENSOR]", where CURVE may be a range "FIRST..LAST"."""

import re
from collections.abc import Collection

from attrs import frozen

from crashkit.errors import CrashkitError
from crashkit_formats.ev5 import Curve, Ev5

_CHANNEL = re.compile(r"(?P<sign>-?)(?P<curves>[^=]+)=(?P<body>[^:=]+)(?::(?P<sensor>[^:=]+))?")
_TERM = re.compile(r"(\d+)(?:\.\.(\d+))?")


@frozen
class Channel:
    """Curves that are joined into one sensor of a recording.

    Arguments:
        curves: joined, all of one kind.
        sign: 1 or -1.
        body: the model's name of what carries them.
        sensor: name in the recording.
        skipped: curves of a range that the laboratory declared void, or whose file is not there.
    """

    curves: tuple[Curve, ...]
    sign: float
    body: str
    sensor: str
    skipped: tuple[Curve, ...] = ()


def select(text: str, test: Ev5, present: Collection[int]) -> Channel:
    """The channel that `text` chooses.

    Arguments:
        text: as the user wrote it.
        test: the metadata.
        present: numbers of the curves whose data are there.
    """
    match = _CHANNEL.fullmatch(text.strip())
    if not match:
        raise CrashkitError(f"expected a channel like 93+94=vehicle:compartment or -107..632=barrier:wall, found {text!r}")
    curves: list[Curve] = []
    skipped: list[Curve] = []
    for term in match["curves"].split("+"):
        _add(term.strip(), test, present, curves, skipped)
    if not curves:
        raise CrashkitError(f"channel {text}: expected at least one curve with data, found none")
    _check(text, curves)
    sensor = match["sensor"] or re.sub(r"\W+", "_", f"{curves[0].location}_{curves[0].axis}_{match['curves']}")
    return Channel(tuple(curves), -1.0 if match["sign"] else 1.0, match["body"], sensor, tuple(skipped))


def _add(term: str, test: Ev5, present: Collection[int], curves: list[Curve], skipped: list[Curve]) -> None:
    match = _TERM.fullmatch(term)
    if not match:
        raise CrashkitError(f"expected a curve number or a range like 107..632, found {term!r}")
    first = _curve(int(match[1]), test)
    if match[2] is None:
        curves.append(_usable(first, present))
        return
    for number in range(first.number, int(match[2]) + 1):
        curve = test.curves.get(number)
        if curve is not None and curve.kind == first.kind:
            (skipped if curve.failed or number not in present else curves).append(curve)


def _curve(number: int, test: Ev5) -> Curve:
    if number not in test.curves:
        raise CrashkitError(f"curve {number}: expected one of the curves of the EV5 file, found none of that number")
    return test.curves[number]


def _usable(curve: Curve, present: Collection[int]) -> Curve:
    if curve.failed:
        raise CrashkitError(f"curve {curve.number}: expected valid data, found the comment {curve.comment!r}")
    if curve.number not in present:
        raise CrashkitError(f"curve {curve.number}: expected a data file, found none ({curve.comment})")
    return curve


def _check(text: str, curves: list[Curve]) -> None:
    kinds = {curve.kind for curve in curves}
    if len(kinds) > 1:
        found = ", ".join(" ".join(kind) for kind in sorted(kinds))
        raise CrashkitError(f"channel {text}: expected curves of one sensor type, axis and unit, found {found}")
    numbers = [curve.number for curve in curves]
    if len(set(numbers)) < len(numbers):
        twice = next(number for number in numbers if numbers.count(number) > 1)
        raise CrashkitError(f"channel {text}: expected each curve once, found curve {twice} twice")
