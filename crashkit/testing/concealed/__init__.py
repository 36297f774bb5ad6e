"""Cases with concealed physics: a vehicle, its tests and its secret, from a world that shares nothing with the engine.

`make_case` draws a vehicle, conceals effects in it at a chosen size and records its tests; `write_case` writes what a
diagnosis may see, `write_answer` what it must find.
"""

from crashkit.testing.concealed.answer import read_answer, write_answer
from crashkit.testing.concealed.case import Case, make_case, write_case
from crashkit.testing.concealed.draft import EFFECTS
from crashkit.testing.concealed.size import HIDDEN, SIZES

__all__ = ["EFFECTS", "HIDDEN", "SIZES", "Case", "make_case", "read_answer", "write_answer", "write_case"]
