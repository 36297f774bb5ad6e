"""Film as the cameras saw it: markers and control points in pixels."""

import xarray as xr

from crashkit.data.schema import GroupSchema, Variable
from crashkit.errors import CrashkitError
from crashkit.protocols import Observer, SensorErrors
from crashkit_cameras.film import MARKER_BODY, MARKER_POINT

NEEDS_FILM = "a camera group must be reconstructed into a film group first, and this version cannot do that yet"


class Camera(Observer):
    """Image coordinates of markers in several views: read and validated, not yet reconstructed."""

    name = "camera"
    schema = GroupSchema(
        "camera",
        (
            Variable(
                "image_position",
                ("time", "view", "marker", "image_axis"),
                "pixel",
                "a marker's place in the image",
                allow_nan=True,
            ),
            Variable("control_position", ("control_point", "axis"), "m", "a control point's position in the laboratory frame"),
            Variable(
                "control_image",
                ("control_point", "view", "image_axis"),
                "pixel",
                "a control point's place in the image",
                allow_nan=True,
            ),
            MARKER_BODY,
            MARKER_POINT,
            Variable("time_marker", ("time", "view"), None, "the synchronising diode, on or off", kind="flag", required=False),
        ),
    )
    quantity = "image_position"
    channel = "marker"

    def predict(self, motion: xr.Dataset, instrument: xr.Dataset, errors: SensorErrors | None = None) -> xr.Dataset:
        """Raises CrashkitError: the cameras are not calibrated."""
        raise CrashkitError(NEEDS_FILM)

    def reconstruct(self, instrument: xr.Dataset) -> xr.Dataset:
        """Raises CrashkitError: the cameras are not calibrated."""
        raise CrashkitError(NEEDS_FILM)
