"""All compiled code of the world, in one file: numba's cache does not notice changes elsewhere.

The force of a joint is a broken line that is crushed for good, and the terms that a secret adds to it.
"""

import math
from typing import Any

import numba
import numpy as np

from crashkit.testing.concealed.kinds import Kind


@numba.njit(cache=True)
def follow(
    joints: Any,
    corners: np.ndarray,
    terms: Any,
    mobility: np.ndarray,
    position: np.ndarray,
    velocity: np.ndarray,
    steps: int,
    h: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Positions, velocities, accelerations (3, time, body) and forces (time, joint), by the classical Runge-Kutta method.

    `joints` and `terms` are tables with a row for each, `corners` (joint, corner, 2) in m and N, `mobility` in 1/kg, `h` in s.
    """
    bodies, number = len(mobility), len(terms)
    motion, forces = np.empty((3, steps, bodies)), np.empty((steps, len(joints)))
    x, v, z, d_max = position.copy(), velocity.copy(), np.zeros(number), np.zeros(len(joints))
    a, dz, unused = np.zeros((4, bodies)), np.zeros((4, number)), np.zeros(len(joints))
    xs, vs, zs = np.empty((3, bodies)), np.empty((3, bodies)), np.empty((3, number))
    for n in range(steps):
        time = n * h
        _rates(joints, corners, terms, mobility, x, v, z, d_max, time, a[0], dz[0], forces[n])
        motion[0, n], motion[1, n], motion[2, n] = x, v, a[0]
        for stage in range(3):
            part = h if stage == 2 else 0.5 * h
            for i in range(bodies):
                xs[stage, i] = x[i] + part * (v[i] if stage == 0 else vs[stage - 1, i])
                vs[stage, i] = v[i] + part * a[stage, i]
            for i in range(number):
                zs[stage, i] = z[i] + part * dz[stage, i]
            y = xs[stage], vs[stage], zs[stage]
            _rates(joints, corners, terms, mobility, *y, d_max, time + part, a[stage + 1], dz[stage + 1], unused)
        for i in range(bodies):
            x[i] += h / 6.0 * (v[i] + 2.0 * vs[0, i] + 2.0 * vs[1, i] + vs[2, i])
            v[i] += h / 6.0 * (a[0, i] + 2.0 * a[1, i] + 2.0 * a[2, i] + a[3, i])
        for i in range(number):
            z[i] += h / 6.0 * (dz[0, i] + 2.0 * dz[1, i] + 2.0 * dz[2, i] + dz[3, i])
        for j in range(len(joints)):
            joint = joints[j]
            d_max[j] = max(d_max[j], _deformation(joint, x))
    return motion, forces


@numba.njit(cache=True)
def _rates(
    joints: Any,
    corners: np.ndarray,
    terms: Any,
    mobility: np.ndarray,
    x: np.ndarray,
    v: np.ndarray,
    states: np.ndarray,
    d_max: np.ndarray,
    time: float,
    acceleration: np.ndarray,
    state_rates: np.ndarray,
    force: np.ndarray,
) -> None:
    """Accelerations, rates of the terms' states and forces at one instant."""
    acceleration[:] = 0.0
    for j in range(len(joints)):
        joint = joints[j]
        d = _deformation(joint, x)
        rate = -joint.side * (v[joint.back] - v[joint.front])
        curve = corners[j, : joint.corners]
        force[j] = _joint_force(joint, curve, terms, states, state_rates, d, rate, max(d_max[j], d), time)
        for i in range(joint.first_term, joint.last_term):
            if terms[i].kind == Kind.DRIVEN:
                force[j] *= _driven(terms[i].numbers, _deformation(joints[terms[i].driver], x))
        acceleration[joint.front] -= joint.side * force[j]
        acceleration[joint.back] += joint.side * force[j]
    for i in range(len(mobility)):
        acceleration[i] *= mobility[i]


@numba.njit(cache=True)
def _deformation(joint: Any, x: np.ndarray) -> float:
    return joint.length - joint.side * (x[joint.back] - x[joint.front])


@numba.njit(cache=True)
def _driven(p: np.ndarray, driver: float) -> float:
    """What the deformation of another joint multiplies the force by."""
    return max(0.0, 1.0 + p[0] * min(1.0, max(0.0, driver / p[1])))


@numba.njit(cache=True)
def _joint_force(
    joint: Any,
    corners: np.ndarray,
    terms: Any,
    states: np.ndarray,
    state_rates: np.ndarray,
    d: float,
    rate: float,
    d_max: float,
    time: float,
) -> float:
    """The force of a joint, N, compression positive; `state_rates` is given the rates of its terms' states.

    d, rate and d_max are the deformation (m), its rate (m s-1) and its largest value so far (m).
    """
    first, last = joint.first_term, joint.last_term
    if first == last and d <= 0.0:
        return 0.0
    x, x_max = d, d_max
    for i in range(first, last):
        if terms[i].kind < 10:
            x, x_max = _engaged(terms[i].kind, terms[i].numbers, x), _engaged(terms[i].kind, terms[i].numbers, x_max)
    static = _static_force(joint, corners, terms, d, x, x_max)
    force = static
    for i in range(first, last):
        if 50 <= terms[i].kind < Kind.DRIVEN:
            force *= max(0.0, _factor(terms[i].kind, terms[i].numbers, x_max, rate, states[i]))
    total = force
    for i in range(first, last):
        kind, p = terms[i].kind, terms[i].numbers
        state_rates[i] = _state_rate(kind, p, x, rate, static, force, states[i])
        if kind == Kind.LAG:
            total += p[0] * (force - states[i])
        elif kind >= 70:
            total += _beside(kind, p, x, rate, time, states[i])
    return max(total, 0.0) if joint.one_way else total


@numba.njit(cache=True)
def _engaged(kind: int, p: np.ndarray, d: float) -> float:
    """How far a joint is really compressed, m."""
    if kind == Kind.TOE and d > p[0]:
        over = d - p[0]
        return over * over / (2.0 * p[1]) if over < p[1] else over - 0.5 * p[1]
    return d - p[0]


@numba.njit(cache=True)
def _static_force(joint: Any, corners: np.ndarray, terms: Any, d: float, x: float, x_max: float) -> float:
    """The force of the spring at rest, N."""
    first, last = joint.first_term, joint.last_term
    elastic = pulling = 0.0
    if joint.unloading > 0.0:
        force = _first_loading(joint, corners, terms, x_max) - joint.unloading * (x_max - x)
    else:
        force = elastic = _first_loading(joint, corners, terms, x)
    for i in range(first, last):
        kind, p = terms[i].kind, terms[i].numbers
        if 30 <= kind < 40 and x < x_max:
            peak = _first_loading(joint, corners, terms, x_max)
            force = p[0] * _unloading(kind, p, peak, x_max - x) + (1.0 - p[0]) * max(elastic, 0.0)
        if kind == Kind.PULL_LAW and force < 0.0:
            pulling += p[0] * force
        if kind == Kind.PULL_STRAP and d < -p[1]:
            pulling -= min(p[0] * (-d - p[1]), p[2])
    return max(force, 0.0) + pulling


@numba.njit(cache=True)
def _first_loading(joint: Any, corners: np.ndarray, terms: Any, x: float) -> float:
    start, low, slope = 0.0, 0.0, joint.slope
    for i in range(corners.shape[0]):
        if x < corners[i, 0]:
            slope = (corners[i, 1] - low) / (corners[i, 0] - start)
            break
        start, low = corners[i, 0], corners[i, 1]
    force = low + slope * (x - start)
    if x <= 0.0:
        return force
    for i in range(joint.first_term, joint.last_term):
        if 10 <= terms[i].kind < 30:
            force += _on_the_curve(terms[i].kind, terms[i].numbers, x)
    return max(force, 0.0)


@numba.njit(cache=True)
def _on_the_curve(kind: int, p: np.ndarray, x: float) -> float:
    """What a term adds to the force of a first loading to x."""
    if kind == Kind.PEAK_TRIANGLE:
        return p[0] * max(0.0, 1.0 - abs(x - p[1]) / p[2])
    if kind == Kind.PEAK_BUMP:
        return p[0] * x / p[1] * math.exp(1.0 - x / p[1])
    if kind == Kind.PEAK_BELL:
        return p[0] * (math.exp(-(((x - p[1]) / p[2]) ** 2)) - math.exp(-((p[1] / p[2]) ** 2)) * max(0.0, 1.0 - x / p[1]))
    if kind == Kind.DENT:
        away = abs(x - p[1]) / p[2]
        return -p[0] * math.cos(0.5 * math.pi * away) ** 2 if away < 1.0 else 0.0
    return _fold(kind, p, x - p[2]) if kind <= Kind.FOLD_CHIRP else _stop(kind, p, x - p[1])


@numba.njit(cache=True)
def _fold(kind: int, p: np.ndarray, s: float) -> float:
    if s <= 0.0:
        return 0.0
    turns = s / p[1]
    if kind == Kind.FOLD_SINE:
        return p[0] * math.sin(2.0 * math.pi * turns)
    if kind == Kind.FOLD_SAW:
        phase = (turns + 0.05) % 1.0
        return p[0] * min(20.0 * phase - 1.0, 1.0 - 2.0 * (phase - 0.1) / 0.9)
    if kind == Kind.FOLD_ARCHES:
        return p[0] * min(1.0, 4.0 * turns) * (math.pi * abs(math.sin(math.pi * turns)) - 2.0)
    return p[0] * math.sin(2.0 * math.pi * turns * (1.0 + p[3] * turns))


@numba.njit(cache=True)
def _stop(kind: int, p: np.ndarray, s: float) -> float:
    if s <= 0.0:
        return 0.0
    if kind == Kind.STOP_LINE:
        return p[0] * s
    if kind == Kind.STOP_PARABOLA:
        return p[0] * (s / p[2]) ** 2
    if kind == Kind.STOP_POLE:
        return p[0] * (s / (p[2] - s) if s < 0.9 * p[2] else 9.0 + 100.0 * (s / p[2] - 0.9))
    if kind == Kind.STOP_EXPONENTIAL:
        return p[0] * (math.exp(min(s / p[2], 8.0)) - 1.0)
    return p[0] * (s / p[2]) ** 1.5


@numba.njit(cache=True)
def _unloading(kind: int, p: np.ndarray, peak: float, back: float) -> float:
    """The force after going `back` from where it was `peak`."""
    if kind == Kind.UNLOAD_LINE:
        return max(0.0, peak - p[1] * back)
    if kind == Kind.UNLOAD_FADE:
        return peak * math.exp(-back / p[1])
    half = 0.5 * peak / p[1]
    return peak - p[1] * back if back < half else max(0.0, 0.5 * peak - p[2] * (back - half))


@numba.njit(cache=True)
def _factor(kind: int, p: np.ndarray, x_max: float, rate: float, work: float) -> float:
    """What a term multiplies the force by."""
    if kind == Kind.RATE_LINEAR:
        return 1.0 + p[0] * rate
    if kind == Kind.RATE_EYRING:
        return 1.0 + p[0] * math.asinh(rate / p[1])
    if kind == Kind.BREAK_SUDDEN:
        return 1.0 - p[0] if x_max > p[1] else 1.0
    if kind == Kind.BREAK_RAMP:
        return 1.0 - p[0] * min(1.0, max(0.0, (x_max - p[1]) / p[2]))
    if kind == Kind.BREAK_TWICE:
        return 1.0 - 0.5 * p[0] * ((x_max > p[1]) + (x_max > p[1] + p[2]))
    if kind == Kind.SOFTENING:
        return 1.0 - p[0] * (1.0 - math.exp(-work / p[1]))
    if rate <= 0.0:
        return 1.0
    if kind == Kind.RATE_POWER:
        return 1.0 + p[0] * (rate / p[1]) ** p[2]
    if kind == Kind.RATE_SATURATING:
        return 1.0 + p[0] * rate / (rate + p[1])
    away = abs(rate - p[1]) / p[2]
    return 1.0 + p[0] * (1.0 - away) if away < 1.0 else 1.0


@numba.njit(cache=True)
def _beside(kind: int, p: np.ndarray, x: float, rate: float, time: float, state: float) -> float:
    """What a term adds to the force, beside the curve."""
    touching = x > 0.0
    if kind == Kind.DAMP_TOUCHING and not touching:
        return 0.0
    if kind == Kind.DAMP_TOUCHING or kind == Kind.DAMP_ALWAYS:
        return p[0] * math.copysign(abs(rate) ** p[1], rate)
    if kind == Kind.MAXWELL:
        return state if touching else 0.0
    if kind == Kind.PULSE:
        away = (time - p[1]) / p[2]
        return p[0] * math.cos(0.5 * math.pi * away) ** 2 if abs(away) < 1.0 else 0.0
    if kind == Kind.HUM:
        return p[0] * math.sin(2.0 * math.pi * p[1] * time) * math.exp(-time / p[2])
    if kind == Kind.TIE:
        over = abs(x) - p[2]
        return math.copysign(min(p[0] * over, p[3]), x) + p[1] * rate if over > 0.0 else 0.0
    return _friction(kind, p, x, rate, state)


@numba.njit(cache=True)
def _friction(kind: int, p: np.ndarray, x: float, rate: float, bristle: float) -> float:
    if kind == Kind.FRICTION_LATER:
        return p[0] * math.tanh(rate / p[1]) if x > p[2] else 0.0
    if p[2] == 0.0 and x <= 0.0:
        return 0.0
    if kind == Kind.FRICTION:
        return p[0] * 2.0 / math.pi * math.atan(0.5 * math.pi * rate / p[1])
    if kind == Kind.FRICTION_STRIBECK:
        return p[0] * math.tanh(rate / p[1]) * (1.0 + 0.6 * math.exp(-((rate / p[3]) ** 2)))
    return p[0] * bristle


@numba.njit(cache=True)
def _state_rate(kind: int, p: np.ndarray, x: float, rate: float, static: float, force: float, state: float) -> float:
    """How fast a term's state changes; 0 for terms without one."""
    if kind == Kind.SOFTENING:
        return max(static, 0.0) * max(rate, 0.0)
    if kind == Kind.MAXWELL:
        return (p[0] * rate if x > 0.0 else 0.0) - state / p[1]
    if kind == Kind.LAG:
        return (force - state) / p[1]
    if kind == Kind.FRICTION_BRISTLE:
        return rate / p[1] * (1.0 - state * math.copysign(1.0, rate))
    return 0.0
