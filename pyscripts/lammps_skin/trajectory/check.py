"""Whether a trajectory can be what it says: the one place that looks, before anything uses it.

Headers are checked when a file is opened, and each frame when it is read. What is refused here is
a `DamagedError` that names the element or the frame.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import DamagedError, SkinError, reading
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.frame import ABSENT, ADDED, CELL_STATE, WHOLE, Frame
from lammps_skin.trajectory.hdf5 import open_hdf5

GROUP = "particles/trajectory"
NEXT_ID = "observables/trajectory/next_id"
MEMBERS = {"links": 2, "triangles": 3}  # of the membrane, and how many ids each has
INTEGER = 2**31 - 1
LARGEST_CHUNK = 2**22  # bytes that a chunk may have when it is unpacked; ours have 98,304
MOST_PER_BYTE = 8  # slots of a file, or sites of the lattice of its scene


class Headers(NamedTuple):
    """What a skin.h5 says of all its frames.

    Attributes
    ----------
    steps, times : (f,) arrays
    slots : int
    scene : Scene
    seed : int
        Of the cells of the run, which may be another one than the scene's.
    members : dict
        Ids of the particles of the links (l, 2) and triangles (t, 3) of the membrane.
    values : dict
        The dataset of each element of the particles.
    versions : dict
        Versions of what has made the file, as far as it names them.
    """

    steps: Ints
    times: Floats
    slots: int
    scene: Scene
    seed: int
    members: dict[str, Ints]
    values: dict[str, Any]
    versions: dict[str, str]


# ---- a file in HDF5


def opened(path: Path) -> h5py.File:
    """The file, open for reading.

    Raises
    ------
    DamagedError
        If it is no file in HDF5, or has been cut off.
    SkinError
        If it cannot be read now; the text says why.
    """
    try:
        with reading(f"trajectory {path}"):
            return open_hdf5(path)
    except DamagedError:
        raise DamagedError(f"trajectory {path}: is no trajectory in HDF5") from None


def read_headers(file: h5py.File, path: Path) -> Headers:
    """Check all of a file but the contents of its frames."""
    with reading(f"trajectory {path}"):
        return _Checked(file, path).headers()


class _Checked:
    """Access to a file in which nobody is trusted."""

    def __init__(self, file: h5py.File, path: Path) -> None:
        self._file = file
        self._path = path
        self._size = file.id.get_filesize()

    def headers(self) -> Headers:
        for name in ("particles", GROUP, f"{GROUP}/id", "parameters"):
            if name not in self._file:
                raise DamagedError(f"trajectory {self._path}: is no trajectory in HDF5")
        steps, times = self._axis("step", "i"), self._axis("time", "f")
        if len(steps) != len(times):
            raise self._wrong(f"has {len(steps)} steps and {len(times)} times")
        for name, values in (("steps", steps), ("times", times)):
            if len(values) and not (values[0] >= 0 and (np.diff(values) > 0).all()):
                raise self._wrong(f"its {name} do not rise from 0 or later")
        if not np.isfinite(times).all():
            raise self._wrong("its times are not all finite")
        slots = self._slots()
        frames = len(steps)
        values = {"edges": self._dataset(f"{GROUP}/box/edges/value", "f", (frames, 3))}
        values["next_id"] = self._dataset(f"{NEXT_ID}/value", "i", (frames,), ABSENT)
        for name, (kind, inner) in ELEMENTS.items():
            absent = CELL_STATE[name] if name in ADDED else None
            shape = (frames, slots, *inner)
            values[name] = self._dataset(f"{GROUP}/{name}/value", kind, shape, absent)
        scene = self._scene()
        members = {name: self._members(name, width) for name, width in MEMBERS.items()}
        return Headers(
            steps.astype(np.int64), times, slots, scene, self._seed(), members, values,
            self._versions(),
        )  # fmt: skip

    def _wrong(self, why: str) -> DamagedError:
        return DamagedError(f"trajectory {self._path}: {why}")

    def _axis(self, name: str, kind: str) -> Any:
        """The steps or times, which are those of all elements."""
        dataset = self._dataset(f"{GROUP}/position/{name}", kind, (None,))
        self._bound(len(dataset), "frames", 1 / 8)
        return dataset[:]

    def _slots(self) -> int:
        slots = int(self._dataset(f"{GROUP}/id/value", "i", (None, None)).shape[1])
        self._bound(slots, "slots", MOST_PER_BYTE)
        return slots

    def _bound(self, number: int, name: str, per_byte: float = 1) -> None:
        """Raise `DamagedError` if there are more of something than the file can hold."""
        if number > per_byte * self._size:
            raise self._wrong(f"{number:,} {name} cannot be in {self._size:,} bytes")

    def _members(self, name: str, width: int) -> Ints:
        dataset = self._dataset(f"connectivity/{name}", "i", (None, width))
        self._bound(len(dataset), name)
        members: Ints = dataset[:].astype(np.int64)
        return members

    def _scene(self) -> Scene:
        text = self._followed("parameters").attrs["scene"]
        try:
            scene = Scene.from_dict(tomllib.loads(text))
        except (SkinError, tomllib.TOMLDecodeError) as error:
            raise self._wrong(f"its scene cannot be: {str(error).splitlines()[0]}") from None
        self._bound(math.prod(scene.membrane.lattice), "sites of its lattice", MOST_PER_BYTE)
        return scene

    def _versions(self) -> dict[str, str]:
        if "versions" not in self._followed("parameters"):
            return {}
        named = self._followed("parameters/versions").attrs
        return {name: str(value) for name, value in named.items()}

    def _seed(self) -> int:
        seed = self._file["parameters"].attrs["seed"]
        if not isinstance(seed, np.integer):
            raise self._wrong("its seed is no whole number")
        return int(seed)

    def _dataset(
        self, name: str, kind: str, shape: tuple[int | None, ...], absent: float | None = None
    ) -> Any:
        """A dataset that lies in this file, of a kind of numbers and a shape; None is any size.

        If the file may lack it and does, an array of the number `absent`.
        """
        if absent is not None and name.rsplit("/", 1)[0] not in self._file:
            return np.broadcast_to(np.array(absent, kind + "8"), [size or 0 for size in shape])
        dataset = self._followed(name)
        if not isinstance(dataset, h5py.Dataset):
            raise self._wrong(f"{name} is no dataset")
        if dataset.external or dataset.is_virtual:
            raise self._wrong(f"{name} is stored in another file")
        if dataset.dtype.kind != kind or dataset.dtype.itemsize not in (4, 8):
            raise self._wrong(f"{name} has numbers of the type {dataset.dtype}")
        if len(dataset.shape) != len(shape) or any(
            wanted not in (None, size) for wanted, size in zip(shape, dataset.shape, strict=True)
        ):
            form = " x ".join("any" if size is None else f"{size}" for size in shape)
            raise self._wrong(f"{name} has the shape {dataset.shape}; must be {form}")
        if dataset.chunks is None and dataset.id.get_storage_size() < dataset.nbytes:
            raise self._wrong(f"{name} has {dataset.nbytes:,} bytes that are not in the file")
        unpacked = np.prod(dataset.chunks or (0,), dtype=float) * dataset.dtype.itemsize
        if unpacked > LARGEST_CHUNK:
            raise self._wrong(f"{name} has chunks of {unpacked:,.0f} bytes")
        parent = self._file[name.rsplit("/", 1)[0]]
        if "unit" in dataset.attrs or "unit" in parent.attrs:
            raise self._wrong(f"{name} has a unit; these files are in reduced units")
        return dataset

    def _followed(self, name: str) -> Any:
        """What a path leads to; no step of it may be a link to somewhere else."""
        here: Any = self._file
        for part in name.split("/"):
            link = here.get(part, getlink=True) if isinstance(here, h5py.Group) else None
            if link is None:
                raise self._wrong(f"{name} is missing")
            if not isinstance(link, h5py.HardLink):
                raise self._wrong(f"{name} is a link to somewhere else")
            here = here[part]
        return here


ELEMENTS: dict[str, tuple[str, tuple[int, ...]]] = {
    "position": ("f", (3,)),
    "id": ("i", ()),
    "species": ("i", ()),
    **{name: ("i" if name in WHOLE else "f", ()) for name in CELL_STATE},
}


# ---- a frame of any file


def check_frame(
    frame: Frame, kinds: Sequence[int] | Ints, members: Ints | None, slots: int
) -> None:
    """Raise `DamagedError` if the particles of a frame cannot be those of a scene.

    Parameters
    ----------
    frame : Frame
    kinds : sequence of int
        Those that the scene has.
    members : (m,) array of int or None
        Ids of the membrane in another frame, which are the same in all.
    slots : int
        The highest id that there can be.
    """
    for reason in _reasons(frame, kinds, members, slots):
        raise DamagedError(reason)


def _reasons(
    frame: Frame, kinds: Sequence[int] | Ints, members: Ints | None, slots: int
) -> Iterator[str]:
    ids, positions = frame.ids, frame.positions
    if not len(ids):
        yield "there is no particle"
        return
    known = np.isin(frame.kinds, kinds)
    if not known.all():
        first = known.argmin()
        yield f"particle {ids[first]} is of kind {frame.kinds[first]}, which the scene has not"
    finite = np.isfinite(positions)
    if not finite.all():
        yield f"the position of particle {ids[finite.all(axis=1).argmin()]} is not finite"
    if not (np.isfinite(frame.edges).all() and (frame.edges > 0).all()):
        yield f"the box has the sides {frame.edges.tolist()}"
    if frame.next_id != ABSENT and frame.next_id <= ids.max():
        yield f"the next id is {frame.next_id}, and there is particle {ids.max()}"
    membrane = ids[frame.kinds == Kind.MEMBRANE]
    if not len(membrane):
        yield "there is no membrane particle"
    if members is not None and not np.array_equal(membrane, members):
        yield "its membrane is not that of the first frame"
    places = np.flatnonzero(is_cell(frame.kinds))
    cells = ids[places]
    for name, values in frame.state.items():
        column = values[places]
        if name in ADDED and np.array_equal(column, np.full_like(column, CELL_STATE[name]), True):
            continue
        right = np.isfinite(column) if name not in WHOLE else (column >= 0) & (column <= INTEGER)
        if name == "partner":
            right = (column == 0) | np.isin(column, membrane)
        elif name == "pair":
            right &= column <= slots
        if not right.all():
            first = right.argmin()
            yield f"{name} of cell {cells[first]} is {column[first]}"
