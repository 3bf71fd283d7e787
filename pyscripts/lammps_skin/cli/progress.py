"""Progress of what takes long: a bar in a terminal, a line now and then in a file."""

from __future__ import annotations

import time
from typing import Self

from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar

from lammps_skin.cli.output import console, duration

LINES = 10  # of a whole, at least
SILENCE = 600.0  # seconds at most between lines


class Progress:
    """Shows how much of a whole is done; a context manager.

    Parameters
    ----------
    total, start : float
        The whole, and what of it was done before.
    """

    def __init__(self, total: float, start: float = 0.0) -> None:
        self._total, self._start = total, start
        self._began = self._told_at = time.monotonic()
        self._told = start
        self._bar: Bar | None = None
        if console.is_interactive:
            columns = (TextColumn("{task.fields[news]}", markup=False), BarColumn(bar_width=12))
            self._bar = Bar(*columns, TimeRemainingColumn(), console=console)
            self._task = self._bar.add_task("", total=total, news="")
            self._bar.update(self._task, completed=start)

    def __enter__(self) -> Self:
        if self._bar:
            self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar:
            self._bar.stop()

    @property
    def seconds(self) -> float:
        """Since the beginning."""
        return time.monotonic() - self._began

    def show(self, done: float, news: str) -> None:
        """So much of the whole is done; in a file, a line for each tenth of what there was to do.

        What is left takes as long as the same amount has taken since the start.
        """
        if self._bar:
            self._bar.update(self._task, completed=done, news=news)
            return
        ahead, now = self._total - self._start, time.monotonic()
        if done - self._told < ahead / LINES * (1 - 1e-9) and now - self._told_at < SILENCE:
            return
        self._told, self._told_at = done, now
        share = done / self._total if self._total > 0 else 1.0
        since = done - self._start
        rest = self.seconds * (self._total - done) / since if since > 0 else 0.0
        console.print(f"{news}; {share:.0%}" + (f", {duration(rest)} to go" if rest else ""))
        console.file.flush()
