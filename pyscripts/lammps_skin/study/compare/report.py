"""Conditions side by side, as tables: for the terminal, as Markdown, CSV and JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lammps_skin.analysis.statistics import Mean
from lammps_skin.analysis.summary import without_nan
from lammps_skin.study.claims.report import write_text
from lammps_skin.study.compare.comparison import Row, compare, remarks
from lammps_skin.study.compare.conditions import Condition, differences
from lammps_skin.study.ranges import Window
from lammps_skin.study.tradeoff.report import Text, csv_text, markdown_table, number

LEAST_CHANCE = 0.001  # that is written out
MOST_SEEDS = 1000  # the same

HEAD = """\
# Conditions side by side

Made by `skin compare`. Values are means over seeds of the mean over a window of time; births and
deaths are counted during it. Brackets hold intervals at 95 %. A difference is that from the first
condition. "seeds needed" is how many seeds of each would show a difference of the size seen, and
one of half a standard deviation over seeds, with a probability of 80 %."""


class Report(NamedTuple):
    """What is known of conditions, and how they differ."""

    conditions: Sequence[Condition]
    rows: Sequence[Row]

    @classmethod
    def of(
        cls, conditions: Sequence[Condition], columns: Sequence[str], windows: Sequence[Window]
    ) -> Report:
        """See `comparison.compare`."""
        return cls(conditions, compare(conditions, columns, windows))

    @property
    def settings(self) -> list[str]:
        """What was compared: the conditions, in words, and in what their scenes differ."""
        names = (f"{one.name} (seeds: {one.seeds}, to t = {one.end:g})" for one in self.conditions)
        return [", ".join(names), *differences(self.conditions)]

    @property
    def remarks(self) -> list[str]:
        """How to read the table."""
        return remarks(self.conditions, self.rows)


def table(rows: Iterable[Row]) -> Text:
    """A line for each column, window and condition."""
    heads = [
        "column", "t", "condition", "seeds", "mean", "difference", "p", "corrected",
        "seeds needed",
    ]  # fmt: skip
    cells = []
    former: tuple[str, Window] | None = None
    for row in rows:
        place = row.column, row.window
        again = place == former
        former = place
        apart = row.difference
        cells.append([
            "" if again else row.column, "" if again else str(row.window), row.condition,
            str(row.value.n), _interval(row.value), _interval(apart.value) if apart else "",
            _chance(apart.chance) if apart else "", _chance(row.corrected) if apart else "",
            f"{_seeds(apart.needed)}, {_seeds(apart.needed_usual)}" if apart else "",
        ])  # fmt: skip
    return heads, cells


def _interval(value: Mean) -> str:
    middle, low, high = (number(one) for one in (value.value, value.low, value.high))
    return middle if np.isnan(value.low) else f"{middle} [{low}, {high}]"


def _chance(value: float) -> str:
    return f"< {LEAST_CHANCE:g}" if value < LEAST_CHANCE else number(value, 2)


def _seeds(needed: float) -> str:
    return f"> {MOST_SEEDS}" if needed > MOST_SEEDS else number(needed, 6)


# ---- files


def markdown(report: Report) -> str:
    """The page: what was compared, the table, how to read it."""
    said, told = (
        "\n".join(f"* {line}" for line in lines) for lines in (report.settings, report.remarks)
    )
    parts = [HEAD, said, markdown_table(*table(report.rows)), told]
    return "\n\n".join(filter(None, parts)) + "\n"


def _record(row: Row) -> dict[str, Any]:
    apart = row.difference
    value = apart.value if apart else Mean(np.nan, np.nan, np.nan, np.nan, 0)
    return {
        "column": row.column, "start": row.window.start, "end": row.window.end,
        "condition": row.condition, "seeds": row.value.n, "mean": row.value.value,
        "low": row.value.low, "high": row.value.high, "difference": value.value,
        "difference_low": value.low, "difference_high": value.high,
        "test": apart.test if apart else "", "p": apart.chance if apart else np.nan,
        "p_corrected": row.corrected, "needed": apart.needed if apart else np.nan,
        "needed_half_sd": apart.needed_usual if apart else np.nan,
    }  # fmt: skip


def _csv(report: Report) -> str:
    return csv_text(map(_record, report.rows))


def _json(report: Report) -> str:
    data = {
        "conditions": [
            {"name": one.name, "path": str(one.path), "seeds": sorted(one.by_seed), "end": one.end}
            for one in report.conditions
        ],
        "settings": report.settings, "remarks": report.remarks,
        "rows": [_record(row) for row in report.rows],
    }  # fmt: skip
    return json.dumps(without_nan(data), indent=1, allow_nan=False) + "\n"


FORMATS = {".md": markdown, ".csv": _csv, ".json": _json}


def write(report: Report, path: Path) -> None:
    """Write a comparison in the format that the suffix of the name says, one of `FORMATS`."""
    write_text(path, FORMATS[path.suffix](report))
