"""Runs of a few time units from one state: where particles go, and what that costs."""

from __future__ import annotations

import platform
import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from lammps_skin.engine.built import SCENE_FILE
from lammps_skin.engine.engine import Motion
from lammps_skin.errors import SceneError, SimulationError, SkinError
from lammps_skin.files import atomic_write
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration
from lammps_skin.study.result_keys import file_hash, physics, result_key
from lammps_skin.study.runner import Job, Progress
from lammps_skin.study.tradeoff.grid import REFERENCE, Variant, variant
from lammps_skin.study.tradeoff.store import VERSION, EndState, ResultFolder, Timing

FINEST = "finest"  # the variant that stands for the truth
FINER = 16  # how many times its timestep is shorter than that of the reference
NEVER = 2_000_000_000  # steps between event steps, more than there are in a run: no events
PIECES = 40  # of a run: how often the bar moves
ROUNDS = 3  # in which the variants of a group take turns
TOGETHER = 5  # variants of a group, besides the reference


class Measurements:
    """Measures variants of a scene from one state of it, and keeps the results.

    Parameters
    ----------
    scene : Scene
    folder : Path
        Of the results.
    start : Path, optional
        Restart file, or run directory whose last restart file is taken; the start of the scene
        if not given.
    interval : float
        Length of the runs in time units.

    Raises
    ------
    SceneError
        If there is no such restart file, or if it is that of another scene.
    """

    def __init__(
        self, scene: Scene, folder: Path, start: Path | None = None, interval: float = 2.0
    ) -> None:
        self.scene = scene
        self.interval = interval
        self._start = start
        self._given = None if start is None else restart_of(start, scene)
        self.store = ResultFolder(folder)

    def __reduce__(self) -> tuple[Any, ...]:
        """To another process without what is worked out, and may be large."""
        return Measurements, (self.scene, self.store.folder, self._start, self.interval)

    @cached_property
    def state(self) -> Path:
        """Restart file from which all runs begin."""
        if self._given is not None:
            return self._given
        path = self.store.path(
            "state", "start", result_key(VERSION, physics(self.scene)), ".restart"
        )
        if not path.exists():
            reference = variant(self.scene, REFERENCE, {"accuracy": REFERENCE})
            with Simulation.begin(_quiet(reference.scene), configuration=self._begun) as simulation:
                simulation.command(f"write_restart {simulation.directory}/{path.name}")
                with atomic_write(path) as part:
                    shutil.copyfile(simulation.directory / path.name, part)
        return path

    @cached_property
    def _begun(self) -> Configuration:
        """What a directory is built from; its particles are replaced by those of the state."""
        return Configuration.from_scene(self.scene)

    @cached_property
    def _state_hash(self) -> str:
        return file_hash(self.state)

    def _key(self, one: Variant, *more: object) -> str:
        numerics = one.scene.numerics.model_dump(mode="json", exclude={"accuracy"})
        return result_key(
            VERSION, physics(one.scene), numerics, self._state_hash, self.interval, *more
        )

    @contextmanager
    def _simulation(self, one: Variant, events: bool) -> Iterator[Simulation]:
        scene = _quiet(one.scene)
        variables = {"restart": "state.restart"}
        if not events:
            variables["event_interval"] = repr(NEVER * scene.numerics.timestep)
            variables["rounding"] = "0"
        state, folder = self.state, self.store.folder
        try:
            with TemporaryDirectory(
                prefix=f"run-{one.name}-", dir=folder, ignore_cleanup_errors=True
            ) as name:
                directory = Path(name)
                shutil.copyfile(state, directory / "state.restart")
                with Simulation.begin(
                    scene, directory, self._begun, variables=variables
                ) as simulation:
                    yield simulation
        except OSError as error:
            raise SkinError(f"folder {folder}: {error.strerror}") from None

    # ---- trajectories

    def finest(self) -> Variant:
        """The reference with a much shorter timestep."""
        reference = {"accuracy": REFERENCE}
        timestep = variant(self.scene, REFERENCE, reference).scene.numerics.timestep / FINER
        return variant(self.scene, FINEST, {**reference, "timestep": timestep})

    def end_state_path(self, one: Variant) -> Path:
        """Where it is kept what `end_state` finds."""
        return self.store.path("reached", one.name, self._key(one), ".npz")

    def end_state(self, one: Variant, progress: Progress | None = None) -> EndState:
        """Where all particles are after the interval, without births, removals and their like."""
        path = self.end_state_path(one)
        if not path.exists():
            self.store.save_end_state(path, self._run_to_end(one, progress))
        return self.store.load_end_state(path)

    def _run_to_end(self, one: Variant, progress: Progress | None) -> EndState:
        with self._simulation(one, events=False) as simulation:
            begin = simulation.time
            before = simulation.forces().ids

            def report(now: float, _: Simulation) -> None:
                if progress:
                    progress(now - begin)

            try:
                simulation.run(begin + self.interval, report, every=self.interval / PIECES)
            except SimulationError as error:
                nobody = np.empty(0, int), np.empty((0, 3)), Motion(*[np.nan] * len(Motion._fields))
                return EndState(*nobody, problem=str(error))
            after = simulation.forces()
            assert np.array_equal(after.ids, before), "an event in a run without events"
            return EndState(after.ids, after.positions, simulation.motion())

    # ---- time

    def timing_path(self, one: Variant) -> Path:
        """Where it is kept what `time_group` finds."""
        return self.store.path("timing", one.name, self._key(one, platform.node()), ".json")

    def timing(self, one: Variant) -> Timing:
        """What `time_group` has found."""
        return self.store.load_timing(self.timing_path(one))

    def timing_groups(self, found: Sequence[Variant]) -> list[list[Variant]]:
        """Those that have not been timed, in groups, each with the reference, the first, before."""
        reference, *others = found
        missing = [one for one in others if not self.timing_path(one).exists()]
        groups = [missing[n : n + TOGETHER] for n in range(0, len(missing), TOGETHER)]
        if not groups and not self.timing_path(reference).exists():
            groups = [[]]
        return [[reference, *group] for group in groups]

    def time_group(
        self, group: Sequence[Variant], turn: Callable[[Variant], None] | None = None
    ) -> None:
        """Let variants take turns, each from the state through all rounds, with all events.

        `turn` is called after each.
        """
        with ExitStack() as stack:
            runs = [stack.enter_context(self._simulation(one, events=True)) for one in group]
            begin = runs[0].time
            seconds = np.full((ROUNDS, len(group)), np.nan)
            problems = [""] * len(group)
            for n in range(ROUNDS):
                for m, (one, simulation) in enumerate(zip(group, runs, strict=True)):
                    if not problems[m]:
                        since = time.process_time()
                        try:
                            simulation.run(begin + (n + 1) * self.interval)
                        except SimulationError as error:
                            problems[m] = str(error)
                        seconds[n, m] = (time.process_time() - since) / self.interval
                    if turn:
                        turn(one)
        ratios = seconds / seconds[:, :1]
        for one, own, ratio, problem in zip(group, seconds.T, ratios.T, problems, strict=True):
            spread = float(np.ptp(ratio)) / 2
            timing = Timing(float(np.median(own)), float(np.median(ratio)), spread, problem)
            if problem:
                timing = Timing(np.nan, np.nan, np.nan, problem)
            self.store.save_timing(self.timing_path(one), timing)


@dataclass(frozen=True)
class Trajectory(Job):
    """The run of a variant to the end of the interval, as one of many."""

    one: Variant
    measurements: Measurements

    @property
    def label(self) -> str:
        return f"trajectory of {self.one.name}"

    @property
    def length(self) -> float:
        return self.measurements.interval

    def run(self, keep: bool = False, progress: Progress | None = None) -> None:
        self.measurements.end_state(self.one, progress)


def _quiet(scene: Scene) -> Scene:
    """Without output on the way, with the steps that it has beside that."""
    quiet = {"thermo_interval": scene.end_time, "dump_interval": 0.0, "checkpoint_interval": 0.0}
    numerics = scene.numerics.model_dump(exclude_none=True)
    return scene.replace(output=quiet, **{f"numerics.{key}": one for key, one in numerics.items()})


def restart_of(start: Path, scene: Scene) -> Path:
    """A restart file, or the last of a run directory, if it is one of this scene."""
    found = [start]
    if start.is_dir():
        found = sorted(start.glob("skin.*.restart"), key=lambda path: path.stat().st_mtime)
    if not found or not found[-1].is_file():
        raise SceneError(f"--from {start}: neither a restart file nor a directory with one")
    described = found[-1].parent / SCENE_FILE
    if described.is_file():
        own, other = physics(scene), physics(Scene.load(described))
        for key, value in own.items():
            if value != other[key]:
                raise SceneError(
                    f"--from {start}: is a run of another scene: {key} = {other[key]}, not {value}"
                )
    return found[-1].resolve()
