"""A mass that the model does not have, tied to a body."""

from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import fresh_name, with_body, with_joint
from crashkit.protocols import Hypothesis, Proposal

MASS_SHARES = (0.05, 0.2)
PERIODS = (0.02, 0.06)


@frozen
class Tie:
    """How a load hangs on its carrier: a law, and what its parameters start from."""

    form: str
    parameters: tuple[str, ...]
    slacks: tuple[float, ...]


TIES = (Tie("tied", ("stiffness", "damping"), (0.0,)), Tie("slack", ("stiffness", "damping", "slack"), (0.01, 0.04, 0.1)))


class CarriedLoad(Hypothesis):
    """A body of unknown mass on a spring and damper, tied closely or with slack: an occupant, cargo, a powertrain."""

    physics: ClassVar[str] = "carried_load"
    sentence: ClassVar[str] = "{place} carries a mass that the model does not have"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every moving body that is not itself a load, with each kind of tie."""
        carriers = [body for body in model.bodies if not body.fixed and not body.carrier]
        return [_loaded(model, body, tie) for body in carriers for tie in TIES]


def _loaded(model: Model, carrier: Body, tie: Tie) -> Proposal:
    load = fresh_name(f"{carrier.name}_load", (body.name for body in model.bodies))
    joint = fresh_name(f"{load}_tie", (joint.name for joint in model.joints))
    mass = carrier.mass.value
    body = Body(load, carrier.position, carrier.velocity, Parameter(0.1 * mass, 1e-3 * mass, 2.0 * mass), carrier=carrier.name)
    # The load comes first, so that its pressing forward counts as compression.
    spring = Joint(joint, (load, carrier.name), "tie", _tie_parameters(tie, mass))
    augmented = with_joint(with_body(model, body), spring)
    names = (f"body.{load}.mass", *(f"joint.{joint}.{name}" for name in tie.parameters))
    starts = tuple(dict(zip(names, values, strict=True)) for values in _starts(tie, mass))
    return Proposal("carried_load", tie.form, {"body": carrier.name}, augmented, names, {}, starts)


def _tie_parameters(tie: Tie, mass: float) -> dict[str, Parameter]:
    stiffest = mass * (2.0 * np.pi / 1e-3) ** 2
    slack = Parameter(0.02, 0.0, 0.5) if "slack" in tie.parameters else Parameter(0.0, fixed=True)
    return {
        "stiffness": Parameter(1e-2 * stiffest, 1e-7 * stiffest, stiffest),
        "damping": Parameter(0.0, 0.0, stiffest),
        "slack": slack,
    }


def _starts(tie: Tie, mass: float) -> Iterator[tuple[float, ...]]:
    for share in MASS_SHARES:
        for period in PERIODS:
            stiffness = share * mass * (2.0 * np.pi / period) ** 2
            damping = 0.3 * np.sqrt(stiffness * share * mass)
            for slack in tie.slacks:
                yield (share * mass, stiffness, damping, slack)[: 1 + len(tie.parameters)]
