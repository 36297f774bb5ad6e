"""Film that has been reconstructed: the positions of markers in the laboratory frame."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from crashkit.data.instrument_errors import (
    CLOCK,
    CLOCK_ERRORS,
    ROCKING,
    coordinates,
    error_values,
    prediction_coordinates,
    true_times,
)
from crashkit.data.schema import GroupSchema, Variable
from crashkit.data.schemas import body_of, point_of, std_of
from crashkit.protocols import Misread, ParameterSpec, PlainObserver, Reading, SensorErrors, Shown, TurningReading
from crashkit_cameras.body_motion import body_motion
from crashkit_cameras.marker_motion import MarkerMotion, marker_motion, shown_motion
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
            Variable("position", DIMS, "m", "a marker's position in the laboratory frame", allow_nan=True, allow_silent=True),
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
        stamps, markers, axes = coordinates(instrument, DIMS)
        own = error_values(self, markers.tolist(), axes.tolist(), errors)
        at = true_times(stamps, own)
        points = instrument.variables["marker_point"].values
        seen = marker_motion(self, motion, instrument.variables["marker_body"].values.tolist(), points, axes.tolist(), at)
        read = _recorded(seen, stamps, at, own, [spec.name for spec in self.errors])
        predicted = {
            "position": xr.Variable(DIMS, read.value, {"units": "m"}),
            "position_error_sensitivity": xr.Variable((*DIMS, "error"), read.by_error),
        }
        if read.slope is not None:
            predicted["position_sensitivity"] = xr.Variable((*DIMS, "parameter"), read.slope)
        return xr.Dataset(predicted, prediction_coordinates(self, motion, instrument))

    def reading(self, instrument: xr.Dataset, turning: bool) -> Reading | TurningReading:
        """The positions of the bodies, shifted by the markers' points, which may turn with them."""
        points = instrument.variables["marker_point"].values
        axes = tuple(instrument.variables["axis"].values.tolist())
        bodies = tuple(body for body in instrument.variables["marker_body"].values.tolist() for _ in axes)
        if turning and points.any():
            return TurningReading("position", bodies, axes * len(points), axes, points.repeat(len(axes), axis=0))
        return Reading("position", bodies, axes * len(points), points.ravel())

    def misread(self, shown: Shown, instrument: xr.Dataset, errors: SensorErrors, wanted: Sequence[str]) -> Misread:
        """As `PlainObserver.misread` says."""
        stamps, markers, axes = coordinates(instrument, DIMS)
        own = error_values(self, markers.tolist(), axes.tolist(), errors)
        at = true_times(stamps, own)
        return _recorded(shown_motion(shown, len(axes), at), stamps, at, own, wanted)

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


def _recorded(
    seen: MarkerMotion, stamps: np.ndarray, at: np.ndarray, own: Mapping[str, np.ndarray], wanted: Sequence[str]
) -> Misread:
    """What a film with errors shows of markers that it saw at `at` and stamped with `stamps`, s, (time,)."""
    gain, share = own["gain"], own["rocking_share"]
    displacement, velocity = seen.position - seen.start, seen.velocity
    slope = None if seen.slope is None else seen.slope - seen.start_slope
    slopes: dict[str, np.ndarray] = {}
    if share.any() or "rocking_share" in wanted:
        rocking = Rocking(seen, at, own["rocking_frequency"], own["rocking_damping"])
        aside = rocking.displacement()
        slopes["rocking_share"] = gain * aside
    if share.any():
        displacement, velocity = displacement + share * aside, velocity + share * rocking.rate()
        if "rocking_frequency" in wanted or "rocking_damping" in wanted:
            by_shape = rocking.derivatives()
            slopes |= zip(("rocking_frequency", "rocking_damping"), (gain * share * one for one in by_shape), strict=True)
        if slope is not None:
            slope = slope + share[..., None] * rocking.linear(slope - at[:, None, None, None] * seen.start_velocity_slope)
    late = -gain * velocity
    slopes |= {"gain": displacement, "clock_offset": late}
    if "clock_rate" in wanted:
        slopes["clock_rate"] = late * stamps[:, None, None]
    by_error = np.zeros((*late.shape, len(wanted)))
    for index, name in enumerate(wanted):
        by_error[..., index] = 1.0 if name == "bias" else slopes.get(name, 0.0)
    return Misread(
        seen.start + gain * displacement + own["bias"],
        None if slope is None else seen.start_slope + gain[..., None] * slope,
        by_error,
    )
