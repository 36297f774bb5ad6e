"""Displacement from film and from accelerometers in one figure, and their difference."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from plotly.offline import get_plotlyjs

from crashkit.misfit.bands import CONFIDENCE
from crashkit.report.files import write_text
from crashkit.report.page import rows, template
from crashkit.report.words import unit

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

FILM, ACCELEROMETER = "#0072b2", "#d55e00"


def write_cross_check(check: xr.Dataset, run: str, directory: Path) -> Path:
    """Write `directory`/index.html with the verdicts and Figure 6, and what it needs, and return the page's path.

    Arguments:
        check: as `crashkit.misfit.cross_check` returns it.
        run: the recording's name.
    """
    figure = cross_check_figure(check).update_layout(title=None, margin_t=40)
    page = template("cross_check.html").render(
        run=run,
        agree=bool(check["consistent"].all()),
        bodies=rows(check, "body"),
        figure=figure.to_html(full_html=False, include_plotlyjs=False, config={"displayModeBar": False}),
    )
    write_text(directory / "plotly.min.js", get_plotlyjs())
    return write_text(directory / "index.html", page)


def cross_check_figure(check: xr.Dataset) -> "Figure":
    """Figure 6: for every marker and axis both displacements, and beside them their difference, with bands of 95 %.

    Arguments:
        check: as `crashkit.misfit.cross_check` returns it.

    Returns:
        A plotly figure: `show()` it, or `write_html(path)`.
    """
    from plotly.graph_objects import Figure
    from plotly.subplots import make_subplots

    stacked = check.stack(column=check["film"].dims[1:])
    labels = [" ".join(map(str, column)) for column in stacked["column"].values]
    titles = [title for label in labels for title in (label, f"{label}: film less accelerometer")]
    figure: Figure = make_subplots(len(labels), 2, shared_xaxes=True, subplot_titles=titles)
    for row, label in enumerate(labels):
        _draw(figure, stacked.isel(column=row), row + 1, label)
    figure.update_xaxes(title_text="time (s)", row=len(labels))
    figure.update_layout(title=_verdicts(check), height=120 + 260 * len(labels), template="plotly_white")
    return figure


def _verdicts(check: xr.Dataset) -> str:
    return "<br>".join(str(sentence) for sentence in check["sentence"].values)


def _draw(figure: "Figure", column: xr.Dataset, row: int, label: str) -> None:
    times = column["time"].values
    first = row == 1
    followed, spread = column["accelerometer"].values, CONFIDENCE * column["accelerometer_std"].values
    _band(figure, times, followed, spread, ACCELEROMETER, (row, 1))
    _line(figure, times, followed, "accelerometer", ACCELEROMETER, (row, 1), first)
    _line(figure, times, column["film"].values, "film", FILM, (row, 1), first, mode="markers")
    _band(figure, times, np.zeros(len(times)), CONFIDENCE * column["difference_std"].values, "#999999", (row, 2))
    _line(figure, times, column["difference"].values, "difference", FILM, (row, 2), False, mode="markers")
    units = unit(column["film"].attrs.get("units", ""))
    figure.update_yaxes(title_text=f"displacement ({units})", row=row, col=1)
    figure.update_yaxes(title_text=f"difference ({units})", row=row, col=2)


def _line(
    figure: "Figure",
    x: np.ndarray,
    y: np.ndarray,
    name: str,
    colour: str,
    place: tuple[int, int],
    legend: bool,
    mode: str = "lines",
) -> None:
    marks = {"color": colour, "size": 3} if mode == "markers" else {}
    row, column = place
    figure.add_scatter(x=x, y=y, name=name, mode=mode, line_color=colour, marker=marks, showlegend=legend, row=row, col=column)


def _band(figure: "Figure", x: np.ndarray, y: np.ndarray, half: np.ndarray, colour: str, place: tuple[int, int]) -> None:
    known = np.isfinite(y + half)
    around = np.concatenate([(y + half)[known], (y - half)[known][::-1]])
    row, column = place
    figure.add_scatter(
        x=np.concatenate([x[known], x[known][::-1]]),
        y=around,
        fill="toself",
        fillcolor=colour,
        opacity=0.25,
        line_width=0,
        mode="lines",
        hoverinfo="skip",
        showlegend=False,
        row=row,
        col=column,
    )
