"""Readings are compared and one is chosen by the rule, from tables that nobody ran."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.analysis.observables import write_table
from lammps_skin.errors import SkinError
from lammps_skin.model.scene import Scene
from lammps_skin.study.claims import readings_levels, readings_page
from lammps_skin.study.claims.readings import Reading, choose, named, read, stiffness_series
from lammps_skin.study.claims.tables import Ensemble
from lammps_skin.study.ranges import Window
from numpy.lib import recfunctions

from tests.pages import ROOT, text
from tests.study.claims.made_up import ND, STEM, TIMES, Change, ensembles, ramp

DATA = ROOT / "docs" / "data"
OTHERS = {"ta": 500.0, "papilla_width_cells": 3.0, "membrane_area": 1.1, "most_on_particle": 3.0}
HEAP = {"nd-c": 0.7}  # none below at last


def reading(
    folder: Path,
    parameters: str,
    none_below: Mapping[str, float] | None = None,
    changes: Mapping[str, Change] | None = None,
    only: Collection[str] = (*STEM, *ND),
    seeds: int = 8,
    longer: float = 1.0,
    **keys: Any,
) -> Path:
    """A folder of tables of ideal courses with changes, and with a layer that ends as given."""
    for name, one in ensembles(changes, seeds=seeds, only=only).items():
        columns = {"none_below": 0.95, **OTHERS}
        table = recfunctions.append_fields(
            one.table, list(columns), [np.full(len(one.table), x) for x in columns.values()],
            usemask=False,
        )  # fmt: skip
        table["none_below"][table["time"] > 800] = (none_below or {}).get(name, 0.95)
        table["time"] *= longer
        scene = Scene.load(f"quarter-{name}").replace(parameters=parameters, **keys)
        comments = ["made up, key 0123", f"scene: {json.dumps(scene.given())}"]
        write_table(table, folder / f"quarter-{name}.csv.gz", comments)
    return folder


def names(found: Collection[Reading]) -> list[str]:
    return [one.name for one in found]


LOW: dict[str, Change] = {"zeta_nd": lambda *_: -1.0}  # claim 9 does not hold


def test_departures_of_kinds_of_cells_are_those_that_are_given(tmp_path):
    (full,) = read([reading(tmp_path, "earlier-full", only=("ring",))])
    assert [key for key in full.departures if "kinds" in key] == [
        "cells.kinds.ta.paired_with", "cells.kinds.ta.paired_stiffness",
    ]  # fmt: skip
    assert len(full.departures) == 12


def test_most_claims_then_fewest_departures(tmp_path):
    found = read([
        reading(tmp_path / "a", "papilla", changes=LOW),
        reading(tmp_path / "b", "earlier-stiff"),
        reading(tmp_path / "c", "weak5", HEAP),
        reading(tmp_path / "d", "earlier"),
        reading(tmp_path / "e", "direct5", only=("ring", "nd-b")),
    ])  # fmt: skip
    assert [one.is_layer for one in found] == ["yes", "yes", "no", "yes", "not known"]
    assert [len(one.departures) for one in found] == [2, 5, 2, 4, 3]
    assert [len(one.claims("holds")) for one in found] == [8, 9, 9, 9, 7]
    assert found[2].least and found[2].least[:2] == ("nd-c", Window(800, 1000))
    candidates, best = choose(found)
    assert names(candidates) == ["earlier (M = 10)", "earlier-stiff (M = 10)", "papilla (M = 10)"]
    assert names(best) == ["earlier (M = 10)"]

    page = readings_page.markdown(found)
    for said in (
        "The rule takes earlier (M = 10): as many claims hold with it as with earlier-stiff",
        "9, and it has fewer departures from print, 4 against 5. Not known enough: direct5",
        "As many claims or more hold with weak5 (M = 10) (1, 2, 3, 4, 5, 6, 7, 8, 9), which",
        "Nearer to print, and a basal layer, too: papilla (M = 10).",
        "direct5 (M = 10); it does not hold with papilla (M = 10).**",
        "A heap of cells in at least one scene and window: weak5 (M = 10).",
        "The same from ring and nd-b alone:",
    ):
        assert said in page, said


def test_what_argues_against_the_choice(tmp_path):
    """Of two with as many claims the other one may be a cleaner layer, with more findings."""
    heap = dict.fromkeys((*STEM, *ND), 0.85)
    always: dict[str, Change] = {"zeta_nd": lambda *_: 0.5 * ramp(300, 500) - 0.25}
    found = read([
        reading(tmp_path / "a", "papilla", heap, LOW),
        reading(tmp_path / "b", "earlier", changes=always),
    ])  # fmt: skip
    page = readings_page.markdown(found)
    said = "Fewer cells lie over others with earlier (M = 10): in the worst window none below"
    assert said in page
    assert "as claimed with earlier (M = 10): those of claim 9 (4 instead of 0)." in page


def test_what_the_rule_does_not_tell_apart(tmp_path):
    both = read([reading(tmp_path / "a", "papilla"), reading(tmp_path / "b", "weak5")])
    assert [names(part) for part in choose(both)] == [["papilla (M = 10)", "weak5 (M = 10)"]] * 2
    said = "The rule does not tell these apart: papilla (M = 10) and weak5 (M = 10)."
    assert said in readings_page.outcome(both)


def test_no_candidate(tmp_path):
    """Neither a heap of cells, nor runs with few seeds, nor tissues that never cover."""
    found = read([
        reading(tmp_path / "a", "papilla", HEAP),
        reading(tmp_path / "b", "weak5", seeds=3),
        reading(tmp_path / "c", "earlier", changes={"coverage": lambda *_: 0.5}),
    ])  # fmt: skip
    assert [one.is_layer for one in found] == ["no", "not known", "not known"]
    assert choose(found) == ([], [])
    assert readings_page.outcome(found).startswith("The rule takes no reading: none is known")
    assert "What argues against it" not in readings_page.markdown(found)


def test_what_is_missing(tmp_path):
    folder = reading(tmp_path / "a", "earlier", only=("ring", "nd-b"))
    (one,) = read([reading(folder, "earlier", only=("nd-d",), seeds=3)])
    assert one.seeds == "8 seeds of 2 scenes; 3 seeds of 1 scene"
    assert one.missing == ["cluster", "random", "nd-a", "nd-c", "nd-d"]
    heads, (row,) = readings_page.rule_table([one])
    assert row[heads.index("lacks")] == "cluster, random, nd-a, nd-c, nd-d"
    assert row[heads.index("basal layer")] == "not known"


def test_names(tmp_path):
    few = {"only": ("ring",), "seeds": 1}
    found = read([
        reading(tmp_path / "a", "earlier", **few, **{"cells.generations": 15, "end_time": 900.0}),
        reading(tmp_path / "b", "earlier", **few, **{"cells.generations": "endless"}),
        reading(tmp_path / "c", "earlier", **few, **{"membrane.noise": 0.1, "seed": 7}),
        reading(tmp_path / "d", "earlier", **few, longer=2.0),
        reading(tmp_path / "e", "earlier", **few),
    ])  # fmt: skip
    assert names(found)[:3] == [
        "earlier (M = 15)", "earlier (M without end)", "earlier (M = 10, membrane.noise = 0.1)"
    ]  # fmt: skip
    assert names(named(found)) == [names(found)[n] for n in (0, 1, 4)]


def test_folders_that_are_no_readings(tmp_path):
    one, same = (reading(tmp_path / name, "earlier", only=("ring",)) for name in "ab")
    with pytest.raises(SkinError, match=r"a and .*b: both are of earlier \(M = 10\)"):
        read([one, same])
    reading(same, "earlier", only=("random",), **{"cells.generations": 15})
    with pytest.raises(SkinError, match="differ in more than their arrangement"):
        read([same])
    path = one / "quarter-ring.csv.gz"
    write_table(ensembles(only=("ring",))["ring"].table, path)
    with pytest.raises(SkinError, match="does not say what was run"):
        read([one])
    path.rename(one / "paper-ring.csv.gz")
    with pytest.raises(SkinError, match="has no table of the quarter size"):
        read([one])


def test_bending_stiffness(tmp_path):
    """Readings that differ in nothing else, the printed values of the sets included."""
    scenes = ("ring", "nd-b")
    found = read([
        reading(tmp_path / "a", "earlier-stiff", only=scenes),
        reading(tmp_path / "b", "earlier", only=scenes, **{"membrane.bending_stiffness": 2.0}),
        reading(tmp_path / "c", "earlier", only=scenes),
        reading(tmp_path / "d", "earlier", only=scenes, **{"cells.generations": 15}),
        reading(tmp_path / "e", "weak5", only=scenes),
    ])  # fmt: skip
    series = stiffness_series(found)
    assert [one.scene.membrane.bending_stiffness for one in series] == [0.5, 2, 10]
    page = readings_page.markdown(found)
    assert "From a bending stiffness of 0.5 to 10, the number of papillae goes from " in page
    assert "higher than stem cells with 3 of 3 readings. The verdicts on claims 7 to 9" in page


def test_long_runs(tmp_path):
    (one,) = read([reading(tmp_path / "a", "earlier", only=("nd-b",), longer=4.0)])
    assert one.is_long and not named([one])
    rest = 4 * TIMES  # every 100: a block has the frames of its two ends
    apart = np.where((rest < 1300) | ((rest >= 2000) & (rest < 2600)), 1.0, -2.0)
    table = one.ensembles["nd-b"].table
    table["zeta_nd"] = table["zeta"] + np.tile(apart, 8)
    above = readings_levels.higher(Ensemble("nd-b", table))
    assert above.shape == (30, 8) and (above.sum(axis=0) == 7).all()
    assert [readings_levels.longest(column) for column in above.T] == [5] * 8
    page = "\n".join(readings_levels.long_runs([one]))
    assert "for at most 500, 500, 500, 500, 500, 500, 500, 500 in each of 8 seeds." in page
    assert "| earlier (M = 10) | nd-b | 8 | 3500-4000 | 500 [" in page


def test_the_command(skin, tmp_path):
    sets = "earlier", "earlier-stiff"
    folders = [reading(tmp_path / name, name, only=("ring", "nd-b")) for name in sets]
    answer = skin("claims", *folders, "-o", "page.md", "-o", "series.png")
    assert answer.code == 0 and not answer.err
    assert "The rule takes no reading" in answer.out
    assert (tmp_path / "page.md").read_text() == readings_page.markdown(read(folders))
    assert (tmp_path / "series.png").read_bytes().startswith(b"\x89PNG")
    refused = skin("claims", *folders, "-o", "table.csv")
    assert refused.code == 2 and refused.err.startswith("error: output table.csv: its name must")


def test_the_page_on_readings_is_what_the_command_writes():
    folders = [DATA, *sorted((DATA / "readings").iterdir())]
    said = "skin claims docs/data docs/data/readings/* -o docs/readings.md"
    assert readings_page.markdown(read(folders)) == text("readings.md"), said
