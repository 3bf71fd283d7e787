"""What pages of studies say is what their tables tell."""

from __future__ import annotations

import re
import runpy
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.study.studies.design import Design
from lammps_skin.study.studies.sensitivity import effects, sensitivities
from lammps_skin.study.studies.tables import read_courses

from tests.conftest import Answer
from tests.pages import BY_NAME, ROOT, blocks, commands, text

COMPARED = [
    (page, words)
    for page, words in commands("skin")
    if page.startswith("studies") and words[0] == "compare" and "--plot" not in words
]


@pytest.mark.parametrize(("page", "words"), COMPARED, ids=[page for page, _ in COMPARED])
def test_tables(
    page: str, words: list[str], skin: Callable[..., Answer], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Each row of each table below a command of `skin compare`."""
    monkeypatch.chdir(ROOT)
    told = tmp_path / "told.md"
    answer = skin(*words, "-o", told)
    assert answer.code == 0, answer.err
    rows = [line for line in told.read_text("utf-8").splitlines() if line.startswith("| ")]
    assert len(rows) > 3
    missing = [row for row in rows if row not in text(page).splitlines()]
    assert not missing


NUMBER = r"(-?\d+(?:\.\d+)?(?:e-?\d+)?)"
MEAN = re.compile(rf"{NUMBER} \[{NUMBER}, {NUMBER}\]")


@pytest.mark.parametrize("page", [page for page in BY_NAME if page.startswith("studies/")])
def test_intervals_in_sentences_are_those_of_the_tables(page: str) -> None:
    """Rounded as they are in the sentence; "lower by" has the opposite sign."""
    lines = text(page).splitlines()
    told = " ".join(line.strip() for line in lines if not line.startswith("|"))
    table = "\n".join(line for line in lines if line.startswith("|"))
    known = [tuple(map(float, found)) for found in MEAN.findall(table)]
    known += [(-value, -high, -low) for value, low, high in known]
    for found in MEAN.findall(told):
        errors = [0.5 * 10.0 ** -len(word.partition(".")[2]) + 1e-9 for word in found]
        values = np.array(found, float)
        assert (abs(np.array(known) - values) <= errors).all(axis=1).any(), found


def test_pictures_are_shown() -> None:
    """Each page that compares shows the picture of its study."""
    assert COMPARED
    for page in {page for page, _ in COMPARED if page != "studies.md"}:
        name = page.removeprefix("studies/").removesuffix(".md")
        assert f"/figures/studies/{name}.png)" in text(page)
        assert any(f"skin study {name}" in block for _, block in blocks(page))


def test_the_list_of_studies_leads_to_their_pages() -> None:
    there = {page for page in BY_NAME if page.startswith("studies/")}
    assert there <= set(re.findall(r"\]\((studies/[\w-]+\.md)\)", text("studies.md")))


def test_effects_of_the_page_on_sensitivity() -> None:
    """Its table is what the study's means tell."""
    design = Design.load(Path("sensitivity"))
    sample, labels = design.sample, [point.label for point in design.points]
    assert sample
    courses = read_courses(ROOT / "docs" / "data" / "studies" / "sensitivity")
    lines = text("studies/sensitivity.md").splitlines()
    head = next(line for line in lines if line.startswith("| key | chi_H |"))
    wanted = [cell.strip() for cell in head.strip("|").split("|")][1:]
    found = sensitivities(sample, labels, courses, wanted, design.windows[-1])
    told = effects(sample, found)
    assert len(told) == 2 + 14 and not [line for line in told if line not in lines]


def test_indices_of_the_page_on_sensitivity() -> None:
    """Each cell of its table is a total index of Sobol and its interval."""
    design = Design.load(Path("sensitivity-sobol"))
    sample, labels = design.sample, [point.label for point in design.points]
    assert sample and not sample.remark
    courses = read_courses(ROOT / "docs" / "data" / "studies" / "sensitivity-sobol")
    lines = text("studies/sensitivity.md").splitlines()
    head = lines.index("| key | chi_H | zeta | skewness | papillae | height_std | none_below |")
    wanted = [cell.strip() for cell in lines[head].strip("|").split("|")][1:]
    found = sensitivities(sample, labels, courses, wanted, design.windows[-1])
    columns = [
        [one.values[:, one.heads.index(name)] for name in ("total", "total_error")] for one in found
    ]
    for n, key in enumerate(sample.ranges):
        cells = [f"{total[n]:.2f} ± {error[n]:.2f}" for total, error in columns]
        assert " | ".join([f"| `{key}`", *cells]) + " |" in lines


def test_the_page_on_the_continuum_has_what_its_script_tells(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    script, data = ROOT / "docs/studies/continuum.py", ROOT / "docs/data/studies/continuum"
    picture = tmp_path / "a.png"
    monkeypatch.setattr("sys.argv", [str(script), "-o", str(data), "--picture", str(picture)])
    runpy.run_path(str(script), run_name="__main__")
    *tables, pull, drag = capsys.readouterr().out.splitlines()
    page = text("studies/continuum.md")
    rows = [line for line in tables if line]
    assert len(rows) > 40 and not [row for row in rows if row not in page.splitlines()]
    for number in (pull, drag):
        assert number.partition(": ")[2] in page
    assert picture.stat().st_size > 10_000
