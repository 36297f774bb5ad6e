"""The force of a link: a broken line that is crushed for good, and the terms that a secret adds to it."""

import math
from enum import IntEnum
from typing import Any

import numba
import numpy as np


class Kind(IntEnum):
    """What a term does; its numbers, in their order, in brackets."""

    GAP = 0  # (gap)
    TOE = 1  # (gap, toe): a parabola over the toe
    PEAK_TRIANGLE = 10  # (force, place, half width)
    PEAK_BUMP = 11  # (force, place): x exp(-x)
    PEAK_BELL = 12  # (force, place, width)
    FOLD_SINE = 13  # (force, length, start)
    FOLD_SAW = 14  # (force, length, start)
    FOLD_ARCHES = 15  # (force, length, start)
    FOLD_CHIRP = 16  # (force, length, start, growth of the frequency)
    STOP_LINE = 17  # (stiffness, start)
    STOP_PARABOLA = 18  # (force, start, reach)
    STOP_POLE = 19  # (force, start, reach): s / (reach - s)
    STOP_EXPONENTIAL = 20  # (force, start, reach)
    STOP_HERTZ = 21  # (force, start, reach): power 1.5
    DENT = 22  # (force, place, half width)
    UNLOAD_LINE = 30  # (share, stiffness)
    UNLOAD_FADE = 31  # (share, length): exponential
    UNLOAD_TWO = 32  # (share, first stiffness, second stiffness): changes at half the force
    PULL_LAW = 40  # (share): the line goes on below zero
    PULL_STRAP = 41  # (stiffness, slack, limit)
    RATE_LINEAR = 50  # (s/m)
    RATE_POWER = 51  # (size, reference rate, power)
    RATE_EYRING = 52  # (size, reference rate): asinh
    RATE_SATURATING = 53  # (size, reference rate)
    RATE_WINDOW = 54  # (size, middle rate, half width)
    BREAK_SUDDEN = 55  # (share lost, place)
    BREAK_RAMP = 56  # (share lost, place, width)
    BREAK_TWICE = 57  # (share lost, place, way to the second)
    SOFTENING = 58  # (share lost, work)
    DAMP_TOUCHING = 70  # (coefficient, power)
    DAMP_ALWAYS = 71  # (coefficient, power)
    MAXWELL = 72  # (stiffness, time)
    LAG = 73  # (share, time): the fresh part of the force fades
    FRICTION = 74  # (force, rate, always)
    FRICTION_STRIBECK = 75  # (force, rate, always, rate at which it has fallen)
    FRICTION_BRISTLE = 76  # (force, bristle, always)
    FRICTION_LATER = 77  # (force, rate, start)
    PULSE = 78  # (force, time, half width)
    HUM = 79  # (force, frequency, decay time)
    TIE = 80  # (stiffness, damping, slack, limit): both ways


NUMBERS = 5
"""How many numbers a term has room for."""


@numba.njit(cache=True)
def _engaged(kind: int, p: np.ndarray, d: float) -> float:
    """How far a link is really compressed, m."""
    if kind == 0:
        return d - p[0]
    if kind == 1 and d > p[0]:
        over = d - p[0]
        return over * over / (2.0 * p[1]) if over < p[1] else over - 0.5 * p[1]
    return d - p[0] if kind == 1 else d


@numba.njit(cache=True)
def _on_the_curve(kind: int, p: np.ndarray, x: float) -> float:
    """What a term adds to the force of a first loading to x."""
    if kind == 10:
        return p[0] * max(0.0, 1.0 - abs(x - p[1]) / p[2])
    if kind == 11:
        return p[0] * x / p[1] * math.exp(1.0 - x / p[1])
    if kind == 12:
        return p[0] * (math.exp(-(((x - p[1]) / p[2]) ** 2)) - math.exp(-((p[1] / p[2]) ** 2)) * max(0.0, 1.0 - x / p[1]))
    if kind == 22:
        away = abs(x - p[1]) / p[2]
        return -p[0] * math.cos(0.5 * math.pi * away) ** 2 if away < 1.0 else 0.0
    return _fold(kind, p, x - p[2]) if kind <= 16 else _stop(kind, p, x - p[1])


@numba.njit(cache=True)
def _fold(kind: int, p: np.ndarray, s: float) -> float:
    if s <= 0.0:
        return 0.0
    turns = s / p[1]
    if kind == 13:
        return p[0] * math.sin(2.0 * math.pi * turns)
    if kind == 14:
        phase = (turns + 0.05) % 1.0
        return p[0] * min(20.0 * phase - 1.0, 1.0 - 2.0 * (phase - 0.1) / 0.9)
    if kind == 15:
        return p[0] * min(1.0, 4.0 * turns) * (math.pi * abs(math.sin(math.pi * turns)) - 2.0)
    return p[0] * math.sin(2.0 * math.pi * turns * (1.0 + p[3] * turns))


@numba.njit(cache=True)
def _stop(kind: int, p: np.ndarray, s: float) -> float:
    if s <= 0.0:
        return 0.0
    if kind == 17:
        return p[0] * s
    if kind == 18:
        return p[0] * (s / p[2]) ** 2
    if kind == 19:
        return p[0] * (s / (p[2] - s) if s < 0.9 * p[2] else 9.0 + 100.0 * (s / p[2] - 0.9))
    if kind == 20:
        return p[0] * (math.exp(min(s / p[2], 8.0)) - 1.0)
    return p[0] * (s / p[2]) ** 1.5


@numba.njit(cache=True)
def _unloading(kind: int, p: np.ndarray, peak: float, back: float) -> float:
    """The force after going `back` from where it was `peak`."""
    if kind == 30:
        return max(0.0, peak - p[1] * back)
    if kind == 31:
        return peak * math.exp(-back / p[1])
    half = 0.5 * peak / p[1]
    return peak - p[1] * back if back < half else max(0.0, 0.5 * peak - p[2] * (back - half))


@numba.njit(cache=True)
def _factor(kind: int, p: np.ndarray, x_top: float, rate: float, work: float) -> float:
    """What a term multiplies the force by."""
    if kind == 50:
        return 1.0 + p[0] * rate
    if kind == 52:
        return 1.0 + p[0] * math.asinh(rate / p[1])
    if kind == 55:
        return 1.0 - p[0] if x_top > p[1] else 1.0
    if kind == 56:
        return 1.0 - p[0] * min(1.0, max(0.0, (x_top - p[1]) / p[2]))
    if kind == 57:
        return 1.0 - 0.5 * p[0] * ((x_top > p[1]) + (x_top > p[1] + p[2]))
    if kind == 58:
        return 1.0 - p[0] * (1.0 - math.exp(-work / p[1]))
    if rate <= 0.0:
        return 1.0
    if kind == 51:
        return 1.0 + p[0] * (rate / p[1]) ** p[2]
    if kind == 53:
        return 1.0 + p[0] * rate / (rate + p[1])
    away = abs(rate - p[1]) / p[2]
    return 1.0 + p[0] * (1.0 - away) if away < 1.0 else 1.0


@numba.njit(cache=True)
def _friction(kind: int, p: np.ndarray, d: float, rate: float, bristle: float) -> float:
    if kind == 77:
        return p[0] * math.tanh(rate / p[1]) if d > p[2] else 0.0
    if p[2] == 0.0 and d <= 0.0:
        return 0.0
    if kind == 74:
        return p[0] * 2.0 / math.pi * math.atan(0.5 * math.pi * rate / p[1])
    if kind == 75:
        return p[0] * math.tanh(rate / p[1]) * (1.0 + 0.6 * math.exp(-((rate / p[3]) ** 2)))
    return p[0] * bristle


@numba.njit(cache=True)
def _beside(kind: int, p: np.ndarray, d: float, rate: float, time: float, hidden: float) -> float:
    """What a term adds to the force, beside the curve; 72 and 76 have a hidden state."""
    touching = d > 0.0
    if kind == 70 and not touching:
        return 0.0
    if kind == 70 or kind == 71:
        return p[0] * math.copysign(abs(rate) ** p[1], rate)
    if kind == 72:
        return hidden if touching else 0.0
    if kind == 78:
        away = (time - p[1]) / p[2]
        return p[0] * math.cos(0.5 * math.pi * away) ** 2 if abs(away) < 1.0 else 0.0
    if kind == 79:
        return p[0] * math.sin(2.0 * math.pi * p[1] * time) * math.exp(-time / p[2])
    if kind == 80:
        over = abs(d) - p[2]
        return math.copysign(min(p[0] * over, p[3]), d) + p[1] * rate if over > 0.0 else 0.0
    return _friction(kind, p, d, rate, hidden)


@numba.njit(cache=True)
def _first_loading(x: float, corners: np.ndarray, slope: float, terms: Any, first: int, last: int) -> float:
    start, low = 0.0, 0.0
    for i in range(corners.shape[0]):
        if x < corners[i, 0]:
            slope = (corners[i, 1] - low) / (corners[i, 0] - start)
            break
        start, low = corners[i, 0], corners[i, 1]
    force = low + slope * (x - start)
    if x <= 0.0:
        return force
    for i in range(first, last):
        if 10 <= terms[i].kind < 30:
            force += _on_the_curve(terms[i].kind, terms[i].numbers, x)
    return max(force, 0.0)


@numba.njit(cache=True)
def link_force(
    link: Any,
    corners: np.ndarray,
    terms: Any,
    hidden: np.ndarray,
    change: np.ndarray,
    d: float,
    rate: float,
    d_max: float,
    time: float,
) -> float:
    """The force of a link, N, and in `change` the rates of its terms' hidden states."""
    first, last = link.first_term, link.last_term
    if first == last and d <= 0.0:
        return 0.0
    x, x_top = d, d_max
    for i in range(first, last):
        if terms[i].kind < 10:
            x, x_top = _engaged(terms[i].kind, terms[i].numbers, x), _engaged(terms[i].kind, terms[i].numbers, x_top)
    elastic = 0.0
    if link.unloading > 0.0:
        force = _first_loading(x_top, corners, link.slope, terms, first, last) - link.unloading * (x_top - x)
    else:
        force = elastic = _first_loading(x, corners, link.slope, terms, first, last)
    pulling = 0.0
    for i in range(first, last):
        kind, p = terms[i].kind, terms[i].numbers
        if 30 <= kind < 40 and x < x_top:
            peak = _first_loading(x_top, corners, link.slope, terms, first, last)
            force = p[0] * _unloading(kind, p, peak, x_top - x) + (1.0 - p[0]) * max(elastic, 0.0)
        if kind == 40 and force < 0.0:
            pulling += p[0] * force
        if kind == 41 and d < -p[1]:
            pulling -= min(p[0] * (-d - p[1]), p[2])
    static = max(force, 0.0) + pulling
    force = static
    for i in range(first, last):
        if 50 <= terms[i].kind < 70:
            force *= max(0.0, _factor(terms[i].kind, terms[i].numbers, x_top, rate, hidden[i]))
    total = force
    for i in range(first, last):
        kind, p = terms[i].kind, terms[i].numbers
        if kind == 58:
            change[i] = max(static, 0.0) * max(rate, 0.0)
        if kind == 72:
            change[i] = (p[0] * rate if x > 0.0 else 0.0) - hidden[i] / p[1]
        if kind == 73:
            change[i] = (force - hidden[i]) / p[1]
            total += p[0] * (force - hidden[i])
        elif kind >= 70:
            total += _beside(kind, p, x, rate, time, hidden[i])
        if kind == 76:
            change[i] = rate / p[1] * (1.0 - hidden[i] * math.copysign(1.0, rate))
    return max(total, 0.0) if link.one_way else total
