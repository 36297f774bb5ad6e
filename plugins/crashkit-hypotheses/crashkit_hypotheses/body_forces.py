"""What acts on a body besides its joints: a wrong mass, friction on the ground."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import fresh_name, with_joint
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import proposal
from crashkit_hypotheses.parallel_forces import falling


class AddedMass(Hypothesis):
    """The mass of a body is other than stated."""

    physics: ClassVar[str] = "added_mass"
    sentence: ClassVar[str] = "the mass of {place} is wrong"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every moving body whose mass is not identified already, if something fixes the scale of forces."""
        moving = [(body, body.mass.value) for body in model.bodies if body.mass is not None and body.mass.fixed]
        if len(moving) < 2 and not _forces_recorded(recordings):
            return []
        return [self._heavier(model, body, mass) for body, mass in moving]

    def _heavier(self, model: Model, body: Body, mass: float) -> Proposal:
        free = Parameter(mass, 0.3 * mass, 3.0 * mass)
        augmented = model.with_parameters({f"body.{body.name}.mass": free})
        prefix = f"body.{body.name}."
        return proposal(self.physics, "constant", {"body": body.name}, augmented, prefix, {"mass": free}, "mass", ({},), mass)


class GroundFriction(Hypothesis):
    """A near-constant force brakes a body: F = f sign(v), or one that falls with the speed."""

    physics: ClassVar[str] = "ground_friction"
    sentence: ClassVar[str] = "{place} is braked by friction on the ground"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every moving body; the ground is a fixed body of its own, so that no wall load cell feels it."""
        forms = {
            "constant": {"friction_force": Parameter(0.0, 0.0, 1e7), "slip_rate": Parameter(0.05, fixed=True)},
            "falling": falling(max(float(np.nanmax(np.abs(one["velocity"].values))) for one in motion)),
        }
        braked = [body for body in model.bodies if body.mass is not None and not body.carrier]
        return [self._braked(model, body, form, friction) for body in braked for form, friction in forms.items()]

    def _braked(self, model: Model, body: Body, form: str, friction: dict[str, Parameter]) -> Proposal:
        ground = Body(
            fresh_name("ground", (b.name for b in model.bodies)), _ahead(body), (0.0,) * len(body.position), fixed=True
        )
        grounded = evolve(model, bodies=(*model.bodies, ground))
        name = fresh_name(f"{body.name}_friction", (joint.name for joint in model.joints))
        augmented = with_joint(grounded, Joint(name, (ground.name, body.name), "coulomb", friction))
        prefix = f"joint.{name}."
        return proposal(self.physics, form, {"body": body.name}, augmented, prefix, friction, "friction_force", ({},))


def _ahead(body: Body) -> tuple[float, ...]:
    """A point in the direction of travel, so that driving on counts as compression."""
    return tuple(x + (100.0 if v >= 0 else -100.0) for x, v in zip(body.position, body.velocity, strict=True))


def _forces_recorded(recordings: Sequence[xr.DataTree]) -> bool:
    return any("force" in group.data_vars for recording in recordings for group in recording.children.values())
