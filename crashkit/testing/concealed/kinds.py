"""The terms that a secret adds to the force of a joint."""

from enum import IntEnum

NUMBERS = 5
"""How many numbers a term has room for."""


class Kind(IntEnum):
    """What a term does; its numbers, in their order, in brackets. The groups begin at 0, 10, 30, 40, 50 and 70."""

    # The deformation that counts.
    GAP = 0  # (gap)
    TOE = 1  # (gap, toe): a parabola over the toe
    # Added to the force of first loading.
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
    # How it unloads.
    UNLOAD_LINE = 30  # (share, stiffness)
    UNLOAD_FADE = 31  # (share, length): exponential
    UNLOAD_TWO = 32  # (share, first stiffness, second stiffness): changes at half the force
    # How it pulls.
    PULL_LAW = 40  # (share): the line goes on below zero
    PULL_STRAP = 41  # (stiffness, slack, limit)
    # Factors of the force.
    RATE_LINEAR = 50  # (s/m)
    RATE_POWER = 51  # (size, reference rate, power)
    RATE_EYRING = 52  # (size, reference rate): asinh
    RATE_SATURATING = 53  # (size, reference rate)
    RATE_WINDOW = 54  # (size, middle rate, half width)
    BREAK_SUDDEN = 55  # (share lost, place)
    BREAK_RAMP = 56  # (share lost, place, width)
    BREAK_TWICE = 57  # (share lost, place, way to the second)
    SOFTENING = 58  # (share lost, work); state: the work done so far
    DRIVEN = 59  # (size, reach): rises with the deformation of another joint, up to a limit
    # Forces beside the spring.
    DAMP_TOUCHING = 70  # (coefficient, power)
    DAMP_ALWAYS = 71  # (coefficient, power)
    MAXWELL = 72  # (stiffness, time); state: the branch's force
    LAG = 73  # (share, time): the fresh part of the force fades; state: the force as it was
    FRICTION = 74  # (force, rate, always)
    FRICTION_STRIBECK = 75  # (force, rate, always, rate at which it has fallen)
    FRICTION_BRISTLE = 76  # (force, bristle, always); state: the bristle's share of its full deflection
    FRICTION_LATER = 77  # (force, rate, start)
    PULSE = 78  # (force, time, half width)
    HUM = 79  # (force, frequency, decay time)
    TIE = 80  # (stiffness, damping, slack, limit): both ways
