"""What film and accelerometers can tell of the plane model of figure 3: four bodies, 14 springs."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from crashkit.api import load_model
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.registry import load

FOLDER = Path(__file__).parent.parent.parent / "docs" / "examples" / "figure-3"
TIMES = np.linspace(0.0, 0.08, 81)
ARM = 0.3
"""m, of both markers and both accelerometers of a body to either side of its centre of mass."""
STD = {"position": 2e-3, "acceleration": 10.0}
"""m, m s-2."""
GRADES = {"to 5 %": 0.05, "to 20 %": 0.2, "to 100 %": 1.0}
FILM = {"film": True, "accelerometer": False}
BOTH = {"film": True, "accelerometer": True}
TESTS: dict[str, tuple[tuple[str, ...], dict[str, bool]]] = {
    "orthogonal, film": (("orthogonal",), FILM),
    "orthogonal, film and accelerometers": (("orthogonal",), BOTH),
    "orthogonal, offset and oblique, film and accelerometers": (("orthogonal", "offset", "oblique"), BOTH),
}


def as_markdown() -> str:
    """How many of the laws' parameters each set of tests tells, by kind, at the Cramér-Rao bound."""
    blocks = []
    for test, (barriers, instruments) in TESTS.items():
        names, deviations = bounds(barriers, instruments)
        kinds = list(dict.fromkeys(name.rsplit(".", 1)[1] for name in names))
        head = ["of the 14 springs", *GRADES, "not"]
        rows = [_row(kind, [d for n, d in zip(names, deviations, strict=True) if n.endswith(f".{kind}")]) for kind in kinds]
        rows.append(_row("all", list(deviations)))
        blocks.append("\n".join([f"**{test}**", "", line(head), "|" + " --- |" * len(head), *rows]))
    return "\n\n".join(blocks)


def bounds(barriers: Sequence[str], instruments: dict[str, bool]) -> tuple[list[str], np.ndarray]:
    """The laws' parameters, and the smallest relative standard deviation that any unbiased method can have of each."""
    models = [load_model(FOLDER / f"{barrier}.toml") for barrier in barriers]
    names = [path for path in models[0].free_parameters() if path.startswith("joint.") and _is_of_all(path, models)]
    information = np.zeros((len(names), len(names)))
    for model in models:
        misfit = misfit_of(model, instruments)
        columns = [misfit.names.index(name) for name in names]
        jacobian = misfit.residual_and_jacobian(misfit.start())[1][:, columns]
        share = np.abs(misfit.parameters(misfit.start()) / misfit.scaling(misfit.start()))[columns]
        information += (jacobian * share).T @ (jacobian * share)
    return names, relative_bounds(information)


def relative_bounds(information: np.ndarray) -> np.ndarray:
    """The smallest relative deviations; beforehand nothing is known of a value but its size, a deviation of ten times it."""
    return np.asarray(np.sqrt(np.diag(np.linalg.inv(information + 0.01 * np.eye(len(information))))))


def _is_of_all(path: str, models: Sequence[Model]) -> bool:
    return all(path in model.free_parameters() and model.parameters()[path].value != 0.0 for model in models)


def _row(kind: str, deviations: Sequence[float]) -> str:
    least, counts = 0.0, []
    for most in (*GRADES.values(), np.inf):
        counts.append(sum(least <= deviation < most for deviation in deviations))
        least = most
    return line([kind.replace("_", " "), *map(str, counts)])


def line(cells: Sequence[str]) -> str:
    """A line of a table."""
    return "| " + " | ".join(cells) + " |"


def misfit_of(model: Model, instruments: dict[str, bool]) -> Misfit:
    """The model with instruments that read nothing yet: only their derivatives are asked for."""
    registry = load()
    film = _instrument(model, "position", "marker", "m", {"observer": "film"})
    meters = {"observer": "accelerometer", "channel_frequency_class": 0, "frame": "body"}
    groups = {"film": film, "accelerometer": _instrument(model, "acceleration", "sensor", "m s-2", meters)}
    root = xr.Dataset(attrs={"crashkit_schema": "recording/1", "title": model.name})
    tree = xr.DataTree.from_dict({"/": root} | {name: group for name, group in groups.items() if instruments[name]})
    return Misfit(model, {"run": tree}, registry.spring_laws, registry.observers)


def _instrument(model: Model, quantity: str, channel: str, units: str, attributes: dict[str, object]) -> xr.Dataset:
    places = [(body.name, side) for body in model.bodies if not body.fixed for side in (-ARM, ARM)]
    names = [f"{body}_{'right' if side < 0.0 else 'left'}" for body, side in places]
    return xr.Dataset(
        {
            quantity: (("time", channel, "axis"), np.zeros((len(TIMES), len(places), 2)), {"units": units}),
            f"{channel}_body": (channel, [body for body, _ in places]),
            f"{channel}_point": ((channel, "axis"), [[0.0, side] for _, side in places], {"units": "m"}),
            f"{quantity}_std": (channel, np.full(len(places), STD[quantity]), {"units": units}),
        },
        coords={"time": ("time", TIMES, {"units": "s"}), channel: names, "axis": ["x", "y"]},
        attrs=attributes,
    )
