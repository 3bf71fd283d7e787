"""``skin claims``: what it reads, prints and writes, and what it refuses."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from lammps_skin.analysis.observables import write_table
from lammps_skin.study.claims import report
from lammps_skin.study.claims.catalogue import CLAIMS
from lammps_skin.study.claims.rules import FEWEST_SEEDS, POSITIVE, Finding, Word
from lammps_skin.study.claims.tables import Ensemble, layer_remarks, load
from lammps_skin.study.ensemble import scene_of
from lammps_skin.study.ranges import Window
from numpy.lib import recfunctions

from tests.pages import ROOT, rows, section, text
from tests.study.claims.made_up import ensemble

DATA = ROOT / "docs" / "data"
GIVEN = {
    "name": "quarter-ring", "seed": 8, "parameters": "earlier", "numerics": {"timestep": 0.02},
    "membrane": {"lattice": [100, 114]}, "cells": {"stem": 16, "nd": 0, "arrangement": "ring"},
}  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A ring with eight seeds, nd-b with three; a scene that is none of the paper's."""
    for scene, seeds in (("ring", 8), ("nd-b", 3)):
        given = GIVEN | {"name": f"quarter-{scene}"}
        comments = ["quarter, key 0123", f"scene: {json.dumps(given)}"]
        table = ensemble(scene, seeds=seeds).table
        write_table(table, tmp_path / "many" / f"quarter-{scene}.csv.gz", comments)
    write_table(table, tmp_path / "many" / "quarter-other.csv.gz")
    return tmp_path / "many"


def test_the_command(skin, folder, tmp_path):
    files = [tmp_path / name for name in ("page.md", "all.csv", "all.json")]
    answer = skin("claims", folder, *(word for file in files for word in ("-o", file)))
    assert answer.code == 0 and not answer.err
    told = " ".join(answer.out.split())
    assert 'numerics.timestep = 0.02, parameters = "earlier"; seeds: 8, of ring' in told
    assert "seeds: 3, of nd-b" in told and "needs 4 seeds, not 3 (nd-b)" in told
    assert "the scenes differ in more than their arrangement" in told  # cells.nd and the name

    (found,) = json.loads(files[2].read_text(), parse_constant=lambda word: pytest.fail(word))
    words = [one["verdict"] for one in found["claims"]]
    missing = ["not tested"] * 2
    assert words == ["holds"] * 4 + missing + ["too few seeds"] * 3 + missing
    assert found["claims"][4]["notes"] == "needs cluster"

    rows = list(csv.DictReader(files[1].open()))
    assert {row["claim"] for row in rows} == {str(number) for number in range(1, 12)}
    one = next(row for row in rows if row["statistic"] == "chi_H" and row["t"] == "600-800")
    values = load(folder)["quarter"]["ring"].mean("chi_H", Window(600, 800))
    assert float(one["mean"]) == pytest.approx(values.mean())
    half = 2.364624 * values.std(ddof=1) / np.sqrt(8)  # Student's t, 7 degrees of freedom
    assert float(one["low"]) == pytest.approx(values.mean() - half)
    assert (one["claimed_low"], one["claimed_high"], one["seeds"]) == ("0", "inf", "8")

    page = files[0].read_text()
    assert "### Claim 3: holds" in page and "### Claim 7" not in page


def test_the_page_on_ensembles_is_what_the_command_writes():
    page = report.markdown(report.reports(DATA), Path("docs/data"))
    assert page == text("ensembles.md"), "skin claims docs/data -o docs/ensembles.md"


def test_the_page_on_claims_names_them():
    assert rows(section("claims.md", "The claims")) == [
        [
            str(one.number), one.sentence, one.statistic or "-", one.threshold or "-",
            " and ".join(" or ".join(group) for group in one.scenes) or "-",
        ]
        for one in CLAIMS
    ]  # fmt: skip
    assert [row[0] for row in rows(section("claims.md", "Verdicts"))] == list(get_args(Word))
    assert f"fewer than {FEWEST_SEEDS} seeds" in section("claims.md", "Verdicts")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["many", "-o", "table.txt"], "output table.txt: its name must end in one of .md"),
        (["many", "-o", "nowhere/table.md"], "output nowhere/table.md: No such file"),
        (["nothing"], "folder nothing: has no table of an ensemble of the paper's scenes"),
    ],
)
def test_what_is_refused(skin, folder, arguments, said):
    answer = skin("claims", *arguments)
    assert answer.code == 2 and answer.err.startswith(f"error: {said}")


def test_tables_that_are_none(skin, folder, tmp_path):
    path = folder / "paper-ring.csv.gz"
    table = ensemble("ring").table
    names = [name for name in table.dtype.names if name != "seed"]
    write_table(table[names], path)
    assert skin("claims", folder).err.endswith("is no table of an ensemble\n")
    names = [name for name in table.dtype.names if name != "skewness"]
    write_table(table[names], path)
    assert skin("claims", folder).err == f"error: table {path}: has no column skewness\n"
    path.write_bytes(b"no table")
    assert skin("claims", folder).code == 2
    assert scene_of(path) == {}


def test_remarks_on_what_is_no_basal_layer():
    """Only once the membrane is covered; the column may be missing."""
    plain = ensemble("ring")
    below = np.where(plain.table["time"] < 300, 0.1, np.where(plain.table["time"] > 600, 0.4, 0.9))
    heap = Ensemble("ring", recfunctions.append_fields(
        plain.table, "none_below", below, usemask=False))  # fmt: skip
    layer = Ensemble("random", heap.table.copy())
    layer.table["none_below"] = 0.9
    bare = (layer.table["time"] >= 400) & (layer.table["time"] < 550)
    layer.table["none_below"][bare], layer.table["coverage"][bare] = 0.1, 0.5
    first, second = layer_remarks({"ring": heap, "random": layer, "cluster": plain})
    assert first.startswith("ring is not a basal layer: over t = 800-1000 only 0.40 ")
    assert second.endswith("for want of the column none_below: cluster")


def test_windows_of_longer_runs():
    long = ensemble("ring").table.copy()
    long["time"] *= 2.2
    one = Ensemble("ring", long)
    assert [str(window) for window in one.windows[3:]] == ["1000-1500", "1500-2000"]
    assert str(one.late) == "400-2000"


def test_values_that_are_not_there():
    """Where no seed has papillae there is no interval, and nothing speaks for a claim."""
    nothing = Finding("", "", "", Window(0, 1), POSITIVE, (np.full(8, np.nan),))
    assert nothing.outcome() == "undecided" and np.isnan(nothing.value.value)
