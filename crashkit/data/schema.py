"""Declared variables: one frozen spec each, from which validation and documentation follow."""

from attrs import field, frozen


@frozen
class Dimension:
    """A dimension that means the same in every group.

    Arguments:
        name: of the dimension and of its coordinate variable.
        meaning: one phrase for people.
        labelled: whether its coordinate variable must be there.
        values: the labels it may have (empty: any text).
        least: the smallest length it may have.
    """

    name: str
    meaning: str
    labelled: bool = True
    values: tuple[str, ...] = ()
    least: int = 1


@frozen
class Variable:
    """A variable of a group.

    Arguments:
        name: of the variable.
        dims: in order; "a|b" where alternatives are allowed.
        units: CF spelling; None for text or flags without units.
        meaning: one phrase for people.
        kind: "number", "text" or "flag" (0/1).
        required: whether the group must hold it.
        allow_nan: whether single values may be missing.
        allow_silent: whether all values of some channels may be.
        allow_infinite: whether values may be infinite (a bound that is not there).
        allow_negative: whether values may be below 0.
        positive: whether every value must be above 0 (a standard deviation).
    """

    name: str
    dims: tuple[str, ...]
    units: str | None
    meaning: str
    kind: str = "number"
    required: bool = True
    allow_nan: bool = False
    allow_silent: bool = False
    allow_infinite: bool = False
    allow_negative: bool = True
    positive: bool = False


@frozen
class Attribute:
    """An attribute of a group, with the values it may take (empty: any)."""

    name: str
    meaning: str
    values: tuple[object, ...] = ()
    required: bool = True


@frozen
class GroupSchema:
    """What a group of a recording, or a motion, holds; unknown extra variables and attributes are kept."""

    name: str
    variables: tuple[Variable, ...]
    attributes: tuple[Attribute, ...] = field(default=())
