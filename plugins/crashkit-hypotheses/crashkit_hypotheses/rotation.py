"""A body of a model on a line turns."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import NEVER_TURNS, plane_inertia

LEVER = 0.5
"""m, by which the forces on a body that turns pass beside its centre of mass. What turns it is lever^2 / inertia, and only
instruments away from the centre of mass tell the two apart; so the lever is assumed, and the inertia identified."""
SHARES = (0.3, 3.0)
"""Moments of inertia to start from, in m2 times the mass: of a small body, and of a long one."""


class Rotation(Hypothesis):
    """m x'' = -F, I theta'' = -F e in the plane, where the model has m x'' = -F on a line."""

    physics: ClassVar[str] = "rotation"
    sentence: ClassVar[str] = "{place} turns, which the axes of the model leave out"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every body that moves, either way about, if the model is on a line and the recordings have a further axis."""
        across = _further_axis(model, recordings)
        if across is None:
            return []
        moving = [(body, body.mass.value) for body in model.bodies if body.mass is not None and not body.carrier]
        plane = _in_plane(model, across)
        return [self._turning(plane, across, body.name, mass, lever) for body, mass in moving for lever in (LEVER, -LEVER)]

    def _turning(self, plane: Model, across: str, name: str, mass: float, lever: float) -> Proposal:
        never = NEVER_TURNS * mass
        inertia = Parameter(SHARES[0] * mass, 0.01 * mass, 10.0 * never)
        bodies = tuple(evolve(b, inertia=(inertia,)) if b.name == name else b for b in plane.bodies)
        shift = tuple(lever if axis == across else 0.0 for axis in plane.axes)
        joints = tuple(_aside(joint, shift) if name in joint.bodies else joint for joint in plane.joints)
        path = f"body.{name}.inertia"
        form = "force to the left" if lever > 0 else "force to the right"
        starts = tuple({path: share * mass} for share in SHARES)
        return Proposal(
            self.physics, form, {"body": name}, evolve(plane, bodies=bodies, joints=joints), (path,), {path: never}, starts
        )


def _further_axis(model: Model, recordings: Sequence[xr.DataTree]) -> str | None:
    """An axis that the model leaves out and that every recording has, of its first state and of all instruments."""
    groups = [group.to_dataset(inherit=False) for recording in recordings for group in recording.children.values()]
    known = [set(group["axis"].values.tolist()) for group in groups if "axis" in group.coords]
    if len(model.axes) > 1 or not known:
        return None
    return next((axis for axis in "xyz" if axis not in model.axes and all(axis in axes for axes in known)), None)


def _in_plane(model: Model, across: str) -> Model:
    """The same model with a second axis, in which nothing happens yet."""
    axes = tuple(axis for axis in "xyz" if axis in (*model.axes, across))

    def wide(values: Sequence[float]) -> tuple[float, ...]:
        return tuple(values[0] if axis in model.axes else 0.0 for axis in axes)

    plane = evolve(model, axes=axes, gravity=wide(model.gravity) if model.gravity else ())
    bodies = tuple(
        evolve(
            body,
            position=wide(body.position),
            velocity=wide(body.velocity),
            inertia=() if body.mass is None else plane_inertia(plane, body.mass.value),
        )
        for body in model.bodies
    )
    joints = []
    for joint in model.joints:
        points = joint.points or ((0.0,), (0.0,))
        ends = [model.body(name).position[0] + point[0] for name, point in zip(joint.bodies, points, strict=True)]
        # A joint on a line keeps its direction, as the contact with a face does.
        side = 1.0 if ends[1] >= ends[0] else -1.0
        joints.append(evolve(joint, points=(wide(points[0]), wide(points[1])), normal=wide((side,))))
    return evolve(plane, bodies=bodies, joints=tuple(joints))


def _aside(joint: Joint, shift: tuple[float, ...]) -> Joint:
    """The joint, whose force passes beside the centre of mass: it acts at the second body's point."""
    assert joint.points is not None  # as `_in_plane` makes them
    first, second = joint.points
    return evolve(joint, points=(first, tuple(x + move for x, move in zip(second, shift, strict=True))))
