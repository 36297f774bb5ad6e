"""What a body must fulfil before it can be simulated."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from crashkit.data.validate import names, shown
from crashkit.errors import Fault
from crashkit.model.body import Body
from crashkit.model.given import GivenForce, GivenMotion
from crashkit.model.model import Model
from crashkit.model.number_checks import (
    counted,
    finite_faults,
    parameter_faults,
    positive_faults,
    row_faults,
    time_faults,
    vector_faults,
)
from crashkit.model.parameter import Parameter
from crashkit.model.pose import ORIENTATION, ROTATION, is_unit

ROUNDING = 1e-9
"""Relative, of moments of inertia: those of a thin plate fulfil their inequality as an equation."""
EXPECTED_ORIENTATION = {2: "an angle in rad", 3: "a quaternion (w, x, y, z)"}
EXPECTED_ANGULAR_VELOCITY = {2: "one number in rad s-1", 3: "three numbers in rad s-1"}
EXPECTED_INERTIA = {
    2: "a moment of inertia in kg m2",
    3: "three moments of inertia in kg m2 (principal), six (Ixx, Iyy, Izz, Ixy, Ixz, Iyz), or a number about every axis",
}


def body_faults(body: Body, model: Model, where: str) -> Iterator[Fault]:
    """Every fault of a body of the model; `where` names it."""
    axes = len(model.axes)
    yield from vector_faults(body.position, axes, f"{where}/position")
    yield from vector_faults(body.velocity, axes, f"{where}/velocity")
    others = list(dict.fromkeys(other.name for other in model.bodies if other.name not in ("", body.name)))
    if body.carrier and body.carrier not in others:
        yield Fault(f"{where}/carrier", f"one of {names(others) or 'no bodies'}", shown(body.carrier))
    yield from _mass_faults(body, where)
    if axes in ORIENTATION:
        yield from _rotation_faults(body, axes, where)
        yield from _inertia_faults(body, axes, f"{where}/inertia")
        yield from _given_faults(body, axes, where)
    yield from _held_faults(body, where)


def _mass_faults(body: Body, where: str) -> Iterator[Fault]:
    if body.mass is not None:
        yield from positive_faults(body.mass, "a mass", f"{where}/mass")
    elif body.is_free:
        yield Fault(f"{where}/mass", "a mass in kg", "none")


def _held_faults(body: Body, where: str) -> Iterator[Fault]:
    """Nothing is given twice, or to no effect, for a body that no force moves."""
    if body.is_free:
        return
    held = "a fixed body" if body.fixed else "a body whose motion is given"
    if any(body.velocity):
        yield Fault(f"{where}/velocity", f"no velocity for {held}", names(body.velocity))
    if any(body.angular_velocity):
        yield Fault(f"{where}/angular_velocity", f"no angular velocity for {held}", names(body.angular_velocity))
    if body.force is not None:
        yield Fault(f"{where}/force", f"no force for {held}", "one")
    if body.fixed and body.motion is not None:
        yield Fault(f"{where}/motion", f"no motion for {held}", "one")


def _rotation_faults(body: Body, axes: int, where: str) -> Iterator[Fault]:
    yield from _orientation_faults(body.orientation, axes, f"{where}/orientation")
    yield from _length_faults(
        body.angular_velocity, ROTATION[axes], EXPECTED_ANGULAR_VELOCITY.get(axes), f"{where}/angular_velocity"
    )


def _orientation_faults(orientation: Sequence[float], axes: int, where: str) -> Iterator[Fault]:
    faults = list(_length_faults(orientation, ORIENTATION[axes], EXPECTED_ORIENTATION.get(axes), where))
    if not faults and len(orientation) == 4 and not is_unit(orientation):
        faults.append(Fault(where, "a quaternion of length 1", f"one of length {math.hypot(*orientation):.9g}"))
    yield from faults


def _length_faults(values: Sequence[float], length: int, expected: str | None, where: str) -> Iterator[Fault]:
    """What may be left out is as long as the axes ask for; in one axis, where nothing turns, it is left out."""
    if values and expected is None:
        yield Fault(where, "none in one axis", names(values))
    elif values and len(values) != length:
        yield Fault(where, expected or "", counted(len(values)))
    yield from finite_faults(values, where)


def _inertia_faults(body: Body, axes: int, where: str) -> Iterator[Fault]:
    found = len(body.inertia)
    if axes == 1:
        if found:
            yield Fault(where, "none in one axis", names(entry.value for entry in body.inertia))
    elif not found:
        if body.is_free:
            yield Fault(where, EXPECTED_INERTIA[axes], "none")
    elif found not in {2: (1,), 3: (3, 6)}[axes]:
        yield Fault(where, EXPECTED_INERTIA[axes], counted(found))
    elif axes == 2:
        yield from positive_faults(body.inertia[0], "a moment of inertia", where)
    else:
        yield from _space_inertia_faults(body.inertia, where)


def _space_inertia_faults(inertia: Sequence[Parameter], where: str) -> Iterator[Fault]:
    faults = [
        fault
        for index, entry in enumerate(inertia)
        for fault in (
            positive_faults(entry, "a moment of inertia", f"{where}[{index}]")
            if index < 3
            else parameter_faults(entry, None, f"{where}[{index}]")
        )
    ]
    yield from faults or _principal_faults([entry.value for entry in inertia], where)


def _principal_faults(inertia: Sequence[float], where: str) -> Iterator[Fault]:
    """The principal moments, sums of m (y^2 + z^2) and its sisters, are above 0 and none exceeds the sum of the others."""
    xx, yy, zz, xy, xz, yz = (*inertia, 0.0, 0.0, 0.0)[:6]
    moments = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    found = f"principal moments {', '.join(f'{moment:.6g}' for moment in moments)}"
    if moments[0] <= 0.0:
        yield Fault(where, "a positive definite matrix", found)
    elif moments[2] > (moments[0] + moments[1]) * (1.0 + ROUNDING):
        yield Fault(where, "principal moments of which none exceeds the sum of the others", found)


def _given_faults(body: Body, axes: int, where: str) -> Iterator[Fault]:
    if body.motion is not None:
        yield from _motion_faults(body.motion, axes, f"{where}/motion")
        if body.orientation and body.motion.orientation:
            yield Fault(f"{where}/orientation", "none beside those of the given motion", names(body.orientation))
    if body.force is not None:
        yield from _force_faults(body.force, axes, f"{where}/force")


def _motion_faults(motion: GivenMotion, axes: int, where: str) -> Iterator[Fault]:
    times = len(motion.time)
    yield from time_faults(motion.time, f"{where}/time")
    yield from row_faults(motion.position, times, axes, f"{where}/position")
    if not motion.orientation:
        return
    if axes == 1:
        yield Fault(f"{where}/orientation", "none in one axis", f"{len(motion.orientation)} rows")
        return
    faults = list(row_faults(motion.orientation, times, ORIENTATION[axes], f"{where}/orientation"))
    yield from faults
    for index, row in enumerate([] if faults else motion.orientation):
        yield from _orientation_faults(row, axes, f"{where}/orientation[{index}]")


def _force_faults(force: GivenForce, axes: int, where: str) -> Iterator[Fault]:
    times = len(force.time)
    yield from time_faults(force.time, f"{where}/time")
    yield from row_faults(force.force, times, axes, f"{where}/force")
    if force.moment and axes == 1:
        yield Fault(f"{where}/moment", "none in one axis", f"{len(force.moment)} rows")
    elif force.moment:
        yield from row_faults(force.moment, times, ROTATION[axes], f"{where}/moment")
