"""Film that has been reconstructed: the positions of markers in the laboratory frame."""

import numpy as np
import xarray as xr

from crashkit.data.instrument_errors import CLOCK, CLOCK_ERRORS, ROCKING, error_values, prediction_coordinates, true_times
from crashkit.data.schema import GroupSchema, Variable
from crashkit.data.schemas import body_of, point_of, std_of
from crashkit.protocols import ParameterSpec, PlainObserver, Reading, SensorErrors
from crashkit_cameras.body_motion import body_motion
from crashkit_cameras.marker_motion import marker_motion
from crashkit_cameras.rocking import Rocking

DIMS = ("time", "marker", "axis")


class Film(PlainObserver):
    """Markers on bodies, which may turn.

    z(t) = y_0 + gain (y(t (1 - clock_rate) - clock_offset) - y_0) + bias, with y = x + R p the place of the point p of a body
    at x, turned by R, and y_0 where it is at the motion's start; y + share w on a body that rocks, see `Rocking`.
    """

    name = "film"
    schema = GroupSchema(
        "film",
        (
            Variable("position", DIMS, "m", "a marker's position in the laboratory frame", allow_nan=True),
            body_of("marker"),
            point_of("marker"),
            std_of("position", "marker", "m"),
        ),
    )
    quantity = "position"
    channel = "marker"
    errors = (
        ParameterSpec("gain", "1", "recorded displacement per displacement", 0.2, 5.0, default=1.0, null=1.0),
        ParameterSpec("bias", "m", "offset of the recorded position", default=0.0, null=0.0),
        *CLOCK,
        *ROCKING,
    )
    instrument_errors = CLOCK_ERRORS

    def predict(self, motion: xr.Dataset, instrument: xr.Dataset, errors: SensorErrors | None = None) -> xr.Dataset:
        """The markers' positions, as `Observer.predict` says."""
        axes = instrument.variables["axis"].values.tolist()
        own = error_values(self, instrument.variables["marker"].values.tolist(), axes, errors)
        gain, bias = own["gain"], own["bias"]
        stamps = instrument.variables["time"].values
        at = true_times(stamps, own)
        points = instrument.variables["marker_point"].values
        seen = marker_motion(self, motion, instrument.variables["marker_body"].values.tolist(), points, axes, at)

        share, rocking = own["rocking_share"], Rocking(seen, at, own["rocking_frequency"], own["rocking_damping"])
        displacement, velocity = seen.position - seen.start, seen.velocity
        aside = rocking.displacement()
        by_shape = (np.zeros_like(aside),) * 2
        if share.any():
            displacement, velocity = displacement + share * aside, velocity + share * rocking.rate()
            by_shape = rocking.derivatives()
        late = -gain * velocity, -gain * velocity * stamps[:, None, None]
        slopes = (displacement, np.ones_like(aside), *late, gain * aside, *(gain * share * one for one in by_shape))
        predicted = {
            "position": xr.Variable(DIMS, seen.start + gain * displacement + bias, {"units": "m"}),
            "position_error_sensitivity": xr.Variable((*DIMS, "error"), np.stack(slopes, axis=-1)),
        }
        if seen.slope is not None and seen.start_slope is not None and seen.start_velocity_slope is not None:
            slope = seen.slope - seen.start_slope
            if share.any():
                slope = slope + share[..., None] * rocking.linear(slope - at[:, None, None, None] * seen.start_velocity_slope)
            predicted["position_sensitivity"] = xr.Variable((*DIMS, "parameter"), seen.start_slope + gain[..., None] * slope)
        return xr.Dataset(predicted, prediction_coordinates(self, motion, instrument))

    def reading(self, instrument: xr.Dataset, turning: bool) -> Reading | None:
        """The positions of the bodies, shifted by the markers' points; None for markers that turn about their bodies."""
        points = instrument.variables["marker_point"].values
        if turning and points.any():
            return None
        axes = instrument.variables["axis"].values.tolist()
        bodies = [body for body in instrument.variables["marker_body"].values.tolist() for _ in axes]
        return Reading("position", tuple(bodies), tuple(axes) * len(points), points.ravel())

    def reconstruct(self, instrument: xr.Dataset) -> xr.Dataset:
        """The bodies' positions and orientations, as `body_motion` says, from the markers that are visible.

        Markers count by their `position_std` if it is known, else all alike.
        """
        positions = instrument["position"].transpose(*DIMS).values.astype(float)
        covariance = None
        if "position_std" in instrument and np.isfinite(instrument["position_std"]).all():
            variance = instrument["position_std"].values[:, None, None] ** 2 * np.eye(positions.shape[2])
            covariance = np.broadcast_to(variance, (len(positions), *variance.shape))
        return body_motion(instrument, positions, covariance, np.zeros((*positions.shape, 0)))
