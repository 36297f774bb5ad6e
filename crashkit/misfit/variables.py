"""What an identifier searches: the free parameters of a model, and what is known of them beforehand."""

import math
from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from attrs import frozen

from crashkit.model import KnownSum, Model, Parameter


@frozen
class Prior:
    """What is known of parameters beforehand.

    Attributes:
        centres: values by path, none of them 0.
        std: relative to each; of its logarithm where that is searched.
    """

    centres: Mapping[str, float]
    std: float


NO_PRIOR = Prior({}, math.inf)
FARTHEST = 10.0
"""Standard deviations. A model without what it lacks may drive a stiffness to a thousand times what the user believes: its
joint then rattles, each run takes a hundred times as long, and nothing is learnt."""
FAR = 2.0
"""Standard deviations from which a parameter is far from what is known of it; that many are a little off says nothing."""
STRAINED = 9.0
"""Chi squared of those that are far off, from which they may make up for something."""


class SearchVariables:
    """Free parameters as search variables: the logarithm of one whose lower bound is above 0, else the parameter itself.

    Arguments:
        free: by path.
        prior: what is known of some of them.
        sums: of some of them, that are known.
    """

    def __init__(self, free: Mapping[str, Parameter], prior: Prior, sums: Sequence[KnownSum] = ()) -> None:
        self.prior = prior
        self.names, self._free = tuple(free), tuple(free.values())
        self._log = np.array([parameter.lower > 0 for parameter in self._free], dtype=bool)
        expected = [self._expected(name, parameter) for name, parameter in free.items()]
        self._known = np.flatnonzero([std < math.inf for _, std in expected])
        self._centres, self._stds = np.array(expected).reshape(-1, 2)[self._known].T
        self._sums = np.array([np.isin(self.names, one.paths) / one.std for one in sums]).reshape(len(sums), len(free))
        self._totals = np.array([one.total / one.std for one in sums])

    def start(self) -> np.ndarray:
        """The model's own values, as search variables."""
        return self.scaled(np.array([parameter.value for parameter in self._free]))

    def start_at(self, values: Mapping[str, float]) -> np.ndarray:
        """These values by path, and the model's own for the rest, as search variables."""
        return self.scaled(np.array([values.get(n, p.value) for n, p in zip(self.names, self._free, strict=True)]))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds of the search variables; logarithms stay within `FARTHEST` of what is known beforehand."""
        lower, upper = self._bounds
        return lower.copy(), upper.copy()

    @cached_property
    def _bounds(self) -> tuple[np.ndarray, np.ndarray]:
        lower, upper = (self.scaled(np.array([getattr(one, end) for one in self._free])) for end in ("lower", "upper"))
        known = [i for i in np.flatnonzero(self._log) if self.names[i] in self.prior.centres]
        centres = np.log([self.prior.centres[self.names[i]] for i in known])
        lower[known] = np.maximum(lower[known], centres - FARTHEST * self.prior.std)
        upper[known] = np.minimum(upper[known], centres + FARTHEST * self.prior.std)
        return lower, upper

    def scaled(self, values: np.ndarray) -> np.ndarray:
        """Search variables: the logarithm of parameters whose lower bound is above 0."""
        scaled = np.array(values, dtype=float)
        scaled[self._log] = np.log(scaled[self._log])
        return scaled

    def parameters(self, scaled: np.ndarray) -> np.ndarray:
        """The parameters in their own units."""
        values = np.array(scaled, dtype=float)
        with np.errstate(over="ignore"):  # an interval that is open has no end
            values[self._log] = np.exp(values[self._log])
        return values

    def scaling(self, scaled: np.ndarray) -> np.ndarray:
        """d parameter / d search variable."""
        return np.where(self._log, self.parameters(scaled), 1.0)

    def values(self, scaled: np.ndarray) -> dict[str, float]:
        """The parameters by path."""
        return dict(zip(self.names, self.parameters(scaled).tolist(), strict=True))

    def belief(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The residuals of what is known of parameters beforehand, and their derivatives to the search variables."""
        alone = np.eye(len(scaled))[self._known] / self._stds[:, None]
        return self._departure(scaled), np.vstack([alone, self._sums * self.scaling(scaled)])

    def is_strained(self, scaled: np.ndarray) -> bool:
        """Whether some parameters are so far from what is known of them beforehand that they may make up for something."""
        apart = self._departure(scaled)
        return bool(np.sum(apart[np.abs(apart) >= FAR] ** 2) >= STRAINED)

    def _departure(self, scaled: np.ndarray) -> np.ndarray:
        alone = (scaled[self._known] - self._centres) / self._stds
        return np.concatenate([alone, self._sums @ self.parameters(scaled) - self._totals])

    def _expected(self, name: str, parameter: Parameter) -> tuple[float, float]:
        """Mean and standard deviation of a search variable beforehand."""
        if name not in self.prior.centres:
            return 0.0, parameter.size
        centre, std = self.prior.centres[name], self.prior.std
        return (math.log(centre), std) if parameter.lower > 0 else (centre, std * abs(centre))

    def known_to(self, std: float) -> Prior:
        """That the values are known to about `std`, relative to each; of zeros nothing is known."""
        return Prior({n: p.value for n, p in zip(self.names, self._free, strict=True) if p.value and math.isinf(p.size)}, std)


def sums_of_free(model: Model) -> list[KnownSum]:
    """The known sums of a model, of their free parameters alone."""
    free, values = model.free_parameters(), model.values()
    return [_of_free(one, free, values) for one in model.sums if not free.keys().isdisjoint(one.paths)]


def _of_free(known: KnownSum, free: Mapping[str, Parameter], values: Mapping[str, float]) -> KnownSum:
    rest = sum(values[path] for path in known.paths if path not in free)
    return KnownSum(tuple(path for path in known.paths if path in free), known.total - rest, known.std)
