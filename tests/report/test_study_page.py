"""The page of a study: its answer, its time courses, and a run of each point."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.errors import SkinError
from lammps_skin.report.page import report_study
from lammps_skin.report.study import MOST_CURVES, StudyTables, study_pages
from lammps_skin.study.studies.answer import answers
from lammps_skin.study.studies.runs import Study
from lammps_skin.study.studies.sensitivity import sensitivities
from lammps_skin.study.studies.tables import read_courses, write_tables

from tests.report.browser import Browser
from tests.study.studies.conftest import made

POINTS = "[conditions.one]\n[conditions.two]\ncells.stem = 2\ncells.arrangement = 'cluster'\n"


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    """Two points with two seeds; the trajectories are kept."""
    asked = made(tmp_path_factory.mktemp("study"), end=POINTS)
    for run in asked.runs:
        run.run(keep=True)
    write_tables(asked)
    return asked


@pytest.fixture(scope="module")
def without(study: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the same study without trajectories."""
    folder = tmp_path_factory.mktemp("without") / "study"
    shutil.copytree(study.folder, folder, ignore=shutil.ignore_patterns("*.h5"))
    return folder


def texts(page: Browser, selector: str) -> list[str]:
    found: list[str] = page.value(
        f"[...document.querySelectorAll({selector!r})].map((one) => one.innerText)"
    )
    return found


def test_answer_curves_and_runs(study: Study, browser: Browser, tmp_path: Path) -> None:
    browser.errors.clear()
    browser.open(report_study(study.folder, tmp_path / "study.html").as_uri())
    assert texts(browser, "details[open] .answer td:first-child") == ["one", "two"]
    for window in study.design.windows:
        browser.choose("window", str(window))
        for n, one in enumerate(
            one for one in answers(study.design, read_courses(study.folder), ["coverage"])
            if one.window == window
        ):  # fmt: skip
            told = texts(browser, "details[open] .answer td[data-column=coverage]")[n]
            said = [float(word) for word in re.findall(r"[\d.]+", told)]
            assert said == pytest.approx([one.mean.value, one.mean.low, one.mean.high], rel=6e-3)
    assert browser.value("page.views.map((view) => view.run.told.name)") == [
        "one, seed 1", "two, seed 1",
    ]  # fmt: skip
    browser.choose("slider", "0")
    assert browser.value("page.views.map((view) => view.drawn)") == [1, 2]
    chart = "[data-column=coverage]"
    shown = browser.value(f"document.querySelector('figure{chart} b').textContent").split(" | ")
    courses = read_courses(study.folder).values()
    expected = [course["coverage"][course["time"] == 0].mean() for course in courses]
    assert [float(value) for value in shown] == pytest.approx(expected, rel=6e-3)
    bands = f"document.querySelectorAll('figure{chart} .band').length"
    assert browser.value(bands) == 2
    browser.value("document.querySelector('#curves input').click()")
    assert browser.value(bands) == 1
    assert browser.errors == []


def test_without_trajectories(without: Path, browser: Browser, tmp_path: Path) -> None:
    """The slider goes over the frames of the courses."""
    browser.errors.clear()
    browser.open(report_study(without, tmp_path / "study.html").as_uri())
    assert "with --keep" in texts(browser, "#warnings")[0]
    assert browser.value("getComputedStyle(document.querySelector('.stage')).display") == "none"
    times = np.unique(next(iter(read_courses(without).values()))["time"])
    assert browser.value("page.steps") == pytest.approx(times)
    browser.choose("slider", "2")
    assert browser.value("page.time") == times[2]
    assert browser.errors == []


def test_what_is_missing_is_told(without: Path, tmp_path: Path) -> None:
    """Of a run that is gone; of a study of which no run is done there is no page."""
    asked = made(tmp_path, end=POINTS)
    shutil.copytree(without, asked.folder)
    asked.runs[0].table.unlink()
    write_tables(asked)
    told, records = study_pages(asked.folder, 4)
    assert told["warnings"] == ["Missing: one, seed 1. Means are of the others."]
    assert [point["done"] for point in told["points"]] == [1, 2] and not records
    value, low, _, seeds = told["means"][told["windows"][0]]["coverage"][0]
    assert value is not None and (low, seeds) == (None, 1)
    for run in asked.runs:
        run.table.unlink(missing_ok=True)
    write_tables(asked)
    with pytest.raises(SkinError, match="no run is done"):
        StudyTables(asked.folder)


def test_curves_of_many_points_are_few(tmp_path: Path) -> None:
    """All points are in the answer."""
    many = MOST_CURVES + 2
    values = ", ".join(f"{1 + n / 100}" for n in range(many))
    asked = made(tmp_path, 'windows = "0-3"', f"[grid]\ncells.radius = [{values}]\n")
    for run in asked.runs[:1]:
        run.run()
    write_tables(asked)
    told, _ = study_pages(asked.folder, 4)
    assert len(told["points"]) == many and len(told["curves"]) == 1
    assert told["remarks"][0] == f"Curves show the first {MOST_CURVES} of {many} points."


def test_the_command(skin, study: Study, tmp_path: Path) -> None:
    """Of a folder, and of a file, whose runs are in studies/NAME."""
    shutil.copytree(study.folder, tmp_path / "studies/tiny")
    file = study.folder.parent / "tiny.toml"
    for named in ("studies/tiny", file):
        answer = skin("report", named, "-o", "page.html", "--frames", "2")
        assert answer.code == 0 and answer.out.startswith("page.html: ")
        assert "<title>tiny</title>" in (tmp_path / "page.html").read_text()
    answer = skin("report", "studies/tiny", "studies/tiny")
    assert answer.err == "error: studies/tiny: is a study, which has a page of its own\n"
    answer = skin("report", "nowhere.toml")
    assert answer.code == 2 and answer.err.startswith("error: study nowhere.toml: ")


def test_a_sample_has_its_values_and_wide_bands_leave_the_chart(
    browser: Browser, tmp_path: Path
) -> None:
    """The means of all seeds fill a third of the chart, and it is said how far intervals reach."""
    end = "[sample]\nmethod = 'morris'\nn = 2\n[sample.ranges]\ncells.radius = [1.2, 1.4]\n"
    asked = made(tmp_path, end=end)
    for run in asked.runs:
        run.run()
    write_tables(asked)
    browser.errors.clear()
    browser.open(report_study(asked.folder, tmp_path / "study.html").as_uri())
    sample, labels = asked.design.sample, [point.label for point in asked.design.points]
    assert sample
    rows = texts(browser, "details[open] .answer tr")[1:]
    for row, point in zip(rows, asked.design.points, strict=True):
        assert row.split("\t")[:2] == [point.label, f"{point.values['cells.radius']:.3g}"]
    keys, values = (
        texts(browser, f"#indices td{one}") for one in (":first-child", "[class=number]")
    )
    assert keys == ["cells.radius"] * 3  # mu*, mu, sigma
    (effect,) = sensitivities(
        sample, labels, read_courses(asked.folder), ["ta"], asked.design.windows[-1]
    )
    assert f"{effect.values[0][0]:.3g} ± {effect.values[0][1]:.3g}" in values
    low, high = browser.value("""(() => {
      const lines = [...document.querySelectorAll('figure[data-column=ta] path:not(.band)')];
      const places = lines.flatMap((line) => line.getAttribute('d').match(/,[-0-9.]+/g));
      return endsOf(places.map((place) => Number(place.slice(1))));
    })()""")
    assert 0 <= low < high <= 104 and high - low >= 104 / 3 - 8
    (said,) = texts(browser, "figure[data-column=ta] .hint")
    assert re.search(r"; intervals reach from [-\d.]+ to [\d.]+$", said)
    assert browser.errors == []
