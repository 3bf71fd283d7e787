"""``skin watch``: a run as it goes on, in the terminal and in a browser."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Group
from rich.live import Live
from rich.table import Table

from lammps_skin.cli.output import console, duration

if TYPE_CHECKING:
    from lammps_skin.report.server import PageServer
    from lammps_skin.report.watched import Look

SHOWN = ("coverage", "none_below", "chi_H", "zeta")
BARS, WIDTH = "▁▂▃▄▅▆▇█", 28  # with titles and numbers in 80 columns


def watch(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Directory of a run that goes on.")],
    browser: Annotated[
        bool, typer.Option("--browser", help="Serve the page of `skin report`, for this machine.")
    ] = False,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Of the page [default: any that is free].")
    ] = 0,
    every: Annotated[float, typer.Option(min=0.1, help="Seconds between two looks.")] = 2.0,
) -> None:
    """Watch a run as it goes on: numbers in the terminal, or the page in a browser as well."""
    from lammps_skin.report.watched import Watched  # MDAnalysis takes a second to import

    try:
        watched = Watched(run)
        look = watched.look()
        if not console.is_interactive and not browser:
            console.print(_shown(run, look))
            return
        with _served(run, port) if browser else nullcontext() as page:
            if page:
                console.print(f"{page.address} (control-C ends it)")
            with Live(console=console, auto_refresh=False) as live:
                while True:
                    live.update(_shown(run, look), refresh=True)
                    if look.ended and not page:
                        return
                    time.sleep(every)
                    look = watched.look()
                    if page:
                        page.refresh(len(look.table))
    except KeyboardInterrupt:
        return


def _served(run: Path, port: int) -> PageServer:
    from lammps_skin.report.server import PageServer

    with console.status("making the page"):
        return PageServer(run, port)


def _shown(run: Path, look: Look) -> Group:
    """All that the terminal shows."""
    table = Table(box=None, pad_edge=False, show_header=False)
    for justify in ("left", "left", "right"):
        table.add_column(justify=justify, no_wrap=True)
    for title, values in _statistics(look):
        table.add_row(title, sparkline(values), _number(values[-1]))
    removals = ", ".join(f"{number:,} {cause}" for cause, number in look.removals.items()) or "0"
    frame = f"last frame t = {look.table['time'][-1]:g}"
    return Group(
        f"{look.scene.name} in {run}: {_progress(look)}",
        table,
        f"births {look.births:,}; removals {removals}; {frame}; {_checkpoint(look)}",
    )


def _progress(look: Look) -> str:
    reached = f"t = {look.time:.6g} of {look.scene.end_time:g}"
    if look.ended:
        return f"{reached}, {'ended' if look.time >= look.scene.end_time else 'not running'}"
    if math.isnan(look.seconds_left):
        return f"{reached}, running"
    return f"{reached}, {look.speed:.3g} t/s, {duration(look.seconds_left)} to go"


def _checkpoint(look: Look) -> str:
    if math.isnan(look.checkpoint):
        return "no checkpoint yet"
    return f"last checkpoint t = {look.checkpoint:g}"


def _statistics(look: Look) -> Iterator[tuple[str, list[float]]]:
    """Titles and values over the frames; of kinds of cells, those that there have been."""
    from lammps_skin.analysis.labels import label

    for kind in look.scene.kinds_of_cells:
        numbers = look.table[kind.label].tolist()
        if any(numbers):
            yield f"{kind.name} cells", numbers
    for name in SHOWN:
        yield label(name).text, look.table[name].tolist()


def sparkline(values: Sequence[float], width: int = WIDTH) -> str:
    """Values as bars, the last of each of so many parts; a blank where there is none."""
    parts = min(len(values), width)
    last = [values[(n + 1) * len(values) // parts - 1] for n in range(parts)]
    known = [value for value in last if not math.isnan(value)]
    low, high = min(known, default=0.0), max(known, default=0.0)

    def bar(value: float) -> str:
        if math.isnan(value):
            return " "
        share = (value - low) / (high - low) if high > low else 0.0
        return BARS[round(share * (len(BARS) - 1))]

    return "".join(map(bar, last))


def _number(value: float) -> str:
    if math.isnan(value):
        return "-"
    return f"{value:,.0f}" if value == round(value) else f"{value:.3g}"
