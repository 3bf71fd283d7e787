"""``skin run``: a run with a progress bar, and at its end what happened and where the files are."""

from __future__ import annotations

import math
import shlex
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from lammps_skin.cli.cores import warn_of_crowding
from lammps_skin.cli.monitor import RunMonitor
from lammps_skin.cli.options import (
    Accuracy,
    At,
    From,
    Parameters,
    Seed,
    Settings,
    keep_results,
    scene_from,
    scenes_beginning,
)
from lammps_skin.cli.output import console
from lammps_skin.engine.built import load_built, variable
from lammps_skin.errors import SceneError, SimulationError, SkinError
from lammps_skin.model.remarks import remarks
from lammps_skin.model.scene import Scene
from lammps_skin.model.scenes import BUILT_IN
from lammps_skin.run.directory_lock import DirectoryLock
from lammps_skin.run.results import RESTARTS, replaced_results, restart_files
from lammps_skin.run.simulation import Simulation, check_run
from lammps_skin.start.configuration import Configuration

FILES = {
    "events.csv": "births, ends of divisions, removals, interventions",
    "skin.h5": "trajectory",
    "log.lammps": "energies by term and numbers of cells against time",
}
INTERRUPTED = 130


def run(
    source: Annotated[
        str,
        typer.Argument(
            metavar="SCENE|DIR",
            help="Built-in scene, .toml file or built directory.",
            autocompletion=scenes_beginning,
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Run directory [default: runs/NAME]."),
    ] = None,
    ranks: Annotated[
        int | None, typer.Option(help="MPI ranks [default: as many as pay off on idle cores].")
    ] = None,
    threads: Annotated[int, typer.Option(help="Threads of each rank.")] = 1,
    until: Annotated[
        float | None, typer.Option(help="Time at which to end, instead of the scene's.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the results of a run.")] = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with the run in DIR from its last checkpoint.")
    ] = False,
    timestep: Annotated[
        float | None, typer.Option(help="With --resume: another timestep from there on.")
    ] = None,
    parameters: Parameters = None,
    accuracy: Accuracy = None,
    seed: Seed = None,
    settings: Settings = None,
    begin: From = None,
    at: At = None,
) -> None:
    """Run a scene, or a directory that `skin build` has made."""
    began = time.perf_counter()
    scene, directory = _what_and_where(
        source, output, parameters, settings, accuracy, seed, begin, at
    )
    check_run(directory, ranks, threads)
    if resume and (scene or force):
        raise SceneError(
            "--resume: goes on with the run in a directory, as it is; give that alone: "
            f"{_go_on(directory, until)}"
        )
    if timestep is not None and not resume:
        raise SceneError("--timestep: goes with --resume; else give --set numerics.timestep=...")
    warn_of_crowding(ranks or 1, "rank", threads)
    with DirectoryLock(directory, make=scene is not None) as lock:
        if resume:
            simulation = _resumed(lock, directory, ranks, threads, until, timestep)
        else:
            simulation = _begun(lock, scene, directory, ranks, threads, until, force)
        _watch(simulation, directory, until, began)


def _begun(
    lock: DirectoryLock, scene: Scene | None, directory: Path, ranks: int | None, threads: int,
    until: float | None, force: bool,
) -> Simulation:  # fmt: skip
    """The simulation of a scene, from its initial state."""
    if not force:
        go_on = f"{_go_on(directory, until)} goes on with it, --force replaces them"
        if scene and (other := _another(scene, directory)):
            go_on = f"it is one of {other}; give this one another directory by -o, or {go_on}"
        keep_results(directory, go_on)
    if until is not None:
        scene = _shortened(scene, directory, until)
    configuration = None
    if scene and scene.start.run is not None:  # its last frame may say when this one begins
        configuration = Configuration.from_scene(scene)
        scene = configuration.described(scene)
    for remark in remarks(scene or load_built(directory)):
        console.print(remark)
    with console.status("building"):
        if scene and not configuration:
            configuration = Configuration.from_scene(scene)
        with replaced_results(directory):
            how: dict[str, Any] = {"replace": force, "lock": lock}
            if scene is None:
                simulation = Simulation.begin_built(directory, ranks, threads, **how)
            else:
                simulation = Simulation.begin(
                    scene, directory, configuration, ranks, threads, **how
                )
    _print_notes(simulation)
    return simulation


def _another(scene: Scene, directory: Path) -> str:
    """What scene stands in a directory, if it is another one but for its end."""
    try:
        there = load_built(directory)
        one, other = (each.replace(end_time=scene.end_time).given() for each in (scene, there))
    except SkinError:
        return ""
    if (there.name, there.seed) != (scene.name, scene.seed):
        return f"{there.name}, seed {there.seed}"
    return "" if one == other else f"{there.name} with other keys"


def _resumed(
    lock: DirectoryLock, directory: Path, ranks: int | None, threads: int, until: float | None,
    timestep: float | None,
) -> Simulation:  # fmt: skip
    """The simulation of a run that has ended before its time."""
    if timestep is not None and not 0 < timestep < math.inf:
        raise SimulationError(f"--timestep = {timestep:g}: must be a number greater than 0")
    with console.status("resuming"):
        changed = {} if timestep is None else {"timestep": repr(timestep)}
        simulation = Simulation.resume(directory, ranks, threads, changed, lock)
    _print_notes(simulation)
    end = simulation.scene.end_time if until is None else until
    if simulation.time < end < math.inf:
        console.print(f"{simulation.scene.name}: goes on at t = {simulation.time:.6g}")
        return simulation
    reached = simulation.time
    simulation.close()
    raise SimulationError(
        f"directory {directory}: has reached t = {reached:.6g}; --until takes it further"
    )


def _print_notes(simulation: Simulation) -> None:
    for note in simulation.notes:
        console.print(note)


def _watch(simulation: Simulation, directory: Path, until: float | None, began: float) -> None:
    """Run with a progress bar, and tell in the end what has happened."""
    monitor, end = RunMonitor(simulation, until), "stopped after"
    try:
        with simulation:
            monitor.go()
        end = "reached"
    except KeyboardInterrupt:
        end = "interrupted at"
        raise typer.Exit(INTERRUPTED) from None
    except SystemExit:
        end = "terminated at"
        raise
    finally:
        seconds = time.perf_counter() - began
        console.print(f"{simulation.scene.name}: {end} t = {monitor.time:.6g}, {seconds:.1f} s")
        for line in monitor.lines(directory / "events.csv"):
            console.print(f"  {line}")
        _name_files(directory, ended=end == "reached")


def _shortened(scene: Scene | None, directory: Path, until: float) -> Scene | None:
    """The scene with another end time; a built directory stays as it is."""
    start = scene.begins if scene else variable(directory, "start_time")
    if not start < until < math.inf:
        raise SimulationError(f"--until = {until:g}: must be a time after the start, {start:g}")
    shortened = (scene or load_built(directory)).replace(end_time=until)
    return shortened if scene else None


def _what_and_where(
    source: str,
    output: Path | None,
    parameters: str | None,
    settings: list[str] | None,
    accuracy: str | None,
    seed: int | None,
    begin: str | None,
    at: float | None,
) -> tuple[Scene | None, Path]:
    """The scene, None for a built directory, and the directory of the run."""
    built = bool(source) and source not in BUILT_IN and Path(source).is_dir()
    if not built:
        scene = scene_from(source, parameters, settings, accuracy, seed, begin, at)
        return scene, output or Path("runs") / scene.name
    given = {
        "--set": settings, "--parameters": parameters, "--accuracy": accuracy, "--seed": seed,
        "--from": begin, "--at": at, "-o": output,
    }  # fmt: skip
    for option, value in given.items():
        if value not in (None, []):
            raise SceneError(
                f"{option}: a built directory is run as it is; give the scene to change it"
            )
    load_built(Path(source))
    return None, Path(source)


def _go_on(directory: Path, until: float | None = None) -> str:
    """The command that goes on with the run in a directory."""
    further = "" if until is None else f" --until {until:g}"
    return f"skin run {shlex.quote(str(directory))} --resume{further}"


def _name_files(directory: Path, ended: bool) -> None:
    """Print what a run has left, and how to go on with one that has not ended."""
    console.print(f"in {directory}:")
    for name, content in FILES.items():
        if (directory / name).exists():
            console.print(f"  {name:<16} {content}")
    if restart_files(directory):
        go_on = "" if ended else f"; go on: {_go_on(directory)}"
        console.print(f"  {RESTARTS:<16} checkpoints{go_on}")
