"""When instruments that have clocks of their own saw what they saw."""

from crashkit_cameras.synchronise.acceleration import synchronise_with_accelerometer
from crashkit_cameras.synchronise.clocks import corrected_time, synchronised
from crashkit_cameras.synchronise.diodes import synchronise_by_diode
from crashkit_cameras.synchronise.resample import resampled
from crashkit_cameras.synchronise.views import synchronise_views

__all__ = [
    "corrected_time",
    "resampled",
    "synchronise_by_diode",
    "synchronise_views",
    "synchronise_with_accelerometer",
    "synchronised",
]
