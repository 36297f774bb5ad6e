"""Factors by which a joint's force rises with the rate at which it is deformed."""

import math

from crashkit.protocols import ParameterSpec, SpringLaw

ROUNDING = 0.01
"""m s-1, below which a power of the rate is rounded off: its slope at rest would be infinite."""


class RateLinear(SpringLaw):
    """A rise in proportion to the rate: max(0, 1 + a ddot) (Mizzi & Jezequel 1992, eq 1)."""

    name = "rate_linear"
    unit = "1"
    parameters = (
        ParameterSpec("rate_slope", "s m-1", "relative rise of the force with deformation rate (a)", lower=0.0, null=0.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, rate_slope: float) -> float:
        """The factor."""
        return max(0.0, 1.0 + rate_slope * ddot)


class RatePower(SpringLaw):
    """A rise with a power of the rate while loading: 1 + A (ddot / 1 m/s)^n, after Cowper and Symonds (1957).

    In their form, 1 + (rate / D)^(1/q), n is 1/q and A is D^(-1/q), with D as a rate of deformation in m/s. With
    r = max(ddot, 0) and r0 = 0.01 m/s the power is (r^2 + r0^2)^(n/2) - r0^n, smooth at rest.
    """

    name = "rate_power"
    unit = "1"
    parameters = (
        ParameterSpec("rate_amplitude", "1", "relative rise of the force at 1 m/s (A)", lower=0.0, null=0.0),
        ParameterSpec("rate_exponent", "1", "exponent of the rate (n)", lower=0.05, upper=2.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, rate_amplitude: float, rate_exponent: float) -> float:
        """The factor."""
        rate = max(0.0, ddot)
        power = (rate * rate + ROUNDING * ROUNDING) ** (rate_exponent / 2.0) - ROUNDING**rate_exponent
        return 1.0 + rate_amplitude * power


class RateLogarithm(SpringLaw):
    """A rise with the logarithm of the rate while loading: 1 + A ln(1 + ddot / reference_rate), after Johnson and Cook (1983).

    Their form, 1 + C ln(rate / reference rate) above the reference rate, has the same C = A and the same slope in ln(rate) at
    high rates; the 1 in the logarithm lets it begin at rest without a corner.
    """

    name = "rate_logarithm"
    unit = "1"
    parameters = (
        ParameterSpec("rate_amplitude", "1", "relative rise of the force for e times the rate (A, or C)", lower=0.0, null=0.0),
        ParameterSpec("reference_rate", "m s-1", "rate about which the force begins to rise", lower=1e-3, upper=100.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, rate_amplitude: float, reference_rate: float) -> float:
        """The factor."""
        return 1.0 + rate_amplitude * math.log(1.0 + max(0.0, ddot) / reference_rate)


class RateSaturating(SpringLaw):
    """A rise with the rate while loading that has a limit: 1 + A ddot / (ddot^n + r^n)^(1 / n)."""

    name = "rate_saturating"
    unit = "1"
    parameters = (
        ParameterSpec("rate_amplitude", "1", "relative rise of the force in the end (A)", lower=0.0, null=0.0),
        ParameterSpec("reference_rate", "m s-1", "rate at which it would be there along a line (r)", lower=1e-3, upper=100.0),
        ParameterSpec("limit_sharpness", "1", "1: it bends at once; more: late and sharply (n)", 1.0, 20.0, 1.0, free=False),
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, rate_amplitude: float, reference_rate: float, limit_sharpness: float
    ) -> float:
        """The factor."""
        rate = max(1e-12, ddot) / reference_rate  # 0^n has no derivative to n
        return 1.0 + rate_amplitude * rate / (1.0 + rate**limit_sharpness) ** (1.0 / limit_sharpness)


class RateRising(SpringLaw):
    """A rise with the rate while loading that is given in steps, each smooth: any curve that does not fall.

    1 + sum_i rises[i] (s_i(ddot) - s_i(0)), s_i = tanh(1.5 (n ddot / rising_reach - i - 1/2)) / 2 for n rises; about flat
    beyond rising_reach.
    """

    name = "rate_rising"
    unit = "1"
    parameters = (
        ParameterSpec("rises", "1", "relative rise of the force in each step", lower=0.0, vector=True, null=0.0),
        ParameterSpec("rising_reach", "m s-1", "rate that the steps cover", lower=1e-3, free=False),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, rises: list[float], rising_reach: float) -> float:
        """The factor."""
        place = max(0.0, ddot) / rising_reach * len(rises)
        total = 1.0
        for i, rise in enumerate(rises):
            total = total + 0.5 * rise * (math.tanh(1.5 * (place - i - 0.5)) + math.tanh(1.5 * (i + 0.5)))
        return total


class RateEyring(SpringLaw):
    """A rise with the logarithm of the rate, and a fall on the way back: max(0, 1 + A asinh(ddot / r)), after Eyring (1936).

    For polymers; doi:10.1063/1.1749836. r is `reference_rate`.
    """

    name = "rate_eyring"
    unit = "1"
    parameters = (
        ParameterSpec("rate_amplitude", "1", "relative rise of the force for e times the rate (A)", lower=0.0, null=0.0),
        ParameterSpec("reference_rate", "m s-1", "rate about which the force begins to rise", lower=1e-3, upper=100.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, rate_amplitude: float, reference_rate: float) -> float:
        """The factor."""
        rate = ddot / reference_rate
        if rate >= 0.0:
            return 1.0 + rate_amplitude * math.log(rate + math.sqrt(rate * rate + 1.0))
        return max(0.0, 1.0 - rate_amplitude * math.log(math.sqrt(rate * rate + 1.0) - rate))
