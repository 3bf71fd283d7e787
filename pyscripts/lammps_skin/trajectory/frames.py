"""The frames of a run, from skin.h5 or from skin.dump."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lammps_skin.errors import SkinError
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.store import DUMP, Store, trajectory_of


def open_frames(run: str | Path) -> Store | Dump:
    """The frames of a run directory, or of a trajectory; `SkinError` if there is none."""
    path = Path(run)
    if path.is_dir():
        path = trajectory_of(path)
    frames = Dump(path) if path.suffix == Path(DUMP).suffix else Store(path)
    if not len(frames):
        raise SkinError(f"trajectory {path}: holds no complete frame")
    return frames


def nearest_frame(frames: Store | Dump, time: float | None) -> int:
    """Number of the frame nearest to a time; of the last one without a time."""
    if time is None:
        return len(frames) - 1
    return int(np.abs(np.asarray(frames.times) - time).argmin())
