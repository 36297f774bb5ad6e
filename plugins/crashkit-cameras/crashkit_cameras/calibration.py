"""The result of a calibration, with its quality, as an object and as a Dataset."""

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit_cameras.control import Control
from crashkit_cameras.dlt import COEFFICIENTS, coefficient_derivatives, coefficients_of
from crashkit_cameras.projection import PARAMETERS, Cameras

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


