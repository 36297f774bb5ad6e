"""The result of a calibration and its quality, as an object, as a Dataset, and in words."""

from collections.abc import Iterator

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit_cameras.control import AXES, Control
from crashkit_cameras.dlt import COEFFICIENTS, coefficient_derivatives, coefficients_of
from crashkit_cameras.projection import PARAMETERS, Cameras

IMAGE_AXES = ["u", "v"]
NOISY, NEARLY_FLAT, NARROW, UNSYNCHRONISED = 1.0, 100.0, 0.05, 3.0
"""From where notes warn: noise (pixel), condition, coverage (1), noise of markers over that of control points (1)."""


@frozen(eq=False)
class Calibration:
    """Calibrated cameras and what is known of their quality.

    Attributes:
        control: the control points.
        cameras: of V views.
        covariance: of the cameras' steps (`Cameras.moved`), (16 V, 16 V).
        control_std, marker_std: of a reading in the image, (view,), pixel.
        residual: of the control points, recorded - predicted, (view, control_point, 2), pixel, NaN where hidden.
        rejected: control points whose reading is a blunder, (view, control_point).
        condition: of the linear equations, (view,).
        from_readings: how much of each of k1, k2, k3, p1, p2 the readings determine (1) rather than what lenses are like (0),
            (view, 5).
        coverage: the share of each image that the control points span, (view,).
        markers: how many marker positions took part.
        contradiction: whether the markers contradict the control points, and were left out for it.
    """

    control: Control
    cameras: Cameras
    covariance: np.ndarray
    control_std: np.ndarray
    marker_std: np.ndarray
    residual: np.ndarray
    rejected: np.ndarray
    condition: np.ndarray
    from_readings: np.ndarray
    coverage: np.ndarray
    markers: int
    contradiction: bool

    @property
    def notes(self) -> tuple[str, ...]:
        """What a user should look at before trusting the cameras, as sentences; empty where nothing is amiss."""
        return tuple(self._notes())

    def dataset(self) -> xr.Dataset:
        """Coefficients with their covariance, the cameras that they amount to, and the measures of quality.

        Returns:
            Dataset over `view`. `coefficient_value` (view, coefficient) are L1 to L11 of the direct linear transformation,
            then the distortion k1, k2, k3, p1, p2, in units of the focal length; `coefficient_std`, `coefficient_covariance`.
            `camera_position`, `focal_length`, `pixel_aspect`, `skew`, `principal_point`: the cameras.
            `control_residual`, `control_rejected`, `control_std`, `marker_std`, `condition`, `image_coverage`, and
            `distortion_terms`: how many of the five the readings determine. The attribute `notes` holds the notes.
        """
        cameras, std = self.cameras, self.numbers_std()
        by_view = {
            "camera_position": (("view", "axis"), cameras.position, "m"),
            "camera_position_std": (("view", "axis"), std[:, 3:6], "m"),
            "focal_length": ("view", cameras.focal, "pixel"),
            "focal_length_std": ("view", cameras.focal * std[:, 6], "pixel"),
            "principal_point": (("view", "image_axis"), cameras.centre, "pixel"),
            "principal_point_std": (("view", "image_axis"), std[:, 9:11], "pixel"),
            "pixel_aspect": ("view", cameras.aspect, "1"),
            "skew": ("view", cameras.skew, "1"),
            "control_residual": (("view", "control_point", "image_axis"), self.residual, "pixel"),
            "control_std": ("view", self.control_std, "pixel"),
            "marker_std": ("view", self.marker_std, "pixel"),
            "condition": ("view", self.condition, "1"),
            "image_coverage": ("view", self.coverage, "1"),
            "distortion_terms": ("view", self.from_readings.sum(axis=1), "1"),
        }
        variables = {name: xr.Variable(dims, values, {"units": units}) for name, (dims, values, units) in by_view.items()}
        variables["control_rejected"] = xr.Variable(("view", "control_point"), self.rejected)
        coordinates = {
            "view": list(self.control.views),
            "coefficient": list(COEFFICIENTS),
            "image_axis": IMAGE_AXES,
            "axis": AXES,
            "control_point": list(self.control.names),
        }
        return xr.Dataset(variables | self._coefficients(), coordinates, {"notes": "; ".join(self.notes)})

    def numbers_std(self) -> np.ndarray:
        """Standard deviations of the steps of `Cameras.moved`, (view, 16)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)).reshape(-1, PARAMETERS))

    def _coefficients(self) -> dict[str, xr.Variable]:
        slope = coefficient_derivatives(self.cameras)
        blocks = self.covariance.reshape(len(slope), PARAMETERS, len(slope), PARAMETERS)
        own = blocks[range(len(slope)), :, range(len(slope))]
        covariance = slope @ own @ slope.transpose(0, 2, 1)
        std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
        return {
            "coefficient_value": xr.Variable(("view", "coefficient"), coefficients_of(self.cameras)),
            "coefficient_std": xr.Variable(("view", "coefficient"), std),
            "coefficient_covariance": xr.Variable(("view", "coefficient", "coefficient_2"), covariance),
        }

    def _notes(self) -> Iterator[str]:
        for index, view in enumerate(self.control.views):
            for point in np.flatnonzero(self.rejected[index]):
                off = np.linalg.norm(self.residual[index, point])
                name = self.control.names[point]
                yield f'view "{view}": control point {name} is off by {off:.2g} pixel and counts for little'
            if self.control_std[index] > NOISY:
                yield f'view "{view}": the control points fit to {self.control_std[index]:.2g} pixel only'
            if self.condition[index] > NEARLY_FLAT:
                yield f'view "{view}": the control points lie nearly in a plane (condition {self.condition[index]:.0f})'
            if self.coverage[index] < NARROW:
                yield f'view "{view}": the control points span {self.coverage[index]:.0%} of the image'
        multiple = float(np.max(self.marker_std / self.control_std))
        if self.contradiction:
            yield "the markers contradict the control points and were left out: are the views synchronised?"
        elif multiple > UNSYNCHRONISED and self.marker_std.max() > NOISY:
            yield f"the markers are {multiple:.2g} times as noisy as the control points: are the views synchronised?"
