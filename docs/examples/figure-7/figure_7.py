"""Figure 7 of Mizzi & Jezequel (1992): one noisy record, smoothed and differentiated by splines and by spectrum.

    python docs/examples/figure-7/figure_7.py

writes `figure_7.png` beside itself. It needs matplotlib.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from crashkit.registry import load

METHODS = ("gcv_cubic", "gcv_quintic", "adaptive_quintic", "spectral")
QUANTITIES = ("value", "first_derivative", "second_derivative")
LABELS = ("displacement error (mm)", "speed (m/s)", "acceleration (m/s²)")
LIMITS = ((-2.6, 2.6), (-2.0, 16.0), (-290.0, 90.0))
INK, BAND, TRUTH, SAMPLES = "#1f5fa8", "#a9c8ea", "#222222", "#b9b9b9"
MILLISECONDS = 1e3
SPEED, BEGIN, DURATION = 50.0 / 3.6, 0.02, 0.1  # m/s, s, s
NOISE, DRAW = 1e-3, 3  # m; a draw whose errors are near the median of every method


def motion(times: np.ndarray) -> np.ndarray:
    """A stop by half a sine of deceleration: position, speed and acceleration, (3, time)."""
    w = np.pi / DURATION
    during = np.clip(times - BEGIN, 0.0, DURATION)
    position = SPEED * np.minimum(times, BEGIN) + 0.5 * SPEED * (during + np.sin(w * during) / w)
    velocity = 0.5 * SPEED * (1.0 + np.cos(w * during))
    return np.stack([position, velocity, -0.5 * SPEED * w * np.sin(w * during)])


def film() -> xr.DataArray:
    """The position as film at 1 kHz shows it, m."""
    times = np.arange(200) / 1000.0
    noise = np.random.default_rng(DRAW).normal(scale=NOISE, size=len(times))
    return xr.DataArray(motion(times)[0] + noise, {"time": times}, ("time",), attrs={"units": "m"})


def panel(axis: Axes, samples: xr.DataArray, smooth: xr.Dataset, order: int) -> None:
    """A curve with its band of two standard deviations, and the truth; a displacement less its truth, with the samples."""
    time, truth = samples["time"].values, motion(samples["time"].values)
    origin, scale = (truth[0], 1e3) if order == 0 else (0.0, 1.0)
    curve = scale * (smooth[QUANTITIES[order]].values - origin)
    spread = 2.0 * scale * smooth[f"{QUANTITIES[order]}_std"].values
    exact = scale * (truth[order] - origin)
    if order == 0:
        axis.plot(MILLISECONDS * time, scale * (samples - origin), ".", color=SAMPLES, markersize=2)
    axis.fill_between(MILLISECONDS * time, curve - spread, curve + spread, color=BAND, linewidth=0.0)
    axis.plot(MILLISECONDS * time, exact, color=TRUTH, linewidth=0.8, linestyle="--")
    axis.plot(MILLISECONDS * time, curve, color=INK, linewidth=1.2)
    error = np.sqrt(np.mean((curve - exact) ** 2))
    height = 0.86 if order == 1 else 0.05
    axis.text(0.97, height, f"rms {error:.2g}", transform=axis.transAxes, ha="right", color=INK)


def draw(path: Path) -> None:
    """A column for each method: displacement, speed, acceleration."""
    samples = film()
    figure, panels = plt.subplots(3, len(METHODS), figsize=(10.5, 6.5), sharex=True, sharey="row", layout="constrained")
    for column, name in enumerate(METHODS):
        smooth = load().smoother(name)().smooth(samples)
        for order in range(3):
            panel(panels[order, column], samples, smooth, order)
        panels[0, column].set_title(name)
        panels[2, column].set_xlabel("time (ms)")
    for order, label in enumerate(LABELS):
        panels[order, 0].set(ylabel=label, ylim=LIMITS[order])
    figure.savefig(path, dpi=90)
    plt.close(figure)


if __name__ == "__main__":
    draw(Path(__file__).parent / "figure_7.png")
