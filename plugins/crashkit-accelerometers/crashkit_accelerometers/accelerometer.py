"""Accelerometers: sensors at points of bodies that may turn."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from crashkit.data.instrument_errors import CLOCK_ERRORS, ROCKING
from crashkit.data.schema import GroupSchema, Variable
from crashkit.data.schemas import CHANNEL_FREQUENCY_CLASS, FRAME
from crashkit.errors import CrashkitError
from crashkit.protocols import Misread, PlainObserver, Reading, SensorErrors, Shown, TurningReading
from crashkit_accelerometers.chain import Own
from crashkit_accelerometers.error_specs import AXES, LEAN, POSITION_ERRORS, channel_errors
from crashkit_accelerometers.point_acceleration import felt_by_points
from crashkit_accelerometers.rigid_body import rigid_body_motion
from crashkit_accelerometers.sensor_channel import (
    DIMS,
    bodies_of,
    felt_in_laboratory,
    misread_channels,
    own_errors,
    plain_reading,
    predict_channels,
    reconstruct_bodies,
)


class Accelerometer(PlainObserver):
    """A sensor at the point p of a body feels a + alpha x R p + omega x (omega x R p), and records it with its own errors.

    `frame` = "body": its axes turn with the body; "laboratory": they do not. Where a body does not turn, every point of it has
    its acceleration.
    """

    name = "accelerometer"
    schema = GroupSchema(
        "accelerometer",
        (
            Variable(
                "acceleration", DIMS, "m s-2", "a sensor's acceleration along each axis", allow_nan=True, allow_silent=True
            ),
            Variable("sensor_body", ("sensor",), None, "the body that carries the sensor", kind="text"),
            Variable(
                "sensor_point", ("sensor", "axis"), "m", "the sensor's place in the body's frame, from the centre of mass"
            ),
            Variable(
                "acceleration_std",
                ("sensor",),
                "m s-2",
                "standard deviation of a sample as recorded",
                required=False,
                positive=True,
            ),
        ),
        (
            CHANNEL_FREQUENCY_CLASS,
            FRAME,
        ),
    )
    quantity = "acceleration"
    channel = "sensor"
    errors = (*channel_errors("m s-2", full_scale=1000.0), LEAN, *POSITION_ERRORS, *ROCKING)
    instrument_errors = CLOCK_ERRORS
    place_errors = tuple(spec.name for spec in POSITION_ERRORS)

    def predict(self, motion: xr.Dataset, instrument: xr.Dataset, errors: SensorErrors | None = None) -> xr.Dataset:
        """The sensors' accelerations, as `Observer.predict` says."""
        own = own_errors(self, instrument, errors)
        bodies = bodies_of(self, motion, instrument)
        if "orientation" in motion.variables:
            felt = felt_by_points(motion, bodies, _points(instrument, own), instrument.attrs.get("frame") == "body")
        else:
            felt = felt_in_laboratory(self, motion, "acceleration", bodies)
        return predict_channels(self, motion, instrument, own, felt)

    def reading(self, instrument: xr.Dataset, turning: bool) -> Reading | TurningReading:
        """The accelerations of the bodies, or those of the sensors' points, which may turn with them."""
        plain, own_axes = plain_reading(instrument, "acceleration"), instrument.attrs.get("frame") == "body"
        points = instrument.variables["sensor_point"].values
        if not turning or not (own_axes or points.any()):
            return plain
        axes = tuple(instrument.variables["axis"].values.tolist())
        return TurningReading("acceleration", plain.bodies, plain.axes, axes, points.repeat(len(axes), axis=0), own_axes)

    def misread(self, shown: Shown, instrument: xr.Dataset, errors: SensorErrors, wanted: Sequence[str]) -> Misread:
        """As `PlainObserver.misread` says."""
        return misread_channels(self, shown, instrument, errors, wanted)

    def reconstruct(self, instrument: xr.Dataset) -> xr.Dataset:
        """What the sensors tell of the motion without knowing how it began.

        Returns:
            On a line `acceleration` (time, body, axis), the mean of each body's sensors, and `acceleration_std` where theirs
            is stated; else what `rigid_body_motion` returns, for bodies whose axes are at first those of the laboratory.

        Raises CrashkitError where no body has enough sensors, saying what is missing.
        """
        if instrument.sizes["axis"] == 1:
            return reconstruct_bodies(self, instrument, "acceleration")
        return rigid_body_motion(instrument)


def _points(instrument: xr.Dataset, own: Own) -> np.ndarray:
    """Where the sensors are, (sensor, 3) m; 0 along axes that the instrument does not have."""
    points = np.stack([own[f"position_{axis}"] for axis in AXES], axis=-1)
    if (points != points[:, :1]).any():
        raise CrashkitError("accelerometer: expected the position errors of whole sensors, found those of single axes")
    points = points[:, 0]
    recorded = [AXES.index(axis) for axis in instrument.variables["axis"].values.tolist()]
    points[:, recorded] += instrument.variables["sensor_point"].values
    return points
