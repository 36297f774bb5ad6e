"""A number of a model that may be free to be identified, and a sum of several that is known."""

import math

from attrs import frozen


@frozen
class Parameter:
    """A value with its bounds; `fixed` parameters are not identified.

    Attributes:
        size: how large it is expected to be, either way from zero, before anything is recorded; infinite: nothing is expected.
    """

    value: float
    lower: float = -math.inf
    upper: float = math.inf
    fixed: bool = False
    size: float = math.inf


@frozen
class KnownSum:
    """What several numbers of a model come to, of which each may be free: a hypothesis may part what was weighed as one.

    Attributes:
        paths: of the numbers.
        total: that they come to.
        std: how well that is known.
    """

    paths: tuple[str, ...]
    total: float
    std: float
