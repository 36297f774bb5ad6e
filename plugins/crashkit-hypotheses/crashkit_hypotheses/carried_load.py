"""A mass that the model does not have, on a body."""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import fresh_name, with_body, with_joint
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import forward, grid, plane_inertia
from crashkit_hypotheses.carried_contact import meets_obstacle

MASS_SHARES = (0.01, 0.05, 0.2)
SLACKS = (0.02, 0.06)
UNSEEN = (5.0, 0.1)
"""Speed in m s-1 and time in s of a stop, where the motion shows none."""

Parameters = Mapping[str, Parameter]
Start = Mapping[str, float]


class CarriedLoad(Hypothesis):
    """A body of unknown mass: tied closely, with slack, by a yielding belt; crushing what it meets; or hitting the wall."""

    physics: ClassVar[str] = "carried_load"
    sentence: ClassVar[str] = "{place} carries a mass that the model does not have"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every moving body that is not itself a load, with each kind of tie."""
        carriers = [(body, body.mass.value) for body in model.bodies if body.mass is not None and not body.carrier]
        tied = [
            tie(Carrier(model, body, mass, *stop_of(motion, body.name)))
            for body, mass in carriers
            for tie in (_tied, _slack, _belt, _crush)
        ]
        return [*tied, *(p for body, mass in carriers for p in meets_obstacle(model, body, mass, recordings))]


@frozen
class Carrier:
    """A body that may carry a load: its mass, the speed it loses (m s-1), and the time that takes (s)."""

    model: Model
    body: Body
    mass: float
    speed: float
    duration: float

    @property
    def force(self) -> float:
        """What stops a load of the carrier's mass as the carrier is stopped, N."""
        return self.mass * self.speed / self.duration

    @property
    def stiffest(self) -> float:
        """A spring on which the carrier's mass swings within a millisecond, N m-1."""
        return self.mass * (2.0 * np.pi / 1e-3) ** 2

    def spring(self, share: float, period: float) -> float:
        """N m-1 for a load of this share of the mass; the period in durations of the stop."""
        return share * self.mass * (2.0 * np.pi / (period * self.duration)) ** 2


def stop_of(motion: Sequence[xr.Dataset], body: str) -> tuple[float, float]:
    """How fast the body was before it was stopped, m s-1, and how long that took, s, in the middle of all runs."""
    stops = [
        _stop(one["velocity"].sel(body=body).isel(axis=0).values, one["time"].values) for one in motion if "velocity" in one
    ]
    speeds, durations = zip(*stops, strict=True) if stops else ((0.0,), (0.0,))
    speed, duration = float(np.median(speeds)), float(np.median(durations))
    return (speed, duration) if speed > 0.0 and duration > 0.0 else UNSEEN


def _stop(velocity: np.ndarray, time: np.ndarray) -> tuple[float, float]:
    stopped = np.flatnonzero(velocity * velocity[0] <= 0.0)
    return abs(float(velocity[0])), float(time[stopped[0]] if len(stopped) else time[-1])


def _tied(carrier: Carrier) -> Proposal:
    """F = k d + c ddot."""
    starts = [_swing(carrier, share, period) for share in MASS_SHARES for period in (0.3, 1.0)]
    return _loaded(carrier, "tied", "tie", _spring(carrier), starts)


def _slack(carrier: Carrier) -> Proposal:
    """The same beyond a slack either way."""
    starts = [
        _swing(carrier, share, period) | {"slack": slack} for share in MASS_SHARES for period in (0.5, 1.5) for slack in SLACKS
    ]
    return _loaded(carrier, "slack", "tie", _spring(carrier) | {"slack": Parameter(0.02, 0.0, 0.5)}, starts)


def _belt(carrier: Carrier) -> Proposal:
    """The same with a spring that yields, and that unloads more steeply than it was loaded."""
    more = {
        "slack": Parameter(0.02, 0.0, 0.5),
        "yield_force": Parameter(0.1 * carrier.force, 1e-3 * carrier.force, 10.0 * carrier.force),
        "unloading_stiffness": Parameter(1e-3 * carrier.stiffest, 1e-9 * carrier.stiffest, 10.0 * carrier.stiffest),
    }
    starts = []
    for share in MASS_SHARES:
        swing = _swing(carrier, share, 1.0)
        hardness = {"yield_force": 1.5 * share * carrier.force, "unloading_stiffness": 4.0 * swing["stiffness"]}
        starts += [swing | hardness | start for start in grid(slack=SLACKS)]
    return _loaded(carrier, "belt", "tie", _spring(carrier) | more, starts)


def _crush(carrier: Carrier) -> Proposal:
    """The load crushes what it meets: elastic slope, plateau, densification, and steep unloading, behind a clearance."""
    stiffness = Parameter(1e-3 * carrier.stiffest, 1e-9 * carrier.stiffest, 10.0 * carrier.stiffest)
    parameters = {
        "elastic_stiffness": stiffness,
        "crush_force": Parameter(0.1 * carrier.force, 1e-3 * carrier.force, 10.0 * carrier.force),
        "densification_deformation": Parameter(0.2, 1e-3, 2.0),
        "densification_stiffness": stiffness,
        "unloading_stiffness": stiffness,
        "clearance": Parameter(0.02, 0.0, 0.5),
    }
    travel = 0.5 * carrier.speed * carrier.duration
    starts = []
    for share in MASS_SHARES:
        spring = carrier.spring(share, 1.0)
        start = {
            "mass": share * carrier.mass,
            "elastic_stiffness": spring,
            "crush_force": share * carrier.force,
            "densification_deformation": 0.5 * travel,
            "densification_stiffness": spring,
            "unloading_stiffness": 4.0 * spring,
        }
        starts += [start | other for other in grid(clearance=SLACKS)]
    return _loaded(carrier, "crush", "crush_plateau", parameters, starts)


def _spring(carrier: Carrier) -> dict[str, Parameter]:
    return {
        "stiffness": Parameter(1e-2 * carrier.stiffest, 1e-9 * carrier.stiffest, carrier.stiffest),
        "damping": Parameter(0.0, 0.0, carrier.stiffest),
    }


def _swing(carrier: Carrier, share: float, period: float) -> dict[str, float]:
    """A load on a spring with 15 % of the critical damping."""
    mass, stiffness = share * carrier.mass, carrier.spring(share, period)
    return {"mass": mass, "stiffness": stiffness, "damping": 0.3 * float(np.sqrt(stiffness * mass))}


def _loaded(carrier: Carrier, form: str, law: str, parameters: Parameters, starts: Sequence[Start]) -> Proposal:
    """The model with the load; `starts` name its mass `mass`, and the rest as its joint does."""
    model, body, mass = carrier.model, carrier.body, carrier.mass
    load = fresh_name(f"{body.name}_load", (b.name for b in model.bodies))
    joint = fresh_name(f"{load}_tie", (j.name for j in model.joints))
    weight = Parameter(0.1 * mass, 1e-3 * mass, 2.0 * mass)
    # The load comes first, so that its pressing forward counts as compression.
    augmented = with_joint(
        with_body(
            model,
            Body(load, body.position, body.velocity, weight, carrier=body.name, inertia=plane_inertia(model, mass)),
        ),
        Joint(joint, (load, body.name), law, dict(parameters), normal=forward(model, body)),
    )
    paths = {"mass": f"body.{load}.mass", **{name: f"joint.{joint}.{name}" for name in parameters}}
    named = tuple({paths[name]: value for name, value in start.items()} for start in starts)
    return Proposal("carried_load", form, {"body": body.name}, augmented, tuple(paths.values()), {}, named)
