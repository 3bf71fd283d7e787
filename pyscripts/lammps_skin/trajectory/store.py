"""The trajectory of a run in HDF5, read frame by frame; where the trajectory of a run is."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np

from lammps_skin.errors import SkinError, reading
from lammps_skin.kinds import Kind
from lammps_skin.scene import Scene
from lammps_skin.trajectory.dump import Dump
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
        except (OSError, LookupError, ValueError, TypeError, AttributeError, RuntimeError):
            raise SkinError(f"trajectory {path}: is no trajectory in HDF5") from None
        if len(self):
            self._check_members(self[0])

    def __len__(self) -> int:
        return len(self.steps)

    def _check_members(self, first: Frame) -> None:
        """Links and triangles are of particles of the membrane."""
        membrane = first.ids[first.kinds == Kind.MEMBRANE]
        for name, members in (("links", self.links), ("triangles", self.triangles)):
            if not np.isin(members, membrane).all():
                raise SkinError(f"trajectory {self.path}: its {name} are not those of its membrane")

    def __getitem__(self, n: int) -> Frame:
        with reading(f"trajectory {self.path}: frame {n}"), h5py.File(self.path) as file:
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
    """The trajectory in a run directory: the one that has gone on last if there are two.

    A dump that begins after skin.h5 is of a run that goes on from a restart file: of these the
    one with the later end counts, whatever the files' times are. Of two runs from the start it is
    the one that was written last.
    """
    store, dump = Path(run) / STORE, Path(run) / DUMP
    found = [path for path in (store, dump) if path.is_file()]
    if not found:
        raise SkinError(f"directory {run}: holds no trajectory (neither {STORE} nor {DUMP})")
    try:
        ours, theirs = ([*Store(store).steps], Dump(dump, ()).steps) if found[1:] else ([], [])
    except SkinError:  # one of them cannot be read
        ours, theirs = [], []
    if ours and theirs and ours[0] < theirs[0]:
        return dump if theirs[-1] > ours[-1] else store
    return max(found, key=lambda path: path.stat().st_mtime_ns)
