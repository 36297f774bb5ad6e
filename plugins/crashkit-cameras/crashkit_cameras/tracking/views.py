"""What several cameras followed, as the data contract's camera group holds it."""

from collections.abc import Mapping

import xarray as xr

TRACKED = ("image_position", "image_position_std", "quality")
SAME_TIME = 9
"""Decimals of a second to which times are compared."""


def combine_views(views: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Join what `follow` found in the films of several cameras.

    Arguments:
        views: by the name of the camera.

    Returns:
        Dataset with `image_position` (time, view, marker, image_axis), `image_position_std` and `quality`, over all times and
        markers; NaN where a view has no frame or does not see the marker. For a camera group it lacks the control points
        and `marker_body`, `marker_point`.
    """
    tracks = [view[list(TRACKED)].assign_coords(time=view["time"].round(SAME_TIME)) for view in views.values()]
    names = xr.DataArray(list(views), dims="view", name="view")
    joined = xr.concat(tracks, dim=names, join="outer", data_vars="all", coords="minimal", compat="equals", combine_attrs="drop")
    return joined.transpose("time", "view", "marker", "image_axis")
