"""Seeds and windows of time, as they are given in a line of text."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from lammps_skin.errors import SceneError

MOST_SEEDS = 10_000


class Window(NamedTuple):
    """Times from start to end, both included."""

    start: float
    end: float

    def __str__(self) -> str:
        return f"{self.start:g}-{self.end:g}" if self.start < self.end else f"{self.start:g}"

    def holds_frame(self, interval: float) -> bool:
        """Whether one of the frames at multiples of an interval is in it."""
        last = interval * math.floor(self.end / interval * (1 + 1e-12))
        return last >= self.start * (1 - 1e-12)


def seeds_of(text: Any, key: str = "--seeds ") -> list[int]:
    """Seeds of a list of numbers and ranges; `SceneError` begins with the key and the text."""
    found: list[int] = []
    for part in str(text).split(","):
        first, dash, last = part.strip().partition("-")
        if not (first.isdecimal() and (last.isdecimal() or not dash)):
            raise SceneError(f"{key}{text}: must be numbers and ranges, such as 1-8 or 1,3,5-7")
        begin, end = int(first), int(last or first)
        if not 1 <= begin <= end < begin + MOST_SEEDS:
            raise SceneError(
                f"{key}{text}: {part.strip()} must ascend from at least 1, and hold no more "
                f"than {MOST_SEEDS:,} seeds"
            )
        found += range(begin, end + 1)
    return sorted(set(found))


def windows_of(text: Any, end: float, key: str = "--windows ") -> list[Window]:
    """Windows of a list of ranges; without one, before and long after crowding at t = 300."""
    if text is None:
        return [Window(0.3 * end, 0.6 * end), Window(0.8 * end, end)]
    found = []
    for part in str(text).split(","):
        first, _, last = part.partition("-")
        try:
            window = Window(float(first), float(last))
        except ValueError:
            window = Window(0.0, -1.0)
        if not 0 <= window.start < window.end <= end:
            raise SceneError(
                f"{key}{text}: {part} must be two times such as 300-600, ascending, up to "
                f"the end time, {end:g}"
            )
        found.append(window)
    return found
