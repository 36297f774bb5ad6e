"""From what several cameras followed to the camera group of a recording."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit_cameras.control import AXES
from crashkit_cameras.result import IMAGE_AXES
from crashkit_cameras.tracking.views import combine_views


def camera_group(
    tracks: Mapping[str, xr.Dataset],
    markers: Mapping[str, tuple[str, Sequence[float]]],
    control: Mapping[str, Sequence[float]],
    control_images: Mapping[str, xr.Dataset],
    image_size: tuple[float, float] | None = None,
) -> xr.Dataset:
    """The camera group of a recording, as the data contract has it, for `Camera`, `calibrate` and `triangulate`.

    Arguments:
        tracks: what `follow` found, by camera.
        markers: the body that carries each marker, and the marker's place in the body's frame (3,), m.
        control: the place of each control point in the laboratory frame (3,), m.
        control_images: the control points' targets, by camera, with the names of the control points: from `follow` at one
            time, or from `detect` with names assigned. A control point that a camera does not see is left out.
        image_size: width and height, pixel, of all cameras; the calibration is better for it.

    Raises CrashkitError where cameras or markers of one argument are missing in another.
    """
    joined = combine_views(tracks)
    names, views = joined["marker"].values.tolist(), list(tracks)
    _refuse_missing("markers", names, markers)
    _refuse_missing("control_images", views, control_images)
    seen = [control_images[view]["image_position"].reindex(marker=list(control)).values for view in views]
    pixel, metre = {"units": "pixel"}, {"units": "m"}
    group = joined.assign(
        control_position=(("control_point", "axis"), np.array([control[name] for name in control], dtype=float), metre),
        control_image=(("control_point", "view", "image_axis"), np.stack(seen, axis=1), pixel),
        marker_body=("marker", [markers[name][0] for name in names]),
        marker_point=(("marker", "axis"), np.array([markers[name][1] for name in names], dtype=float), metre),
    ).assign_coords(control_point=list(control), axis=AXES, image_axis=IMAGE_AXES)
    if image_size is not None:
        group = group.assign(
            image_size=(("view", "image_axis"), np.tile(np.array(image_size, dtype=float), (len(views), 1)), pixel)
        )
    return group.assign_attrs(observer="camera")


def _refuse_missing(argument: str, wanted: Sequence[str], given: Mapping[str, object]) -> None:
    missing = [name for name in wanted if name not in given]
    if missing:
        raise CrashkitError(f"{argument}: expected {', '.join(wanted)}, found none of {', '.join(missing)}")
