"""The errors that a sensor can have, as parameters that can be identified; at their null the sensor is perfect."""

import math

from crashkit.data.instrument_errors import CLOCK
from crashkit.protocols import ParameterSpec

AXES = ("x", "y", "z")
UNITS = {"m s-2": ("m s-3", "s2 m-1", "s4 m-2"), "N": ("N s-1", "N-1", "N-2")}
"""Of a rate, and of the reciprocal and its square, by the unit itself."""


def channel_errors(unit: str, full_scale: float) -> tuple[ParameterSpec, ...]:
    """The error parameters of a channel.

    Arguments:
        unit: of the recorded values, one of UNITS.
        full_scale: about the largest value that such sensors record, for the bounds.
    """
    rate, reciprocal, square = UNITS[unit]
    return (
        ParameterSpec("gain", "1", "recorded per true", 0.2, 5.0, default=1.0, null=1.0),
        ParameterSpec("bias", unit, "offset of the recorded values", default=0.0, null=0.0),
        ParameterSpec("bias_drift", rate, "change of the offset with time, 0 at t = 0", default=0.0, null=0.0),
        ParameterSpec("zero_shift", unit, "by how much the offset changes in a shock", default=0.0, null=0.0),
        ParameterSpec("zero_shift_time", "s", "middle of that change", default=0.0, null=0.0),
        _shape("zero_shift_rise", "s", "a quarter of the time that it takes", 1e-5, 0.1, 1e-3),
        *(_around_null(f"tilt_{axis}", "rad", f"rotation of the sensing axes about {axis}", 0.5) for axis in AXES),
        *(_around_null(f"transverse_{axis}", "1", f"share of {axis} in channels across it", 0.5) for axis in AXES),
        _around_null("quadratic", reciprocal, "quadratic term of the linearity", 1.0 / full_scale),
        _around_null("cubic", square, "cubic term of the linearity", 1.0 / full_scale**2),
        _around_null("hysteresis", unit, "half the distance of the falling and the rising branch", 0.1 * full_scale),
        _shape(
            "hysteresis_travel", unit, "way from one branch to the other", 1e-3 * full_scale, full_scale, 0.05 * full_scale
        ),
        _limit("saturation", unit, "size beyond which readings clip"),
        _limit("saturation_above", unit, "the same of readings above 0 only"),
        _limit("saturation_below", unit, "the same of readings below 0 only"),
        _limit("saturation_soft", unit, "size towards which readings bend"),
        _limit("saturation_knee", unit, "the same, in a knee"),
        _shape("knee_sharpness", "1", "of that knee: 1 bends from the start, 30 clips", 1.0, 30.0, 8.0),
        _around_null("resonance_share", "1", "how much of the reading comes through a ringing mount", 1.0),
        _shape("resonance_frequency", "s-1", "natural frequency of the mount", 10.0, 2e4, 500.0),
        _shape("resonance_damping", "1", "damping of the mount, of critical", 1e-3, 0.99, 0.05),
        _shape(
            "resonance_path", "1", "1: through the mount's damper too; 0: its spring alone, a sensing element", 0.0, 1.0, 1.0
        ),
        *CLOCK,
    )


POSITION_ERRORS = tuple(
    ParameterSpec(f"position_{axis}", "m", f"how far along {axis} the sensor sits from its point", -0.5, 0.5, 0.0, null=0.0)
    for axis in AXES
)

LEAN = ParameterSpec("lean", "rad", "angle out of the axis of a model on a line, towards gravity", -1.5, 1.5, 0.0, null=0.0)


def _around_null(name: str, unit: str, meaning: str, bound: float) -> ParameterSpec:
    return ParameterSpec(name, unit, meaning, -bound, bound, default=0.0, null=0.0)


def _limit(name: str, unit: str, meaning: str) -> ParameterSpec:
    return ParameterSpec(name, unit, meaning, 0.0, default=math.inf, null=math.inf)


def _shape(name: str, unit: str, meaning: str, lower: float, upper: float, usual: float) -> ParameterSpec:
    """A parameter that only shapes another error: without effect while that one is at its null."""
    return ParameterSpec(name, unit, meaning, lower, upper, default=usual, null=usual)
