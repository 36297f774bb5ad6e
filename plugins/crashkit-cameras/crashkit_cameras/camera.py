"""Film as the cameras saw it: markers and control points in pixels."""

from functools import lru_cache

import numpy as np
import xarray as xr

from crashkit.data.instrument_errors import CLOCK, CLOCK_ERRORS, error_values, prediction_coordinates, true_times
from crashkit.data.schema import GroupSchema, Variable
from crashkit.data.schemas import body_of, point_of, std_of
from crashkit.protocols import Observer, ParameterSpec, SensorErrors
from crashkit_cameras.body_motion import body_motion
from crashkit_cameras.calibration import calibrate
from crashkit_cameras.control import AXES
from crashkit_cameras.marker_motion import marker_motion
from crashkit_cameras.markers import triangulation
from crashkit_cameras.projection import Cameras, project_with_point_derivatives

DIMS = ("time", "view", "marker", "image_axis")
CALIBRATING = ("control_position", "control_image", "control_position_std", "image_size")


class Camera(Observer):
    """Markers as one or several cameras see them, and control points by which the cameras are calibrated.

    z(t) = u_0 + gain (u(t (1 - clock_rate) - clock_offset) - u_0) + bias, with u the image of the marker, and u_0 where it is
    at the motion's start.
    """

    name = "camera"
    schema = GroupSchema(
        "camera",
        (
            Variable("image_position", DIMS, "pixel", "a marker's place in the image", allow_nan=True, allow_silent=True),
            Variable("control_position", ("control_point", "axis"), "m", "a control point's position in the laboratory frame"),
            Variable(
                "control_image",
                ("control_point", "view", "image_axis"),
                "pixel",
                "a control point's place in the image",
                allow_nan=True,
            ),
            body_of("marker"),
            point_of("marker"),
            std_of("image_position", "marker", "pixel"),
            Variable(
                "control_position_std",
                ("control_point",),
                "m",
                "standard deviation of the control point's survey; 0 if omitted",
                required=False,
                allow_negative=False,
            ),
            Variable(
                "image_size",
                ("view", "image_axis"),
                "pixel",
                "width and height of the image; guessed if omitted",
                required=False,
                positive=True,
            ),
            Variable("time_marker", ("time", "view"), None, "the synchronising diode, on or off", kind="flag", required=False),
        ),
    )
    quantity = "image_position"
    channel = "marker"
    errors = (
        ParameterSpec("gain", "1", "recorded displacement per displacement", 0.2, 5.0, default=1.0, null=1.0),
        ParameterSpec("bias", "pixel", "offset of the recorded place", default=0.0, null=0.0),
        *CLOCK,
    )
    instrument_errors = CLOCK_ERRORS

    def predict(self, motion: xr.Dataset, instrument: xr.Dataset, errors: SensorErrors | None = None) -> xr.Dataset:
        """The markers' images, as `Observer.predict` says, through the cameras that the control points calibrate.

        A model in one axis or a plane says nothing of the others: there its bodies are at 0.
        """
        cameras = _cameras(instrument)
        markers = instrument.variables["marker"].values.tolist()
        own = error_values(self, markers, ["u", "v"], errors)
        stamps = instrument.variables["time"].values
        at = true_times(stamps, own)
        bodies, points = instrument.variables["marker_body"].values.tolist(), instrument.variables["marker_point"].values
        seen = marker_motion(self, motion, bodies, points, AXES, at, in_space=True)
        image, slope = _images(cameras, seen.position)
        start, start_slope = _images(cameras, seen.start[None])

        gain, bias = own["gain"], own["bias"]
        displacement = image - start
        rate = (slope @ seen.velocity[:, None, :, :, None])[..., 0]
        late = -gain * rate, -gain * rate * stamps[:, None, None, None]
        derivatives = np.stack([displacement, np.ones_like(image), *late], axis=-1)
        predicted = {
            "image_position": xr.Variable(DIMS, start + gain * displacement + bias, {"units": "pixel"}),
            "image_position_error_sensitivity": xr.Variable((*DIMS, "error"), derivatives),
        }
        if seen.slope is not None and seen.start_slope is not None:
            from_start = start_slope @ seen.start_slope[None, None]
            sensitivity = from_start + gain[..., None] * (slope @ seen.slope[:, None] - from_start)
            predicted["image_position_sensitivity"] = xr.Variable((*DIMS, "parameter"), sensitivity)
        return xr.Dataset(predicted, prediction_coordinates(self, motion, instrument))

    def reconstruct(self, instrument: xr.Dataset) -> xr.Dataset:
        """The bodies' positions and orientations, as `body_motion` says, from the markers that two views or more saw.

        The cameras are calibrated by the control points and the markers together. Raises CrashkitError where the control
        points cannot calibrate a camera, or there is only one view.
        """
        found = triangulation(instrument, calibrate(instrument))
        shape = instrument.sizes["time"], instrument.sizes["marker"]
        positions, covariance, response = (
            array.reshape(*shape, *array.shape[1:]) for array in (found.position, found.noise, found.response)
        )
        return body_motion(instrument, positions, covariance, response)


def _images(cameras: Cameras, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The images (time, view, marker, 2) of positions (time, marker, 3), and their derivatives to these, (..., 2, 3)."""
    times, markers, _ = positions.shape
    image, slope = project_with_point_derivatives(cameras, positions.reshape(-1, 3))
    image = image.reshape(-1, times, markers, 2).swapaxes(0, 1)
    return image, slope.reshape(-1, times, markers, 2, 3).swapaxes(0, 1)


def _cameras(instrument: xr.Dataset) -> Cameras:
    """The cameras of a group, calibrated once for the same control points."""
    variables = tuple(
        (name, variable.dims, variable.shape, variable.values.astype(float).tobytes())
        for name, variable in ((name, instrument.variables.get(name)) for name in CALIBRATING)
        if variable is not None
    )
    return _calibrated(variables, tuple(instrument.variables["axis"].values.tolist()))


@lru_cache(maxsize=64)
def _calibrated(variables: tuple[tuple[str, tuple[str, ...], tuple[int, ...], bytes], ...], axes: tuple[str, ...]) -> Cameras:
    group = {name: xr.Variable(dims, np.frombuffer(content).reshape(shape)) for name, dims, shape, content in variables}
    return calibrate(xr.Dataset(group, {"axis": list(axes)}), markers=False).cameras
