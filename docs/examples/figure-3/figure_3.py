"""Figure 3 of Mizzi & Jezequel (1992): displacements, speeds and accelerations of the four bodies, and how the car yaws.

    python docs/examples/figure-3/figure_3.py

writes `figure_3.png` and `yaw.png` beside the models. It needs matplotlib.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

from crashkit.api import load_model
from crashkit.mechanics import simulate
from crashkit.registry import load

FOLDER = Path(__file__).parent
BODIES = ("compartment", "engine", "subframe", "crossmember")
STYLES = ("-", "--", "-.", ":")
BARRIERS = ("orthogonal", "oblique", "offset")
MILLISECONDS = 1e3
STANDARD_GRAVITY = 9.80665


def motion_of(barrier: str, duration: float = 0.08) -> xr.Dataset:
    """The motion of the car against one of the barriers, every 0.1 ms."""
    times = np.linspace(0.0, duration, 1 + round(duration / 1e-4))
    return simulate(load_model(FOLDER / f"{barrier}.toml"), times, load().spring_laws)


def curves(motion: xr.Dataset) -> dict[str, xr.DataArray]:
    """What the paper plots, along x: displacement (cm), speed (m/s), and deceleration (g)."""
    along = motion.sel(axis="x", body=list(BODIES))
    return {
        "displacement (cm)": 100.0 * (along["position"] - along["position"].isel(time=0)),
        "speed (m/s)": along["velocity"],
        "deceleration (g)": -along["acceleration"] / STANDARD_GRAVITY,
    }


def yaw(motion: xr.Dataset, body: str = "compartment") -> np.ndarray:
    """The angle about the vertical by which a body has turned (degrees), to the left positive."""
    w, _, _, z = motion["orientation"].sel(body=body).transpose("quaternion", "time").values
    return np.degrees(2.0 * np.arctan2(z, w))


def draw_curves(path: Path) -> None:
    """The three panels of figure 3."""
    figure, panels = plt.subplots(3, 1, figsize=(7.0, 9.0), sharex=True, layout="constrained")
    for panel, (label, values) in zip(panels, curves(motion_of("orthogonal")).items(), strict=True):
        for body, style in zip(BODIES, STYLES, strict=True):
            panel.plot(MILLISECONDS * values["time"], values.sel(body=body), style, label=body)
        panel.set_ylabel(label)
        panel.grid(alpha=0.3)
    panels[0].legend(loc="upper left")
    panels[-1].set_xlabel("time (ms)")
    figure.savefig(path, dpi=110)


def draw_yaw(path: Path) -> None:
    """How far the compartment turns against each barrier."""
    figure, panel = plt.subplots(figsize=(7.0, 3.5), layout="constrained")
    for barrier, style in zip(BARRIERS, STYLES, strict=False):
        motion = motion_of(barrier, 0.12)
        panel.plot(MILLISECONDS * motion["time"], yaw(motion), style, label=barrier)
    panel.set_xlabel("time (ms)")
    panel.set_ylabel("yaw of the compartment (degrees)")
    panel.grid(alpha=0.3)
    panel.legend()
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    draw_curves(FOLDER / "figure_3.png")
    draw_yaw(FOLDER / "yaw.png")
