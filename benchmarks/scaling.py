"""Cost against size, memory per particle, ranks and threads, and what ranks send to each other.

A finished run of a small scene gives a crowded tissue; copies of it side by side give the same
tissue at every size, with the level of accuracy `balanced`.

- sizes: the sizes take turns in one process; seconds of this thread for a step, and the exponent
  of its growth with the number of particles;
- memory: `lmp` alone, in a process of its own for each size;
- ranks: ranks x threads, in turns; wall time of LAMMPS' loop and CPU time of all ranks;
- small: one rank and two for fresh scenes of several sizes; wall time of a step;
- traffic: messages and bytes of a rank, counted by a library that stands between LAMMPS and MPI
  (`mpi_count.c`), as the difference of a longer and a shorter run.

    skin run sixteenth.toml -o runs/sixteenth      # lattice [50, 58], 4 stem cells, to t = 400
    python benchmarks/scaling.py sizes runs/sixteenth
    python benchmarks/scaling.py memory runs/sixteenth
    python benchmarks/scaling.py ranks runs/sixteenth
    python benchmarks/scaling.py traffic runs/sixteenth
    python benchmarks/scaling.py small

Each writes docs/data/scaling-*.csv; `scaling_model.py` makes the model and the plot of them.
"""

from __future__ import annotations

import argparse
import csv
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import lattice
from lammps_skin.start.build import build
from lammps_skin.start.configuration import PER_PARTICLE, Configuration
from lammps_skin.trajectory.frames import open_frames
from whole_run import configuration_of

DATA = Path(__file__).resolve().parent.parent / "docs" / "data"
TILES = (1, 2, 4, 8)  # copies along x and along y
SMALL = ((24, 28), (40, 46), (56, 64), (72, 82), (100, 114))  # lattices of the smaller scenes
PAPER = 4  # copies that are about the size of the paper's scene
LEVEL = {"numerics.accuracy": "balanced"}
QUIET = {"output.dump_interval": 0.0, "output.checkpoint_interval": 0.0}
BIN = Path(sys.executable).parent


def tile_of(run: Path) -> tuple[Scene, Configuration]:
    """The last frame of a run."""
    scene = Scene.load(run / "scene.toml").replace(**LEVEL, **QUIET)
    frames = open_frames(run)
    return scene, configuration_of(frames[len(frames) - 1], scene)


def tiled(
    scene: Scene, tile: Configuration, copies: tuple[int, int]
) -> tuple[Scene, Configuration]:
    """Copies of a periodic state along x and y, and the scene that it is a state of.

    Membrane particles come first, in the order of the larger lattice; then all others, copy by
    copy. A dividing pair that lies across the edge of the tile is one of two copies.
    """
    (nx, ny), (columns, rows) = scene.membrane.lattice, copies
    larger = (nx * columns, ny * rows)
    whole = scene.replace(**{
        "membrane.lattice": larger, "cells.stem": scene.cells.stem * columns * rows,
        "cells.nd": scene.cells.nd * columns * rows,
    })  # fmt: skip
    sites = lattice.positions((nx, ny), scene.spacing, 0.0)
    sheet = tile.kinds == Kind.MEMBRANE
    x = tile.wrapped()
    x[sheet, :2] -= tile.box[:2] * np.round((x[sheet] - sites)[:, :2] / tile.box[:2])

    # index of every particle of every copy: membrane by row and column, others after it
    count, others = len(x), np.flatnonzero(~sheet)
    index = np.empty((rows, columns, count), int)
    row, column = np.divmod(np.arange(nx * ny), nx)
    rest = nx * ny * columns * rows
    for up in range(rows):
        for along in range(columns):
            index[up, along, sheet] = (up * ny + row) * larger[0] + along * nx + column
            index[up, along, others] = rest + np.arange(len(others))
            rest += len(others)

    links, hinges = lattice.links_and_hinges(larger)
    state = Configuration(
        box=np.array(whole.box_sides), kinds=np.empty(rest, int), positions=np.empty((rest, 3)),
        links=links, hinges=hinges, time=tile.time,
    )  # fmt: skip
    paired = np.flatnonzero(tile.pair)
    other = tile.pair[paired] - 1
    shift = np.round((x[paired] - x[other])[:, :2] / tile.box[:2]).astype(int)
    for up in range(rows):
        for along in range(columns):
            here = index[up, along]
            state.kinds[here] = tile.kinds
            state.positions[here] = x + np.array([along * tile.box[0], up * tile.box[1], 0.0])
            for name in PER_PARTICLE:
                getattr(state, name)[here] = getattr(tile, name)
            state.parent[here] = 0
            there = (up + shift[:, 1]) % rows, (along + shift[:, 0]) % columns, other
            state.pair[here[paired]] = index[there] + 1
    state.positions = state.wrapped()
    return whole, state


def write(name: str, rows: Iterable[Mapping[str, Any]]) -> None:
    """A table in docs/data, and on the screen."""
    table = list(rows)
    path = DATA / f"scaling-{name}.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    print(path.read_text("utf-8"))


def sizes(run: Path, steps: int, rounds: int) -> None:
    """Seconds of this thread for a step of each size."""
    scene, tile = tile_of(run)
    spent: dict[int, list[float]] = {copies: [] for copies in TILES}
    particles: dict[int, tuple[int, int]] = {}
    with ExitStack() as stack:
        running = {}
        for copies in TILES:
            whole, state = tiled(scene, tile, (copies, copies))
            particles[copies] = len(state.kinds), int(state.is_cell.sum())
            running[copies] = stack.enter_context(Simulation.begin(whole, configuration=state))
        for turn in range(rounds + 1):
            for copies, simulation in running.items():
                until = simulation.time + steps * simulation.scene.numerics.timestep
                began = time.thread_time()
                simulation.run(until=until)
                if turn:  # the first sets up
                    spent[copies].append((time.thread_time() - began) / steps)
    write("sizes", (
        {"copies": copies**2, "turn": turn, "particles": particles[copies][0],
         "cells": particles[copies][1], "seconds_per_step": f"{seconds:.6g}"}
        for copies in TILES for turn, seconds in enumerate(spent[copies])
    ))  # fmt: skip


def built(run: Path, copies: tuple[int, int], folder: Path, grid: str = "* *") -> Scene:
    """Inputs of a size, and of a grid of ranks, in a folder."""
    whole, state = tiled(*tile_of(run), copies)
    build(whole, folder, state)
    script = folder / "skin.in"
    text = script.read_text("utf-8")
    script.write_text(text.replace("processors      * * 1", f"processors      {grid} 1"), "utf-8")
    return whole


def lmp(
    folder: Path,
    scene: Scene,
    start: float,
    steps: int,
    ranks: int = 1,
    threads: int = 1,
    environment: Mapping[str, str] | None = None,
) -> tuple[str, float, float]:
    """Log, CPU seconds of all ranks and largest resident set (bytes) of `lmp` for some steps."""
    until = start + steps * scene.numerics.timestep
    command = [str(BIN / "mpirun"), "-np", str(ranks)] if ranks > 1 else []
    command += [str(BIN / "lmp"), "-in", "skin.in", "-screen", "none", "-var", "end_time",
                repr(until)]  # fmt: skip
    if threads > 1:
        command += ["-sf", "omp", "-pk", "omp", str(threads)]
    process = subprocess.Popen(
        command, cwd=folder, stdout=subprocess.DEVNULL, env={**os.environ, **(environment or {})}
    )
    _, status, usage = os.wait4(process.pid, 0)
    log = (folder / "log.lammps").read_text("utf-8")
    if status:
        raise SystemExit(f"lmp ended with status {status}: {log.splitlines()[-1]}")
    return log, usage.ru_utime + usage.ru_stime, 1024.0 * usage.ru_maxrss


def number(pattern: str, log: str) -> float:
    return float(re.findall(pattern, log)[-1])


def memory(run: Path) -> None:
    """Largest resident set of `lmp`, and LAMMPS' own account of its arrays."""
    rows = []
    for copies in TILES:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            scene = built(run, (copies, copies), folder)
            log, _, resident = lmp(folder, scene, tile_of(run)[1].time, 2)
            rows.append({
                "copies": copies**2, "particles": int(number(r"with (\d+) atoms", log)),
                "ghosts": int(number(r"Nghost: +(\S+) ave", log)), "resident_bytes": int(resident),
                "lammps_bytes": int(1e6 * number(r"allocation .* = \S+ \| \S+ \| (\S+)", log)),
            })  # fmt: skip
    write("memory", rows)


def ranks(run: Path, steps: int, rounds: int, copies: int) -> None:
    """Wall and CPU seconds of a step on ranks x threads, the variants in turns."""
    variants = ((1, 1, "1 1"), (2, 1, "2 1"), (2, 1, "1 2"), (1, 2, "1 1"))
    start, rows = tile_of(run)[1].time, []
    with tempfile.TemporaryDirectory() as name:
        folders = {grid: Path(name) / grid.replace(" ", "x") for _, _, grid in variants}
        scenes = {
            grid: built(run, (copies, copies), folder, grid) for grid, folder in folders.items()
        }
        for turn in range(rounds):
            for count, threads, grid in variants:
                log, cpu, _ = lmp(folders[grid], scenes[grid], start, steps, count, threads)
                wall = number(r"Loop time of (\S+)", log) / steps
                rows.append({
                    "ranks": count, "threads": threads, "grid": grid.replace(" ", "x"),
                    "turn": turn, "ghosts": int(number(r"Nghost: +(\S+) ave", log)),
                    "wall_per_step": f"{wall:.6g}",
                    "cpu_of_all": f"{cpu:.6g}",
                })  # fmt: skip
    write("ranks", rows)


def small(steps: int, rounds: int) -> None:
    """Wall seconds of a step of scenes of several sizes, on one rank and on two in turns."""
    rows = []
    for lattice_of in SMALL:
        scene = Scene.load("demo").replace(**{"membrane.lattice": lattice_of}, **LEVEL, **QUIET)
        with ExitStack() as stack:
            both = {
                count: stack.enter_context(Simulation.begin(scene, ranks=count)) for count in (1, 2)
            }
            particles = len(both[1].forces().ids)
            for turn in range(rounds + 1):
                for count, simulation in both.items():
                    until = simulation.time + steps * scene.numerics.timestep
                    began = time.perf_counter()
                    simulation.run(until=until)
                    if turn:  # the first sets up
                        wall = (time.perf_counter() - began) / steps
                        rows.append({
                            "particles": particles, "ranks": count, "turn": turn - 1,
                            "wall_per_step": f"{wall:.6g}",
                        })  # fmt: skip
    write("small", rows)


def traffic(run: Path, steps: int, copies: int) -> None:
    """What a rank sends in a step, counted, and the ghost particles that LAMMPS reports."""
    start, rows = tile_of(run)[1].time, []
    with tempfile.TemporaryDirectory() as name:
        library = Path(name) / "mpi_count.so"
        source = Path(__file__).with_name("mpi_count.c")
        subprocess.run(
            [str(BIN / "mpicc"), "-O2", "-shared", "-fPIC", str(source), "-o", str(library)],
            check=True,
        )
        for count, grid in ((1, "1 1"), (2, "2 1"), (2, "1 2"), (4, "2 2")):
            folder = Path(name) / grid.replace(" ", "x")
            scene = built(run, (copies, copies), folder, grid)
            counts, logs = [], []
            for length in (2, 2 + steps):
                environment = {"LD_PRELOAD": str(library), "SKIN_MPI_COUNT": str(folder / "mpi")}
                log, _, _ = lmp(folder, scene, start, length, count, environment=environment)
                files = sorted(folder.glob("mpi.*"))
                counts.append(np.mean([np.loadtxt(file) for file in files], axis=0))
                logs.append(log)
            messages, bytes_, collectives, seconds = (counts[1] - counts[0])[1:] / steps
            rows.append({
                "ranks": count, "grid": grid.replace(" ", "x"),
                "particles": int(number(r"with (\d+) atoms", logs[1])),
                "ghosts": int(number(r"Nghost: +(\S+) ave", logs[1])),
                "messages_per_step": f"{messages:.1f}", "bytes_per_step": f"{bytes_:.0f}",
                "collectives_per_step": f"{collectives:.1f}",
                "mpi_seconds_per_step": f"{seconds:.4g}",
            })  # fmt: skip
    write("traffic", rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("sizes", "memory", "ranks", "small", "traffic"))
    parser.add_argument(
        "run", type=Path, nargs="?", help="run directory of a small periodic tissue; not for small"
    )
    parser.add_argument("--steps", type=int, default=8)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument(
        "--copies", type=int, default=PAPER, help="along x and y; for ranks, traffic"
    )
    options = parser.parse_args()
    DATA.mkdir(exist_ok=True)
    if options.what == "small":
        small(options.steps, options.rounds)
    elif options.run is None:
        parser.error(f"{options.what}: needs the directory of a run")
    elif options.what == "sizes":
        sizes(options.run, options.steps, options.rounds)
    elif options.what == "memory":
        memory(options.run)
    elif options.what == "ranks":
        ranks(options.run, options.steps, options.rounds, options.copies)
    else:
        traffic(options.run, options.steps, options.copies)


if __name__ == "__main__":
    main()
