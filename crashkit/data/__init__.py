"""The data contract: schemas, one error that lists every fault, recordings and motions on disk."""

from crashkit.data.motion import read_motion, write_motion
from crashkit.data.recording import check_recording, instruments, read_recording, unknown_observers, write_recording
from crashkit.data.schema import Attribute, Dimension, GroupSchema, Variable
from crashkit.data.schemas import DIMENSIONS, INITIAL, MOTION, RECORDING
from crashkit.data.validate import check, faults_of

__all__ = [
    "DIMENSIONS",
    "INITIAL",
    "MOTION",
    "RECORDING",
    "Attribute",
    "Dimension",
    "GroupSchema",
    "Variable",
    "check",
    "check_recording",
    "faults_of",
    "instruments",
    "read_motion",
    "read_recording",
    "unknown_observers",
    "write_motion",
    "write_recording",
]
