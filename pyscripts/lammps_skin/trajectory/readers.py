"""What MDAnalysis reads: skin.h5 as format SKIN, skin.dump as format SKINDUMP.

Both give an atom for every id ever given out; atom n has id n + 1. ``ts.positions`` are in
single precision and NaN where there is nothing; ``ts.data`` has, as arrays over all atoms, alive
(1 or 0) and all that `Frame.over_slots` gives, so positions in double precision too.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from lammps_skin.errors import SkinError
from lammps_skin.trajectory.connectivity import connectivity
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.frame import ABSENT, CELL_STATE, Ints
from lammps_skin.trajectory.store import Store

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of packages that MDAnalysis imports
    from MDAnalysis.coordinates.base import ReaderBase
    from MDAnalysis.coordinates.H5MD import H5MDReader
    from MDAnalysis.core.topology import Topology
    from MDAnalysis.core.topologyattrs import Atomids, Bonds
    from MDAnalysis.lib.util import store_init_arguments
    from MDAnalysis.topology.base import TopologyReaderBase


class SkinReader(H5MDReader):  # type: ignore[misc]
    """Reader of skin.h5."""

    format = "SKIN"

    def __init__(self, filename: str | Path, **options: Any) -> None:
        super().__init__(str(filename), **{**options, "convert_units": False})

    def _reopen(self) -> None:
        """Go to the beginning of the file that is open; a run may have put a longer one there."""
        self._frame = -1

    def _copy_to_data(self) -> None:
        super()._copy_to_data()
        data, group = self.ts.data, self._particle_group
        for name in ("position", "id", "species", *CELL_STATE):
            data[name] = group[name]["value"][self._frame]
        data["alive"] = (data["id"] != ABSENT).astype(np.int64)


class SkinDumpReader(ReaderBase):  # type: ignore[misc]
    """Reader of skin.dump, whose scene lies beside it."""

    format = "SKINDUMP"
    units = {"time": None, "length": None}  # noqa: RUF012

    @store_init_arguments  # type: ignore[untyped-decorator]
    def __init__(self, filename: str | Path, **options: Any) -> None:
        super().__init__(str(filename), **{**options, "convert_units": False})
        self._dump = Dump(self.filename)
        self.n_atoms = self._dump.slots
        self.n_frames = len(self._dump)
        self._reopen()
        self._read_next_timestep()

    def _reopen(self) -> None:
        self.ts = self._Timestep(self.n_atoms, positions=True, **self._ts_kwargs)
        self.ts.frame = -1

    def _read_next_timestep(self, ts: Any = None) -> Any:
        return self._read_frame(self.ts.frame + 1)

    def _read_frame(self, n: int) -> Any:
        if n >= self.n_frames:
            raise OSError("there are no more frames")  # as MDAnalysis wants to be told
        frame, ts = self._dump[n], self.ts
        ts.frame, ts.time = n, frame.time
        ts.dimensions = [*frame.edges, 90, 90, 90]
        data = frame.over_slots(self.n_atoms)
        ts.positions = data["position"]
        ts.data |= {**data, "alive": (data["id"] != ABSENT).astype(np.int64), "step": frame.step}
        return ts


class SkinParser(TopologyReaderBase):  # type: ignore[misc]
    """Atoms, their ids and the links of the membrane, of skin.h5."""

    format = "SKIN"

    def parse(self, **_: Any) -> Topology:
        """The topology, which is the same in all frames."""
        store = Store(self.filename)
        return _topology(self.filename, store.slots, store.links)


class SkinDumpParser(TopologyReaderBase):  # type: ignore[misc]
    """Atoms, their ids and the links of the membrane, of skin.dump."""

    format = "SKINDUMP"

    def parse(self, **_: Any) -> Topology:
        """The topology, which is the same in all frames."""
        links, _triangles = connectivity(Path(self.filename).parent)
        return _topology(self.filename, Dump(self.filename).slots, links)


def _topology(path: str, slots: int, links: Ints) -> Topology:
    if not slots:
        raise SkinError(f"trajectory {path}: holds no complete frame")
    bonds = Bonds([tuple(link) for link in (links - 1).tolist()])
    return Topology(slots, 1, 1, attrs=[Atomids(np.arange(1, slots + 1)), bonds])
