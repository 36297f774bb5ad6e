"""A channel as a polynomial, a random sine series whose power falls with frequency, and white noise."""

from typing import Self

import numpy as np
from attrs import frozen
from scipy.optimize import minimize

DECAYS = (2.75, 4.5)
"""Half the power with which the prior power falls: below 2.5 an acceleration has no variance, above 4.5 an end no doubt."""
CORNERS = 12
SLOPES = (3.0, 4.0)
"""Candidates before the search."""
TINY = np.finfo(float).tiny


@frozen
class Law:
    """The power of mode k over that of the noise is (corner / k)^(2 decay)."""

    corner: float
    decay: float

    def noise_share(self, modes: int) -> np.ndarray:
        """(mode,) v_k, the share of noise in the power of mode k = 1, 2, ..."""
        power = 2.0 * self.decay * (np.log(np.arange(1, modes + 1)) - np.log(self.corner))
        return 1.0 / (1.0 + np.exp(-power))


@frozen
class Estimate:
    """What a law makes of the data.

    Attributes:
        law: of the power.
        factors: of the columns, (column,).
        covariance: theirs, for noise 1.
        amplitudes: of the series, (mode,).
        freedom: effective degrees of freedom.
        square: of the residuals, weighed by their covariance.
        deviance: -2 ln L and what the polynomials cost.
    """

    law: Law
    factors: np.ndarray
    covariance: np.ndarray
    amplitudes: np.ndarray
    freedom: float
    square: float
    deviance: float


@frozen
class SpectralModel:
    """data = columns . factors + series + noise, mode by mode; in all modes the noise has the same variance.

    Attributes:
        data: (equation,) amplitudes of the samples.
        columns: (equation, column) amplitudes of what has no prior: the polynomials, then a 1 at each missing sample.
        modes: the first of them that the series has; the others hold noise only.
        count: the number of samples.
        missing: the number of missing samples.
        variance: of the noise if it is known.
        rounding: what the rounding of digits adds to the sum of squares.
    """

    data: np.ndarray
    columns: np.ndarray
    modes: int
    count: int
    missing: int
    variance: float | None
    rounding: float

    @classmethod
    def of(
        cls, data: np.ndarray, columns: np.ndarray, modes: int, missing: int, variance: float | None, rounding: float
    ) -> Self:
        """From all modes; those without the series are compressed to as many equations as there are unknowns, and one."""
        rest: np.ndarray = np.linalg.qr(np.column_stack([columns[modes:], data[modes:]])).R
        return cls(
            data=np.concatenate([data[:modes], rest[:, -1]]),
            columns=np.concatenate([columns[:modes], rest[:, :-1]]),
            modes=modes,
            count=len(data) - missing,
            missing=missing,
            variance=variance,
            rounding=rounding,
        )

    @property
    def polynomials(self) -> int:
        """The number of polynomials."""
        return self.columns.shape[1] - self.missing

    def best(self) -> Estimate:
        """The law of the greatest likelihood."""
        corners = np.geomspace(1.5, max(0.7 * self.modes, 2.0), CORNERS)
        start = min(((c, d) for c in corners for d in SLOPES), key=lambda pair: self.estimate(Law(*pair)).deviance)
        found = minimize(
            lambda logs: self.estimate(Law(*np.exp(logs))).deviance,
            np.log(start),
            method="Nelder-Mead",
            bounds=np.log([(1.0, self.modes), DECAYS]),
            options={"xatol": 1e-3, "fatol": 1e-3},
        )
        return self.estimate(Law(*np.exp(found.x)))

    def estimate(self, law: Law) -> Estimate:
        """Columns by generalised least squares, series by its conditional mean, and their likelihood (Whittle's)."""
        share = np.ones(len(self.data))
        share[: self.modes] = law.noise_share(self.modes)
        weighed = share[:, None] * self.columns
        normal = self.columns.T @ weighed
        covariance = np.linalg.inv(normal)
        factors = covariance @ (weighed.T @ self.data)
        residual = self.data - self.columns @ factors
        square = float(np.sum(share * residual**2)) + self.rounding
        signal = 1.0 - share[: self.modes]
        return Estimate(
            law=law,
            factors=factors,
            covariance=covariance,
            amplitudes=signal * residual[: self.modes],
            freedom=float(signal.sum() + np.sum(covariance * (weighed.T @ weighed))) - self.missing,
            square=square,
            deviance=self._deviance(share, normal, square),
        )

    def _deviance(self, share: np.ndarray, normal: np.ndarray, square: float) -> float:
        """-2 ln L, the noise at its own best unless it is known, and ln n for each polynomial (Schwarz)."""
        p = self.polynomials
        fit = self.count * np.log(max(square, TINY) / self.count) if self.variance is None else square / self.variance
        gaps = np.linalg.slogdet(normal[p:, p:])[1] if self.missing else 0.0
        return float(fit - np.sum(np.log(share[: self.modes])) + gaps + p * np.log(self.count))
