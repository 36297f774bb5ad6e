"""What a test gives rather than the structure: imposed motions and forces."""

from attrs import field, frozen

Rows = tuple[tuple[float, ...], ...]


@frozen
class GivenMotion:
    """A motion that is imposed on a body, by a twice differentiable spline through the samples.

    Arguments:
        time: s, increasing; before the first and after the last the body goes on uniformly.
        position: m, a row of one value for each axis at each time.
        orientation: at each time a row of the angle (rad) in the plane, of the unit quaternion (w, x, y, z) in space; ():
            that of the body at t = 0.
    """

    time: tuple[float, ...]
    position: Rows
    orientation: Rows = field(default=())


@frozen
class GivenForce:
    """A force that acts on a body's centre of mass, affine between the samples and 0 outside them.

    Arguments:
        time: s, increasing.
        force: N, laboratory frame, a row of one value for each axis at each time.
        moment: N m, laboratory frame, at each time a row of one value in the plane, of three in space; (): none.
    """

    time: tuple[float, ...]
    force: Rows
    moment: Rows = field(default=())
