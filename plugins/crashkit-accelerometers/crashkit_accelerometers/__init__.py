"""Observers for accelerometers and load cells."""

from crashkit_accelerometers.accelerometer import Accelerometer
from crashkit_accelerometers.load_cell import LoadCell

__all__ = ["Accelerometer", "LoadCell"]
