"""How subcommands print: the console, tables, durations."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich.console import Console, ConsoleOptions, RenderableType
from rich.measure import Measurement
from rich.segment import Segment
from rich.table import Table

from lammps_skin.errors import printable
from lammps_skin.text import counted as counted

GAP = 2  # between the columns of a table
WIDEST = 200  # of tables that do not fold, also where the terminal is narrower


class PlainConsole(Console):
    """Console to which nothing that is printed is markup or gives orders to the terminal."""

    def __init__(self) -> None:
        super().__init__(markup=False, highlight=False, emoji=False, soft_wrap=True)

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Segments without what is not printable, but for the console's own orders."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=printable(segment.text))


console = PlainConsole()


def print_table(
    heads: Sequence[str], rows: Iterable[Sequence[str]], whole: Sequence[int] = (),
    right: bool = False, fold: bool = False,
) -> None:  # fmt: skip
    """Print a table after an empty line; nothing without rows.

    Parameters
    ----------
    heads, rows : headings of the columns, and cells
    whole : sequence of int
        Columns whose cells are never broken.
    right : bool
        All columns but the first are numbers, flush right.
    fold : bool
        Break long cells into lines rather than be wider than the terminal, or 80 columns.
    """
    table = Table(box=None, pad_edge=False)
    for n, title in enumerate(heads):
        table.add_column(
            title, justify="right" if right and n else "left", overflow="fold",
            no_wrap=n in whole or not fold,
        )  # fmt: skip
    for row in rows:
        table.add_row(*row)
    if not table.row_count:
        return
    if not fold:
        table.width = Measurement.get(console, console.options.update(width=WIDEST), table).maximum
    console.print()
    console.print(table)


def print_parts(heads: Sequence[str], rows: Sequence[Sequence[str]], repeated: int) -> None:
    """Print a table as some below each other, none wider than the terminal, if that is possible.

    Cells are not broken. The first columns, as many as `repeated`, are in each of them.
    """
    widths = [max(map(len, column)) + GAP for column in zip(heads, *rows, strict=True)]
    room = console.width + GAP - sum(widths[:repeated])
    parts: list[list[int]] = [[]]
    for n in range(repeated, len(heads)):
        if parts[-1] and sum(widths[one] for one in parts[-1]) + widths[n] > room:
            parts.append([])
        parts[-1].append(n)
    for part in parts:
        chosen = [*range(repeated), *part]
        print_table([heads[n] for n in chosen], [[row[n] for n in chosen] for row in rows])


def duration(seconds: float) -> str:
    """Seconds in the unit in which they are read most easily."""
    for limit, unit, name in ((120, 1, "s"), (7200, 60, "min"), (172_800, 3600, "h")):
        if seconds < limit:
            return f"{seconds / unit:.3g} {name}"
    return f"{seconds / 86_400:.3g} days"
