"""Penalised least squares in a banded basis, with the smoothing that generalised cross-validation chooses.

A symmetric banded matrix M is kept as LAPACK's lower band storage: band[k, j] = M[j + k, j].
"""

import numpy as np
from attrs import field, frozen
from numba import njit
from scipy import sparse
from scipy.linalg import cho_solve_banded, cholesky_banded

COARSE, FINE = 16, 13  # candidates over the whole range, then about the best
LARGEST_CONDITION = 1e14  # beyond it the decomposition fails
MOST_FREEDOM = 0.9  # of the samples: with as much freedom as samples the score is 0 / 0


@frozen
class Fit:
    """A fit with one smoothing.

    Attributes:
        coefficients: (coefficient,).
        covariance: its band, for samples with a standard deviation of 1.
        smoothing: the weight of the roughness.
        freedom: effective degrees of freedom, the trace of the influence matrix.
        residual: sum of squares.
        score: of generalised cross-validation.
    """

    coefficients: np.ndarray
    covariance: np.ndarray
    smoothing: float
    freedom: float
    residual: float
    score: float


@frozen
class PenalisedFit:
    """Minimises |z - B c|^2 + smoothing c'Rc.

    Arguments:
        basis: B, (sample, coefficient); the products of its columns are banded as R is.
        samples: z, (sample,).
        roughness: the band of R.
    """

    basis: sparse.csr_array
    samples: np.ndarray
    roughness: np.ndarray
    normal: np.ndarray = field(init=False)
    moments: np.ndarray = field(init=False)

    def __attrs_post_init__(self) -> None:
        object.__setattr__(self, "normal", lower_band(self.basis.T @ self.basis, len(self.roughness)))
        object.__setattr__(self, "moments", self.basis.T @ self.samples)

    def with_smoothing(self, smoothing: float) -> Fit:
        """The fit with this weight of the roughness."""
        factor = cholesky_banded(self.normal + smoothing * self.roughness, lower=True)
        coefficients = cho_solve_banded((factor, True), self.moments)
        covariance = _inverse_band(factor)
        products = covariance * self.normal
        freedom = float(2.0 * products.sum() - products[0].sum())
        residual = float(np.sum((self.samples - self.basis @ coefficients) ** 2))
        count = len(self.samples)
        score = count * residual / (count - freedom) ** 2 if freedom <= MOST_FREEDOM * count else np.inf
        return Fit(coefficients, covariance, smoothing, freedom, residual, score)

    def by_cross_validation(self) -> Fit:
        """The fit whose smoothing minimises V = n |(I - A) z|^2 / tr(I - A)^2, with A the influence matrix.

        On [0, 1] the roughness of k half waves is (pi k)^6 / n times their square. The candidates reach from the smoothing
        that halves the roughest wave to the one that halves the smoothest, as far as the digits go.

        Craven & Wahba 1978, doi:10.1007/BF01404567.
        """
        span = float(len(self.moments)) ** 6
        least = len(self.samples) / np.pi**6 / span
        most = least * min(span, LARGEST_CONDITION)
        coarse = np.geomspace(least, most, COARSE)
        best = self._best(coarse)
        step = coarse[1] / coarse[0]
        return self._best(np.geomspace(best.smoothing / step, min(best.smoothing * step, most), FINE))

    def _best(self, candidates: np.ndarray) -> Fit:
        return min((self.with_smoothing(float(smoothing)) for smoothing in candidates), key=lambda fit: fit.score)


def lower_band(matrix: sparse.csr_array, diagonals: int) -> np.ndarray:
    """The band of a symmetric matrix: (diagonals, coefficient)."""
    band = np.zeros((diagonals, matrix.shape[0]))
    for k in range(min(diagonals, matrix.shape[0])):
        band[k, : matrix.shape[0] - k] = matrix.diagonal(-k)
    return band


def symmetric(band: np.ndarray) -> sparse.csr_array:
    """The matrix of a band: (coefficient, coefficient)."""
    count = band.shape[1]
    lower = [row[: count - k] for k, row in enumerate(band)]
    offsets = range(-len(band) + 1, len(band))
    return sparse.diags_array(lower[:0:-1] + lower, offsets=list(offsets), shape=(count, count)).tocsr()


@njit(cache=True)
def _inverse_band(factor: np.ndarray) -> np.ndarray:  # pragma: no cover
    """The band of Z = (L L')^-1 from the band of L: L'Z = L^-1, from the last column to the first.

    Hutchinson & de Hoog 1985, doi:10.1007/BF01389878.
    """
    diagonals, count = factor.shape
    inverse = np.zeros((diagonals, count))
    for column in range(count - 1, -1, -1):
        last = min(column + diagonals, count) - 1
        for row in range(last, column - 1, -1):
            total = 1.0 / factor[0, column] if row == column else 0.0
            for k in range(column + 1, last + 1):
                total -= factor[k - column, column] * inverse[abs(row - k), min(row, k)]
            inverse[row - column, column] = total / factor[0, column]
    return inverse
