"""What the command line does, as functions on files; each returns the result, or what is to be printed.

Files are named by text or by a `Path`. Where several are asked for, one alone stands for a list of it.
"""

from crashkit.api.diagnosis import diagnose_files, diagnose_recordings, run_demo, workshop
from crashkit.api.files import load_model, load_recordings
from crashkit.api.identification import Identified, identify_files
from crashkit.api.recordings import check_files, cross_check_file, import_recording, list_channels, simulate_file
from crashkit.mechanics import simulate

__all__ = [
    "Identified",
    "check_files",
    "cross_check_file",
    "diagnose_files",
    "diagnose_recordings",
    "identify_files",
    "import_recording",
    "list_channels",
    "load_model",
    "load_recordings",
    "run_demo",
    "simulate",
    "simulate_file",
    "workshop",
]


def __dir__() -> list[str]:
    """What people see where they ask for completion."""
    return __all__
