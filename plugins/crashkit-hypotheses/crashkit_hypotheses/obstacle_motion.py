"""The obstacle is not rigid: it slides, is pushed away, or springs back."""

from collections.abc import Callable, Mapping, Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import fresh_name
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import grid, plane_inertia
from crashkit_hypotheses.sizes import largest_force

LIGHT, HEAVY = 0.05, 1e3
"""Masses that an obstacle may have, in masses of what runs into it: a wall of a hundred still leaves a trace."""
NEVER, AT_ONCE = 1e3, 1e-4
"""m, a deformation out of reach, and one that is passed before the elastic limit."""
SLIP_RATE = 0.1
"""m s-1, at which sliding is established, unless that is sought too: the slower, the more steps a light obstacle costs."""

Parameters = Mapping[str, Parameter]


class ObstacleMotion(Hypothesis):
    """A fixed body has a mass M, and is held by nothing, by dry friction f sign(v), by a spring k u and a dashpot c v, by
    both, or by what it crushes, on a plateau or on a rising line."""

    physics: ClassVar[str] = "obstacle_motion"
    sentence: ClassVar[str] = "{place} is no rigid obstacle: it yields or moves"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every fixed body that a joint presses against."""
        mass = sum(body.mass.value for body in model.bodies if body.mass is not None)
        pushed = {body.name: _push(model, motion, body.name) for body in model.bodies if body.fixed}
        return [
            proposal
            for name, force in pushed.items()
            if force > 0.0
            for proposal in (
                _free(model, name, mass),
                *(hold(model, name, mass, force) for hold in _holds(model, recordings, name)),
            )
        ]


def _holds(
    model: Model, recordings: Sequence[xr.DataTree], name: str
) -> tuple[Callable[[Model, str, float, float], Proposal], ...]:
    """Only on a line can a joint hold a body from behind, where a load cell does not feel it."""
    groups = [group.to_dataset(inherit=False) for recording in recordings for group in recording.children.values()]
    is_weighed = any("force" in group and name in group["sensor_body"].values for group in groups)
    return (
        ()
        if is_weighed and len(model.axes) > 1
        else (_sliding, _sliding_slowly, _sprung, _sprung_and_sliding, _crushing, _hardening)
    )


def _push(model: Model, motion: Sequence[xr.Dataset], name: str) -> float:
    """The most that any joint presses on a body, N."""
    return max((largest_force(motion, joint.name) for joint in model.joints if name in joint.bodies), default=0.0)


def _free(model: Model, name: str, mass: float) -> Proposal:
    return _moving(model, name, "free", mass, None, {}, grid(mass=[3.0 * mass]))


def _sliding(model: Model, name: str, mass: float, force: float) -> Proposal:
    friction = {
        "friction_force": Parameter(0.5 * force, 1e-3 * force, 10.0 * force),
        "slip_rate": Parameter(SLIP_RATE, fixed=True),
    }
    starts = _starts(mass, "friction_force", force, ((0.5, 0.15), (0.5, 0.5), (5.0, 0.5), (5.0, 0.9)))
    return _moving(model, name, "sliding", mass, "coulomb", friction, starts)


def _sliding_slowly(model: Model, name: str, mass: float, force: float) -> Proposal:
    """A heavy obstacle hardly gets faster than that at which sliding is established, which therefore shows."""
    friction = {
        "friction_force": Parameter(0.5 * force, 1e-3 * force, 10.0 * force),
        "slip_rate": Parameter(0.2 * SLIP_RATE, 0.01 * SLIP_RATE, 10.0 * SLIP_RATE),
    }
    starts = _starts(mass, "friction_force", force, ((5.0, 0.5), (100.0, 0.3), (100.0, 0.9)))
    return evolve(_moving(model, name, "sliding slowly", mass, "coulomb", friction, starts), refined=True)


def _sprung(model: Model, name: str, mass: float, force: float) -> Proposal:
    spring = {
        "stiffness": Parameter(20.0 * force, force, 1e4 * force),
        "damping": Parameter(0.0, 0.0, 10.0 * force),
        "slack": Parameter(0.0, fixed=True),
        "holds": Parameter(1.0, fixed=True),
    }
    starts = _starts(mass, "stiffness", force, ((0.5, 5.0), (0.5, 50.0), (5.0, 50.0), (5.0, 500.0)))
    return _moving(model, name, "sprung", mass, "tie", spring, starts)


def _sprung_and_sliding(model: Model, name: str, mass: float, force: float) -> Proposal:
    """A block on soil that springs back, or one on springs that rubs."""
    held = {
        "stiffness": Parameter(5.0 * force, 1e-2 * force, 1e4 * force),
        "damping": Parameter(0.0, 0.0, 10.0 * force),
        "slack": Parameter(0.0, fixed=True),
        "holds": Parameter(1.0, fixed=True),
        "friction_force": Parameter(0.3 * force, 1e-3 * force, 10.0 * force),
        "slip_rate": Parameter(0.5 * SLIP_RATE, 0.01 * SLIP_RATE, 10.0 * SLIP_RATE),
    }
    shares = ((0.5, 5.0, 0.3), (5.0, 2.0, 0.3), (5.0, 50.0, 0.3), (50.0, 50.0, 0.3))
    starts = [{"mass": m * mass, "stiffness": k * force, "friction_force": f * force} for m, k, f in shares]
    return evolve(_moving(model, name, "sprung and sliding", mass, "tie | coulomb", held, starts), refined=True)


def _crushing(model: Model, name: str, mass: float, force: float) -> Proposal:
    base = {
        "elastic_stiffness": Parameter(20.0 * force, force, 1e4 * force),
        "crush_force": Parameter(0.7 * force, 1e-2 * force, 10.0 * force),
        "densification_deformation": Parameter(NEVER, fixed=True),
        "densification_stiffness": Parameter(force, fixed=True),
        "unloading_stiffness": Parameter(200.0 * force, force, 1e5 * force),
    }
    starts = _starts(mass, "elastic_stiffness", force, ((0.5, 50.0), (5.0, 50.0), (5.0, 500.0)))
    return _moving(model, name, "crushing", mass, "crush_plateau", base, starts)


def _hardening(model: Model, name: str, mass: float, force: float) -> Proposal:
    """A post in soil, or a face of honeycomb: beyond its elastic limit the force rises on, and a dashpot stands beside it."""
    base = {
        "elastic_stiffness": Parameter(20.0 * force, force, 1e4 * force),
        "crush_force": Parameter(0.7 * force, 1e-2 * force, 10.0 * force),
        "densification_deformation": Parameter(AT_ONCE, fixed=True),
        "densification_stiffness": Parameter(2.0 * force, 1e-2 * force, 1e4 * force),
        "unloading_stiffness": Parameter(200.0 * force, force, 1e5 * force),
        "damping": Parameter(0.0, 0.0, 10.0 * force),
    }
    starts = _starts(mass, "elastic_stiffness", force, ((0.1, 50.0), (0.5, 50.0), (5.0, 50.0), (5.0, 500.0)))
    return evolve(_moving(model, name, "hardening", mass, "crush_plateau | viscous", base, starts), refined=True)


def _starts(mass: float, name: str, force: float, shares: Sequence[tuple[float, float]]) -> list[dict[str, float]]:
    """From an obstacle that is easily moved to one that hardly moves, as the given one."""
    return [{"mass": heavy * mass, name: strong * force} for heavy, strong in shares]


def _moving(
    model: Model,
    name: str,
    form: str,
    mass: float,
    law: str | None,
    parameters: Parameters,
    starts: Sequence[Mapping[str, float]],
) -> Proposal:
    """The model with the obstacle set free, and joined to the ground by a law; `starts` name its mass `mass`."""
    obstacle = model.body(name)
    weight = Parameter(mass, LIGHT * mass, HEAVY * mass)
    released = evolve(obstacle, fixed=False, mass=weight, inertia=plane_inertia(model, mass))
    bodies = tuple(released if body.name == name else body for body in model.bodies)
    paths = {"mass": f"body.{name}.mass"}
    if law is None:
        augmented = evolve(model, bodies=bodies)
    else:
        ground = Body(fresh_name("ground", (b.name for b in bodies)), _behind(model, obstacle), obstacle.velocity, fixed=True)
        joint = fresh_name(f"{name}_ground", (j.name for j in model.joints))
        paths |= {key: f"joint.{joint}.{key}" for key, value in parameters.items() if not value.fixed}
        held = Joint(joint, (ground.name, name), law, dict(parameters), support=len(model.axes) == 1)
        augmented = evolve(model, bodies=(*bodies, ground), joints=(*model.joints, held))
    named = tuple({paths[key]: value for key, value in start.items()} for start in starts)
    return Proposal("obstacle_motion", form, {"body": name}, augmented, tuple(paths.values()), {}, named)


def _behind(model: Model, obstacle: Body) -> tuple[float, ...]:
    """A point so far behind the obstacle, as what runs into it sees it, that being pushed counts as compression."""
    others = [body for body in model.bodies if body.mass is not None]
    travel = [sum(body.velocity[axis] for body in others) for axis in range(len(model.axes))]
    length = sum(v * v for v in travel) ** 0.5 or 1.0
    return tuple(x + 100.0 * v / length for x, v in zip(obstacle.position, travel, strict=True))
