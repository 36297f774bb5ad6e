"""Declared variables: one frozen spec each, from which validation and documentation follow."""

from attrs import field, frozen


@frozen
class Variable:
    """A variable of a group.

    Arguments:
        name: of the variable.
        dims: in order; "a|b" where alternatives are allowed.
        units: CF spelling; None for text or flags without units.
        kind: "number", "text" or "flag" (0/1).
        meaning: one phrase for people.
        required: whether the group must hold it.
        allow_nan: whether single values may be missing; a channel that is NaN throughout is always refused.
    """

    name: str
    dims: tuple[str, ...]
    units: str | None
    meaning: str
    kind: str = "number"
    required: bool = True
    allow_nan: bool = False


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
