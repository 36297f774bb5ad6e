"""The quintic smoothing spline whose smoothing is chosen by generalised cross-validation."""

import math

import numpy as np
import xarray as xr
from scipy import sparse

from crashkit.errors import CrashkitError
from crashkit.protocols import Smoother
from crashkit_smoothers.penalised_fit import Fit, PenalisedFit, lower_band, symmetric
from crashkit_smoothers.quintic_spline import DEGREE, basis, differentiation, knot_vector, roughness

FIRST_KNOTS = 200  # the condition grows with their sixth power: knots at all of 1e4 samples of a smooth motion lose all digits
WORTH = 0.99  # of the score, at the most, that three times the knots must reach to be kept
FEWEST_SAMPLES = 6


class GcvQuintic(Smoother):
    """Minimises sum (z_i - f(t_i))^2 + p integral (f''')^2 dt over quintic splines f, with p by generalised cross-validation.

    The bands are those of the Bayesian posterior, s^2 (B'B + p R)^-1, with B the basis, R its roughness and s the noise:
    s^2 = |(I - A) z|^2 / tr(I - A) with A the influence matrix, unless it is given. The noise is taken as white: a
    filtered channel is followed sample by sample, unless it is thinned out to independent ones first.

    Mizzi & Jezequel 1992, eq 31-32; Wahba 1983, doi:10.1111/j.2517-6161.1983.tb01239.x.
    """

    name = "gcv_quintic"
    degree = 2

    def smooth(self, samples: xr.DataArray, std: float | None = None) -> xr.Dataset:
        """Smooth one channel, as `Smoother.smooth` says.

        The attribute `smoothing_parameter` is p, in s^5.

        Raises CrashkitError where there are fewer than six samples.
        """
        times, present = samples["time"].values, np.isfinite(samples.values)
        count = int(present.sum())
        if count < FEWEST_SAMPLES:
            raise CrashkitError(f"gcv_quintic: expected at least {FEWEST_SAMPLES} samples, found {count}")
        duration = float(times[-1] - times[0])
        x = (times - times[0]) / duration  # without a unit, so that none matters
        z = samples.values[present].astype(float)
        parabola = np.polynomial.Polynomial.fit(x[present], z, self.degree)  # has no roughness: kept out of the rounding
        knots, fit = _fit(x[present], z - parabola(x[present]))
        covariance = symmetric(fit.covariance)
        noise = math.sqrt(fit.residual / (count - fit.freedom)) if std is None else std

        variables = {}
        for order, name in enumerate(("value", "first_derivative", "second_derivative")):
            rows, derivative = basis(x, knots, order), differentiation(knots, order)
            values = rows @ (derivative @ fit.coefficients) + parabola.deriv(order)(x)
            spread = _spread(rows, derivative @ covariance @ derivative.T)
            variables[name] = ("time", values / duration**order)
            variables[f"{name}_std"] = ("time", noise * spread / duration**order)
        attrs = {
            "noise_std": noise,
            "smoothing_parameter": fit.smoothing * duration**DEGREE,
            "effective_degrees_of_freedom": fit.freedom,
            "choice": f"generalised cross-validation chose {fit.freedom:.1f} degrees of freedom for {count} samples",
        }
        return xr.Dataset(variables, {"time": samples["time"]}, attrs)


def _fit(x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, Fit]:
    """The spline on as few knots as show all that the samples tell: the knots and the fit."""
    interior = FIRST_KNOTS
    knots, fit = _fit_on(knot_vector(x, interior), x, z)
    while interior < len(x):
        interior *= 3
        finer_knots, finer = _fit_on(knot_vector(x, interior), x, z)
        if finer.score > WORTH * fit.score:
            break
        knots, fit = finer_knots, finer
    return knots, fit


def _fit_on(knots: np.ndarray, x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, Fit]:
    return knots, PenalisedFit(basis(x, knots), z, lower_band(roughness(knots), DEGREE + 1)).by_cross_validation()


def _spread(rows: sparse.csr_array, covariance: sparse.csr_array) -> np.ndarray:
    """sqrt(diag(B C B')), the standard deviations of B c; every row of B reaches as many coefficients, side by side."""
    reach = rows.nnz // rows.shape[0]
    weights, places = rows.data.reshape(-1, reach), rows.indices.reshape(-1, reach)
    variance = np.zeros(rows.shape[0])
    for k, diagonal in enumerate(lower_band(covariance, reach)):
        products = weights[:, k:] * weights[:, : reach - k] * diagonal[places[:, : reach - k]]
        variance += (2.0 if k else 1.0) * products.sum(axis=1)
    return np.sqrt(variance)
