"""The particles of a run at chosen times, from skin.h5 or from skin.dump."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import MDAnalysis
import numpy as np

from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import FigureError
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.connectivity import connectivity
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.store import STORE, Store, trajectory_of

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
    """

    scene: Scene
    time: float
    kinds: Ints
    positions: Floats
    triangles: Ints

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
    FigureError
        If there is no trajectory, or no frame within half an interval between two of them.
    """
    if isinstance(source, MDAnalysis.Universe):
        path = Path(source.trajectory.filename)
        times = [source.trajectory.ts.time if time is None else time for time in times]
    else:
        path = trajectory_of(source) if Path(source).is_dir() else Path(source)
    scene, frames, written = _open(path)
    corners = frames.triangles if isinstance(frames, Store) else connectivity(path.parent)[1]
    moments = []
    for time in times:
        nearest = len(written) - 1 if time is None else int(np.abs(written - time).argmin())
        frame = frames[nearest]
        off = 0.0 if time is None else abs(frame.time - time)
        if not off <= scene.output.dump_interval / 2 + 1e-6:
            raise FigureError(f"time = {time:g}: the nearest frame of {path} is at {frame.time:g}")
        members = frame.ids[frame.kinds == Kind.MEMBRANE]
        triangles = np.searchsorted(members, corners)
        moments.append(Moment(scene, frame.time, frame.kinds, frame.positions, triangles))
    return moments


def last_time(path: Path) -> float:
    """Time of the last frame of a run directory."""
    _, _, written = _open(trajectory_of(path))
    return float(written[-1])


def _open(path: Path) -> tuple[Scene, Dump | Store, Floats]:
    """Scene, frames and their times (f,)."""
    if not path.is_file():
        raise FigureError(f"run {path}: there is no such directory or file")
    frames = (Store if path.suffix == Path(STORE).suffix else Dump)(path)
    if not len(frames):
        raise FigureError(f"trajectory {path}: holds no complete frame")
    return frames.scene, frames, np.asarray(frames.times)
