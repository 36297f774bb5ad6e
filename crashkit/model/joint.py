"""Joints: non-linear springs between the bodies, the arcs of an oriented multigraph."""

from collections.abc import Mapping

from attrs import field, frozen

from crashkit.model.parameter import Parameter


@frozen
class Joint:
    """A spring between two bodies; its deformation is positive when they approach.

    F = law(d, ddot, d_max) times every factor; several joints between the same two bodies add up.

    Arguments:
        name: unique in the model.
        bodies: names of the two bodies.
        law: name of the SpringLaw plugin that gives the force.
        parameters: of the law and of the factors by name; a tuple where the law declares a vector.
        factors: names of SpringLaw plugins with unit "1" that multiply the law.
        points: m, attachment in each body's frame; None: the centres of mass.
        free_length: m, the distance at which the deformation is 0; None: the distance at t = 0.
        normal: unit vector in the first body's frame: the joint is the contact of a point of the second body with a flat
            face of the first, its distance is measured along this normal, and its force acts along it at the point; None:
            the joint is the line between its two points. In one axis the two are the same.
        acts_on: names of the two bodies on which its force acts where that are not the two whose approach deforms it: a
            linkage carries it there. The first is pushed as the joint would push its own first body. In one axis only.
        driver: name of the joint whose deformation drives the law or the factors that are `driven`; "" where none is.
        support: whether it holds one of the bodies to what stands behind it: a load cell on that body does not feel it. In
            one axis only.
    """

    name: str
    bodies: tuple[str, str]
    law: str
    parameters: Mapping[str, Parameter | tuple[Parameter, ...]]
    factors: tuple[str, ...] = field(default=())
    points: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    free_length: Parameter | None = None
    normal: tuple[float, ...] | None = None
    support: bool = False
    acts_on: tuple[str, str] | None = None
    driver: str = ""

    @property
    def pushed(self) -> tuple[str, str]:
        """The two bodies on which its force acts."""
        return self.acts_on or self.bodies
