"""The tables of docs/compatibility.md, made from the table of commands.

``python -m tests.compatibility.page`` puts them into the page.
"""

import re
import tomllib
from collections import Counter
from itertools import groupby
from pathlib import Path

from tests.compatibility.tries import FAMILIES, Row, table

PAGE = Path(__file__).resolve().parents[2] / "docs" / "compatibility.md"
BEGIN, END = "<!-- tables: tests/compatibility/page.py -->\n", "<!-- end of the tables -->\n"


def tables() -> str:
    """How many commands there are, and one table of each family."""
    results = Counter(row.result for row in table())
    counts = ", ".join(f"{n} {result}" for result, n in results.most_common())
    parts = [f"{results.total()} commands: {counts}.\n\n"]
    for family, rows in groupby(table(), key=lambda row: row.family):
        title = tomllib.loads(FAMILIES[family].read_text("utf-8"))["title"]
        parts.append(f"### {title}\n\n| command | result | |\n| --- | --- | --- |\n")
        parts += [f"| {' | '.join(cells(row))} |\n" for row in rows]
        parts.append("\n")
    return "".join(parts)


def cells(row: Row) -> tuple[str, str, str]:
    """Command, result, and what there is to know of it."""
    name, remark = re.fullmatch(r"([^(]+?)(?: \((.+)\))?", row.command).groups()
    command = ", ".join(f"`{part}`" for part in name.split(", "))
    if remark:
        command += f" ({remark})"
    told = row.works or row.documented or f'"{row.refused}"'
    return command, row.result, f"{told}; {row.says}" if row.says else told


def whole(text: str) -> str:
    """The page with the tables of now."""
    before, rest = text.split(BEGIN)
    return before + BEGIN + "\n" + tables() + END + rest.split(END)[1]


if __name__ == "__main__":
    PAGE.write_text(whole(PAGE.read_text("utf-8")), "utf-8")
