"""One small run with births, removals and changes of kind: by LAMMPS alone and driven by Python."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from lammps_skin.engine.engine import Cells, Forces
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import lattice
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration
from lammps_skin.trajectory.convert import convert
from lammps_skin.trajectory.dump import read_dump
from lammps_skin.trajectory.frame import CELL_STATE, Frame
from lammps_skin.trajectory.recorder import Recorder

from tests.cells.conftest import lmp

INTERVAL, FRAMES = 0.5, 24


class Run(NamedTuple):
    """The same run twice, and the arrays of LAMMPS at the time of every frame.

    In `directory`, plain lmp has written skin.dump and `convert` skin.h5; in `driven`, Python has
    written skin.h5 on the way.
    """

    directory: Path
    driven: Path
    scene: Scene
    particles: list[Forces]
    cells: list[Cells]
    next_ids: list[int]
    frames: list[Frame]


def small_scene() -> Scene:
    """Cycles of about 1 time unit, pairs of half of that."""
    return Scene.from_dict(
        {
            "name": "small",
            "dermis": {"present": False},
            "membrane": {"lattice": [24, 28]},
            "cells": {
                "stem": 2, "nd": 1, "arrangement": "random", "generations": 2,
                "cycle_delay": 0.5, "cycle_rate": 2.0, "first_phase": 0.5, "division_rate": 5.0,
            },
            "numerics": {"accuracy": "reference", "event_interval": 0.1},
            "output": {"dump_interval": INTERVAL, "checkpoint_interval": 0.0},
        }
    )  # fmt: skip


def high_cells(scene: Scene) -> Configuration:
    """The first cells of the scene, and exhausted cells so high that they leave at once."""
    plain = Configuration.from_scene(scene)
    more = np.array([[2.0, 2.0, 26.0], [6.0, 2.0, 26.0], [10.0, 10.0, 26.0]])
    links, hinges = lattice.links_and_hinges(scene.membrane.lattice)
    return Configuration(
        box=plain.box,
        kinds=np.concatenate([plain.kinds, [Kind.EXHAUSTED] * len(more)]),
        positions=np.concatenate([plain.positions, more]),
        links=links,
        hinges=hinges,
        divisions_left=np.concatenate([plain.divisions_left, [0] * len(more)]),
    )


def same(frame: Frame, other: Frame) -> bool:
    """Bit for bit, NaN being equal to itself."""
    names = [field.name for field in fields(Frame) if field.name != "state"]
    pairs = [(getattr(frame, name), getattr(other, name)) for name in names]
    pairs += [(frame.state[name], other.state[name]) for name in CELL_STATE]
    return all(np.array_equal(a, b, equal_nan=True) for a, b in pairs)


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    directory, driven = (tmp_path_factory.mktemp(name) for name in ("by_lmp", "driven"))
    scene = small_scene()
    build(scene, directory, high_cells(scene))
    ended = lmp(directory, "-var", "end_time", str((FRAMES - 1) * INTERVAL))
    assert ended.returncode == 0, ended.stdout
    convert(directory)
    particles, cells, next_ids = [], [], []
    with Simulation.begin(scene, driven, high_cells(scene)) as simulation:
        for n in range(FRAMES):
            simulation.run(until=n * INTERVAL)
            particles.append(simulation.forces())
            cells.append(simulation.cells())
            next_ids.append(simulation.next_id())
    frames = list(read_dump(directory / "skin.dump"))
    return Run(directory, driven, scene, particles, cells, next_ids, frames)


class Replay:
    """Stands in for LAMMPS: moments, which `advance` goes through."""

    def __init__(self, moments: Iterable[tuple[Forces, Cells, int]]) -> None:
        self._moments = iter(moments)
        self._step = -round(INTERVAL / 0.01)
        self.advance()

    def advance(self) -> None:
        self._step += round(INTERVAL / 0.01)
        self._particles, self._cells, self._next_id = next(self._moments)

    def step(self) -> int:
        return self._step

    def time(self) -> float:
        return self._step * 0.01

    def timestep(self) -> float:
        return 0.01

    def box(self) -> tuple[float, float, float]:
        return small_scene().box_sides

    def forces(self) -> Forces:
        return self._particles

    def cells(self) -> Cells:
        return self._cells

    def next_id(self) -> int:
        return self._next_id


@pytest.fixture
def built(run, tmp_path) -> Path:
    """A built scene without results."""
    build(run.scene, tmp_path / "built", high_cells(run.scene))
    return tmp_path / "built"


def equal(frames: Iterable[Frame], others: Iterable[Frame]) -> bool:
    """As many, and bit for bit."""
    return all(same(*pair) for pair in zip(frames, others, strict=True))


def replay(run, recorder: Recorder) -> Iterator[int]:
    """Record the moments of the run; number of frames after each."""
    engine = Replay(zip(run.particles, run.cells, run.next_ids, strict=True))
    for n in range(1, FRAMES + 1):
        recorder.record(engine)
        yield n
        if n < FRAMES:
            engine.advance()
