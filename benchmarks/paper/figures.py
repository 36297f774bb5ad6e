"""Figures 9, 11, 12, 13, 15 and 16 of the paper, drawn anew."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes

from benchmarks.identification import searched
from benchmarks.paper.cases import CASES, Case, predicted, problem_of, start_of, truth_of
from benchmarks.paper.tables import PATIENCE
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.registry import load
from crashkit.testing import toys
from crashkit_identifiers.chebyshev import Chebyshev
from crashkit_identifiers.force_surface import Surface

SPEEDS = (0.7, 0.9, 1.1, 1.3)
"""Of the four runs of the non-parametric method."""
SETS = {"8 x 8 degrees, scattered": ("scattered", 8), "2 x 2 degrees, scattered": ("scattered", 2), "direct": ("direct", 12)}
STARTED, FOUND, WANTED = (
    {"color": "tab:blue", "lw": 1.2, "ls": ":", "label": "start"},
    {"color": "tab:red", "lw": 1.2, "ls": "--", "label": "identified"},
    {"color": "silver", "lw": 4.0, "label": "reference"},
)
TIME = toys.TIMES * toys.SPEED
"""In the paper's unit."""


def draw(folder: Path) -> None:
    """All of them, as PNG."""
    _figure_9().savefig(folder / "figure_9.png", dpi=90)
    one, two = CASES[0], CASES[6]
    _curves(one, {"integral_filter": "integral filter"}, (1.0, 1.5)).savefig(folder / "figure_11.png", dpi=90)
    _curves(one, {"sensitivity": "sensitivity"}, (1.0, 1.5)).savefig(folder / "figure_12.png", dpi=90)
    _curves(one, {"optimal_control": "optimal control"}, (1.0, 1.5)).savefig(folder / "figure_13.png", dpi=90)
    _curves(two, {"integral_filter": "integral filter"}, (1.0, 2.0)).savefig(folder / "figure_15.png", dpi=90)
    methods = ("sensitivity", "optimal_control", "substructuring", "multi_start")
    _curves(two, {name: name.replace("_", " ") for name in methods}, (2.0,)).savefig(folder / "figure_16.png", dpi=90)
    plt.close("all")


def _figure_9() -> plt.Figure:
    """Force over deformation at speed 0.9, by three surfaces and as it is."""
    registry, truth = load(), toys.one_degree()
    misfit = toys.problem(truth, truth, registry.spring_laws, registry.observers, SPEEDS, exact=True)
    figure, axes = plt.subplots(1, len(SETS), figsize=(10, 3.5), sharey=True, layout="constrained")
    motion = misfit.predictor.motion("speed_0.9", misfit.values(misfit.start()))
    deformation, rate, force = (motion[name].values[:, 0] for name in ("deformation", "deformation_rate", "force"))
    pressed = deformation > 0.0
    for panel, (title, (form, degree)) in zip(axes, SETS.items(), strict=True):
        surface: Surface = Chebyshev(form=form, degree=degree).start(misfit).surfaces["first"]
        shown = surface.force(deformation, rate)
        panel.plot(deformation[pressed], force[pressed] / toys.STIFFNESS, **WANTED)
        panel.plot(deformation[pressed], shown[pressed] / toys.STIFFNESS, **FOUND)
        panel.set(title=title, xlabel="deformation")
        panel.grid(alpha=0.3)
    axes[0].set_ylabel("force")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    return figure


def _curves(case: Case, methods: dict[str, str], speeds: Sequence[float]) -> plt.Figure:
    """Accelerations by the start, as identified at speed 1, and by the reference, at several speeds."""
    truth, start = truth_of(case), start_of(case)
    columns = [(name, speed) for name in methods for speed in speeds]
    rows = 1 if case.is_single else 2
    figure, axes = plt.subplots(
        rows, len(columns), figsize=(3.6 * len(columns), 2.6 * rows + 0.3), squeeze=False, layout="constrained"
    )
    found = {name: _found(problem_of(case), truth, name) for name in methods}
    for column, (name, speed) in enumerate(columns):
        curves = [predicted(model, speed) for model in (start, truth, found[name])]
        for row in range(rows):
            _panel(axes[row, column], [curve[:, row] for curve in curves])
        axes[0, column].set_title(f"{methods[name]}, speed {speed:g} ({'fitted' if speed == 1.0 else 'predicted'})")
        axes[-1, column].set_xlabel("time")
    for row in range(rows):
        axes[row, 0].set_ylabel("acceleration" if case.is_single else f"acceleration of body {row + 1}")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False)
    return figure


def _panel(axes: Axes, curves: Sequence[np.ndarray]) -> None:
    for curve, style in zip(curves, (STARTED, WANTED, FOUND), strict=True):
        axes.plot(TIME, curve, **style)
    axes.grid(alpha=0.3)


def _found(misfit: Misfit, truth: Model, method: str) -> Model:
    values = searched(load().identifier(method)(), misfit, PATIENCE)
    return truth.with_values(dict(zip(misfit.names, values.tolist(), strict=True)))
