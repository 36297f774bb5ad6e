"""The real frontal crash again, with the wall in two parts: where the load meets it, and what that adds.

The lower part is the four lowest rows of cells, which the rails, the bumper and the engine meet; the upper part the seven rows
above. The engine's own accelerometers are opened only to compare. Recordings as for `real_crash`.
"""

import tempfile
from pathlib import Path
from time import perf_counter

from benchmarks import Row
from benchmarks.real_crash import GIVEN, SEEN, diagnosed, engine_rows, fit_rows, mass_rows

PARTS = ["-107..296=wall_lower:lower", "-299..632=wall_upper:upper"]
SECONDS = 300.0
"""After which no further cause is asked for."""


def run() -> list[Row]:
    """The residual of each channel, the load's mass, and its predicted motion against the engine's sensors."""
    start = perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        answer = diagnosed(Path(folder), GIVEN.with_name("rows.toml"), [*SEEN[:1], *PARTS], SECONDS)
    elapsed = perf_counter() - start
    return [*fit_rows(answer), *mass_rows(answer), *engine_rows(answer), Row("diagnosis", "time", "s", elapsed, "", None)]
