"""What changes where a car's structure is changed: one member removed, or stiffened (Mizzi & Jezequel 1992, introduction).

    python docs/examples/perturbation/perturbation.py

A model whose numbers are known, from identification or otherwise, is asked before anything is built. Each variant is the car
of figure 3 with one change; the table says how far it crushes, how hard its compartment is braked, and how far it yaws.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from crashkit.api import load_model
from crashkit.data.channel_filter import filter_channel
from crashkit.mechanics import simulate
from crashkit.model import Model
from crashkit.model.edit import without_joint
from crashkit.registry import load

CAR = Path(__file__).parents[1] / "figure-3" / "orthogonal.toml"
DURATION = 0.12
INTERVAL = 1e-4
STANDARD_GRAVITY = 9.80665


def variants(car: Model) -> dict[str, Model]:
    """The car as it is, and with one change each."""
    return {
        "as it is": car,
        "left rail removed": without_joint(car, "rail_left"),
        "right brace removed": without_joint(car, "brace_right"),
        "left rail 30 % stronger": scaled(car, {"joint.rail_left.crush_force": 1.3}),
        "both rails 30 % stronger": scaled(car, {f"joint.rail_{side}.crush_force": 1.3 for side in ("left", "right")}),
        "engine 30 kg lighter": car.with_values({"body.engine.mass": car.parameters()["body.engine.mass"].value - 30.0}),
    }


def scaled(model: Model, factors: Mapping[str, float]) -> Model:
    """The model with some parameters multiplied, by path."""
    known = model.parameters()
    return model.with_values({path: factor * known[path].value for path, factor in factors.items()})


def consequences(model: Model) -> dict[str, float]:
    """Crush (m), peak deceleration of the compartment (g, filtered by channel frequency class 60), and yaw (degrees)."""
    times = np.linspace(0.0, DURATION, 1 + round(DURATION / INTERVAL))
    motion = simulate(model, times, load().spring_laws).sel(body="compartment")
    along = motion["position"].sel(axis="x").values
    return {
        "crush": float(np.max(along - along[0])),
        "deceleration": float(np.max(-filtered(motion["acceleration"].sel(axis="x").values, times))) / STANDARD_GRAVITY,
        "yaw": yaw(motion["orientation"].isel(time=-1)),
    }


def filtered(acceleration: np.ndarray, times: np.ndarray) -> np.ndarray:
    """As a laboratory would report it: uniform motion before the impact, channel frequency class 60."""
    return filter_channel(acceleration, times, 60, before=0.0)


def yaw(orientation: xr.DataArray) -> float:
    """The angle about the vertical (degrees), to the left positive."""
    w, _, _, z = orientation.values
    return float(np.degrees(2.0 * np.arctan2(z, w)))


def main() -> None:
    """Print the table."""
    print(f"{'variant':28}{'crush':>10}{'peak':>10}{'yaw':>12}")
    for name, model in variants(load_model(CAR)).items():
        row = consequences(model)
        print(f"{name:28}{row['crush']:>8.3f} m{row['deceleration']:>8.1f} g{round(row['yaw'], 1) + 0.0:>8.1f} deg")


if __name__ == "__main__":
    main()
