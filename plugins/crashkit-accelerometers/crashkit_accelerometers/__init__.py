"""Observers for accelerometers and load cells: what they record, and what that tells of the motion of rigid bodies."""

from crashkit_accelerometers.accelerometer import Accelerometer
from crashkit_accelerometers.calibration import Calibration
from crashkit_accelerometers.layout import accelerometers
from crashkit_accelerometers.load_cell import LoadCell
from crashkit_accelerometers.recorded import recorded
from crashkit_accelerometers.rigid_body import rigid_body_motion
from crashkit_accelerometers.tumbling import tumbling

__all__ = ["Accelerometer", "Calibration", "LoadCell", "accelerometers", "recorded", "rigid_body_motion", "tumbling"]
