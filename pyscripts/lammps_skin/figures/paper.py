"""The figures of the paper: what each shows, which runs it needs, and how it is drawn."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure

from lammps_skin.analysis.observables import ORDERS, Table, read_table
from lammps_skin.errors import FigureError, SkinError
from lammps_skin.figures.gallery import draw_run, draw_scenes
from lammps_skin.figures.look import mean_cycle
from lammps_skin.figures.moments import last_time
from lammps_skin.figures.potential_curves import draw_potentials
from lammps_skin.figures.time_courses import TISSUE, draw_courses, draw_stem_and_nd
from lammps_skin.model.scene import Scene
from lammps_skin.study.ensemble import Member, member_of, members, with_seed

ARRANGEMENTS = ("ring", "cluster", "random")
WITH_ND = ("nd-a", "nd-b", "nd-c", "nd-d")
SEEDS = range(1, 9)  # of a scene without a table, if the user gives none
OF_THE_COMMAND = Path("runs")  # where `skin run` puts its runs


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper.

    Attributes
    ----------
    title : str
    scenes : tuple of str
        Built-in scenes that it shows, by their names without the size.
    of : str
        What it needs of each: the "table" of observables of several seeds, the directory of a
        "run" with its trajectory, or "nothing".
    draw : callable
        Makes the figure of a mapping from scenes to tables or directories, and of the mean time of
        a cell cycle, the unit of time in print.
    """

    title: str
    scenes: tuple[str, ...]
    of: Literal["table", "run", "nothing"]
    draw: Callable[[Mapping[str, Any], float | None], Figure]


FIGURES = {
    1: PaperFigure("the potentials", (), "nothing", lambda *_: draw_potentials()),
    2: PaperFigure(
        "snapshots of the ring run: stem cells, stem and TA cells", ("ring",), "run",
        lambda runs, _: draw_run(runs["ring"]),
    ),
    3: PaperFigure(
        "chi_H, chi_G, zeta and sigma for ring, cluster and random", ARRANGEMENTS, "table",
        lambda tables, cycle: draw_courses(tables, ORDERS, 2, cycle),
    ),
    4: PaperFigure(
        "scenes (a) to (d) of stem and ND cells, at first and at last", WITH_ND, "run",
        lambda runs, _: draw_scenes(runs),
    ),
    5: PaperFigure(
        "chi_H, chi_G, zeta and sigma of stem and of ND cells", WITH_ND, "table",
        lambda tables, cycle: draw_stem_and_nd(tables, ORDERS, cycle),
    ),
    6: PaperFigure(
        "numbers of cells, coverage, height and papillae", ARRANGEMENTS, "table",
        lambda tables, cycle: draw_courses(tables, TISSUE, 4, cycle),
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Request:
    """A figure that is wanted of certain scenes.

    Parameters
    ----------
    number : int
    scenes : dict of str to Scene
        The scenes of the figure, by their names without the size.
    seeds : sequence of int or None
        Those wanted; None takes the seeds of a table that is there, else `SEEDS`. A figure of
        runs shows the first.
    folder : path
        Of an ensemble: its tables are used, and what is missing is run there.
    """

    number: int
    scenes: dict[str, Scene]
    seeds: Sequence[int] | None
    folder: Path

    @property
    def figure(self) -> PaperFigure:
        return FIGURES[self.number]

    @property
    def missing(self) -> list[Member]:
        """What has to be run before the figure can be drawn."""
        if self.figure.of == "run":
            shown = [self._shown(scene) for scene in self.scenes.values()]
            return [member for member in shown if run_of(member) is None]
        wanted = [member for scene in self.scenes.values() for member in self._wanted(scene)]
        return [member for member in wanted if not member.done]

    def draw(self) -> Figure:
        """The figure, once nothing is missing."""
        if self.figure.of == "run":
            found: dict[str, Any] = {
                name: run_of(self._shown(scene)) for name, scene in self.scenes.items()
            }
        else:
            found = {name: self._table(scene) for name, scene in self.scenes.items()}
        cycles = [mean_cycle(scene) for scene in self.scenes.values()]
        return self.figure.draw(found, cycles[0] if cycles else None)

    def _shown(self, scene: Scene) -> Member:
        """The run whose trajectory is shown."""
        (member,) = members([scene], list(self.seeds or SEEDS)[:1], self.folder)
        return member

    def _wanted(self, scene: Scene) -> list[Member]:
        """Runs that are not in the gathered table of a scene."""
        there = self._gathered(scene)
        if there is not None and self.seeds is None:
            return []
        wanted = members([scene], list(self.seeds or SEEDS), self.folder)
        return [m for m in wanted if there is None or m.seed not in there["seed"]]

    def _gathered(self, scene: Scene) -> Table | None:
        path = Member(scene, self.folder).gathered
        return read_table(path) if path.is_file() else None

    def _table(self, scene: Scene) -> Table:
        """Rows of the wanted seeds, from the gathered table and from runs that are not in it."""
        there = self._gathered(scene)
        parts = [] if there is None else [there]
        parts += [with_seed(read_table(m.table), m.seed) for m in self._wanted(scene)]
        if len({part.dtype.names for part in parts}) > 1:
            raise FigureError(
                f"tables of {scene.name} in {self.folder}: have different columns; move "
                f"{scene.name}.csv.gz away and gather them again with skin ensemble"
            )
        together: Table = np.concatenate(parts)
        if self.seeds is None:
            return together
        return together[np.isin(together["seed"], list(self.seeds))]


def figure_of(number: int) -> PaperFigure:
    """Figure of a number; raises `FigureError` if there is none."""
    if number not in FIGURES:
        raise FigureError(f"figure {number}: must be one of {', '.join(map(str, FIGURES))}")
    return FIGURES[number]


def run_of(member: Member) -> Path | None:
    """Directory of a complete run of a member: of the ensemble, or of `skin run`."""
    for directory in (member.directory, OF_THE_COMMAND / member.scene.name):
        try:
            same = member_of(directory, member.folder)
            left = same.scene.end_time - last_time(directory)
        except SkinError:
            continue
        wanted = (same.key, same.seed) == (member.key, member.seed)
        if wanted and left < same.scene.output.dump_interval:
            return directory
    return None
