"""The map of a scene as tables: rows, CSV, Markdown."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from lammps_skin.errors import SkinError
from lammps_skin.files import atomic_write
from lammps_skin.study.stability.bisection import Limit
from lammps_skin.study.stability.methods import Method
from lammps_skin.study.tradeoff.report import Text, csv_text, markdown_table, number


class Row(NamedTuple):
    """The limit of one method at one point of the map.

    Attributes
    ----------
    varied : str
        What of the scene is scaled, a key of `methods.SCALED`.
    factor : float
    method : str
    limit : float
        The longest stable timestep; 0 if not even the shortest that was tried is stable.
    unstable : float
        The shortest unstable timestep; infinite if not even the longest that was tried is one.
    monotone : bool
        Whether nothing longer than that was stable.
    estimate_begin, estimate_end : float
        From the largest eigenvalue in the state, and at the end of the run from there.
    eigenvalue_begin, eigenvalue_end : float
    problem : str
        Of the run with the shortest unstable timestep.
    """

    varied: str
    factor: float
    method: str
    limit: float
    unstable: float
    monotone: bool
    estimate_begin: float
    estimate_end: float
    eigenvalue_begin: float
    eigenvalue_end: float
    problem: str

    @property
    def text(self) -> str:
        """The limit in a few characters: with a sign where it is a bound, with ? where unsure."""
        if not self.limit:
            return f"< {number(self.unstable, 2)}"
        sign = "≥ " if self.unstable == math.inf else ""
        return sign + number(self.limit, 2) + ("" if self.monotone else "?")


def row(
    varied: str, factor: float, method: Method, limit: Limit, eigenvalues: Sequence[float]
) -> Row:
    """The row of a limit and the largest eigenvalues at begin and end."""
    begin, end = eigenvalues
    failed = limit.unstable
    return Row(
        varied, factor, method.name, limit.timestep, failed.timestep if failed else math.inf,
        limit.monotone, method.estimate(begin), method.estimate(end), begin, end,
        failed.problem if failed else "",
    )  # fmt: skip


def rows_table(rows: Iterable[Row]) -> Text:
    """Limits by what is varied and method, with the estimates at begin and end."""
    names = ["varied", "factor", "method", "limit", "estimate", "at the end", "why not longer"]
    cells = [
        [
            row.varied, f"{row.factor:g}", row.method, row.text, number(row.estimate_begin, 2),
            number(row.estimate_end, 2), short(row.problem),
        ]
        for row in rows
    ]  # fmt: skip
    return names, cells


# words of an error, and what they come to in a table
CAUSES = {
    "energy": "energy", "inverted": "triangle inverted", "breaks through": "cell through membrane",
    "is unstable": "no number", "link of": "link too long", "missing": "link too long",
    "lost": "particle lost", "leaves the box": "particle lost", "istance": "pair too close",
}  # fmt: skip


def short(problem: str) -> str:
    """The cause of an instability in a word or two."""
    return next((cause for words, cause in CAUSES.items() if words in problem), problem[:40])


def write(rows: Sequence[Row], title: str, notes: Sequence[str], folder: Path) -> list[Path]:
    """Write TITLE.csv and TITLE.md."""
    page = "\n\n".join([f"# {title}", *notes, markdown_table(*rows_table(rows))]) + "\n"
    contents = {
        folder / f"{title}.csv": csv_text(row._asdict() for row in rows),
        folder / f"{title}.md": page,
    }
    try:
        for path, content in contents.items():
            with atomic_write(path) as place:
                place.write_text(content, "utf-8")
    except OSError as error:
        raise SkinError(f"table {path}: {error.strerror}") from None
    return list(contents)
