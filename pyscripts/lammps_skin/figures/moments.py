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
from lammps_skin.trajectory.frames import nearest_frame, open_frames

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
    moments = []
    for time in times:
        frame = frames[nearest_frame(frames, time)]
        off = 0.0 if time is None else abs(frame.time - time)
        if not off <= scene.output.dump_interval / 2 + 1e-6:
            raise FigureError(
                f"time = {time:g}: the nearest frame of {frames.path} is at {frame.time:g}"
            )
        members = frame.ids[frame.kinds == Kind.MEMBRANE]
        triangles = np.searchsorted(members, frames.triangles)
        moments.append(Moment(scene, frame.time, frame.kinds, frame.positions, triangles))
    return moments


def last_time(path: Path) -> float:
    """Time of the last frame of a run directory."""
    return float(open_frames(path).times[-1])
