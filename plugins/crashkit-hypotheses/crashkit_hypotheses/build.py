"""How the hypotheses of this distribution put an effect into a model: as a joint, in the law of one, or as a factor."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import product

import numpy as np
from attrs import evolve, field, frozen

from crashkit.mechanics.given import side_of
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import fresh_name, with_changed_joint, with_factor, with_joint
from crashkit.protocols import Proposal
from crashkit.registry import load

Table = Mapping[str, Parameter | tuple[Parameter, ...]]
BESIDE = " | ", " & "
"""Signs of laws that stand side by side in one joint."""
NEVER_TURNS = 1e9
"""m2, moment of inertia over mass of a body that does not turn."""


@frozen
class Effect:
    """One piece of physics in one form, wherever it acts.

    Attributes:
        physics: its name.
        form: the functional form.
        law: or factor that tells it; empty where it is no joint's: a mass, an error of a sensor.
        parameters: of the law, by their names there.
        amplitude: the one of them, a number or a table, that says how much of it there is.
        starts: values of some of them to start a fit from, one mapping each.
        null: of the amplitude, at which it vanishes; None where it does at none.
    """

    physics: str
    form: str
    law: str
    parameters: Table
    amplitude: str
    starts: Sequence[Mapping[str, float]] = field(default=({},))
    null: float | None = field(default=0.0)


def parallel(model: Model, joint: Joint, effect: Effect) -> Proposal:
    """A second joint beside `joint`."""
    name, own = f"{joint.name}_{effect.physics}", dict(effect.parameters)
    beside = evolve(joint, name=name, law=effect.law, parameters=own, factors=(), free_length=_own_length(joint))
    return _joined(model, beside, {"joint": joint.name}, effect)


def at_a_distance(model: Model, joint: Joint, effect: Effect, apart: float) -> list[Proposal]:
    """A second joint beside `joint` that is deformed even where that is stretched by `apart`, m; none where how far apart its
    ends are at t = 0 is not told by where its bodies are."""
    if joint.free_length is None and len(model.axes) > 1 and (joint.points or joint.normal):
        return []
    length = joint.free_length.value if joint.free_length else _apart(model, joint)
    longer = evolve(joint, free_length=Parameter(length + apart, fixed=True))
    return [parallel(model, longer, effect)]


def linked(model: Model, joint: Joint, driver: Joint, effect: Effect) -> Proposal:
    """A second joint that is deformed as another one is and pushes where `joint` does; on a line."""
    pair = joint.bodies if side_of(model, joint) == side_of(model, driver) else joint.bodies[::-1]
    own, free_length = dict(effect.parameters), _own_length(driver)
    link = evolve(
        driver, law=effect.law, parameters=own, factors=(), free_length=free_length, acts_on=pair, support=joint.support
    )
    return _joined(model, evolve(link, name=f"{joint.name}_{effect.physics}"), {"joint": joint.name}, effect)


def added(model: Model, joint: Joint, effect: Effect) -> Proposal:
    """A force in the loading curve of `joint`, so that it unloads with it; beside it where its law takes none."""
    if takes_in(joint, effect):
        return changed(model, joint, evolve(effect, law=_with_added(joint.law, effect.law)))
    return parallel(model, joint, effect)


def beside(model: Model, joint: Joint, effect: Effect) -> list[Proposal]:
    """A force that a joint adds to its own but releases by itself; none where `added` has no other place for it."""
    if not takes_in(joint, effect):
        return []
    return [evolve(parallel(model, joint, evolve(effect, form=f"{effect.form}, beside")), refined=True)]


def takes_in(joint: Joint, effect: Effect) -> bool:
    """Whether the law of a joint takes a force into its loading curve."""
    return " + " not in joint.law and _with_added(joint.law, effect.law) in load().spring_laws


def _with_added(law: str, added: str) -> str:
    """A law with another in its loading curve, which is that of the first where several push together."""
    first, sign, others = law.partition(" & ")
    return f"{first} + {added}{sign}{others}"


def pushing_beside(model: Model, joint: Joint, effect: Effect) -> list[Proposal]:
    """A force beside the law of `joint`, which together only push; none where that may pull or has one beside it already."""
    law = f"{joint.law} & {effect.law}"
    pull = joint.parameters.get("tension")
    may_pull = isinstance(pull, Parameter) and pull.value
    if may_pull or any(sign in joint.law for sign in BESIDE) or law not in load().spring_laws:
        return []
    return [changed(model, joint, evolve(effect, law=law))]


def changed(model: Model, joint: Joint, effect: Effect) -> Proposal:
    """Parameters of the law of `joint`, which it had left out; the law may be another one that holds its own."""
    numbers = {**joint.parameters, **effect.parameters}
    augmented = with_changed_joint(model, joint.name, law=effect.law, parameters=numbers)
    return proposal(augmented, {"joint": joint.name}, f"joint.{joint.name}.", effect)


def multiplied(model: Model, joint: Joint, effect: Effect) -> Proposal:
    """A factor on `joint`."""
    augmented = with_factor(model, joint.name, effect.law, effect.parameters)
    return proposal(augmented, {"joint": joint.name}, f"joint.{joint.name}.", effect)


def driven(model: Model, joint: Joint, driver: Joint, effect: Effect) -> Proposal:
    """A factor on `joint` that another joint's deformation drives."""
    augmented = with_factor(model, joint.name, effect.law, effect.parameters)
    moved = with_changed_joint(augmented, joint.name, driver=driver.name)
    return proposal(moved, {"joint": joint.name}, f"joint.{joint.name}.", effect)


def grounded(model: Model, body: Body, effect: Effect, across: bool = False) -> Proposal:
    """A force on a body that nothing else feels: a joint to a fixed body of its own, compressed by driving on; or, in the
    plane, by moving to the left."""
    where = _ahead(body)
    if across:
        forwards = np.subtract(where, body.position)
        where = tuple(np.add(body.position, (-forwards[1], forwards[0])).tolist())
    ground = Body(fresh_name("ground", (b.name for b in model.bodies)), where, (0.0,) * len(body.position), fixed=True)
    held = Joint(f"{body.name}_{effect.physics}", (ground.name, body.name), effect.law, dict(effect.parameters))
    return _joined(evolve(model, bodies=(*model.bodies, ground)), held, {"body": body.name}, effect)


def between(model: Model, pair: tuple[str, str], effect: Effect, factors: tuple[str, ...] = ()) -> Proposal:
    """A joint between two bodies that have none, and factors on its force."""
    joint = Joint(f"{pair[0]}_{pair[1]}_{effect.physics}", pair, effect.law, dict(effect.parameters), factors=factors)
    return _joined(model, joint, {"bodies": list(pair)}, effect)


def _joined(model: Model, joint: Joint, location: Mapping[str, object], effect: Effect) -> Proposal:
    """One more joint, by a name that no other has."""
    name = fresh_name(joint.name, (j.name for j in model.joints))
    return proposal(with_joint(model, evolve(joint, name=name)), location, f"joint.{name}.", effect)


def proposal(model: Model, location: Mapping[str, object], prefix: str, effect: Effect) -> Proposal:
    """The proposal of a model with the effect, whose parameters stand below one path, the amplitude first."""
    amplitudes = _entries(prefix, effect.amplitude, effect)
    others = [path for name in effect.parameters if name != effect.amplitude for path in _entries(prefix, name, effect)]
    return Proposal(
        effect.physics,
        effect.form,
        location,
        model,
        (*amplitudes, *others),
        {} if effect.null is None else dict.fromkeys(amplitudes, effect.null),
        tuple({prefix + name: value for name, value in start.items()} for start in effect.starts),
    )


def proposal_at(
    *,
    physics: str,
    form: str,
    location: Mapping[str, object],
    model: Model,
    paths: Mapping[str, str],
    starts: Iterable[Mapping[str, float]],
) -> Proposal:
    """The proposal of a model whose new parameters stand at several paths and vanish at none.

    Arguments:
        paths: of the free ones, by the names that `starts` give them.
    """
    named = tuple({paths[name]: value for name, value in start.items()} for start in starts)
    return Proposal(physics, form, location, model, parameters=tuple(paths.values()), null={}, starts=named)


def free_paths(joint: Joint) -> dict[str, str]:
    """Of the free parameters of a joint, by name."""
    free = [key for key, value in joint.parameters.items() if isinstance(value, Parameter) and not value.fixed]
    return {key: f"joint.{joint.name}.{key}" for key in free}


def _entries(prefix: str, name: str, effect: Effect) -> list[str]:
    """The paths of the free entries of one parameter."""
    value = effect.parameters[name]
    if isinstance(value, Parameter):
        return [] if value.fixed else [prefix + name]
    return [f"{prefix}{name}[{index}]" for index, entry in enumerate(value) if not entry.fixed]


def grid(**values: Sequence[float]) -> list[dict[str, float]]:
    """Every combination of start values."""
    return [dict(zip(values, combination, strict=True)) for combination in product(*values.values())]


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


def _apart(model: Model, joint: Joint) -> float:
    """m, the distance of the ends of a joint at t = 0."""
    points = joint.points or ((0.0,) * len(model.axes),) * 2
    first, second = (np.add(model.body(name).position, point) for name, point in zip(joint.bodies, points, strict=True))
    return float(np.linalg.norm(second - first))


def _own_length(joint: Joint) -> Parameter | None:
    """The same rest length, not identified twice."""
    return None if joint.free_length is None else Parameter(joint.free_length.value, fixed=True)
