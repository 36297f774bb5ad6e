"""Film that has been reconstructed: the positions of markers in the laboratory frame."""

import numpy as np
import xarray as xr

from crashkit.data.schema import GroupSchema, Variable
from crashkit.protocols import Observer, ParameterSpec, SensorErrors
from crashkit_cameras.marker_motion import error_values, sample_path, selection

MARKER_BODY = Variable("marker_body", ("marker",), None, "the body that carries the marker", kind="text")
MARKER_POINT = Variable(
    "marker_point", ("marker", "axis"), "m", "the marker's place in the body's frame, from the centre of mass"
)

DIMS = ("time", "marker", "axis")


class Film(Observer):
    """Markers on bodies that do not turn.

    z(t) = x_0 + gain (x(t - clock_offset) - x_0) + bias, x the body's position plus the marker's point and x_0 its first.
    """

    name = "film"
    schema = GroupSchema(
        "film",
        (
            Variable("position", DIMS, "m", "a marker's position in the laboratory frame", allow_nan=True),
            MARKER_BODY,
            MARKER_POINT,
            Variable("position_std", ("marker",), "m", "standard deviation of a reading", required=False),
        ),
    )
    quantity = "position"
    channel = "marker"
    errors = (
        ParameterSpec("gain", "1", "recorded displacement per displacement", 0.2, 5.0, default=1.0, null=1.0),
        ParameterSpec("bias", "m", "offset of the recorded position", default=0.0, null=0.0),
        ParameterSpec("clock_offset", "s", "how late the time stamps are", -0.05, 0.05, default=0.0, null=0.0),
    )
    instrument_errors = ("clock_offset",)

    def predict(self, motion: xr.Dataset, instrument: xr.Dataset, errors: SensorErrors | None = None) -> xr.Dataset:
        """The markers' positions, as `Observer.predict` says."""
        own = error_values(self, instrument.variables["marker"].values.tolist(), errors)
        gain, bias = own["gain"][:, None], own["bias"][:, None]
        nodes = motion.variables["time"].values
        at = instrument.variables["time"].values - own["clock_offset"][0]
        at_markers = selection(motion, instrument)

        path = at_markers("position")
        start = path[0]
        path, rate = sample_path(nodes, path, at_markers("velocity"), at)
        displacement = path - start
        position = start + instrument.variables["marker_point"].values + gain * displacement + bias
        derivatives = np.stack([displacement, np.ones_like(path), -gain * rate], axis=-1)
        predicted = {
            "position": xr.Variable(DIMS, position, {"units": "m"}),
            "position_error_sensitivity": xr.Variable((*DIMS, "error"), derivatives),
        }
        if "position_sensitivity" in motion.variables:
            path = at_markers("position_sensitivity")
            start = path[0]
            path, _ = sample_path(nodes, path, at_markers("velocity_sensitivity"), at)
            sensitivity = start + gain[..., None] * (path - start)
            predicted["position_sensitivity"] = xr.Variable((*DIMS, "parameter"), sensitivity)
        return xr.Dataset(predicted, self._coordinates(motion, instrument))

    def reconstruct(self, instrument: xr.Dataset) -> xr.Dataset:
        """The bodies' positions, each the mean over its visible markers, and their standard deviations if they are known.

        Returns:
            position (time, body, axis), NaN while all markers of a body are hidden; position_std (body) with all visible.
        """
        carriers = instrument["marker_body"].values
        bodies = list(dict.fromkeys(carriers.tolist()))
        centres = instrument["position"].transpose(*DIMS).values - instrument["marker_point"].values
        means = np.stack([_mean(centres[:, carriers == body]) for body in bodies], axis=1)
        variables = {"position": xr.Variable(("time", "body", "axis"), means, {"units": "m"})}
        if "position_std" in instrument:
            variance = instrument["position_std"].values ** 2
            stds = [np.sqrt(variance[carriers == body].sum()) / (carriers == body).sum() for body in bodies]
            variables["position_std"] = xr.Variable("body", stds, {"units": "m"})
        return xr.Dataset(variables, {"time": instrument["time"], "body": bodies, "axis": instrument["axis"]})

    def _coordinates(self, motion: xr.Dataset, instrument: xr.Dataset) -> xr.Coordinates:
        """The coordinates of a prediction, without indexes: building those takes longer than predicting."""
        variables = {"error": xr.Variable("error", [spec.name for spec in self.errors])}
        for source, dims in ((instrument, DIMS), (motion, ("parameter",))):
            variables |= {dim: source.variables[dim] for dim in dims if dim in source.variables}
        return xr.Coordinates(variables, indexes={})


def _mean(positions: np.ndarray) -> np.ndarray:
    """The mean over markers (dim 1) that are visible, NaN where none is."""
    visible = np.isfinite(positions)
    count = visible.sum(axis=1)
    return np.where(count > 0, np.where(visible, positions, 0.0).sum(axis=1) / np.maximum(count, 1), np.nan)
