"""A number of a model that may be free to be identified."""

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
