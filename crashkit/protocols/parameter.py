"""How a plugin declares a parameter: once, for files, docs, identification and reports."""

import math

from attrs import frozen


@frozen
class ParameterSpec:
    """A parameter as its plugin declares it.

    Arguments:
        name: as written in model files.
        unit: CF spelling, for example "N m-1".
        meaning: one phrase for people.
        lower, upper: bounds in `unit`; a parameter whose lower bound is above 0 is searched in its logarithm.
        default: the value when a file omits it (then it is fixed); None: the file must give it.
        free: whether a plain number in a file is free to be identified.
        vector: True for a list of numbers, one parameter each.
        increasing: whether the numbers of a vector must increase strictly.
        null: the value at which the physics of this parameter is absent; a plain number equal to it is fixed.
    """

    name: str
    unit: str
    meaning: str
    lower: float = -math.inf
    upper: float = math.inf
    default: float | None = None
    free: bool = True
    vector: bool = False
    null: float | None = None
    increasing: bool = False
