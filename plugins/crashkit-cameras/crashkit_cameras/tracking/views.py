"""What several cameras followed, as the data contract's camera group holds it."""

from collections.abc import Mapping

import xarray as xr

SAME_TIME = 9
"""Decimals of a second to which times are compared."""


def combine_views(views: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Join what `follow` found in the films of several cameras.

    Arguments:
        views: by the name of the camera.

    Returns:
        Dataset with `image_position` (time, view, marker, image_axis), pixel, NaN where a view has no frame or does not see
        the marker; `image_position_std` (marker), the root mean square of `image_position_noise`, which has the dims of
        `image_position`; `quality` (time, view, marker). `camera_group` adds what makes it a group of a recording.
    """
    tracks = [view[["image_position", "image_position_std", "quality"]] for view in views.values()]
    timed = [track.assign_coords(time=track["time"].round(SAME_TIME)) for track in tracks]
    names = xr.DataArray(list(views), dims="view", name="view")
    joined = xr.concat(timed, names, join="outer", data_vars="all", coords="minimal", compat="equals", combine_attrs="drop")
    each = joined["image_position_std"]
    places = {
        "image_position": joined["image_position"],
        "image_position_std": (each**2).mean(("time", "view", "image_axis")) ** 0.5,
        "image_position_noise": each,
    }
    joined = joined.assign({name: values.assign_attrs(units="pixel") for name, values in places.items()})
    return joined.transpose("time", "view", "marker", "image_axis")
