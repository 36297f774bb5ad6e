"""index.html: the diagnosis for people, a page that opens offline in any browser."""

import math
from collections.abc import Iterator
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

import xarray as xr
from attrs import frozen
from jinja2 import Environment, PackageLoader, StrictUndefined, Template
from plotly.offline import get_plotlyjs

from crashkit.diagnose.fitting.evidence import FLOOR
from crashkit.diagnose.locate.consistency import SIGNIFICANT
from crashkit.diagnose.result import Diagnosis, Finding, place_of
from crashkit.report import words
from crashkit.report.channels import UNRATED, ChannelCurves, ChannelFit, channels_of, fits_of
from crashkit.report.charts import Figure, ForceRun, channel_chart, force_charts
from crashkit.report.document import MODELS, SETS
from crashkit.report.files import write_text

Row = dict[str, Any]

SET_NAMES = {"holdout": "Held-out runs, never fitted", "calibration": "Fitted runs"}


def write_report(diagnosis: Diagnosis, directory: Path) -> Path:
    """Write `directory`/index.html and what it needs, each file whole or not at all, and return the page's path."""
    page = render(diagnosis)
    write_text(directory / "plotly.min.js", get_plotlyjs())
    return write_text(directory / "index.html", page)


def render(diagnosis: Diagnosis) -> str:
    """The page as text; it needs plotly.min.js beside it."""
    channels = list(channels_of(diagnosis))
    return template("page.html").render(
        diagnosis=diagnosis,
        verdict=words.verdict_of(diagnosis.verdict, diagnosis.time_up is not None),
        with_after=bool(diagnosis.findings),
        set_names=SET_NAMES,
        forces=list(_forces(diagnosis)),
        held_out=_runs([channel for channel in channels if channel.holdout], bool(diagnosis.findings)),
        fitted=_runs([channel for channel in channels if not channel.holdout], bool(diagnosis.findings)),
        fits=[table for name in reversed(SETS) if (table := _fit_table(diagnosis, name))],
        rounds=_rounds(diagnosis.ranking),
        with_left_out=any(math.isfinite(row["left_out_drop"]) for row in rows(diagnosis.ranking, "hypothesis")),
        detectable=rows(diagnosis.detectable, "effect"),
        consistency=rows(diagnosis.consistency, "check"),
        inconsistent=SIGNIFICANT,
        infinity=math.inf,
        floor=FLOOR,
        identified=rows(diagnosis.identified, "parameter"),
    )


def template(name: str) -> Template:
    """A page to be filled in. Every variable is escaped: names of runs, bodies and sensors are the user's."""
    environment = Environment(
        loader=PackageLoader("crashkit.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    filters = (words.label, words.likelihood, words.percent, words.unit, words.number, words.estimate, words.grade, place_of)
    environment.filters |= {function.__name__: function for function in filters}
    return environment.get_template(name)


@frozen
class Plot:
    """A channel and its chart."""

    channel: ChannelCurves
    figure: Figure


@frozen
class Run:
    """The charts of one run."""

    name: str
    plots: tuple[Plot, ...]


@frozen
class Force:
    """The missing force of one finding, drawn against deformation and against time."""

    finding: Finding
    by_deformation: Figure
    by_time: Figure


@frozen
class FitTable:
    """The fits of one set of runs; each row is a channel's name and its fits before and after.

    `expected` is what the right model would leave there, NaN where that was not asked.
    """

    runs: str
    overall: dict[str, float]
    expected: float
    channels: tuple[tuple[str, dict[str, ChannelFit]], ...]


def rows(table: xr.Dataset, dim: str) -> list[Row]:
    """A Dataset over one dim as one dictionary for each entry."""
    columns = {str(name): variable.values.tolist() for name, variable in table.variables.items() if variable.dims == (dim,)}
    return [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]


def _runs(channels: list[ChannelCurves], with_after: bool) -> list[Run]:
    return [
        Run(name, tuple(Plot(channel, channel_chart(channel, with_after)) for channel in group))
        for name, group in groupby(channels, key=lambda channel: channel.run)
    ]


def _forces(diagnosis: Diagnosis) -> Iterator[Force]:
    """Findings about sensors have no missing force, and are left out."""
    for index, finding in enumerate(diagnosis.findings):
        if str(index) in diagnosis.missing_force.children:
            tree = diagnosis.missing_force.children[str(index)]
            runs = [
                ForceRun(node.relative_to(tree), bool(node.attrs.get("holdout", 0)), node.to_dataset())
                for node in tree.leaves
                if "time" in node.sizes
            ]
            yield Force(finding, *force_charts(runs))


def _fit_table(diagnosis: Diagnosis, runs: str) -> FitTable | None:
    fits = diagnosis.fits.get(runs, {})
    if "before" not in fits:
        return None
    by_model = {model: fits_of(fits[model]) if model in fits else {} for model in MODELS}
    overall = {model: fits[model].normalised_rmse if model in fits else float("nan") for model in MODELS}
    channels = [(name, {model: by_model[model].get(name, UNRATED) for model in MODELS}) for name in by_model["before"]]
    expected = fits["after"].expected_rmse if "after" in fits else math.nan
    return FitTable(runs, overall, expected, tuple(channels))


def _rounds(ranking: xr.Dataset) -> list[tuple[int, list[Row]]]:
    """The hypotheses of each round, the most probable first, with their share of the round's largest drop in misfit."""
    entries = sorted(rows(ranking, "hypothesis"), key=_standing)
    rounds = [(int(number), list(group)) for number, group in groupby(entries, key=itemgetter("round"))]
    for _, group in rounds:
        largest = max((row["misfit_drop"] for row in group if row["misfit_drop"] > 0), default=math.inf)
        for row in group:
            row["share"] = max(0.0, row["misfit_drop"] / largest)
    return rounds


def _standing(row: Row) -> tuple[float, float, float]:
    """Where a hypothesis belongs in the ranking; NaN comes last."""
    return row["round"], _last_if_nan(-row["probability"]), _last_if_nan(-row["misfit_drop"])


def _last_if_nan(value: float) -> float:
    return math.inf if math.isnan(value) else value
