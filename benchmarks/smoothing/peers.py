"""Who else smooths and differentiates, each as its documentation has it; None where a peer is not installed."""

import warnings
from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
from numpy.polynomial import Polynomial
from scipy.interpolate import UnivariateSpline, make_smoothing_spline
from scipy.signal import savgol_filter

from benchmarks.smoothing.pulses import BANDWIDTH, Recorded
from crashkit.registry import load
from crashkit_smoothers.knots import knot_vector
from crashkit_smoothers.penalised_spline import PenalisedSpline

Curves = np.ndarray
"""Position, velocity and acceleration, (3, sample)."""
Method = Callable[[Recorded], Curves]

NAMES = ("value", "first_derivative", "second_derivative")


def ours(name: str) -> Method:
    """One of crashkit's smoothers."""
    smoother = load().smoother(name)()

    def smoothed(recorded: Recorded) -> Curves:
        smooth = smoother.smooth(recorded.channel)
        return np.stack([smooth[name].values for name in NAMES])

    return smoothed


def savgol(recorded: Recorded) -> Curves:
    """Savitzky and Golay's filter, 41 samples and degree 4, as chosen for this case by hand."""
    step = recorded.times[1] - recorded.times[0]
    return np.stack([savgol_filter(recorded.samples, 41, 4, deriv=order, delta=step) for order in range(3)])


def scipy_spline(recorded: Recorded, unit: float = 1e3) -> Curves:
    """scipy's cubic spline with its own cross-validation; the search for its parameter works best with time in ms."""
    spline = make_smoothing_spline(recorded.times * unit, recorded.samples)
    return np.stack([spline(recorded.times * unit, nu=order) * unit**order for order in range(3)])


def univariate_spline(recorded: Recorded) -> Curves:
    """scipy's (Dierckx's) quintic spline, which has to be told the noise."""
    spline = UnivariateSpline(recorded.times, recorded.samples, k=5, s=len(recorded.times) * recorded.noise**2)
    return np.stack([spline(recorded.times, nu=order) for order in range(3)])


def csaps_spline(recorded: Recorded) -> Curves:
    """csaps with its automatic parameter."""
    from csaps import CubicSmoothingSpline

    spline = CubicSmoothingSpline(recorded.times, recorded.samples)
    return np.stack([spline(recorded.times, nu=order) for order in range(3)])


def pynumdiff_spline(recorded: Recorded) -> Curves:
    """pynumdiff's spline, its parameters optimised for a known bandwidth."""
    return _pynumdiff("splinediff", recorded, {})


def pynumdiff_kalman(recorded: Recorded) -> Curves:
    """pynumdiff's Kalman smoother for constant acceleration, its ratio of noises optimised for a known bandwidth."""
    return _pynumdiff("rtsdiff", recorded, {"order": 2, "forwardbackward": False, "log_qr_ratio": [4.0, 10.0]})


def _pynumdiff(name: str, recorded: Recorded, search: dict[str, object]) -> Curves:
    """Position and velocity; the acceleration is the velocity's difference quotient."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a convex solver that these methods do not use
        import pynumdiff
        from pynumdiff.optimize import optimize

        method, step = getattr(pynumdiff, name), float(recorded.times[1] - recorded.times[0])
        parameters, _ = optimize(
            method, recorded.samples, step, bandlimit=BANDWIDTH, search_space_updates=search, parallel=False
        )
        position, velocity = method(recorded.samples, step, **parameters)
    return np.stack([position, velocity, np.gradient(velocity, step)])


def oracle(recorded: Recorded) -> Curves:
    """The quintic smoothing spline with that one parameter whose acceleration is nearest to the truth."""
    x = recorded.times / recorded.times[-1]
    trend = Polynomial.fit(x, recorded.samples, 2, domain=[0.0, 1.0])
    knots = knot_vector(x, min(len(x) - 2, 600), 5)
    spline = PenalisedSpline.of(x, recorded.samples - trend(x), np.ones(len(x)), knots, 3)

    def curves(logarithm: float) -> Curves:
        values, _ = spline.evaluated(x, spline.with_smoothing(len(x) * 10.0**logarithm))
        scale = recorded.times[-1] ** np.arange(3)[:, None]
        return (values + np.stack([trend.deriv(order)(x) for order in range(3)])) / scale

    return min((curves(p) for p in np.linspace(-13.0, -4.0, 60)), key=lambda c: float(np.sum((c[2] - recorded.truth[2]) ** 2)))


def installed(module: str, method: Method) -> Method | None:
    """The method, if its module is there."""
    return method if find_spec(module) else None


AUTOMATIC: dict[str, Method | None] = {
    "scipy make_smoothing_spline, ms": scipy_spline,
    "csaps, automatic": installed("csaps", csaps_spline),
}
TOLD: dict[str, Method | None] = {
    "scipy UnivariateSpline, noise known": univariate_spline,
}
EVEN_ONLY: dict[str, Method | None] = {
    "scipy savgol_filter, 41 and 4": savgol,
}
SLOW: dict[str, Method | None] = {
    "pynumdiff splinediff, bandwidth known": installed("pynumdiff", pynumdiff_spline),
    "pynumdiff rtsdiff, bandwidth known": installed("pynumdiff", pynumdiff_kalman),
}
BEST = "adaptive_quintic"
OWN = ("gcv_cubic", "gcv_quintic", "gcv_heptic")
