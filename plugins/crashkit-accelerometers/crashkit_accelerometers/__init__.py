"""Observers for accelerometers and load cells: what they record, and what that tells of the motion of rigid bodies."""

from crashkit_accelerometers.accelerometer import Accelerometer
from crashkit_accelerometers.calibration import Calibration
from crashkit_accelerometers.load_cell import LoadCell
from crashkit_accelerometers.recorded import recorded
from crashkit_accelerometers.rigid_body import rigid_body_motion

__all__ = ["Accelerometer", "Calibration", "LoadCell", "recorded", "rigid_body_motion"]
