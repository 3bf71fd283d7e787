"""A scene in LAMMPS, driven from Python."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Self

from lammps_skin.arrays import Floats, Ints
from lammps_skin.engine.built import check_data, load_built
from lammps_skin.engine.engine import Cells, Forces, Motion
from lammps_skin.engine.rank_count import open_engine
from lammps_skin.engine.world import check_alone
from lammps_skin.errors import SceneError, SimulationError, SkinError
from lammps_skin.model.changes import Change, changes
from lammps_skin.model.scene import Scene
from lammps_skin.model.stiffness import longest_timestep
from lammps_skin.model.terms import Terms
from lammps_skin.run.checkpoints import PART, Checkpoints, find_resumption
from lammps_skin.run.directory_lock import DirectoryLock
from lammps_skin.run.interruption import Interruption
from lammps_skin.run.provenance import Provenance
from lammps_skin.run.remedies import remedy
from lammps_skin.run.results import holds_results
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration
from lammps_skin.start.memory import check_ranks
from lammps_skin.trajectory.recorder import Recorder, set_aside_if_damaged

Progress = Callable[[float, Any], None]


class Simulation:
    """A run of a scene; a context manager that closes LAMMPS.

    `begin`, `begin_built` and `resume` make one.

    Attributes
    ----------
    scene : Scene
    directory : Path
        Where inputs and output are.
    ranks : int
        MPI ranks on which it runs.
    notes : list of str
        What was found to be damaged, after `resume`; why it has fewer ranks than would pay off.
    sound : bool
        Whether LAMMPS can go on; not after an error of a run.

    Examples
    --------
    >>> with Simulation.begin("two-cells") as simulation:
    ...     simulation.run(until=10.0)
    ...     adhesion = simulation.energies()["adhesion"]
    """

    def __init__(
        self,
        scene: Scene,
        directory: Path,
        ranks: int | None,
        threads: int,
        variables: Mapping[str, Any],
        lock: DirectoryLock,
        temporary: bool = False,
    ) -> None:
        """Open LAMMPS with the scene that is built in a directory, which is held."""
        self.scene, self.directory = scene, directory
        self.notes: list[str] = []
        self.sound = True
        self._temporary = temporary
        self._recorder = Recorder(directory, scene, variables)
        self._checkpoints = Checkpoints(directory, scene, variables)
        self._provenance = Provenance.of_run(directory, scene, variables)
        self._engine: Any = self._open(ranks, threads, variables, lock)
        # the script has done those that are due when it is read
        self._changes = [one for one in changes(scene) if self._step_of(one) > self._engine.step()]
        self._resources = ExitStack()

    @classmethod
    def begin(
        cls,
        scene: Scene | str | Path,
        directory: str | Path | None = None,
        configuration: Configuration | None = None,
        ranks: int | None = 1,
        threads: int = 1,
        variables: Mapping[str, Any] | None = None,
        replace: bool = False,
        lock: DirectoryLock | None = None,
    ) -> Self:
        """Build a scene and begin with it.

        Parameters
        ----------
        scene : Scene, str or Path
            What to simulate, or the name or file of it.
        directory : path, optional
            Where inputs and output go; a temporary folder, removed at the end, if not given.
        configuration : Configuration, optional
            Initial state; built from the scene if not given.
        ranks : int, optional
            MPI ranks; with None as many as pay off here and now.
        threads : int
            OpenMP threads of each rank.
        variables : mapping, optional
            Overrides of variables of scene.in, as ``-var`` on the command line.
        replace : bool
            Whether the results of an earlier run in `directory` may be replaced.
        lock : DirectoryLock, optional
            The directory, if it is held already; it is the caller's to close.

        Raises
        ------
        SceneError, ConfigurationError
            For what cannot be built.
        SimulationError
            When LAMMPS stops, another process runs in the directory, or it holds results of a run.
        """
        if not isinstance(scene, Scene):
            scene = Scene.load(scene)
        variables = variables or {}
        with ExitStack() as resources:  # to be closed if the simulation cannot begin
            temporary = not directory
            if not directory:
                directory = resources.enter_context(tempfile.TemporaryDirectory(prefix="skin-"))
            directory = Path(directory).resolve()
            check_run(directory, ranks, threads)
            lock = lock or resources.enter_context(DirectoryLock(directory, make=True))
            _check_replaced(directory, variables, replace)
            scene = build(scene, directory, configuration).described(scene)
            simulation = cls(scene, directory, ranks, threads, variables, lock, temporary)
            simulation._resources = resources.pop_all()
        return simulation

    @classmethod
    def begin_built(
        cls,
        directory: str | Path,
        ranks: int | None = 1,
        threads: int = 1,
        variables: Mapping[str, Any] | None = None,
        replace: bool = False,
        lock: DirectoryLock | None = None,
    ) -> Self:
        """Begin with the scene that was built in a directory, as it is; else as `begin`."""
        directory, variables = Path(directory).resolve(), variables or {}
        check_run(directory, ranks, threads)
        with ExitStack() as resources:
            lock = lock or resources.enter_context(DirectoryLock(directory))
            _check_replaced(directory, variables, replace)
            scene = load_built(directory)
            check_data(directory / "skin.data", scene.kinds)
            simulation = cls(scene, directory, ranks, threads, variables, lock)
            simulation._resources = resources.pop_all()
        return simulation

    @classmethod
    def resume(
        cls,
        directory: str | Path,
        ranks: int | None = 1,
        threads: int = 1,
        variables: Mapping[str, Any] | None = None,
        lock: DirectoryLock | None = None,
    ) -> Self:
        """Go on with a run from its newest good checkpoint, see docs/reliability.md.

        Events and frames after the checkpoint are cut off. What had been given in `variables` is
        given again, but for those that are given here, such as a shorter timestep after a run
        that was unstable. `notes` tells, in lines, of checkpoints and trajectories that are
        damaged.

        Raises
        ------
        SimulationError
            If there is no checkpoint, the inputs have changed since the run began, or another
            process runs in the directory.
        """
        directory = Path(directory)
        check_run(directory, ranks, threads)
        load_built(directory)
        with ExitStack() as resources:
            lock = lock or resources.enter_context(DirectoryLock(directory))
            restart, earlier, notes, passed_over = find_resumption(directory)
            variables = {**earlier, **(variables or {})}
            damaged = set_aside_if_damaged(directory) if restart else None
            if restart:
                variables = {**variables, "restart": restart}
            try:
                simulation = cls.begin_built(directory, ranks, threads, variables, True, lock)
            except SkinError as error:
                if damaged:
                    raise SimulationError(f"{error}; {damaged}") from None
                raise
            simulation.notes += [*notes, *([damaged] if damaged else [])]
            simulation._checkpoints.passed_over = passed_over
            simulation._resources.push(resources.pop_all())
        return simulation

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Write a last checkpoint, end LAMMPS and remove a temporary directory."""
        engine, self._engine = self._engine, None
        try:
            if engine is not None and self.sound and not self._temporary:
                self._checkpoints.write(engine)
        finally:
            with self._resources:
                if engine is not None:
                    engine.close()
                    self._recorder.close(self.sound)
                    self._provenance.end()

    def _open(
        self, ranks: int | None, threads: int, variables: Mapping[str, Any], lock: DirectoryLock
    ) -> Any:
        """LAMMPS with the scene that is built in the directory."""
        given = {**variables, "running": 0, "dump_interval": 0, "restart_file": PART}
        arguments = self.directory, self.scene.kinds, Terms.of(self.scene).names, given
        try:
            engine, self.ranks, why = open_engine(ranks, threads, lock.descriptor, *arguments)
        except SimulationError as error:
            raise SimulationError(f"{error} (starting the scene in {self.directory})") from None
        self.notes += [why] * bool(why)
        return engine

    @property
    def time(self) -> float:
        """Time reached."""
        return float(self._running.time())

    @property
    def timestep(self) -> float:
        """Length of a step."""
        return float(self._running.timestep())

    def run(
        self, until: float | None = None, progress: Progress | None = None, every: float = 1.0
    ) -> None:
        """Advance to a time, by default the scene's end time.

        The trajectory is written to skin.h5 on the way, at every multiple of the scene's
        `output.dump_interval`, and a checkpoint at every multiple of its
        `output.checkpoint_interval`. SIGINT and SIGTERM end the run after a piece, the first as
        KeyboardInterrupt, the second as SystemExit; a last checkpoint follows when the
        simulation is closed.

        Parameters
        ----------
        until : float, optional
        progress : callable, optional
            Called as ``progress(time, simulation)`` after each piece of the run.
        every : float
            Length of the pieces in time units.
        """
        engine = self._running
        timestep = engine.timestep()
        end = self.scene.end_time if until is None else until
        step = engine.step()
        if not self.time - timestep / 2 <= end < 2**53 * timestep:
            raise SimulationError(f"until = {end:g}: must be a time from {self.time:g} on")
        last = step + round((end - self.time) / timestep)
        piece = last - step if progress is None else max(round(every / timestep), 1)
        self._checkpoints.begin(engine)
        self._recorder.record(engine)
        if not self._temporary:
            self._provenance.begin()
        self._reached = self.time
        try:
            with Interruption() as interruption:
                while step < last:
                    step = min(step + piece, last)
                    self._run_to(step, interruption)
                    if progress:
                        progress(self._reached, self)
        except SkinError as error:
            self.sound = False
            self._provenance.error = str(error)
            raise SimulationError(
                f"{error} (after t = {self._reached:g}, {self._remedy(str(error), timestep)}; "
                f"{self._last_checkpoint()})"
            ) from None

    def _run_to(self, step: int, interruption: Interruption) -> None:
        """Advance, with frames and checkpoints on the way; a moment to end well is after each."""
        engine, recorder, checkpoints = self._running, self._recorder, self._checkpoints
        changed = {self._step_of(change) for change in self._changes}
        stops = {*recorder.stops(engine, step), *checkpoints.stops(engine, step)}
        for stop in sorted(stops | {stop for stop in changed if stop < step}):
            self._change()
            self.sound = False
            engine.run_to(stop, checkpoints.due(engine, stop))
            self._reached = self.time
            recorder.record(engine)
            checkpoints.finish(engine)
            self.sound = True
            interruption.check()

    def _change(self) -> None:
        """Change the coefficients that are due to change at this step."""
        while self._changes and self._step_of(self._changes[0]) <= self._engine.step():
            for command in self._changes.pop(0).commands:
                self._engine.command(command)

    def _step_of(self, change: Change) -> int:
        """The first step that is not before its time, as in interventions.in."""
        timestep = self._engine.timestep()
        return change.first_step(self._engine.step(), self._engine.time(), timestep)

    def _remedy(self, error: str, timestep: float) -> str:
        """What to change after an error: a timestep that may be stable, and at most half of it."""
        shorter = min(timestep / 2, longest_timestep(self.scene))
        return remedy(error, self.directory, timestep, shorter)

    def _last_checkpoint(self) -> str:
        latest = self._checkpoints.latest()
        return f"last checkpoint: {latest}" if latest else "no checkpoint was written"

    def command(self, text: str) -> None:
        """Give LAMMPS a command; the history in skin.h5 tells of it."""
        self._running.command(text)
        self._recorder.note(self._running, text)

    def energies(self) -> dict[str, float]:
        """Energy of every term of the model at the current time, by name."""
        energies: dict[str, float] = self._running.energies()
        return energies

    def motion(self) -> Motion:
        """How particles were moved since this simulation began."""
        motion: Motion = self._running.motion()
        return motion

    def forces(self) -> Forces:
        """Ids, types, positions and forces of all particles, sorted by id."""
        forces: Forces = self._running.forces()
        return forces

    def move(self, ids: Ints, positions: Floats) -> None:
        """Put particles (n,) at positions (n, 3), and compute all forces there."""
        self._running.move(ids, positions)
        self._recorder.note(self._running, f"moved {len(ids)} particles")

    def cells(self) -> Cells:
        """State of the living cells, sorted by id."""
        cells: Cells = self._running.cells()
        return cells

    def types(self) -> Ints:
        """Types of all particles (n,) as `Kind`, in any order."""
        types: Ints = self._running.types()
        return types

    def next_id(self) -> int:
        """The ID that the next newborn gets; above all that were ever given out."""
        return int(self._running.next_id())

    @property
    def _running(self) -> Any:
        if self._engine is None:
            raise SimulationError("this simulation is closed")
        return self._engine


def _check_replaced(directory: Path, variables: Mapping[str, Any], replace: bool) -> None:
    """Refuse to begin where a run has left results, unless they may be replaced."""
    if "restart" not in variables and not replace and holds_results(directory):
        raise SimulationError(
            f"directory {directory}: holds results of a run; Simulation.resume goes on with it, "
            "replace=True replaces them"
        )


def check_run(directory: Path, ranks: int | None, threads: int) -> None:
    """Refuse what cannot be run, before anything is written.

    LAMMPS splits its commands at blanks, changes letters beyond ASCII, and quotes, dollars, stars,
    percent and number signs mean something to it.
    """
    for name, value in (("ranks", 1 if ranks is None else ranks), ("threads", threads)):
        if not isinstance(value, int) or not 1 <= value <= 4096:
            raise SimulationError(f"{name} = {value!r}: must be a whole number from 1 to 4096")
    check_alone()
    check_ranks(ranks or 1)
    bad = sorted({c for c in str(directory.resolve()) if not "!" <= c <= "~" or c in "\"'$*%#"})
    if bad:
        raise SceneError(
            f"directory {str(directory)!r}: LAMMPS cannot read a path with {''.join(bad)!a} in it"
        )
