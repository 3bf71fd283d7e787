"""docs/analysis.md names what there is."""

import re
from pathlib import Path

from lammps_skin.analysis import series
from lammps_skin.analysis.observables import COLUMNS
from lammps_skin.analysis.state import StateAnalysis

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "analysis.md").read_text("utf-8")


def first_cells(title: str) -> list[str]:
    """What stands between backticks in the first column of the table below a heading."""
    below = PAGE.split(f"## {title}\n")[1].split("\n## ")[0]
    rows = [line.split(" | ")[0] for line in below.splitlines() if line.startswith("| `")]
    return [name for row in rows for name in re.findall(r"`(\w+)`", row)]


def test_columns_of_the_table():
    assert first_cells("Table of observables") == list(COLUMNS)


def test_classes_and_their_results():
    classes = {
        name: value
        for name, value in vars(series).items()
        if isinstance(value, type) and issubclass(value, StateAnalysis) and value.columns
    }
    assert first_cells("Single observables") == list(classes)
    for name, found in classes.items():
        (row,) = (line for line in PAGE.splitlines() if line.startswith(f"| `{name}` |"))
        assert re.findall(r"`(\w+)`", row)[1:] == list(found.columns)
