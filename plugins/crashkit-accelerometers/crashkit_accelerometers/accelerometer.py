"""Accelerometers on bodies that do not turn."""

import xarray as xr

from crashkit.data.schema import Attribute, GroupSchema, Variable
from crashkit.protocols import Observer, SensorErrors
from crashkit_accelerometers.sensor_channel import (
    CHANNEL_FREQUENCY_CLASS,
    DIMS,
    channel_errors,
    predict_channels,
    reconstruct_bodies,
)


class Accelerometer(Observer):
    """Every point of a body that does not turn has its acceleration: a(t) = filter(gain x''(t - clock_offset) + bias)."""

    name = "accelerometer"
    schema = GroupSchema(
        "accelerometer",
        (
            Variable("acceleration", DIMS, "m s-2", "a sensor's acceleration along each axis", allow_nan=True),
            Variable("sensor_body", ("sensor",), None, "the body that carries the sensor", kind="text"),
            Variable(
                "sensor_point", ("sensor", "axis"), "m", "the sensor's place in the body's frame, from the centre of mass"
            ),
            Variable("acceleration_std", ("sensor",), "m s-2", "standard deviation of a sample as recorded", required=False),
        ),
        (
            CHANNEL_FREQUENCY_CLASS,
            Attribute("frame", "whether the sensors' axes turn with the body", ("body", "laboratory")),
        ),
    )
    quantity = "acceleration"
    channel = "sensor"
    errors = channel_errors("m s-2")
    instrument_errors = ("clock_offset",)

    def predict(self, motion: xr.Dataset, instrument: xr.Dataset, errors: SensorErrors | None = None) -> xr.Dataset:
        """The sensors' accelerations, as `Observer.predict` says."""
        return predict_channels(self, motion, "acceleration", instrument, errors)

    def reconstruct(self, instrument: xr.Dataset) -> xr.Dataset:
        """The bodies' accelerations, (time, body, axis), each the mean of its sensors."""
        return reconstruct_bodies(self, instrument, "acceleration")
