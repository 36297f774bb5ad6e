"""What acts on a body besides its joints: a wrong mass, friction on the ground."""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Body, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, grid, grounded, proposal
from crashkit_hypotheses.friction import REFINED, TAIL, falling, smooth
from crashkit_hypotheses.sizes import duration, forces_recorded, largest_speed, largest_travel

PUT_ON = "from a time on"
BEGINS = (0.05, 0.2, 0.5)
"""Of the duration of the longest run: when friction may set in."""
ACROSS = ("constant", "smooth")
"""Forms of friction that are also tried across the direction of travel, in the plane."""


class AddedMass(Hypothesis):
    """The mass of a body is other than stated."""

    physics: ClassVar[str] = "added_mass"
    sentence: ClassVar[str] = "the mass of {place} is wrong"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every moving body whose mass is not identified already, if something fixes the scale of forces; within the bounds of
        that mass, which whoever weighed it has given."""
        moving = [(body, body.mass) for body in model.bodies if body.mass is not None and body.mass.fixed]
        if len(moving) < 2 and not forces_recorded(recordings):
            return []
        return [self._heavier(model, body, mass) for body, mass in moving if mass.lower < mass.upper]

    def _heavier(self, model: Model, body: Body, mass: Parameter) -> Proposal:
        free = Parameter(mass.value, max(0.3 * mass.value, mass.lower), min(3.0 * mass.value, mass.upper))
        augmented = model.with_parameters({f"body.{body.name}.mass": free})
        heavier = Effect(self.physics, "constant", "", {"mass": free}, "mass", null=mass.value)
        return proposal(augmented, {"body": body.name}, f"body.{body.name}.", heavier)


class GroundFriction(Hypothesis):
    """A near-constant force brakes a body: F = f sign(v), or one that sets in smoothly, falls with speed, or begins later or
    from a time on; along the direction of travel, and in the plane also across it."""

    physics: ClassVar[str] = "ground_friction"
    sentence: ClassVar[str] = "{place} is braked by friction on the ground"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every moving body; the ground is a fixed body of its own, so that no wall load cell feels it."""
        braked = [body for body in model.bodies if body.mass is not None and not body.carrier]
        return [proposed for body in braked for proposed in self._braked(model, body, motion)]

    def _braked(self, model: Model, body: Body, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        constant = {"friction_force": Parameter(0.0, 0.0, 1e7), "slip_rate": Parameter(0.05, fixed=True)}
        way = largest_travel(motion, body.name)
        later = {**constant, "always": Parameter(0.0, fixed=True), "clearance": Parameter(0.2 * way, 1e-3 * way, way)}
        # Bodies set out together: one range of speeds for all of them.
        fastest = largest_speed(motion)
        less, established = falling(fastest), smooth(fastest)
        forms: dict[str, tuple[dict[str, Parameter], Sequence[Mapping[str, float]]]] = {
            "constant": (constant, ({},)),
            "smooth": (constant | established, ({},)),
            "falling": (less, ({},)),
            "smooth and falling": (less | established, ({},)),
            "smooth with a tail": (constant | established | TAIL, ({},)),
            "later": (later, grid(clearance=[share * way for share in (0.2, 0.5, 0.8)])),
        }
        effects = [
            Effect(self.physics, form, "coulomb", friction, "friction_force", starts)
            for form, (friction, starts) in forms.items()
        ]
        effects.append(_brake(self.physics, constant | established, duration(motion)))
        along = [evolve(grounded(model, body, effect), refined=effect.form in (*REFINED, PUT_ON)) for effect in effects]
        sideways = [effect for effect in effects if effect.form in ACROSS] if len(model.axes) == 2 else []
        return [*along, *(_across_too(model, body, effect) for effect in sideways)]


def _brake(physics: str, friction: Mapping[str, Parameter], lasts: float) -> Effect:
    """Friction that sets in at a time, little by little."""
    times = {"start": Parameter(0.1 * lasts, 0.0, lasts), "rise": Parameter(0.05 * lasts, 1e-3 * lasts, lasts)}
    return Effect(physics, PUT_ON, "brake", {**friction, **times}, "friction_force", grid(start=[s * lasts for s in BEGINS]))


def _across_too(model: Model, body: Body, effect: Effect) -> Proposal:
    """Friction along and across the direction of travel, one number each."""
    along = grounded(model, body, effect)
    both = grounded(along.model, body, effect, across=True)
    names, null = (*along.parameters, *both.parameters), {**along.null, **both.null}
    return evolve(both, form=f"{effect.form}, across too", parameters=names, null=null)
