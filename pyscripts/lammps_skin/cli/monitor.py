"""A run as it is watched: progress bar, what is known of the cells, what has happened."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from lammps_skin.analysis.basal_layer import number_below, remark
from lammps_skin.analysis.coverage import count_by_kind, coverage
from lammps_skin.cli.output import counted
from lammps_skin.cli.progress import Progress
from lammps_skin.engine.engine import Motion
from lammps_skin.event_log import ADDITION, BIRTH, COLUMNS, LEAVING, by_intervention
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.run.simulation import Simulation

# fractions of the particles that move beyond the neighbor lists: what is told of, and what is too
# much. With the level "fast", whose ensembles are compared in docs/accuracy.md, it is 0.0017
NOTEWORTHY, TOO_MUCH = 1e-4, 5e-3
PIECES = 200  # of a run at least: how often the bar moves


class RunMonitor:
    """A run of a simulation up to a time, by default its scene's end time.

    Attributes
    ----------
    time : float
        Time reached, also after a failure.
    counts : dict of Kind to int
        Living cells by kind at that time.
    births, removals : int
    """

    def __init__(self, simulation: Simulation, until: float | None) -> None:
        self._simulation = simulation
        self._start = simulation.time
        self._end = simulation.scene.end_time if until is None else until
        self._first_id = simulation.next_id()
        self._first_cells = int(is_cell(simulation.types()).sum())
        self._ranks = counted(simulation.ranks, "rank")
        self._tissue: list[str] = []
        self._motion: Motion | None = None
        self._particles = 0
        self.births = 0
        self._look(self._start)

    def go(self) -> None:
        """Run, and show progress."""
        # LAMMPS computes energies at each end of a piece: mostly where it would anyway
        thermo_interval = self._simulation.scene.output.thermo_interval
        every = min(thermo_interval, (self._end - self._start) / PIECES)
        begins = self._simulation.scene.begins
        with Progress(self._end - begins, self._start - begins) as progress:

            def show(time: float, _: Simulation) -> None:
                self._look(time)
                speed = (time - self._start) / max(progress.seconds, 1e-9)
                reached = f"t = {round(time, 6):.6g} of {self._end:g}"
                cells = f"{self.living()} +{self.births} -{self.removals}"
                progress.show(time - begins, f"{reached}  {cells}  {speed:.3g} t/s  {self._ranks}")

            try:
                self._simulation.run(self._end, progress=show, every=every)
            finally:
                if self._simulation.sound:
                    self._look(self._simulation.time)
        self._tissue = list(self._said_of_tissue())
        self._motion = self._simulation.motion()
        self._particles = len(self._simulation.forces().ids)

    def _look(self, time: float) -> None:
        """Cells by kind; new ones from the next id, since they are given in turn, never again."""
        types = self._simulation.types()
        self.time = time
        self.counts = count_by_kind(types, self._simulation.scene.kinds_of_cells)
        self.births = self._simulation.next_id() - self._first_id
        self.removals = self._first_cells + self.births - int(is_cell(types).sum())

    def _said_of_tissue(self) -> Iterator[str]:
        """How much of the membrane is covered, and a remark if it is so by more than one layer."""
        scene, state = self._simulation.scene, self._simulation.forces()
        cells = state.positions[is_cell(state.types)]
        if not len(cells):
            return
        membrane, box = state.positions[state.types == Kind.MEMBRANE], scene.box_sides[:2]
        covered = coverage(membrane, cells, box, scene.cells.adhesion_range * scene.contact)
        yield f"{covered:.0%} of the membrane within reach of a cell"
        alone = number_below(cells, box, scene.cells.radius) == 0
        if line := remark(self.time, covered, float(alone.mean())):
            yield line

    def living(self) -> str:
        """Numbers of living cells by kind."""
        cells = (f"{count} {kind.name}" for kind, count in self.counts.items() if count)
        return ", ".join(cells) or "no cells"

    def lines(self, log: Path) -> Iterator[str]:
        """What has happened; the event log also has what came and went between two looks."""
        done: dict[str, str] = {}
        if log.exists():
            rows = (row.split(",") for row in log.read_text("utf-8").splitlines()[1:])
            whole = [row for row in rows if len(row) == len(COLUMNS)]
            kinds, causes = [row[1] for row in whole], [row[-1] for row in whole]
            self.births = max(self.births - kinds.count(ADDITION), kinds.count(BIRTH))
            self.removals = max(self.removals, sum(kind in LEAVING for kind in kinds))
            done = by_intervention(kinds, causes)
        happened = counted(self.births, "birth"), counted(self.removals, "removal")
        yield f"{self.living()}; {', '.join(happened)}"
        for name, what in done.items():
            yield f"{name}: {what}"
        yield from self._tissue
        if self._motion and self._motion.steps and (self._motion.divided or self._motion.lowered):
            divided = self._motion.divided / self._motion.steps
            slowed = self._motion.lowered
            yield f"{divided:.2%} of the steps divided, {slowed:.2%} of the particles slowed"
        if self._motion and self._beyond() > NOTEWORTHY:
            yield (
                f"{self._beyond():.2%} of the particles moved beyond the neighbor lists within a "
                f"step: {self._verdict()}"
            )

    def _verdict(self) -> str:
        """What particles beyond the neighbor lists mean for a run."""
        if self._beyond() <= TOO_MUCH:
            return (
                f"the run is valid, up to {TOO_MUCH:.2%} their contacts are seen soon enough "
                "(docs/accuracy.md)"
            )
        return (
            f"the run is not valid, above {TOO_MUCH:.2%} contacts are missed; repeat it with a "
            "larger numerics.neighbor_skin or a shorter numerics.timestep"
        )

    def _beyond(self) -> float:
        """Fraction of particles that the neighbor lists did not reach, in the mean."""
        assert self._motion
        within = self._motion.evaluations - self._motion.steps
        return self._motion.beyond_lists / max(within * self._particles, 1.0)
