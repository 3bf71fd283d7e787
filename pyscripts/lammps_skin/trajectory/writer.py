"""A trajectory in one HDF5 file, in the layout H5MD 1.1, with births and deaths."""

from __future__ import annotations

import getpass
import platform
import subprocess
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple, Self

import h5py
import numpy as np

from lammps_skin.arrays import Ints
from lammps_skin.errors import SkinError, why
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import to_toml
from lammps_skin.trajectory.check import GROUP, MEMBERS, NEXT_ID
from lammps_skin.trajectory.frame import ABSENT, ADDED, CELL_STATE, Frame
from lammps_skin.trajectory.hdf5 import open_hdf5
from lammps_skin.trajectory.packed import (
    FILTERS,
    SLOTS_PER_CHUNK,
    PackedFrame,
    element_type,
    pack,
    write_chunks,
)
from lammps_skin.versions import versions

BOUNDARY = ("periodic", "periodic", "none")
HISTORY = "parameters/history"
NOTE = np.dtype([("step", "i8"), ("time", "f8"), ("text", h5py.string_dtype())])


class Note(NamedTuple):
    """A moment of a run at which something was changed from outside, and what."""

    step: int
    time: float
    text: str


class TrajectoryWriter:
    """Writes frames to a file; a context manager that closes it.

    Every id that was ever given out has its slot, id - 1, in all frames; the slots of particles
    that do not exist in a frame hold fill values. Only chunks with a particle in them are
    written, so the cost of a frame depends neither on how many there are nor on how many
    particles have come and gone. Every frame is on disk when `write` returns.

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
    variables : mapping, optional
        What was given to LAMMPS instead of the scene's values.
    """

    def __init__(
        self, path: str | Path, scene: Scene, links: Ints, triangles: Ints,
        author: str | None = None, variables: Mapping[str, object] | None = None,
    ) -> None:  # fmt: skip
        self._path = Path(path)
        self._file = open_hdf5(path, "w")
        self._frames, self._slots, self._last_step = 0, 0, -1
        self._describe(scene, author or login(), variables or {})
        self._particles = self._file.create_group(GROUP)
        self._create_elements()
        for (name, width), members in zip(MEMBERS.items(), (links, triangles), strict=True):
            ids = np.reshape(members, (-1, width))
            dataset = self._file.create_dataset(f"connectivity/{name}", data=ids, dtype="i4")
            dataset.attrs["particles_group"] = self._particles.ref

    @classmethod
    def append(cls, path: str | Path, until: int | None = None, alone: bool = False) -> Self:
        """Open a file to write more frames to it; those after the step `until` are cut off.

        With `alone`, `OSError` is raised unless it is sure that nobody else has it open.
        """
        writer = cls.__new__(cls)
        writer._path = Path(path)
        writer._file = h5py.File(path, "r+") if alone else open_hdf5(path, "r+")
        try:
            writer._particles = writer._file[GROUP]
            steps = writer._particles["position/step"][:]
            writer._frames, writer._slots = writer._particles["id/value"].shape
        except (KeyError, ValueError):
            writer.close()
            raise SkinError(f"trajectory {path}: is no trajectory in HDF5") from None
        writer._add_missing()
        kept = len(steps) if until is None else int(np.searchsorted(steps, until, side="right"))
        if kept < len(steps):
            writer._cut(kept)
        if until is not None and HISTORY in writer._file:
            history = writer._file[HISTORY]
            history.resize(int((history["step"] <= until).sum()), axis=0)
        writer._last_step = int(steps[kept - 1]) if kept else -1
        return writer

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    @property
    def frames(self) -> int:
        """Number of frames in the file."""
        return self._frames

    @property
    def slots(self) -> int:
        """Number of slots, the highest id so far."""
        return self._slots

    @property
    def last_step(self) -> int:
        """Step of the last frame, -1 if there is none."""
        return self._last_step

    def add(self, one: PackedFrame | Note) -> None:
        """Append a frame, or a line to the history."""
        if isinstance(one, Note):
            self._note(one)
        else:
            self._write(one)

    def go_on(self, step: int, time: float, variables: Mapping[str, object]) -> None:
        """State what counts from a moment on: variables and versions; the history tells of it."""
        parameters = self._file["parameters"]
        changed = []
        for name, values in (("variables", variables), ("versions", _versions())):
            attributes = parameters.require_group(name).attrs
            for key, value in values.items():
                if attributes.get(key) != str(value):
                    attributes[key] = str(value)
                    changed.append(f"{key} = {value}")
        self._note(Note(step, time, f"resumed with {', '.join(changed) or 'nothing changed'}"))

    def write(self, frame: Frame) -> None:
        """Append a frame; raises `SkinError` unless its step is after that of the last one."""
        self._write(pack(frame))

    def _write(self, frame: PackedFrame) -> None:
        if frame.step <= self._last_step:
            raise SkinError(
                f"trajectory {self._path}: a frame of step {frame.step} cannot come after that "
                f"of step {self._last_step}"
            )
        self._slots = max(self._slots, frame.slots)
        rows: dict[str, Any] = {"position/step": frame.step, "position/time": frame.time}
        rows |= {"box/edges/value": frame.edges, f"/{NEXT_ID}/value": frame.next_id}
        for name, row in rows.items():
            self._particles[name].resize(self._frames + 1, axis=0)
            self._particles[name][self._frames] = row
        for name, chunks in frame.chunks.items():
            self._append(name, chunks)
        self._frames += 1
        self._last_step = frame.step
        self._file.flush()

    def _append(self, name: str, chunks: list[tuple[int, bytes]]) -> None:
        """Extend an element by a frame and by new slots; write the chunks that hold particles."""
        dataset = self._particles[name]["value"]
        dataset.resize((self._frames + 1, self._slots, *dataset.shape[2:]))
        write_chunks(dataset, self._frames, chunks)

    def _cut(self, frames: int) -> None:
        """Keep so many frames, and the slots of the ids that occur in them."""
        ids = self._particles["id/value"]
        self._frames = frames
        self._slots = max((int(ids[n].max(initial=0)) for n in range(frames)), default=0)
        for name in ("position/step", "position/time", "box/edges/value", f"/{NEXT_ID}/value"):
            self._particles[name].resize(frames, axis=0)
        for name in ("position", "id", "species", *CELL_STATE):
            dataset = self._particles[name]["value"]
            dataset.resize((frames, self._slots, *dataset.shape[2:]))

    def _note(self, note: Note) -> None:
        if HISTORY not in self._file:
            self._file.create_dataset(HISTORY, (0,), NOTE, maxshape=(None,), chunks=(64,))
        history = self._file[HISTORY]
        history.resize(len(history) + 1, axis=0)
        history[-1] = tuple(note)

    def _create_elements(self) -> None:
        position = self._create("position", (3,))
        position.create_dataset("step", (0,), "i8", maxshape=(None,), chunks=(1024,))
        position.create_dataset("time", (0,), "f8", maxshape=(None,), chunks=(1024,))
        box = self._particles.create_group("box")
        box.attrs["dimension"] = 3
        box.attrs.create("boundary", BOUNDARY, dtype=h5py.string_dtype("ascii", 8))
        edges = box.create_group("edges")
        edges.create_dataset("value", (0, 3), "f8", maxshape=(None, 3), chunks=(256, 3))
        others = [self._create(name) for name in ("id", "species", *CELL_STATE)]
        self._link_times(edges, self._create_next_id(), *others)

    def _create_next_id(self) -> Any:
        group = self._file.create_group(NEXT_ID)
        group.create_dataset(
            "value", (0,), "i8", maxshape=(None,), fillvalue=ABSENT, chunks=(1024,)
        )
        return group

    def _link_times(self, *elements: Any) -> None:
        for element in elements:
            for name in ("step", "time"):
                element[name] = self._particles["position"][name]

    def _add_missing(self) -> None:
        """Create the elements that an older file lacks; its frames do not tell them."""
        for name in ADDED:
            if name not in self._particles:
                element = self._create(name)
                element["value"].resize((self._frames, self._slots))
                self._link_times(element)
        if NEXT_ID not in self._file:
            element = self._create_next_id()
            element["value"].resize(self._frames, axis=0)
            self._link_times(element)

    def _create(self, name: str, inner: tuple[int, ...] = ()) -> Any:
        """A time-dependent element of the particles, without its step and time."""
        group = self._particles.create_group(name)
        kind, fill = element_type(name)
        group.create_dataset(
            "value", (0, 0, *inner), kind, maxshape=(None, None, *inner), fillvalue=fill,
            chunks=(1, SLOTS_PER_CHUNK, *inner), **FILTERS,
        )  # fmt: skip
        return group

    def _describe(self, scene: Scene, author: str, variables: Mapping[str, object]) -> None:
        """Who and what made the file, from which scene."""
        h5md = self._file.create_group("h5md")
        h5md.attrs.create("version", (1, 1), dtype="i4")
        h5md.create_group("author").attrs["name"] = author
        creator = h5md.create_group("creator").attrs
        creator["name"], creator["version"] = "lammps-skin", version("lammps-skin")
        parameters = self._file.create_group("parameters")
        parameters.attrs["scene"] = to_toml(scene.model_dump(exclude_none=True))
        parameters.attrs["parameters"] = scene.parameters
        parameters.attrs["seed"] = int(str(variables.get("seed", scene.cell_seed)))
        given = parameters.create_group("variables").attrs
        for name, value in variables.items():
            given[name] = str(value)
        kinds = parameters.create_group("species").attrs
        for kind in scene.all_kinds:
            kinds[kind.label] = int(kind)
        versions = parameters.create_group("versions").attrs
        for name, value in _versions().items():
            versions[name] = value


def _versions() -> dict[str, str]:
    """Versions of what writes a file, and the commit of the source tree if there is one."""
    found = {"python": platform.python_version(), **versions()}
    found |= {name: version(name) for name in ("numpy", "h5py")}
    commit = source_commit()
    return {**found, "commit": commit} if commit else found


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


def reason(error: OSError) -> str:
    """Why something cannot be read or written, in a few words also where HDF5 has many."""
    return why(error.errno) if error.errno else " ".join(str(error).split())


def login() -> str:
    """Who runs this process."""
    try:
        return getpass.getuser()
    except (OSError, KeyError):
        return "unknown"
