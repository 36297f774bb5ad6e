"""How the hypotheses of this distribution add a joint or a factor, and read the motion for sizes to start from."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations, product

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import fresh_name, with_factor, with_joint
from crashkit.protocols import Proposal
from crashkit.registry import load

NEARER = 1e-3
"""m, least approach of two bodies that may touch."""
NEVER_TURNS = 1e9
"""m2, moment of inertia over mass of a body that does not turn."""


def parallel(
    model: Model,
    joint: Joint,
    physics: str,
    form: str,
    law: str,
    parameters: Mapping[str, Parameter | tuple[Parameter, ...]],
    amplitude: str,
    starts: Iterable[Mapping[str, float]] = ({},),
) -> Proposal:
    """A second joint beside `joint`, whose force vanishes where `amplitude` is 0."""
    name = fresh_name(f"{joint.name}_{physics}", (j.name for j in model.joints))
    extra = evolve(joint, name=name, law=law, parameters=dict(parameters), factors=(), free_length=_own_length(joint))
    return proposal(
        physics, form, {"joint": joint.name}, with_joint(model, extra), f"joint.{name}.", parameters, amplitude, starts
    )


def added(
    model: Model,
    joint: Joint,
    physics: str,
    form: str,
    law: str,
    parameters: Mapping[str, Parameter | tuple[Parameter, ...]],
    amplitude: str,
    starts: Iterable[Mapping[str, float]] = ({},),
) -> Proposal:
    """A force in the loading curve of `joint`, so that it unloads with it; beside it where its law takes none."""
    name = f"{joint.law} + {law}"
    if " + " in joint.law or name not in load().spring_laws:
        return parallel(model, joint, physics, form, law, parameters, amplitude, starts)
    return changed(model, evolve(joint, law=name), physics, form, parameters, amplitude, starts)


def pushing_beside(
    model: Model,
    joint: Joint,
    physics: str,
    form: str,
    law: str,
    parameters: Mapping[str, Parameter | tuple[Parameter, ...]],
    amplitude: str,
    starts: Iterable[Mapping[str, float]] = ({},),
) -> list[Proposal]:
    """A force beside the law of `joint`, which together only push; none where that law is made of several or may pull."""
    name = f"{joint.law} & {law}"
    pull = joint.parameters.get("tension")
    if " " in joint.law or (isinstance(pull, Parameter) and pull.value) or name not in load().spring_laws:
        return []
    return [changed(model, evolve(joint, law=name), physics, form, parameters, amplitude, starts)]


def changed(
    model: Model,
    joint: Joint,
    physics: str,
    form: str,
    parameters: Mapping[str, Parameter | tuple[Parameter, ...]],
    amplitude: str,
    starts: Iterable[Mapping[str, float]] = ({},),
    null: float | None = 0.0,
) -> Proposal:
    """Parameters of the law of `joint`, which it had left out; the law may be another one that holds its own."""
    own = evolve(joint, parameters={**joint.parameters, **parameters})
    augmented = evolve(model, joints=tuple(own if j.name == joint.name else j for j in model.joints))
    prefix = f"joint.{joint.name}."
    return proposal(physics, form, {"joint": joint.name}, augmented, prefix, parameters, amplitude, starts, null)


def multiplied(
    model: Model,
    joint: Joint,
    physics: str,
    form: str,
    factor: str,
    parameters: Mapping[str, Parameter | tuple[Parameter, ...]],
    amplitude: str,
    starts: Iterable[Mapping[str, float]] = ({},),
) -> Proposal:
    """A factor on `joint`, which is 1 where `amplitude` is 0."""
    augmented = with_factor(model, joint.name, factor, parameters)
    prefix = f"joint.{joint.name}."
    return proposal(physics, form, {"joint": joint.name}, augmented, prefix, parameters, amplitude, starts)


def grounded(
    model: Model,
    body: Body,
    physics: str,
    form: str,
    law: str,
    parameters: Mapping[str, Parameter | tuple[Parameter, ...]],
    amplitude: str,
    starts: Iterable[Mapping[str, float]] = ({},),
) -> Proposal:
    """A force on a body that nothing else feels: a joint to a fixed body of its own, compressed by driving on."""
    ground = Body(fresh_name("ground", (b.name for b in model.bodies)), _ahead(body), (0.0,) * len(body.position), fixed=True)
    name = fresh_name(f"{body.name}_{physics}", (joint.name for joint in model.joints))
    augmented = with_joint(
        evolve(model, bodies=(*model.bodies, ground)), Joint(name, (ground.name, body.name), law, dict(parameters))
    )
    return proposal(physics, form, {"body": body.name}, augmented, f"joint.{name}.", parameters, amplitude, starts)


def between(
    model: Model,
    pair: tuple[str, str],
    physics: str,
    form: str,
    law: str,
    parameters: Mapping[str, Parameter | tuple[Parameter, ...]],
    amplitude: str,
    starts: Iterable[Mapping[str, float]] = ({},),
    null: float | None = 0.0,
) -> Proposal:
    """A joint between two bodies that have none."""
    name = fresh_name(f"{pair[0]}_{pair[1]}_{physics}", (joint.name for joint in model.joints))
    augmented = with_joint(model, Joint(name, pair, law, dict(parameters)))
    return proposal(physics, form, {"bodies": list(pair)}, augmented, f"joint.{name}.", parameters, amplitude, starts, null)


def proposal(
    physics: str,
    form: str,
    location: Mapping[str, object],
    model: Model,
    prefix: str,
    parameters: Mapping[str, Parameter | tuple[Parameter, ...]],
    amplitude: str,
    starts: Iterable[Mapping[str, float]],
    null: float | None = 0.0,
) -> Proposal:
    """A proposal whose new parameters stand below one path, the amplitude (a number or a table) first."""
    amplitudes = _entries(prefix, amplitude, parameters)
    others = [path for name in parameters if name != amplitude for path in _entries(prefix, name, parameters)]
    return Proposal(
        physics,
        form,
        location,
        model,
        (*amplitudes, *others),
        {} if null is None else dict.fromkeys(amplitudes, null),
        tuple({prefix + name: value for name, value in start.items()} for start in starts),
    )


def _entries(prefix: str, name: str, parameters: Mapping[str, Parameter | tuple[Parameter, ...]]) -> list[str]:
    """The paths of the free entries of one parameter."""
    value = parameters[name]
    if isinstance(value, Parameter):
        return [] if value.fixed else [prefix + name]
    return [f"{prefix}{name}[{index}]" for index, entry in enumerate(value) if not entry.fixed]


def grid(**values: Sequence[float]) -> list[dict[str, float]]:
    """Every combination of start values."""
    return [dict(zip(values, combination, strict=True)) for combination in product(*values.values())]


def largest_deformation(motions: Sequence[xr.Dataset], joint: str) -> float:
    """m, over all runs."""
    return max(float(np.nanmax(motion["deformation"].sel(joint=joint).values)) for motion in motions)


def largest_extension(motions: Sequence[xr.Dataset], joint: str) -> float:
    """m, over all runs; 0 where it was never stretched."""
    return max(float(-np.nanmin(motion["deformation"].sel(joint=joint).values, initial=0.0)) for motion in motions)


def pulls(motions: Sequence[xr.Dataset], joint: str) -> bool:
    """Whether a joint pulled in some run."""
    stretched = largest_extension(motions, joint) > 0.0
    return stretched and min(float(np.nanmin(one["force"].sel(joint=joint).values)) for one in motions) < 0.0


def largest_force(motions: Sequence[xr.Dataset], joint: str) -> float:
    """N, over all runs."""
    return max(float(np.nanmax(np.abs(motion["force"].sel(joint=joint).values))) for motion in motions)


def largest_rate(motions: Sequence[xr.Dataset], joint: str) -> float:
    """m s-1, over all runs."""
    return max(float(np.nanmax(np.abs(motion["deformation_rate"].sel(joint=joint).values))) for motion in motions)


def largest_travel(motions: Sequence[xr.Dataset], body: str) -> float:
    """m, from where a body was at t = 0, over all runs."""
    return max(_travel(motion["position"].sel(body=body)) for motion in motions)


def _travel(position: xr.DataArray) -> float:
    moved = position.transpose("time", "axis").values
    return float(np.linalg.norm(moved - moved[0], axis=1).max())


def largest_approach(motions: Sequence[xr.Dataset], first: str, second: str) -> float:
    """m, by how much two bodies come closer than they were at t = 0, over all runs."""
    return max(_approach(motion["position"].sel(body=first) - motion["position"].sel(body=second)) for motion in motions)


def approaching(model: Model, motions: Sequence[xr.Dataset]) -> dict[tuple[str, str], float]:
    """The pairs of bodies without a joint that come closer than they were, and by how much, m."""
    joined = {frozenset(joint.bodies) for joint in model.joints}
    pairs = [(a, b) for a, b in combinations(model.bodies, 2) if not (a.fixed and b.fixed) and a.position != b.position]
    free = [(a.name, b.name) for a, b in pairs if {a.name, b.name} not in joined]
    reached = {pair: largest_approach(motions, *pair) for pair in free}
    return {pair: approach for pair, approach in reached.items() if approach > NEARER}


def _approach(separation: xr.DataArray) -> float:
    distance = np.linalg.norm(separation.transpose("time", "axis").values, axis=1)
    return float(distance[0] - distance.min())


def forces_recorded(recordings: Sequence[xr.DataTree]) -> bool:
    """Whether a load cell is among the instruments."""
    return any("force" in group.data_vars for recording in recordings for group in recording.children.values())


def sampling_interval(recordings: Sequence[xr.DataTree]) -> float:
    """s, of the fastest instrument; 1 ms where there is none."""
    groups = [group.to_dataset(inherit=False) for recording in recordings for group in recording.children.values()]
    stamps = [group["time"].values for group in groups if group.sizes.get("time", 0) > 1]
    return min((float(np.median(np.diff(times))) for times in stamps), default=1e-3)


def plane_inertia(model: Model, mass: float) -> tuple[Parameter, ...]:
    """Of a body that shall not turn, kg m2: none on a line, where nothing turns."""
    return tuple(Parameter(NEVER_TURNS * mass, fixed=True) for _ in range({1: 0, 2: 1, 3: 3}[len(model.axes)]))


def forward(model: Model, body: Body) -> tuple[float, ...] | None:
    """The direction of travel, along which bodies at one place press on each other; None on a line, which has no other."""
    if len(model.axes) == 1:
        return None
    speed = float(np.linalg.norm(body.velocity))
    return tuple(v / speed for v in body.velocity) if speed else (1.0, *(0.0 for _ in body.velocity[1:]))


def _ahead(body: Body) -> tuple[float, ...]:
    """A point in the direction of travel."""
    return tuple(x + (100.0 if v >= 0 else -100.0) for x, v in zip(body.position, body.velocity, strict=True))


def _own_length(joint: Joint) -> Parameter | None:
    """The same rest length, not identified twice."""
    return None if joint.free_length is None else Parameter(joint.free_length.value, fixed=True)
