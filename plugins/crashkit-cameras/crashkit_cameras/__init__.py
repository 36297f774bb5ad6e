"""Observers for film: markers followed by one or several cameras, their calibration, and a laboratory to try them in."""

from crashkit_cameras.calibration import calibrate
from crashkit_cameras.camera import Camera
from crashkit_cameras.film import Film
from crashkit_cameras.laboratory import Laboratory, make_laboratory
from crashkit_cameras.markers import film_group, triangulate
from crashkit_cameras.prior import Prior
from crashkit_cameras.result import Calibration

__all__ = ["Calibration", "Camera", "Film", "Laboratory", "Prior", "calibrate", "film_group", "make_laboratory", "triangulate"]
