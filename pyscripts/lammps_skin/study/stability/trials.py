"""Short runs of a scene from one state, and whether they are sane."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import cached_property
from itertools import product, starmap
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from lammps_skin.errors import SceneError, SimulationError, SkinError
from lammps_skin.files import atomic_write
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.arrangements import place_cells
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration
from lammps_skin.study.result_keys import file_hash, physics, result_key
from lammps_skin.study.runner import Job, Progress
from lammps_skin.study.stability.bisection import Limit, Trial, bisect
from lammps_skin.study.stability.hessian import largest_eigenvalue, mobilities
from lammps_skin.study.stability.methods import CROWDING, Method, scaled
from lammps_skin.study.tradeoff.measure import NEVER, restart_of
from lammps_skin.study.tradeoff.store import ResultFolder

VERSION = 1  # to be raised when what is found means something else
KICK = 1e-4  # largest displacement of each coordinate at the start: nothing is exactly at rest
SAMPLES = 16  # of the energy in a run
TRANSIENT, SETTLED = 1.0, 0.5  # energy in excess that is allowed, and in the last quarter
TINY = 1e-300  # a range of energies where nothing has any
FEWEST_STEPS = 4  # of a run: the longest timestep that is tried
MOST_EVALUATIONS = 2000  # of forces in a run: the shortest
FINE = {"integrator": "euler", "stages": 1, "largest_move": 0.05, "stiffness_limit": 0.0}
FINE_TIMESTEP, FINE_PART = 0.005, 0.25  # at most, and as a part of the estimate
MEASURING = 1e-3  # timestep with which mobilities are measured


class InitialState:
    """Where the runs of a map begin.

    Parameters
    ----------
    scene : Scene
    start : Path, optional
        Restart file, or run directory whose last restart file is taken; the start of the scene
        if not given.
    configuration : Configuration, optional
        Instead of the start of the scene.

    Raises
    ------
    SceneError
        If there is no such restart file, or if it is that of another scene.
    """

    def __init__(
        self, scene: Scene, start: Path | None = None, configuration: Configuration | None = None
    ) -> None:
        self._scene, self._given = scene, configuration
        self.restart = None if start is None else restart_of(start, scene)

    @cached_property
    def configuration(self) -> Configuration:
        """What directories are built from; a restart file replaces its particles."""
        return self._given or Configuration.from_scene(self._scene)

    @cached_property
    def key(self) -> str:
        """Hash of the state."""
        if self.restart:
            return file_hash(self.restart)
        positions = [] if self._given is None else self._given.positions.tolist()
        return result_key(physics(self._scene), positions)


class Baseline(NamedTuple):
    """What trials of a scene are compared with.

    Attributes
    ----------
    times, energies : list of float
        Total energy during a run of forward Euler with a short timestep, divided where it must
        be; times since the state.
    eigenvalues : list of list of float
        Largest eigenvalues of the Hessian at the begin and the end of that run; without and with
        a limit of stiffness.
    """

    times: list[float]
    energies: list[float]
    eigenvalues: list[list[float]]

    def excess(self, time: float, energy: float) -> float:
        """Energy above that of the run at a time, over the range of its energies."""
        own = np.interp(time, self.times, self.energies)
        return float((energy - own) / max(np.ptp(self.energies), TINY))


class EnergyTooHigh(Exception):
    """Ends a run whose energy is too high."""


class Trials:
    """Runs of a scene from a state.

    Parameters
    ----------
    scene : Scene
        Possibly with other parameters than those with which the state was reached.
    state : InitialState
    folder : Path
        Of the results; what is there is not computed again.
    interval : float
        Length of the runs.
    stiffness_limit : float
        Of the methods that have one.
    """

    def __init__(
        self,
        scene: Scene,
        state: InitialState,
        folder: Path,
        interval: float,
        stiffness_limit: float,
    ) -> None:
        quiet = {"output.dump_interval": 0.0, "output.checkpoint_interval": 0.0}
        self.scene = scene.replace(**quiet)
        self.state = state
        self.interval = interval
        self.limits = 0.0, stiffness_limit
        self.store = ResultFolder(folder)
        self._working: TemporaryDirectory[str] | None = None  # where runs are, once it is built

    # ---- results

    def limit_path(self, method: Method, tolerance: float) -> Path:
        """Where it is kept what `limit` finds."""
        return self.store.path("limit", method.name, self._key(list(method), tolerance), ".json")

    def done(self, methods: Iterable[Method], tolerance: float) -> bool:
        """Whether all that these methods need is there."""
        paths = (self.limit_path(method, tolerance) for method in methods)
        return self._baseline_path.exists() and all(path.exists() for path in paths)

    def limit(
        self, method: Method, tolerance: float, progress: Callable[[], None] | None = None
    ) -> Limit:
        """The largest stable timestep, by bisection that begins at the estimate at the end.

        `progress` is called now and then.
        """
        path = self.limit_path(method, tolerance)
        if not path.exists():
            guess = method.estimate(self.eigenvalues(method.stiffness_limit)[-1])
            found = bisect(
                lambda timestep: self.problem(method, timestep, progress),
                guess, method.stages * self.interval / MOST_EVALUATIONS,
                self.interval / FEWEST_STEPS, tolerance,
            )  # fmt: skip
            _save(path, found.trials)
        return Limit(tuple(Trial(*trial) for trial in _load(path)))

    def eigenvalues(self, stiffness_limit: float) -> list[float]:
        """Largest eigenvalues at the begin and at the end, with one of the `limits`."""
        return self._baseline.eigenvalues[self.limits.index(stiffness_limit)]

    @property
    def key(self) -> str:
        """Hash of all that the results depend on, but the method."""
        return self._key(self.limits)

    @property
    def _baseline_path(self) -> Path:
        return self.store.path("baseline", "fine", self.key, ".json")

    def _key(self, *more: object) -> str:
        numerics = self.scene.numerics.model_dump(
            mode="json", include={"pair_form", "table_style", "table_points",
                                  "neighbor_skin"},
        )  # fmt: skip
        return result_key(
            VERSION, physics(self.scene), numerics, self.state.key, self.interval, *more
        )

    # ---- runs

    def problem(
        self, method: Method, timestep: float, progress: Callable[[], None] | None = None
    ) -> str:
        """What is wrong with a run; nothing if it is stable.

        A run is stable if it ends, and if its total energy is never further above that of the
        run with a short timestep than the range of energies in the latter, and in the last
        quarter of the interval than half of it. There are no births, ends of divisions and
        removals: they would be at other times in runs with another timestep.
        """
        try:
            with self._simulation({**method.variables, "timestep": repr(timestep)}) as simulation:
                self._follow(simulation, timestep, progress)
        except EnergyTooHigh as error:
            return str(error)
        except SimulationError as error:
            return str(error)
        return ""

    def _follow(
        self, simulation: Simulation, timestep: float, progress: Callable[[], None] | None
    ) -> None:
        """Run, and raise `EnergyTooHigh` when the energy is too high."""
        baseline = self._baseline
        begin = simulation.time

        def look(now: float, _: Simulation) -> None:
            if progress:
                progress()
            energy = sum(simulation.energies().values())
            excess = baseline.excess(now - begin, energy)
            if not excess <= (SETTLED if now - begin > 0.75 * self.interval else TRANSIENT):
                raise EnergyTooHigh(
                    f"energy {energy:.4g} after {now - begin:.3g} time units, {excess:.3g} times "
                    "the range of the comparison above it"
                )

        steps = max(round(self.interval / timestep), 1)
        every = timestep * max(round(steps / SAMPLES), 1)
        simulation.run(begin + steps * timestep, look, every)

    @cached_property
    def _baseline(self) -> Baseline:
        path = self._baseline_path
        if not path.exists():
            _save(path, self._measure_baseline())
        return Baseline(*_load(path))

    def _measure_baseline(self) -> Baseline:
        with self._simulation({**FINE, "timestep": FINE_TIMESTEP}) as simulation:
            simulation.command(f"write_restart {self._restart('begin')}")
        begins = [self._eigenvalue("begin", limit) for limit in self.limits]
        stable = FINE_PART * Method("euler", 1, 0.0).estimate(begins[0])
        timestep = max(min(FINE_TIMESTEP, stable), self.interval / MOST_EVALUATIONS)
        with self._simulation({**FINE, "timestep": repr(timestep)}) as simulation:
            begin = simulation.time
            times, energies = [0.0], [sum(simulation.energies().values())]

            def note(now: float, _: Simulation) -> None:
                times.append(now - begin)
                energies.append(sum(simulation.energies().values()))

            simulation.run(begin + self.interval, note, every=self.interval / SAMPLES)
            simulation.command(f"write_restart {self._restart('end')}")
        ends = [self._eigenvalue("end", limit) for limit in self.limits]
        return Baseline(times, energies, [list(pair) for pair in zip(begins, ends, strict=True)])

    def _eigenvalue(self, restart: str, stiffness_limit: float) -> float:
        variables = {
            **FINE, "timestep": MEASURING, "stiffness_limit": stiffness_limit, "largest_move": 0.0,
        }  # fmt: skip
        with self._simulation(variables, restart) as simulation:
            mobility = np.ones(len(simulation.forces().ids))
            if stiffness_limit:
                mobility = mobilities(simulation)
            return largest_eigenvalue(simulation, mobility)

    @property
    def _directory(self) -> Path:
        """Where all runs of this scene are; of these trials alone."""
        if self._working is None:
            made = TemporaryDirectory(
                prefix="run-", dir=self.store.folder, ignore_cleanup_errors=True
            )
            build(self.scene, Path(made.name), self.state.configuration)
            if self.state.restart:
                shutil.copyfile(self.state.restart, Path(made.name) / "state.restart")
            self._working = made
        return Path(self._working.name)

    def _restart(self, name: str) -> Path:
        return self._directory / f"{name}.restart"

    @contextmanager
    def _simulation(
        self, variables: dict[str, Any], restart: str | None = None
    ) -> Iterator[Simulation]:
        """From the state, kicked, or from one of our own restart files."""
        never = repr(NEVER * float(variables["timestep"]))
        given = {**variables, "event_interval": never, "thermo_interval": never, "rounding": 0}
        try:
            (self._directory / "events.csv").unlink(missing_ok=True)
        except OSError as error:
            raise SkinError(f"folder {self.store.folder}: {error.strerror}") from None
        if restart or self.state.restart:
            given["restart"] = f"{restart or 'state'}.restart"
        with Simulation.begin_built(self._directory, variables=given) as simulation:
            if restart is None:
                simulation.command(f"displace_atoms all random {KICK} {KICK} {KICK} 1 units box")
                simulation.command("run 0 post no")
            yield simulation

    def close(self) -> None:
        """Remove what only the runs need."""
        if self._working is not None:
            self._working.cleanup()
            self._working = None


class Point(NamedTuple):
    """What of a scene is scaled, and by how much."""

    name: str
    factor: float

    def __str__(self) -> str:
        return f"{self.name} x {self.factor:g}"


@dataclass(frozen=True)
class Limits(Job):
    """The limits of some methods at one point of a map, as one of many runs."""

    point: Point
    trials: Trials
    methods: tuple[Method, ...]
    tolerance: float

    @property
    def label(self) -> str:
        return str(self.point)

    @property
    def length(self) -> float:
        return float(len(self.methods))

    def run(self, keep: bool = False, progress: Progress | None = None) -> None:
        with closing(self.trials) as trials:
            for n, method in enumerate(self.methods):

                def tell(done: int = n) -> None:
                    if progress:
                        progress(float(done))

                trials.limit(method, self.tolerance, tell)


def points(
    scene: Scene,
    start: Path | None,
    names: Iterable[str],
    factors: Iterable[float],
    folder: Path,
    interval: float,
    stiffness_limit: float,
) -> tuple[dict[Point, Trials], list[str]]:
    """Trials of the scene with parameters scaled, and why some cannot be.

    All begin from one state, but for those with another number of cells, which begin from the
    start of their own scene.
    """
    found: dict[Point, Trials] = {}
    left_out = []
    state = InitialState(scene, start)
    for point in starmap(Point, product(names, factors)):
        name, factor = point
        if name == CROWDING and start is not None and factor != 1:
            left_out.append(f"{point}: the state is given")
            continue
        try:
            changed = scaled(scene, name, factor)
            place_cells(changed)
        except SceneError as error:
            left_out.append(f"{point}: {error}")
            continue
        own = InitialState(changed) if name == CROWDING and factor != 1 else state
        found[point] = Trials(changed, own, folder, interval, stiffness_limit)
    return found, left_out


def _save(path: Path, content: Any) -> None:
    with atomic_write(path) as part:
        part.write_text(json.dumps(content), "utf-8")


def _load(path: Path) -> Any:
    return json.loads(path.read_text("utf-8"))
