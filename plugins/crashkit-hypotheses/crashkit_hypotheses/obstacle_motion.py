"""The obstacle is not rigid: it slides, is pushed away, or springs back."""

from collections.abc import Callable, Mapping, Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve, frozen

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import fresh_name, with_body, with_joint
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import free_paths, grid, plane_inertia, proposal_at
from crashkit_hypotheses.sizes import largest_force

LIGHT, HEAVY = 0.05, 1e3
"""Masses that an obstacle may have, in masses of what runs into it: a wall of a hundred still leaves a trace."""
NEVER, AT_ONCE = 1e3, 1e-4
"""m, a deformation out of reach, and one that is passed before the elastic limit."""
SLIP_RATE = 0.1
"""m s-1, at which sliding is established, unless that is sought too: the slower, the more steps a light obstacle costs."""

Parameters = Mapping[str, Parameter]
Start = Mapping[str, float]


class ObstacleMotion(Hypothesis):
    """A fixed body has a mass M, and is held by nothing, by dry friction f sign(v), by a spring k u and a dashpot c v, by
    both, or by what it crushes, on a plateau or on a rising line."""

    physics: ClassVar[str] = "obstacle_motion"
    sentence: ClassVar[str] = "{place} is no rigid obstacle: it yields or moves"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every fixed body that a joint presses against."""
        mass = sum(body.mass.value for body in model.bodies if body.mass is not None)
        obstacles = [Obstacle(model, body, mass, _push(model, motion, body.name)) for body in model.bodies if body.fixed]
        return [
            hold(obstacle) for obstacle in obstacles if obstacle.force > 0.0 for hold in (_free, *_holds(obstacle, recordings))
        ]


@frozen
class Obstacle:
    """A fixed body, the mass of all that may run into it (kg), and the most that a joint presses on it (N)."""

    model: Model
    body: Body
    mass: float
    force: float


def _holds(obstacle: Obstacle, recordings: Sequence[xr.DataTree]) -> tuple[Callable[[Obstacle], Proposal], ...]:
    """Only on a line can a joint hold a body from behind, where a load cell does not feel it."""
    groups = [group.to_dataset(inherit=False) for recording in recordings for group in recording.children.values()]
    is_weighed = any("force" in group and obstacle.body.name in group["sensor_body"].values for group in groups)
    if is_weighed and len(obstacle.model.axes) > 1:
        return ()
    return _sliding, _sliding_slowly, _sprung, _sprung_and_sliding, _crushing, _hardening


def _push(model: Model, motion: Sequence[xr.Dataset], name: str) -> float:
    """The most that any joint presses on a body, N."""
    return max((largest_force(motion, joint.name) for joint in model.joints if name in joint.bodies), default=0.0)


def _free(obstacle: Obstacle) -> Proposal:
    return _moving(obstacle, "free", _released(obstacle), {}, grid(mass=[3.0 * obstacle.mass]))


def _sliding(obstacle: Obstacle) -> Proposal:
    friction = _friction(obstacle.force) | {"slip_rate": Parameter(SLIP_RATE, fixed=True)}
    starts = _starts(obstacle, "friction_force", (0.5, 0.15), (0.5, 0.5), (5.0, 0.5), (5.0, 0.9))
    return _held(obstacle, "sliding", "coulomb", friction, starts)


def _sliding_slowly(obstacle: Obstacle) -> Proposal:
    """A heavy obstacle hardly gets faster than that at which sliding is established, which therefore shows."""
    slip_rate = Parameter(0.2 * SLIP_RATE, 0.01 * SLIP_RATE, 10.0 * SLIP_RATE)
    friction = _friction(obstacle.force) | {"slip_rate": slip_rate}
    starts = _starts(obstacle, "friction_force", (5.0, 0.5), (100.0, 0.3), (100.0, 0.9))
    return evolve(_held(obstacle, "sliding slowly", "coulomb", friction, starts), refined=True)


def _sprung(obstacle: Obstacle) -> Proposal:
    spring = _spring(obstacle.force, Parameter(20.0 * obstacle.force, obstacle.force, 1e4 * obstacle.force))
    starts = _starts(obstacle, "stiffness", (0.5, 5.0), (0.5, 50.0), (5.0, 50.0), (5.0, 500.0))
    return _held(obstacle, "sprung", "tie", spring, starts)


def _sprung_and_sliding(obstacle: Obstacle) -> Proposal:
    """A block on soil that springs back, or one on springs that rubs."""
    mass, force = obstacle.mass, obstacle.force
    friction = {
        "friction_force": Parameter(0.3 * force, 1e-3 * force, 10.0 * force),
        "slip_rate": Parameter(0.5 * SLIP_RATE, 0.01 * SLIP_RATE, 10.0 * SLIP_RATE),
    }
    spring = _spring(force, Parameter(5.0 * force, 1e-2 * force, 1e4 * force))
    shares = ((0.5, 5.0, 0.3), (5.0, 2.0, 0.3), (5.0, 50.0, 0.3), (50.0, 50.0, 0.3))
    starts = [{"mass": m * mass, "stiffness": k * force, "friction_force": f * force} for m, k, f in shares]
    return evolve(_held(obstacle, "sprung and sliding", "tie | coulomb", spring | friction, starts), refined=True)


def _crushing(obstacle: Obstacle) -> Proposal:
    starts = _starts(obstacle, "elastic_stiffness", (0.5, 50.0), (5.0, 50.0), (5.0, 500.0))
    return _held(obstacle, "crushing", "crush_plateau", _plateau(obstacle.force), starts)


def _hardening(obstacle: Obstacle) -> Proposal:
    """A post in soil, or a face of honeycomb: beyond its elastic limit the force rises on, and a dashpot stands beside it."""
    force = obstacle.force
    rising = {
        "densification_deformation": Parameter(AT_ONCE, fixed=True),
        "densification_stiffness": Parameter(2.0 * force, 1e-2 * force, 1e4 * force),
        "damping": Parameter(0.0, 0.0, 10.0 * force),
    }
    starts = _starts(obstacle, "elastic_stiffness", (0.1, 50.0), (0.5, 50.0), (5.0, 50.0), (5.0, 500.0))
    return evolve(_held(obstacle, "hardening", "crush_plateau | viscous", _plateau(force) | rising, starts), refined=True)


def _friction(force: float) -> dict[str, Parameter]:
    return {"friction_force": Parameter(0.5 * force, 1e-3 * force, 10.0 * force)}


def _spring(force: float, stiffness: Parameter) -> dict[str, Parameter]:
    return {
        "stiffness": stiffness,
        "damping": Parameter(0.0, 0.0, 10.0 * force),
        "slack": Parameter(0.0, fixed=True),
        "holds": Parameter(1.0, fixed=True),
    }


def _plateau(force: float) -> dict[str, Parameter]:
    return {
        "elastic_stiffness": Parameter(20.0 * force, force, 1e4 * force),
        "crush_force": Parameter(0.7 * force, 1e-2 * force, 10.0 * force),
        "densification_deformation": Parameter(NEVER, fixed=True),
        "densification_stiffness": Parameter(force, fixed=True),
        "unloading_stiffness": Parameter(200.0 * force, force, 1e5 * force),
    }


def _starts(obstacle: Obstacle, name: str, *shares: tuple[float, float]) -> list[Start]:
    """From an obstacle that is easily moved to one that hardly moves, as the given one."""
    return [{"mass": heavy * obstacle.mass, name: strong * obstacle.force} for heavy, strong in shares]


def _held(obstacle: Obstacle, form: str, law: str, parameters: Parameters, starts: Sequence[Start]) -> Proposal:
    """Set free, and joined to the ground by a law."""
    released, body = _released(obstacle), obstacle.body
    ground_name = fresh_name("ground", (b.name for b in released.bodies))
    ground = Body(ground_name, _behind(obstacle.model, body), body.velocity, fixed=True)
    name = fresh_name(f"{body.name}_ground", (j.name for j in released.joints))
    joint = Joint(name, (ground.name, body.name), law, dict(parameters), support=len(released.axes) == 1)
    return _moving(obstacle, form, with_joint(with_body(released, ground), joint), free_paths(joint), starts)


def _released(obstacle: Obstacle) -> Model:
    """The model with the obstacle set free."""
    model, body, mass = obstacle.model, obstacle.body, obstacle.mass
    weight, inertia = Parameter(mass, LIGHT * mass, HEAVY * mass), plane_inertia(model, mass)
    free = evolve(body, fixed=False, mass=weight, inertia=inertia)
    return evolve(model, bodies=tuple(free if other.name == body.name else other for other in model.bodies))


def _moving(obstacle: Obstacle, form: str, model: Model, paths: Mapping[str, str], starts: Sequence[Start]) -> Proposal:
    """An obstacle that is free in this model; `starts` name its mass `mass`, and the rest as `paths`."""
    name = obstacle.body.name
    return proposal_at(
        physics="obstacle_motion",
        form=form,
        location={"body": name},
        model=model,
        paths={"mass": f"body.{name}.mass", **paths},
        starts=starts,
    )


def _behind(model: Model, obstacle: Body) -> tuple[float, ...]:
    """A point so far behind the obstacle, as what runs into it sees it, that being pushed counts as compression."""
    others = [body for body in model.bodies if body.mass is not None]
    travel = [sum(body.velocity[axis] for body in others) for axis in range(len(model.axes))]
    length = sum(v * v for v in travel) ** 0.5 or 1.0
    return tuple(x + 100.0 * v / length for x, v in zip(obstacle.position, travel, strict=True))
