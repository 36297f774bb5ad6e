"""A mass that the model does not have, on a body."""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve, frozen

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import fresh_name, with_body, with_joint
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import forward, free_paths, grid, plane_inertia, proposal_at
from crashkit_hypotheses.carried_contact import meets_obstacle
from crashkit_hypotheses.sizes import of_body

MASS_SHARES = (0.015, 0.05, 0.2)
LEAST = 1e-3
"""Of the mass that carries it: one of six thousandths on a soft tie stood out by 47 standard deviations."""
SLACKS = (0.02, 0.06)
SLIP = 0.05
"""m s-1, below which friction is smooth."""
RUBBING, MOST_RUBBING = 0.05, 0.1
"""Friction of a load to start from, of the force that stops it; and the most, of the force that stops its carrier."""
UNSEEN = (5.0, 0.1)
"""Speed in m s-1 and time in s of a stop, where the motion shows none."""
SLACK = {"slack": Parameter(0.02, 0.0, 0.5)}
HOLDS = {"holds": Parameter(1.0, fixed=True)}

Parameters = Mapping[str, Parameter]
Start = Mapping[str, float]


class CarriedLoad(Hypothesis):
    """A body of unknown mass: tied closely, with slack, sliding, by a belt that yields or stiffens; crushing what it meets."""

    physics: ClassVar[str] = "carried_load"
    sentence: ClassVar[str] = "{place} carries a mass that the model does not have"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every moving body that is not itself a load, with each kind of tie."""
        carriers = [(body, body.mass.value) for body in model.bodies if body.mass is not None and not body.carrier]
        tied = [
            tie(Carrier(model, body, mass, *stop_of(motion, body.name)))
            for body, mass in carriers
            for tie in (_tied, _slack, _let_go, _stiffening, _sliding, _strap, _belt, _crush)
        ]
        return [*tied, *(p for body, mass in carriers for p in meets_obstacle(model, body, mass, recordings))]


def swinging_load(model: Model, body: Body, mass: float, motion: Sequence[xr.Dataset]) -> Proposal:
    """A load on a body of this mass, by a spring and a dashpot; its numbers are mass, stiffness and damping."""
    return _tied(Carrier(model, body, mass, *stop_of(motion, body.name)))


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
        """A spring on which a tenth of the carrier's mass swings within 5 ms, N m-1: a stiffer one is as good as rigid."""
        return 0.1 * self.mass * (2.0 * np.pi / 5e-3) ** 2

    @property
    def most_damped(self) -> float:
        """A dashpot that takes its speed from the carrier's mass within a fifth of the stop, N s m-1."""
        return 5.0 * self.mass / self.duration

    def spring(self, share: float, period: float) -> float:
        """N m-1 for a load of this share of the mass; the period in durations of the stop."""
        return share * self.mass * (2.0 * np.pi / (period * self.duration)) ** 2


def stop_of(motion: Sequence[xr.Dataset], body: str) -> tuple[float, float]:
    """How fast the body was before it was stopped, m s-1, and how long that took, s, in the middle of all runs."""
    stops = [_stop(of_body(one, "velocity", body)[:, 0], one["time"].values) for one in motion if "velocity" in one]
    speeds, durations = zip(*stops, strict=True) if stops else ((0.0,), (0.0,))
    speed, duration = float(np.median(speeds)), float(np.median(durations))
    return (speed, duration) if speed > 0.0 and duration > 0.0 else UNSEEN


def _stop(velocity: np.ndarray, time: np.ndarray) -> tuple[float, float]:
    stopped = np.flatnonzero(velocity * velocity[0] <= 0.0)
    return abs(float(velocity[0])), float(time[stopped[0]] if len(stopped) else time[-1])


def _tied(carrier: Carrier) -> Proposal:
    """F = k d + c ddot."""
    starts = [_swing(carrier, share, period) for share in MASS_SHARES for period in (0.3, 1.0)]
    return _loaded(carrier, "tied", "tie", _spring(carrier) | HOLDS, starts)


def _slack(carrier: Carrier) -> Proposal:
    """The same beyond a slack either way."""
    return _loaded(carrier, "slack", "tie", _spring(carrier) | SLACK | HOLDS, _with_slack(carrier, 0.5, 1.5))


def _let_go(carrier: Carrier) -> Proposal:
    """The same with a dashpot that is let go on the way back."""
    return _loaded(carrier, "slack, let go", "tie", _spring(carrier) | SLACK, _with_slack(carrier, 1.0))


def _stiffening(carrier: Carrier) -> Proposal:
    """The same with a spring that gets stiffer: F = k x (1 + s x) + c ddot, x = d - slack."""
    stiffer = _spring(carrier) | SLACK | _stiffer(carrier)
    return evolve(_loaded(carrier, "stiffening", "tie", stiffer, _with_slack(carrier, 1.0)), refined=True)


def _sliding(carrier: Carrier) -> Proposal:
    """F = k d + c ddot beyond a slack, and friction on the carrier at all times."""
    return _loaded(carrier, "sliding", "tie", _spring(carrier) | SLACK | HOLDS, _rubbed(carrier), _rubs(carrier))


def _strap(carrier: Carrier) -> Proposal:
    """The same with a spring that gets stiffer, and gives back less than it took."""
    gives_less = {"loss": Parameter(0.3, 0.0, 1.0), "unloading_length": Parameter(0.01, 1e-4, 0.3)}
    strap = _spring(carrier) | SLACK | _stiffer(carrier) | gives_less
    loaded = _loaded(carrier, "strap", "tie", strap, _rubbed(carrier), _rubs(carrier), ("unloading_loss",))
    return evolve(loaded, refined=True)


def _belt(carrier: Carrier) -> Proposal:
    """The same with a spring that yields, and that unloads more steeply than it was loaded."""
    more = {
        **SLACK,
        "yield_force": Parameter(0.1 * carrier.force, 1e-3 * carrier.force, 10.0 * carrier.force),
        "unloading_stiffness": Parameter(0.03 * carrier.stiffest, 1e-6 * carrier.stiffest, carrier.stiffest),
    }
    starts = []
    for share in MASS_SHARES:
        swing = _swing(carrier, share, 1.0)
        hardness = {"yield_force": 1.5 * share * carrier.force, "unloading_stiffness": 4.0 * swing["stiffness"]}
        starts += [swing | hardness | start for start in grid(slack=SLACKS)]
    return _loaded(carrier, "belt", "tie", _spring(carrier) | more, starts)


def _crush(carrier: Carrier) -> Proposal:
    """The load crushes what it meets: elastic slope, plateau, densification, and steep unloading, behind a clearance."""
    stiffness = Parameter(0.03 * carrier.stiffest, 1e-6 * carrier.stiffest, carrier.stiffest)
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
        "stiffness": Parameter(0.1 * carrier.stiffest, 1e-6 * carrier.stiffest, carrier.stiffest),
        "damping": Parameter(0.0, 0.0, carrier.most_damped),
    }


def _swing(carrier: Carrier, share: float, period: float) -> dict[str, float]:
    """A load on a spring with 15 % of the critical damping."""
    mass, stiffness = share * carrier.mass, carrier.spring(share, period)
    return {"mass": mass, "stiffness": stiffness, "damping": 0.3 * float(np.sqrt(stiffness * mass))}


def _stiffer(carrier: Carrier) -> dict[str, Parameter]:
    travel = 0.5 * carrier.speed * carrier.duration
    return {"stiffening": Parameter(1.0 / travel, 0.0, 100.0 / travel)}


def _rubs(carrier: Carrier) -> dict[str, Parameter]:
    force = Parameter(0.0, 0.0, MOST_RUBBING * carrier.force)
    return {"friction_force": force, "slip_rate": Parameter(SLIP, fixed=True)}


def _rubbed(carrier: Carrier) -> list[Start]:
    """With slack, and friction that takes a share of what stops the load."""
    weighed = [(start, start["mass"] / carrier.mass) for start in _with_slack(carrier, 1.0)]
    return [{**start, "friction_force": RUBBING * share * carrier.force} for start, share in weighed]


def _with_slack(carrier: Carrier, *periods: float) -> list[Start]:
    swings = [_swing(carrier, share, period) for share in MASS_SHARES for period in periods]
    return [swing | {"slack": slack} for swing in swings for slack in SLACKS]


def _loaded(
    carrier: Carrier,
    form: str,
    law: str,
    parameters: Parameters,
    starts: Sequence[Start],
    rubs: Parameters | None = None,
    factors: tuple[str, ...] = (),
) -> Proposal:
    """The model with the load; `starts` name its mass `mass`, and the rest as its joints do.

    Arguments:
        rubs: parameters of its friction on the carrier, if there is any.
        factors: on the force of the tie.
    """
    body, load = carrier.body, _load(carrier)
    joints = [evolve(_joint(carrier, load, "tie", law, parameters), factors=factors)]
    joints += [_joint(carrier, load, "friction", "coulomb", rubs)] if rubs else []
    augmented, paths = with_body(carrier.model, load), {"mass": f"body.{load.name}.mass"}
    for joint in joints:
        augmented, paths = with_joint(augmented, joint), paths | free_paths(joint)
    return proposal_at(
        physics="carried_load", form=form, location={"body": body.name}, model=augmented, paths=paths, starts=starts
    )


def _load(carrier: Carrier) -> Body:
    body, mass = carrier.body, carrier.mass
    name = fresh_name(f"{body.name}_load", (b.name for b in carrier.model.bodies))
    weight, inertia = Parameter(0.1 * mass, LEAST * mass, 2.0 * mass), plane_inertia(carrier.model, mass)
    return Body(name, body.position, body.velocity, weight, carrier=body.name, inertia=inertia)


def _joint(carrier: Carrier, load: Body, kind: str, law: str, parameters: Parameters) -> Joint:
    """The load comes first, so that its pressing forward counts as compression."""
    name = fresh_name(f"{load.name}_{kind}", (j.name for j in carrier.model.joints))
    ends, normal = (load.name, carrier.body.name), forward(carrier.model, carrier.body)
    return Joint(name, ends, law, dict(parameters), normal=normal)
