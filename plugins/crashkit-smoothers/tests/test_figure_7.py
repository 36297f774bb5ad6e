import runpy
from pathlib import Path

import numpy as np
import pytest

PROGRAM = Path(__file__).parents[3] / "docs" / "examples" / "figure-7" / "figure_7.py"


def test_the_program_draws_the_comparison(tmp_path: Path) -> None:
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    matplotlib.use("Agg")
    program = runpy.run_path(str(PROGRAM))
    times = np.linspace(0.0, 0.199, 20_000)
    position, velocity, acceleration = program["motion"](times)
    np.testing.assert_allclose(np.gradient(position, times)[1:-1], velocity[1:-1], atol=1e-4)
    np.testing.assert_allclose(np.gradient(velocity, times)[1:-1], acceleration[1:-1], atol=0.1)
    program["draw"](tmp_path / "figure_7.png")
    assert (tmp_path / "figure_7.png").stat().st_size > 10_000
