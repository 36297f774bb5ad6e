"""Figures for plotly.js as plain JSON values: drawn by the page, so no plotting library runs here."""

import base64
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.report.channels import ChannelCurves
from crashkit.report.words import unit

Figure = dict[str, Any]


@frozen
class Style:
    """How a simulated curve of `ChannelCurves` is named and drawn."""

    curve: str
    name: str
    colour: str
    dash: str


RECORDED = "#b4bbc5"
BEFORE = Style("before", "before", "#d55e00", "dash")
AFTER = Style("after", "after", "#0072b2", "solid")
ONLY = Style("before", "model", "#0072b2", "solid")
RUN_COLOURS = ("#0072b2", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#e69f00")  # Okabe and Ito: safe for colour-blind eyes
DISPLAYED = {"s": (1e3, "ms"), "m": (1e3, "mm"), "N": (1e-3, "kN")}
MOST_POINTS = 4000
RESIDUAL_POINTS = 120


def channel_chart(channel: ChannelCurves, with_after: bool) -> Figure:
    """Recorded, before and after over time; below, the residuals averaged over short blocks, in standard deviations."""
    scale, units = DISPLAYED.get(channel.units, (1.0, unit(channel.units)))
    traces = [_line(channel.time, scale * channel.recorded, "recorded", RECORDED, width=3.5)]
    residuals = []
    for style in (BEFORE, AFTER) if with_after else (ONLY,):
        simulated = getattr(channel, style.curve)
        times, residual = block_residual(channel, simulated)
        residuals.append(residual)
        traces.append(_line(channel.time, scale * simulated, style.name, style.colour, dash=style.dash))
        traces.append(_line(times, residual, style.name, style.colour, 1.2, yaxis="y2", hovertemplate="%{y:.1f} σ"))
    layout = _layout(_axis("time (ms)", anchor="y2"), _axis(_title(channel.quantity, units), domain=[0.36, 1.0]))
    layout["yaxis2"] = _axis("residual (σ)", domain=[0.0, 0.26], **_residual_scale(residuals))
    layout["shapes"] = [_noise_band()]
    return {"data": traces, "layout": layout}


def _residual_scale(residuals: Sequence[np.ndarray]) -> Figure:
    """Wide enough for the last model's residual, but not so wide for the first's that the noise cannot be seen."""
    first, last = (float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0)) for values in (residuals[0], residuals[-1]))
    largest = max(4.0, 1.1 * last, min(1.1 * first, 12.0))
    return {"range": [-largest, largest], "tickvals": [-(largest // 2), 0, largest // 2]}


def block_residual(channel: ChannelCurves, simulated: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means of recorded - simulated over blocks of samples, divided by the standard deviation of such a mean.

    Without anything missing these are standard normal, whatever the sampling rate; a systematic difference that single
    samples hide stands out.
    """
    size = -(-len(channel.time) // RESIDUAL_POINTS)
    starts = np.arange(0, len(channel.time), size)
    residual = (channel.recorded - simulated) / channel.std
    present = np.isfinite(residual)
    count = np.add.reduceat(present.astype(float), starts)
    total = np.add.reduceat(np.where(present, residual, 0.0), starts)
    mean = np.divide(total, count, out=np.full(len(starts), np.nan), where=count > 0)
    ends = np.minimum(starts + size, len(channel.time)) - 1
    return (channel.time[starts] + channel.time[ends]) / 2, mean * np.sqrt(np.maximum(count / channel.correlation, 1.0))


@frozen
class ForceRun:
    """The missing force of one run at the place of a finding; the Dataset of `Diagnosis.missing_force`."""

    name: str
    holdout: bool
    data: xr.Dataset


def force_charts(runs: Sequence[ForceRun]) -> tuple[Figure, Figure]:
    """The missing force against deformation, and against time: a band from the recordings, a line from the model."""
    against_deformation, against_time = [], []
    for position, run in enumerate(runs):
        colour = RUN_COLOURS[position % len(RUN_COLOURS)]
        against_deformation += _force_traces(run, run.data["deformation"].values, colour)
        against_time += _force_traces(run, run.data["time"].values, colour)
    force = _axis("missing force (kN)", zeroline=True)
    return (
        {"data": against_deformation, "layout": _layout(_axis("deformation (mm)"), force, legend=True)},
        {"data": against_time, "layout": _layout(_axis("time (ms)"), force, legend=True)},
    )


def _force_traces(run: ForceRun, x: np.ndarray, colour: str) -> list[Figure]:
    recorded, std, modelled = (
        1e-3 * run.data[name].values for name in ("missing_force", "missing_force_std", "modelled_force")
    )
    kept = extremes(recorded)
    x, recorded, std, modelled = x[kept], recorded[kept], std[kept], modelled[kept]
    name = escape(run.name) + (" (never fitted)" if run.holdout else "")
    group: Figure = {"legendgroup": name, "hoverinfo": "skip"}
    present = np.isfinite(recorded) & np.isfinite(std) & np.isfinite(x)
    around = np.concatenate([(recorded + std)[present], (recorded - std)[present][::-1]])
    band = _line(np.concatenate([x[present], x[present][::-1]]), around, name, colour, width=0, showlegend=False, **group)
    band |= {"fill": "toself", "opacity": 0.22, "fillcolor": colour}
    points = _line(x, recorded, name, colour, showlegend=False, **group)
    points |= {"mode": "markers", "marker": {"size": 3, "color": colour, "opacity": 0.55}}
    line = _line(x, modelled, name, colour, dash="dash" if run.holdout else "solid", width=2.4, legendgroup=name)
    return [band, points, line]


def extremes(values: np.ndarray, most: int = MOST_POINTS) -> np.ndarray:
    """Positions of at most `most` samples that keep the smallest and the largest of every stretch."""
    count = len(values)
    if count <= most:
        return np.arange(count)
    size = -(-count // (most // 2))
    padded = np.pad(values, (0, -count % size), mode="edge").reshape(-1, size)
    smallest = np.where(np.isnan(padded), np.inf, padded).argmin(axis=1)
    largest = np.where(np.isnan(padded), -np.inf, padded).argmax(axis=1)
    starts = size * np.arange(len(padded))
    return np.unique(np.minimum(np.concatenate([starts + smallest, starts + largest]), count - 1))


def _line(
    x: np.ndarray, y: np.ndarray, name: str, colour: str, width: float = 1.6, dash: str = "solid", **more: object
) -> Figure:
    """A trace; x is a time in s or a deformation in m, both shown in thousandths."""
    kept = extremes(y)
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": _packed(1e3 * x[kept]),
        "y": _packed(y[kept]),
        "line": {"color": colour, "width": width, "dash": dash},
        **more,
    }


def _packed(values: np.ndarray) -> Mapping[str, str]:
    """Numbers as plotly.js reads them fastest; single precision is finer than any screen."""
    return {"dtype": "f4", "bdata": base64.b64encode(np.asarray(values, "<f4").tobytes()).decode("ascii")}


def _title(quantity: str, units: str) -> str:
    return escape(f"{quantity} ({units})" if units else quantity)


def _axis(title: str, **more: object) -> Figure:
    """Plotly reads a few HTML tags in texts, so titles come escaped."""
    return {
        "title": {"text": title, "standoff": 6},
        "automargin": True,
        "zeroline": False,
        "gridcolor": "#e8ebef",
        "linecolor": "#8a939e",
        "ticks": "outside",
        "ticklen": 3,
        "tickcolor": "#8a939e",
        **more,
    }


def _layout(x: Figure, y: Figure, legend: bool = False) -> Figure:
    return {
        "xaxis": x,
        "yaxis": y,
        "showlegend": legend,
        "legend": {"orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom"},
        "hovermode": "closest" if legend else "x unified",
        "margin": {"l": 62, "r": 12, "t": 10, "b": 42},
        "font": {"family": "system-ui, sans-serif", "size": 12, "color": "#2b3138"},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
    }


def _noise_band() -> Figure:
    """Where 19 of 20 residuals lie if only noise is left."""
    return {
        "type": "rect",
        "layer": "below",
        "xref": "paper",
        "x0": 0,
        "x1": 1,
        "yref": "y2",
        "y0": -2,
        "y1": 2,
        "fillcolor": "#dfe4ea",
        "line": {"width": 0},
    }
