"""The trajectory of a run in HDF5, read frame by frame; where the trajectory of a run is."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np

from lammps_skin.errors import SkinError
from lammps_skin.scene import Scene
from lammps_skin.trajectory.frame import ABSENT, CELL_STATE, Frame
from lammps_skin.trajectory.writer import GROUP

STORE, DUMP = "skin.h5", "skin.dump"


class Store:
    """The frames of a skin.h5; in memory are only their steps.

    Attributes
    ----------
    scene : Scene
    links : (l, 2) array of int
        Ids of linked membrane particles.
    triangles : (t, 3) array of int
        Ids of their corners, counterclockwise seen from the side of the cells.

    Raises
    ------
    SkinError
        For a file that is no trajectory in HDF5.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        try:
            with h5py.File(path) as file:
                self.steps = file[f"{GROUP}/position/step"][:]
                self.slots = int(file[f"{GROUP}/id/value"].shape[1])
                self.scene = Scene.from_dict(tomllib.loads(file["parameters"].attrs["scene"]))
                self.links = file["connectivity/links"][:].astype(np.int64)
                self.triangles = file["connectivity/triangles"][:].astype(np.int64)
        except (OSError, KeyError, ValueError):
            raise SkinError(f"trajectory {path}: is no trajectory in HDF5") from None

    def __len__(self) -> int:
        return len(self.steps)

    def __getitem__(self, n: int) -> Frame:
        with h5py.File(self.path) as file:
            group = file[GROUP]
            ids = group["id/value"][n]
            here = ids != ABSENT
            values = {
                name: group[name]["value"][n][here] for name in ("position", "species", *CELL_STATE)
            }
            return Frame(
                step=int(self.steps[n]),
                time=float(group["position/time"][n]),
                edges=group["box/edges/value"][n],
                ids=ids[here].astype(np.int64),
                kinds=values.pop("species").astype(np.int64),
                positions=values.pop("position"),
                state={
                    name: column.astype(np.int64) if column.dtype.kind == "i" else column
                    for name, column in values.items()
                },
            )

    def __iter__(self) -> Iterator[Frame]:
        return (self[n] for n in range(len(self)))


def trajectory_of(run: str | Path) -> Path:
    """The trajectory in a run directory: the one that was written last if there are two."""
    found = [path for path in (Path(run) / STORE, Path(run) / DUMP) if path.is_file()]
    if not found:
        raise SkinError(f"directory {run}: holds no trajectory (neither {STORE} nor {DUMP})")
    return max(found, key=lambda path: path.stat().st_mtime_ns)
