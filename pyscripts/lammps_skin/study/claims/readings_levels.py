"""Levels of readings: of their papillae and cells, against bending stiffness, in long runs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from lammps_skin.analysis.statistics import Mean, mean
from lammps_skin.arrays import Floats
from lammps_skin.study.claims.catalogue import ND_EARLY, ND_LATE
from lammps_skin.study.claims.readings import STIFFNESS, Reading
from lammps_skin.study.claims.report import interval, level
from lammps_skin.study.claims.tables import END, LATER, Ensemble
from lammps_skin.study.ranges import Window
from lammps_skin.study.tradeoff.report import markdown_table

BLOCK = 100.0  # of long runs: what changes its sign within it is noise
SCENES_OF_ND = ("nd-b", "nd-d")


class Level(NamedTuple):
    """What is measured in a scene: the mean of a column, or less that of another one.

    Attributes
    ----------
    title, scene, column, other : str
    window : Window, optional
        The late one if none is given.
    """

    title: str
    scene: str
    column: str
    other: str = ""
    window: Window | None = None

    def of(self, one: Reading) -> Mean:
        """With its interval over seeds; NaN if the reading lacks the scene or the column."""
        ensemble = one.ensembles.get(self.scene)
        if not ensemble or self.column not in (ensemble.table.dtype.names or ()):
            return mean(np.array([]))
        return level(ensemble, self.column, self.window or ensemble.late, self.other)

    def above(self, readings: Sequence[Reading]) -> str:
        """In how many readings the whole interval is above 0."""
        return f"{sum(self.of(one).low > 0 for one in readings)} of {len(readings)} readings"


TISSUE = tuple(
    Level(title, "ring", column, other)
    for title, column, other in (
        ("TA cells", "ta", ""), ("papillae", "papillae", ""),
        ("width in cells", "papilla_width_cells", ""), ("height", "papilla_height", ""),
        ("membrane area / box", "membrane_area", ""), ("chi_H", "chi_H", ""), ("zeta", "zeta", ""),
        ("on tips, less TA cells", "stem_on_tips", "stem_tips_expected"),
    )
)  # fmt: skip
"""Of the ring scene."""


def of_nd(scene: str) -> tuple[Level, ...]:
    """What the claims on ND cells are about: of these less of stem cells."""
    return (
        Level("chi_H", scene, "chi_H_nd", "chi_H"),
        Level("on tips, less TA cells", scene, "nd_on_tips", "nd_tips_expected"),
        Level("sigma", scene, "sigma_nd", "sigma"),
        Level(f"zeta, {ND_EARLY}", scene, "zeta_nd", "zeta", ND_EARLY),
        late_nd(scene),
    )


def late_nd(scene: str) -> Level:
    """How much higher ND cells are than stem cells at last."""
    return Level(f"zeta, {ND_LATE}", scene, "zeta_nd", "zeta", ND_LATE)


def _table(
    heads: Sequence[str], readings: Iterable[tuple[Reading, list[str]]], found: Sequence[Level]
) -> str:
    """A row for each reading: its first cells, then levels."""
    rows = [[*first, *(interval(one.of(reading)) for one in found)] for reading, first in readings]
    return markdown_table([*heads, *(one.title for one in found)], rows)


def levels(readings: Sequence[Reading]) -> Iterator[str]:
    """Paragraphs and tables on the ring, and on ND cells in two scenes."""
    ring = [one for one in readings if "ring" in one.ensembles]
    if ring:
        late = ring[0].ensembles["ring"].late
        parts = [
            f"{one.title} is above 0 with {one.above(ring)}"
            for one in TISSUE if one.title in ("chi_H", "zeta")
        ]  # fmt: skip
        yield f"In the ring scene, over t = {late}, {' and '.join(parts)}."
        yield _table(["reading"], [(one, [one.name]) for one in ring], TISSUE)
    for scene in SCENES_OF_ND:
        those = [one for one in readings if scene in one.ensembles]
        if those:
            yield (
                f"ND cells less stem cells in {scene}: late, over t = {ND_LATE}, ND cells are "
                f"higher than stem cells with {late_nd(scene).above(those)}."
            )
            yield _table(["reading"], [(one, [one.name]) for one in those], of_nd(scene))


# ---- bending stiffness


def stiffness(series: Sequence[Reading], figure: str) -> Iterator[str]:
    """Paragraphs and tables on readings that differ in their bending stiffness."""
    values = [f"{one.scene.membrane.bending_stiffness:g}" for one in series]
    number, width = TISSUE[1], TISSUE[2]
    changes = [
        f"{words} goes from {interval(one.of(series[0]))} to {interval(one.of(series[-1]))}"
        for words, one in (("the number of papillae", number), ("their mean width in cells", width))
    ]
    yield (
        f"From a bending stiffness of {values[0]} to {values[-1]}, {' and '.join(changes)}. "
        f"All else is as in {series[0].name}. The ring scene:"
    )
    heads = [f"`{STIFFNESS}`", "seeds"]

    def first(scene: str) -> list[tuple[Reading, list[str]]]:
        return [
            (one, [value, str(one.ensembles[scene].seeds)])
            for one, value in zip(series, values, strict=True) if scene in one.ensembles
        ]  # fmt: skip

    yield _table(heads, first("ring"), TISSUE)
    nd = [one for one, _ in first("nd-b")]
    if nd:
        yield (
            f"ND cells less stem cells in nd-b: late, ND cells are higher than stem cells with "
            f"{late_nd('nd-b').above(nd)}. The verdicts on claims 7 to 9 are from nd-b alone:"
        )
        rows = [
            (one, [*cells, *(found.word for found in one.alone(["nd-b"]).verdicts[6:9])])
            for one, cells in first("nd-b")
        ]
        yield _table([*heads, "claim 7", "claim 8", "claim 9"], rows, of_nd("nd-b"))
    yield f"![Papillae, stem and ND cells against bending stiffness]({figure})"


# ---- long runs


def long_runs(readings: Sequence[Reading]) -> Iterator[str]:
    """Paragraphs and a table on runs that are longer than those of the paper."""
    all_runs = [(one, ensemble) for one in readings for ensemble in one.ensembles.values()]
    for one, ensemble in all_runs:
        if "zeta_nd" in (ensemble.table.dtype.names or ()) and ensemble.scene.startswith("nd-"):
            yield _who_is_higher(one, ensemble)
    heads = ["reading", "scene", "seeds", "t", "TA cells", "none below", "papillae", "chi_H"]
    rows = []
    for one, ensemble in all_runs:
        for window in windows(LATER, ensemble.end, LATER):
            found = [level(ensemble, c, window) for c in ("ta", "none_below", "papillae", *ORDERS)]
            if ensemble.scene.startswith("nd-"):
                found.append(level(ensemble, "zeta_nd", window, "zeta"))
            rows.append([
                one.name, ensemble.scene, str(ensemble.seeds), str(window), *map(interval, found),
                *[""] * (not ensemble.scene.startswith("nd-")),
            ])  # fmt: skip
    yield markdown_table([*heads, "zeta", "zeta_nd - zeta"], rows)


ORDERS = ("chi_H", "zeta")


def windows(start: float, end: float, length: float) -> list[Window]:
    """Windows of a length from start to end."""
    starts = np.arange(start, end - length + 1e-9, length)
    return [Window(float(start), float(start) + length) for start in starts]


def _who_is_higher(one: Reading, ensemble: Ensemble) -> str:
    above = higher(ensemble)
    share = mean(above.mean(axis=0), fraction=True)
    spells = ", ".join(f"{longest(column) * BLOCK:g}" for column in above.T)
    return (
        f"{one.name}, {ensemble.scene}: after t = {END:g} ND cells are higher than stem cells for "
        f"a fraction of {interval(share)} of the time, in means over {BLOCK:g}. They stay so for "
        f"at most {spells} in each of {ensemble.seeds} seeds."
    )


def higher(one: Ensemble) -> Floats:
    """Whether (b, s) ND cells are higher than stem cells: 1 or 0 in blocks of time, by seed."""
    blocks = windows(END, one.end, BLOCK)
    apart = [one.mean("zeta_nd", block) - one.mean("zeta", block) for block in blocks]
    return np.where(np.array(apart) > 0, 1.0, 0.0)


def longest(flags: Floats) -> int:
    """Length of the longest sequence of ones in flags (n,)."""
    most = run = 0
    for flag in flags:
        run = run + 1 if flag else 0
        most = max(most, run)
    return most
