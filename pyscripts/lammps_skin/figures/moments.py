"""The particles of a run at chosen times, from skin.h5 or from skin.dump."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TypeAlias

import MDAnalysis
import numpy as np

from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import FigureError
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.clones import clones
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.frame import Frame
from lammps_skin.trajectory.frames import nearest_frame, open_frames
from lammps_skin.trajectory.store import Store

Source: TypeAlias = str | Path | MDAnalysis.Universe


@dataclass(frozen=True)
class Moment:
    """The n living particles of one frame, sorted by id.

    Attributes
    ----------
    scene : Scene
    time : float
    kinds : (n,) array of int
    positions : (n, 3) array
    triangles : (t, 3) array of int
        Of the membrane, as indices of its particles, counterclockwise seen from the cells.
    heights : (low, high)
        Of the membrane and, whole, the cells of the first and the last frame of the run: what its
        pictures hold, so that they are alike.
    relief : (low, high)
        Of the membrane in these two frames: the ends of colours of heights.
    ids : (n,) array of int
    state : mapping of (n,) arrays
        Of cells, by the names in `trajectory.frame.CELL_STATE`.
    frames : Store or Dump
        The run.
    """

    scene: Scene
    time: float
    kinds: Ints
    positions: Floats
    triangles: Ints
    heights: tuple[float, float]
    relief: tuple[float, float]
    ids: Ints
    state: Mapping[str, Ints | Floats]
    frames: Store | Dump

    def of(self, *kinds: Kind) -> Floats:
        """Positions (k, 3) of the particles of some kinds."""
        return self.positions[np.isin(self.kinds, kinds)]

    @property
    def box(self) -> tuple[float, float]:
        """L_x, L_y."""
        return self.scene.box_sides[:2]

    @property
    def membrane(self) -> Floats:
        """Positions (m, 3) of the membrane."""
        return self.of(Kind.MEMBRANE)

    @property
    def founders(self) -> Ints:
        """The founder (n,) of each cell; 0 of other particles."""
        return _founders(self.frames)[self.ids - 1]

    def shifted(self, shift: Sequence[float]) -> Moment:
        """The same with all particles moved in x and y, across the sides of the periodic box."""
        return replace(self, positions=self.positions + np.array([*shift, 0.0]))


@lru_cache(maxsize=1)
def _founders(frames: Store | Dump) -> Ints:
    return clones(frames)


def read_moments(source: Source, times: Sequence[float | None]) -> list[Moment]:
    """The frames of a run nearest to some times.

    Parameters
    ----------
    source : path or Universe
        Directory of a run, its skin.h5 or its skin.dump, or what `open_trajectory` gave.
    times : sequence of float
        None is the last frame of a file, and the present one of a Universe.

    Raises
    ------
    SkinError
        If there is no trajectory.
    FigureError
        If there is no frame within half an interval between two of them.
    """
    if isinstance(source, MDAnalysis.Universe):
        now = source.trajectory.ts.time
        times = [now if time is None else time for time in times]
        source = source.trajectory.filename
    frames = open_frames(source)
    scene = frames.scene
    ends = frames[0], frames[len(frames) - 1]
    moments = []
    for time in times:
        frame = frames[nearest_frame(frames, time)]
        off = 0.0 if time is None else abs(frame.time - time)
        if not off <= scene.output.dump_interval / 2 + 1e-6:
            raise FigureError(
                f"time = {time:g}: the nearest frame of {frames.path} is at {frame.time:g}"
            )
        moments.append(_moment(frames, frame, ends))
    return moments


def all_moments(source: Source, every: int = 1) -> Iterator[Moment]:
    """The frames of a run one after the other, or each of so many."""
    frames = open_frames(source)
    ends = frames[0], frames[len(frames) - 1]
    return (_moment(frames, frames[n], ends) for n in range(0, len(frames), every))


def _moment(frames: Store | Dump, frame: Frame, ends: tuple[Frame, Frame]) -> Moment:
    members = frame.ids[frame.kinds == Kind.MEMBRANE]
    triangles = np.searchsorted(members, frames.triangles)
    return Moment(
        frames.scene, frame.time, frame.kinds, frame.positions, triangles,
        _heights(frames.scene, *ends), _relief(*ends), frame.ids, frame.state, frames,
    )  # fmt: skip


def _heights(scene: Scene, *frames: Frame) -> tuple[float, float]:
    """Lowest and highest place of membrane and cells, and a radius of a cell on both sides."""
    low, high = np.inf, -np.inf
    for frame in frames:
        z = frame.positions[frame.kinds != Kind.DERMAL, 2]
        low, high = min(low, z.min()), max(high, z.max())
    return float(low - scene.cells.radius), float(high + 2 * scene.cells.radius)


def _relief(*frames: Frame) -> tuple[float, float]:
    """Lowest and highest place of the membrane."""
    z = np.concatenate([frame.positions[frame.kinds == Kind.MEMBRANE, 2] for frame in frames])
    return float(z.min()), float(z.max())


def last_time(path: Path) -> float:
    """Time of the last frame of a run directory."""
    return float(open_frames(path).times[-1])
