"""Whether a recording is one of a given model."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from crashkit.data.recording import instruments
from crashkit.data.validate import is_text, names, shown
from crashkit.errors import ContractError, Fault
from crashkit.model.model import Model
from crashkit.model.pose import is_unit


def check_recording_against_model(tree: xr.DataTree, model: Model, source: str) -> None:
    """Refuse a recording whose bodies or axes are not those of the model: raises ContractError with every fault.

    Every text variable `<channel>_body` of an instrument must name bodies of the model. The group `initial` may hold bodies
    that the model does not have, but not while bodies of the model are missing from it: such a name is misspelt. In the plane
    and in space it may also hold orientations, and angular velocities about the axes that the model can turn about.
    """
    faults = list(_recording_faults(tree, model))
    if faults:
        raise ContractError(source, faults)


def _recording_faults(tree: xr.DataTree, model: Model) -> Iterator[Fault]:
    bodies = [body.name for body in model.bodies]
    if "initial" in tree.children:
        yield from _initial_faults(tree["initial"].to_dataset(), model)
    for group in instruments(tree):
        for name, variable in tree[group].to_dataset().variables.items():
            if str(name).endswith("_body") and is_text(variable.values):
                unknown = [label for label in dict.fromkeys(variable.values.ravel().tolist()) if label not in bodies]
                if unknown:
                    yield Fault(f"{group}/{name}", f"bodies of the model ({names(bodies)})", names(unknown))


def _initial_faults(initial: xr.Dataset, model: Model) -> Iterator[Fault]:
    found = initial["body"].values.tolist()
    missing = [body.name for body in model.bodies if body.is_free and body.name not in found]
    unknown = [name for name in found if name not in [body.name for body in model.bodies]]
    if missing and unknown:
        yield Fault("initial/body", f"the model's {names(missing)}", names(unknown))
    yield from _axis_faults(initial, model.axes, "initial/axis")
    if len(model.axes) > 1 and "angular_velocity" in initial:
        yield from _axis_faults(initial, _turning_axes(model), "initial/angular_velocity")
    if len(model.axes) > 1 and "orientation" in initial:
        yield from _quaternion_faults(initial["orientation"], "initial/orientation")


def _axis_faults(initial: xr.Dataset, axes: tuple[str, ...], where: str) -> Iterator[Fault]:
    found = initial["axis"].values.tolist()
    missing = [axis for axis in axes if axis not in found]
    if missing:
        yield Fault(where, f"the model's {names(missing)}", names(found))


def _turning_axes(model: Model) -> tuple[str, ...]:
    """The axes that a model's bodies can turn about: in the plane the one across it."""
    return model.axes if len(model.axes) == 3 else tuple(axis for axis in "xyz" if axis not in model.axes)


def _quaternion_faults(orientation: xr.DataArray, where: str) -> Iterator[Fault]:
    for body, row in zip(orientation["body"].values.tolist(), orientation.values.tolist(), strict=True):
        if not is_unit(row):
            yield Fault(where, "quaternions of length 1", f"one of length {np.linalg.norm(row):.9g} at body {shown(body)}")
