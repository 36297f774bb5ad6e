"""The page says what the diagnosis says, opens offline, and survives what users call their sensors."""

import json
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from attrs import evolve
from jinja2 import UndefinedError

from crashkit.diagnose.result import Alternative, Diagnosis, Estimate, Fit
from crashkit.report import write_report
from crashkit.report.page import render

HOSTILE = "</script><script>alert('1 & \"2\"')</script><b>é µ"


class Page(HTMLParser):
    """Collects the text of each section, every reference to a resource and every chart."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[tuple[str, dict[str, str | None]]] = []
        self.sections: dict[str, str] = {}
        self.references: list[str] = []
        self.charts: list[dict] = []
        self.tags: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        found = dict(attributes)
        self.tags.append(tag)
        self.references += [str(found[name]) for name in ("src", "href", "data", "action") if name in found]
        if tag not in ("meta", "link", "img", "br", "input"):
            self.open.append((tag, found))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop()[0] == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] == ("script", {"type": "application/json"}):
            self.charts.append(json.loads(data))
        elif self.open and self.open[-1][0] not in ("script", "style"):
            data = f" {data} " if self.open[-1][0] in ("td", "th", "dt", "dd") else data
            section = next((found.get("id") for tag, found in self.open if tag in ("section", "header")), None) or "top"
            self.sections[section] = re.sub(r"\s+", " ", self.sections.get(section, "") + data)


@pytest.fixture(scope="module")
def page(diagnosis: Diagnosis) -> Page:
    return Page(render(diagnosis))


def test_the_verdict_and_the_summary_stand_at_the_top(page: Page) -> None:
    assert "The model leaves out physics" in page.sections["top"]
    assert "Rate dependence at joint front, 97 %" in page.sections["top"]
    assert "a test at 4 m/s would." in page.sections["top"]


def test_a_finding_says_what_where_when_how_sure_and_what_else(page: Page) -> None:
    text = page.sections["findings"]
    for part in (
        "Rate dependence",
        "linear",
        "97 %",
        "very likely",
        "joint front",
        "1.2 to 94 ms",
        "loading",
        "run_1.nc, run_2.nc",
    ):
        assert part in text
    assert "rate coefficient 0.02210 ± 0.00060 s/m" in text
    assert "Viscous damping linear joint front 2.1 %" in text
    assert "To tell them apart: The same at 4 m/s" in text
    assert "sensor sill_right (accelerometer)" in text


@pytest.mark.parametrize("time", [(0.0, float("inf")), (float("nan"), float("nan"))])
def test_a_finding_without_an_end_acts_throughout(diagnosis: Diagnosis, time: tuple[float, float]) -> None:
    page = Page(render(evolve(diagnosis, findings=(evolve(diagnosis.findings[0], time=time),))))
    assert "When throughout" in page.sections["findings"]


def test_held_out_runs_are_set_apart(page: Page) -> None:
    assert "never fitted" in page.sections["holdout"]
    assert "holdout_1.nc" in page.sections["holdout"]
    assert "run_1.nc" not in page.sections["holdout"]
    assert "run_3.nc" in page.sections["fitted"]
    assert "holdout_1.nc" not in page.sections["fitted"]


def test_there_is_a_chart_for_every_channel_and_two_for_the_missing_force(page: Page) -> None:
    assert len(page.charts) == 2 + 16


def test_tables_show_hypotheses_fits_instruments_and_parameters(page: Page, diagnosis: Diagnosis) -> None:
    assert page.sections["ranking"].index("Rate dependence") < page.sections["ranking"].index("Viscous damping")
    assert "9 more" in page.sections["ranking"]
    overall = diagnosis.fits["holdout"]["after"].normalised_rmse
    assert f"{overall:.2f}" in page.sections["fits"]
    assert "0.97 excellent" in page.sections["fits"]
    assert (
        "sill_right, integrated twice, leaves the film by 41 mm sensor sill_right 36 σ disagree"
        in page.sections["instruments"]
    )
    assert "joint.front.unloading_stiffness 3.200×10⁶ (4.9 ± 8.0)×10⁶ N/m not identifiable" in page.sections["parameters"]
    assert "joint.front.rate_coefficient – 0.02210 ± 0.00060 s/m new" in page.sections["parameters"]
    assert "no run rebounds far enough" in page.sections["notes"]


def test_a_physics_that_may_be_at_either_of_two_places_is_told_with_both_together(diagnosis):
    (finding, *rest) = diagnosis.findings
    rival = Alternative(finding.physics, "", {"joint": "rear"}, 0.3)
    split = evolve(finding, probability=0.6, alternatives=(rival,))
    assert "(there or at another place: 90 %)" in render(evolve(diagnosis, findings=(split, *rest)))
    assert "at another place" not in render(diagnosis)


def test_a_number_that_the_recordings_do_not_see_by_itself_has_no_deviation(diagnosis):
    (finding, *rest) = diagnosis.findings
    unseen = {"rate_coefficient": Estimate(0.0221, 350.0, "s m-1", identifiable=False)}
    page = Page(render(evolve(diagnosis, findings=(evolve(finding, parameters=unseen), *rest))))
    assert "rate coefficient 0.02210 not identifiable s/m" in page.sections["findings"]


def test_what_was_to_be_expected_of_a_prediction_stands_beside_it(diagnosis):
    held = diagnosis.fits["holdout"]
    vague = evolve(held["after"], expected_rmse=13.2, untold="joint.front.crush_force")
    fits = {**diagnosis.fits, "holdout": {**held, "after": vague}}
    assert "the right model would leave about 13.2" in render(evolve(diagnosis, fits=fits))
    assert "the right model would leave about" not in render(diagnosis)


def test_the_folder_is_self_contained(diagnosis: Diagnosis, tmp_path: Path) -> None:
    path = write_report(diagnosis, tmp_path / "report")
    text = path.read_text("utf-8")
    assert path == tmp_path / "report" / "index.html"
    assert not re.search(r"https?:|//[a-z]+\.|@import|url\(", text)
    for reference in Page(text).references:
        assert reference.startswith("#") or (path.parent / reference).is_file()
    assert sum(file.stat().st_size for file in path.parent.iterdir()) < 6e6


def test_links_lead_to_sections_that_are_there(page: Page) -> None:
    assert {reference[1:] for reference in page.references if reference.startswith("#")} <= set(page.sections)


def test_odd_names_are_shown_and_not_obeyed(diagnosis: Diagnosis, page: Page) -> None:
    finding = evolve(
        diagnosis.findings[0],
        physics=HOSTILE,
        form=HOSTILE,
        sentence=HOSTILE,
        location={"joint": HOSTILE},
        runs=(HOSTILE,),
        experiment=HOSTILE,
    )
    curves = diagnosis.curves["run_1.nc/film"].to_dataset().assign_coords(channel=[HOSTILE, "{{ 7 * 7 }}"])
    curves.attrs |= {"quantity": HOSTILE, "units": HOSTILE}
    force = diagnosis.missing_force["0/run_1.nc"].to_dataset()
    run = "a b & <i>.nc"
    odd = Page(
        render(
            evolve(
                diagnosis,
                findings=(finding, diagnosis.findings[1]),
                summary=HOSTILE,
                notes=(HOSTILE,),
                curves=xr.DataTree.from_dict(
                    {f"{run}/film": curves, **{n.path: n.to_dataset() for n in diagnosis.curves.leaves}}
                ),
                missing_force=xr.DataTree.from_dict({f"0/{run}": force}),
            )
        )
    )
    assert sorted(set(odd.tags)) == sorted(set(page.tags))
    assert odd.tags.count("script") == len(odd.charts) + 2
    assert HOSTILE in odd.sections["findings"]
    assert HOSTILE in odd.sections["fitted"]
    assert "{{ 7 * 7 }}" in odd.sections["fitted"]
    assert "a b & <i>.nc" in odd.sections["fitted"]
    titles = [chart["layout"]["yaxis"]["title"]["text"] for chart in odd.charts]
    assert not any("<" in title for title in titles)


def test_a_run_named_by_its_folder_is_one_run(diagnosis: Diagnosis) -> None:
    curves = {f"monday/{node.path.strip('/')}": node.to_dataset() for node in diagnosis.curves.leaves}
    forces = {f"0/monday/{node.name}": node.to_dataset() for node in diagnosis.missing_force["0"].children.values()}
    trees = {"curves": xr.DataTree.from_dict(curves), "missing_force": xr.DataTree.from_dict(forces)}
    page = Page(render(evolve(diagnosis, **trees)))
    assert "monday/run_1.nc" in page.sections["fitted"]
    assert len(page.charts) == 2 + 16


def test_consistent(diagnosis: Diagnosis) -> None:
    note = "A rate effect of 0.8 % would have been seen."
    page = Page(
        render(
            evolve(
                diagnosis, verdict="consistent", findings=(), missing_force=xr.DataTree(), ranking=xr.Dataset(), notes=(note,)
            )
        )
    )
    assert "The model agrees with the recordings" in page.sections["top"]
    assert note in page.sections["notes"]
    assert not {"findings", "force", "ranking"} & set(page.sections)
    assert "After" not in page.sections["fits"]
    assert {trace["name"] for chart in page.charts for trace in chart["data"]} == {"recorded", "model"}


def test_sensor_fault_shows_no_missing_force(diagnosis: Diagnosis) -> None:
    page = Page(
        render(evolve(diagnosis, verdict="sensor_fault", findings=diagnosis.findings[1:], missing_force=xr.DataTree()))
    )
    assert "An instrument is at fault" in page.sections["top"]
    assert "gain 1.0603 ± 0.0011" in page.sections["findings"]
    assert "force" not in page.sections


def test_unexplained_without_a_finding(diagnosis: Diagnosis) -> None:
    page = Page(render(evolve(diagnosis, verdict="unexplained", findings=(), missing_force=xr.DataTree())))
    assert "no known physics explains it" in page.sections["top"]


def test_without_held_out_runs_the_page_says_so(diagnosis: Diagnosis) -> None:
    run = {node.path: node.to_dataset() for node in diagnosis.curves["run_1.nc"].leaves}
    fits = {"calibration": diagnosis.fits["calibration"], "holdout": {}}
    page = Page(render(evolve(diagnosis, curves=xr.DataTree.from_dict(run), fits=fits)))
    assert "There are none" in page.sections["holdout"]
    assert "run_2.nc" not in page.sections["fitted"]
    assert "never fitted" not in page.sections["fits"]


def test_empty_tables_leave_their_sections_out(diagnosis: Diagnosis) -> None:
    empty = xr.Dataset({"physics": ("hypothesis", np.array([])), "round": ("hypothesis", np.array([]))})
    nothing = evolve(
        diagnosis,
        summary="",
        findings=(),
        fits={},
        curves=xr.DataTree(),
        missing_force=xr.DataTree(),
        ranking=empty,
        consistency=xr.Dataset(),
        identified=xr.Dataset(),
        notes=(),
    )
    page = Page(render(nothing))
    assert set(page.sections) == {"top", "instruments", "reading"}
    assert "none could be checked against another" in page.sections["instruments"]


def test_values_that_are_not_known_are_dashes(diagnosis: Diagnosis) -> None:
    table = diagnosis.fits["calibration"]["after"].channels
    unknown = Fit(float("nan"), table.map(lambda column: column * np.nan, keep_attrs=True))
    ranking = diagnosis.ranking.assign(
        {name: ("hypothesis", np.full(26, np.nan)) for name in ("misfit_drop", "left_out_drop", "probability")}
    )
    fits = {"calibration": {"before": unknown, "after": unknown}}
    page = Page(render(evolve(diagnosis, fits=fits, ranking=ranking)))
    assert "– →  –".replace("  ", " ") in page.sections["top"]
    assert not any("nan" in text.lower() for text in page.sections.values())


def test_a_page_that_cannot_be_made_leaves_nothing(diagnosis: Diagnosis, tmp_path: Path) -> None:
    with pytest.raises(UndefinedError, match="sentence"):
        write_report(evolve(diagnosis, consistency=xr.Dataset({"check": [1]})), tmp_path / "report")
    assert not (tmp_path / "report").exists()


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("chromium") is None, reason="needs chromium")
def test_a_browser_draws_the_charts(diagnosis: Diagnosis, tmp_path: Path) -> None:
    path = write_report(diagnosis, tmp_path / "report")
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=2000", "--window-size=1400,12000"]
    command = ["chromium", *options, f"--user-data-dir={tmp_path / 'profile'}", "--dump-dom", path.as_uri()]
    drawn = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout
    assert len(re.findall('class="[^"]*svg-container', drawn)) == 18
