"""What MDAnalysis reads: skin.h5 as format SKIN, skin.dump as format SKINDUMP.

Both give an atom for every id ever given out; atom n has id n + 1. ``ts.positions`` are in
single precision and NaN where there is nothing; ``ts.data`` has, as arrays over all atoms, alive
(1 or 0), radius, and all that `Frame.over_slots` gives, so positions in double precision too.
MDAnalysis knows the files by their contents as soon as this module is imported.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.errors import SkinError
from lammps_skin.kinds import FIRST_CELL, Kind
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.attributes import ATTRIBUTES, labels
from lammps_skin.trajectory.clones import clones
from lammps_skin.trajectory.dump import FIRST_ITEM, Dump
from lammps_skin.trajectory.frame import ABSENT
from lammps_skin.trajectory.store import DUMP, STORE, Store

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of packages that MDAnalysis imports
    from MDAnalysis.coordinates.base import ReaderBase
    from MDAnalysis.coordinates.core import writer
    from MDAnalysis.coordinates.memory import MemoryReader
    from MDAnalysis.core.topology import Topology
    from MDAnalysis.core.topologyattrs import Atomids, Bonds, Masses, Resids, Resnames, Segids
    from MDAnalysis.lib.log import ProgressBar
    from MDAnalysis.lib.util import store_init_arguments
    from MDAnalysis.topology.base import TopologyReaderBase

UNEVEN = 1e-6  # of their mean: distances between frames that are told


# ---- frames


class FrameReader(ReaderBase):  # type: ignore[misc]
    """Reader of the frames of a `Store` or a `Dump`.

    Times are those of the frames. ``dt`` is their distance, the mean one where they are unevenly
    spaced.
    """

    units = {"time": None, "length": None}  # noqa: RUF012
    opened: Callable[[str], Store | Dump]

    @store_init_arguments  # type: ignore[untyped-decorator]
    def __init__(self, filename: str | Path, **options: Any) -> None:
        super().__init__(str(filename), **{**options, "convert_units": False})
        self.frames = type(self).opened(self.filename)
        if not len(self.frames):
            raise SkinError(f"trajectory {filename}: holds no complete frame")
        self.n_atoms = self.frames.slots
        self.n_frames = len(self.frames)
        self.scene, self.triangles = self.frames.scene, self.frames.triangles
        self.seed = self.frames.seed
        self._radii, self._labels = _radii(self.scene), labels(self.scene)
        self.ts = self._Timestep(self.n_atoms, positions=True, **self._ts_kwargs)
        if "dt" not in self._ts_kwargs:
            self.ts.dt = self._distance()
        self._reopen()
        self._read_next_timestep()

    @classmethod
    def parse_n_atoms(cls, filename: str | Path, **_: Any) -> int:
        return cls.opened(str(filename)).slots

    def _distance(self) -> float:
        times = self.frames.times
        if len(times) < 2:
            return float(self.scene.output.dump_interval)
        between = np.diff(times)
        mean = float(times[-1] - times[0]) / len(between)
        if np.ptp(between) > UNEVEN * mean:
            warnings.warn(
                f"trajectory {self.filename}: frames are {between.min():g} to {between.max():g} "
                f"apart; dt = {mean:g} is the mean, and times are exact",
                stacklevel=2,
            )
        return mean

    def _reopen(self) -> None:
        """Go before the first frame; the timestep stays until another one is read."""
        self._frame = -1

    def _read_next_timestep(self, ts: Any = None) -> Any:
        return self._read_frame(self._frame + 1)

    def _read_frame(self, n: int) -> Any:
        if n >= self.n_frames:
            raise OSError("there are no more frames")  # as MDAnalysis wants to be told
        frame, ts = self.frames[n], self.ts
        ts.frame = self._frame = n
        ts.dimensions = [*frame.edges, 90, 90, 90]
        data = frame.over_slots(self.n_atoms)
        ts.positions = data["position"]
        ts.data |= {
            **data,
            "time": frame.time,
            "step": frame.step,
            "edges": frame.edges,
            "alive": (data["id"] != ABSENT).astype(np.int64),
            "radius": self._radii[data["species"]],
            "labels": self._labels,
        }
        return ts

    def Writer(self, filename: str | Path, n_atoms: int | None = None, **options: Any) -> Any:
        """Writer of a format of MDAnalysis, by the name, for frames at the distance of these."""
        return writer(str(filename), n_atoms or self.n_atoms, **{"dt": self.dt, **options})

    def in_memory(
        self, start: int | None, stop: int | None, step: int | None, verbose: bool = False
    ) -> MemoryFrames:
        """Frames in memory, with all that they hold."""
        positions, boxes, moments = [], [], []
        for ts in ProgressBar(self[start:stop:step], verbose=verbose, desc="Loading frames"):
            positions.append(ts.positions.copy())
            boxes.append(ts.dimensions.copy())
            moments.append(ts.data.copy())
        if not moments:
            raise SkinError(f"frames {start}:{stop}:{step}: there are none of {self.n_frames}")
        distance = self.ts.dt * (step or 1)
        return MemoryFrames(
            np.array(positions), dimensions=np.array(boxes), dt=distance,
            filename=self.filename, moments=[{**moment, "dt": distance} for moment in moments],
            source=self,
        )  # fmt: skip


def _radii(scene: Scene) -> Floats:
    """Radius of each kind of particle, by its number; NaN at the end, for `ABSENT`."""
    radii = np.full(len(scene.all_kinds) + 2, np.nan)
    radii[FIRST_CELL:-1] = scene.cells.radius
    radii[Kind.DERMAL], radii[Kind.MEMBRANE] = scene.dermis.radius, scene.membrane.radius
    return radii


class SkinReader(FrameReader):
    """Reader of skin.h5."""

    format = "SKIN"
    opened = Store

    @staticmethod
    def _format_hint(thing: Any) -> bool:
        return _is_store(thing)


class SkinDumpReader(FrameReader):
    """Reader of skin.dump, whose scene lies beside it."""

    format = "SKINDUMP"
    opened = Dump

    @staticmethod
    def _format_hint(thing: Any) -> bool:
        return _is_dump(thing)


class MemoryFrames(MemoryReader):  # type: ignore[misc]
    """Frames of a `FrameReader` in memory: positions can be changed, the rest is as it was read."""

    def __init__(self, array: Any, *, moments: Any, source: FrameReader, **options: Any) -> None:
        self._moments = moments
        super().__init__(array, **options)
        self._kwargs |= {"moments": moments, "source": source}
        self.scene, self.triangles = source.scene, source.triangles

    def _read_next_timestep(self, ts: Any = None) -> Any:
        ts = super()._read_next_timestep(ts)
        ts.data |= self._moments[ts.frame]
        return ts


# ---- atoms


class SkinParser(TopologyReaderBase):  # type: ignore[misc]
    """Atoms, clones and the links of the membrane, of skin.h5."""

    format = "SKIN"

    @staticmethod
    def _format_hint(thing: Any) -> bool:
        return _is_store(thing)

    def parse(self, **_: Any) -> Topology:
        """The topology, which is the same in all frames."""
        return _topology(Store(self.filename))


class SkinDumpParser(TopologyReaderBase):  # type: ignore[misc]
    """Atoms, clones and the links of the membrane, of skin.dump."""

    format = "SKINDUMP"

    @staticmethod
    def _format_hint(thing: Any) -> bool:
        return _is_dump(thing)

    def parse(self, **_: Any) -> Topology:
        """The topology, which is the same in all frames."""
        return _topology(Dump(self.filename))


def _topology(frames: Store | Dump) -> Topology:
    """Residues are the clones, the membrane and the dermis."""
    if not len(frames):
        raise SkinError(f"trajectory {frames.path}: holds no complete frame")
    slots, first = frames.slots, frames[0]
    resids = clones(frames)
    names = np.where(resids > 0, "clone", "unseen").astype(object)
    for kind, name in ((Kind.MEMBRANE, "membrane"), (Kind.DERMAL, "dermis")):
        members = first.ids[first.kinds == kind] - 1
        resids[members] = members.min(initial=slots) + 1
        names[members] = name
    ids, places, residue = np.unique(resids, return_index=True, return_inverse=True)
    attributes = [
        Atomids(np.arange(1, slots + 1)),
        Masses(np.ones(slots)),
        Resids(ids),
        Resnames(names[places]),
        Segids(np.array(["skin"], object)),
        Bonds([tuple(link) for link in (frames.links - 1).tolist()]),
        *(attribute.following(slots) for attribute in ATTRIBUTES),
    ]
    return Topology(slots, len(ids), 1, attrs=attributes, atom_resindex=residue)


# ---- what MDAnalysis asks of every file that it is to open


def _is_store(thing: Any) -> bool:
    """Whether a file is a skin.h5, whatever its name, or has its name."""
    path = _path(thing)
    if path is None or path.name == STORE:
        return path is not None
    try:
        if not h5py.is_hdf5(path):
            return False
        with h5py.File(path) as file:
            return bool(file["h5md/creator"].attrs["name"] == "lammps-skin")
    except (OSError, LookupError, ValueError, TypeError, RuntimeError, AttributeError):
        return False


def _is_dump(thing: Any) -> bool:
    """Whether a file is a dump as `lmp` writes it, or has the name of one."""
    path = _path(thing)
    if path is None or path.name == DUMP:
        return path is not None
    try:
        with path.open("rb") as file:
            return path.suffix == ".dump" and file.read(len(FIRST_ITEM)) == FIRST_ITEM
    except OSError:
        return False


def _path(thing: Any) -> Path | None:
    return Path(thing) if isinstance(thing, (str, Path)) and Path(thing).is_file() else None
