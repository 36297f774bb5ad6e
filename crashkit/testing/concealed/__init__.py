"""Cases with concealed physics, for a demonstration and for blind trials; shares no code with the engine."""

from crashkit.testing.concealed.case import PHYSICS, SIZES, Case, make_case, open_seal, write_case

__all__ = ["PHYSICS", "SIZES", "Case", "make_case", "open_seal", "write_case"]
