"""The trajectory of a run in HDF5, read frame by frame; where the trajectory of a run is."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from lammps_skin.arrays import Ints
from lammps_skin.errors import DamagedError, SkinError, reading
from lammps_skin.kinds import Kind
from lammps_skin.trajectory.check import check_frame, opened, read_headers
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.frame import ABSENT, CELL_STATE, Frame

STORE, DUMP = "skin.h5", "skin.dump"


class Store:
    """The frames of a skin.h5; in memory are only their steps and times.

    The file is open as long as the object exists, so that a run that goes on changes nothing in
    what it gives.

    Attributes
    ----------
    steps, times : (f,) arrays
    slots : int
        The highest id ever given out.
    scene : Scene
    seed : int
        Of the cells of the run, which may be another one than the scene's.
    links : (l, 2) array of int
        Ids of linked membrane particles.
    triangles : (t, 3) array of int
        Ids of their corners, counterclockwise seen from the side of the cells.
    versions : dict of str to str
        Versions of what has made the file, as far as it names them.

    Raises
    ------
    DamagedError
        For a file that is no trajectory in HDF5, or that cannot be right.
    SkinError
        For one that cannot be read now.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._open()

    def _open(self) -> None:
        self._file = opened(self.path)
        headers = read_headers(self._file, self.path)
        self.steps, self.times, self.slots, self.scene, self.seed = headers[:5]
        self.links, self.triangles = headers.members["links"], headers.members["triangles"]
        self._values, self.versions = headers.values, headers.versions
        self._membrane: Ints | None = None
        if len(self):
            first = self[0]
            self._membrane = first.ids[first.kinds == Kind.MEMBRANE]
            for name, members in headers.members.items():
                if not np.isin(members, self._membrane).all():
                    raise DamagedError(
                        f"trajectory {self.path}: its {name} are not those of its membrane"
                    )

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __len__(self) -> int:
        return len(self.steps)

    def __getitem__(self, n: int) -> Frame:
        step = int(self.steps[n])
        what = f"trajectory {self.path}: frame {n}"
        with reading(what):
            ids = self._values["id"][n]
            here = ids != ABSENT
            if not np.array_equal(ids[here], np.flatnonzero(here) + 1):
                raise DamagedError(f"{what}: ids are not those of their slots")
            values = {
                name: self._values[name][n][here] for name in ("position", "species", *CELL_STATE)
            }
            frame = Frame(
                step=step,
                time=float(self.times[n]),
                edges=self._values["edges"][n].astype(float),
                ids=ids[here].astype(np.int64),
                kinds=values.pop("species").astype(np.int64),
                positions=values.pop("position").astype(float),
                state={
                    name: column.astype(np.int64 if column.dtype.kind == "i" else float)
                    for name, column in values.items()
                },
                next_id=int(self._values["next_id"][n]),
            )
        try:
            check_frame(frame, self.scene.kinds, self._membrane, self.slots)
        except DamagedError as error:
            raise DamagedError(f"{what}: {error}") from None
        return frame

    def __iter__(self) -> Iterator[Frame]:
        return (self[n] for n in range(len(self)))

    def parents(self, n: int, above: int) -> tuple[Ints, Ints]:
        """Ids of the cells of a frame that are higher than some id, and of their mothers."""
        with reading(f"trajectory {self.path}: frame {n}"):
            told = self._values["parent"][n, above:].astype(np.int64)
        cells = np.flatnonzero(told != ABSENT)
        return cells + above + 1, told[cells]

    def __getstate__(self) -> dict[str, Any]:
        return {"path": self.path, "steps": self.steps}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Open the file again; it may have gone on, but must be the same up to here."""
        self.path = state["path"]
        self._open()
        frames = len(state["steps"])
        if not np.array_equal(self.steps[:frames], state["steps"]):
            raise SkinError(f"trajectory {self.path}: has been replaced by another one")
        self.steps, self.times = self.steps[:frames], self.times[:frames]


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
