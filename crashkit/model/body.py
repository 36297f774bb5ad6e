"""Rigid bodies."""

from attrs import field, frozen

from crashkit.model.parameter import Parameter


@frozen
class Body:
    """A rigid body; a fixed one (the obstacle) has no mass and never moves.

    Arguments:
        name: unique in the model.
        position: m, centre of mass at t = 0, one value for each axis of the model.
        velocity: m s-1 at t = 0, likewise; a recording's `initial` group overrides both.
        mass: kg; None for a fixed body.
        fixed: whether it is held in place.
        carrier: name of the body that it moves with until t = 0, for a load whose own state no recording holds; "" for none.
    """

    name: str
    position: tuple[float, ...]
    velocity: tuple[float, ...]
    mass: Parameter | None = None
    fixed: bool = field(default=False)
    carrier: str = field(default="")
