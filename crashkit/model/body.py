"""Rigid bodies."""

from attrs import field, frozen

from crashkit.model.given import GivenForce, GivenMotion
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
        inertia: kg m2 about the centre of mass; in the plane one number; in space those of its principal axes, which are
            then its own axes, or Ixx, Iyy, Izz, Ixy, Ixz, Iyz of its own axes, off the diagonal as they stand in the matrix.
        orientation: at t = 0; in the plane the angle (rad); in space the unit quaternion (w, x, y, z); (): its axes are the
            laboratory's.
        angular_velocity: rad s-1 at t = 0; in the plane one number, in space three, laboratory frame; (): none.
        motion: imposed on it; None: it moves by the forces.
        force: given over time; None: none but the joints' and gravity.
    """

    name: str
    position: tuple[float, ...]
    velocity: tuple[float, ...]
    mass: Parameter | None = None
    fixed: bool = field(default=False)
    carrier: str = field(default="")
    inertia: tuple[Parameter, ...] = field(default=())
    orientation: tuple[float, ...] = field(default=())
    angular_velocity: tuple[float, ...] = field(default=())
    motion: GivenMotion | None = None
    force: GivenForce | None = None

    @property
    def is_free(self) -> bool:
        """Whether forces move it."""
        return not self.fixed and self.motion is None
