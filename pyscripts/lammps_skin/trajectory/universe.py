"""The trajectory of a run in MDAnalysis: births, deaths and changes of kind in every frame."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from lammps_skin.errors import SkinError
from lammps_skin.kinds import Kind
from lammps_skin.trajectory.dump import ABSENT, CELL_STATE

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of packages that MDAnalysis imports
    import MDAnalysis
    from MDAnalysis.coordinates.H5MD import H5MDReader
    from MDAnalysis.core.topologyattrs import AtomAttr

GROUP = "particles/trajectory"


class SkinReader(H5MDReader):  # type: ignore[misc]
    """Reader of skin.h5: positions and box, and in ``ts.data`` the particles of the frame."""

    format = "SKIN"

    def __init__(self, filename: str | Path, **options: Any) -> None:
        super().__init__(str(filename), **{**options, "convert_units": False})

    def _copy_to_data(self) -> None:
        """Arrays over all slots: species, alive and the state of cells."""
        super()._copy_to_data()
        data, group = self.ts.data, self._particle_group
        data["alive"] = (group["id/value"][self._frame] != ABSENT).astype(np.int64)
        for name in ("species", *CELL_STATE):
            data[name] = group[name]["value"][self._frame]


# ---- attributes of atoms, which MDAnalysis makes keywords of selections


class Alive(AtomAttr):  # type: ignore[misc]
    attrname = singular = "alive"
    dtype = int


class Partner(AtomAttr):  # type: ignore[misc]
    attrname = singular = "partner"
    dtype = int


class DivisionsLeft(AtomAttr):  # type: ignore[misc]
    attrname = singular = "divisions_left"
    dtype = int


class NextDivision(AtomAttr):  # type: ignore[misc]
    attrname = singular = "next_division"
    dtype = float


class Parent(AtomAttr):  # type: ignore[misc]
    attrname = singular = "parent"
    dtype = int


class Pair(AtomAttr):  # type: ignore[misc]
    attrname = singular = "pair"
    dtype = int


class BirthTime(AtomAttr):  # type: ignore[misc]
    attrname = singular = "birth_time"
    dtype = float


ATTRIBUTES = (Alive, Partner, DivisionsLeft, NextDivision, Parent, Pair, BirthTime)


class FrameAttributes:
    """Transformation that gives the atoms of a universe what is so in the frame just read."""

    def __init__(self, universe: MDAnalysis.Universe) -> None:
        self._universe = universe

    def __call__(self, timestep: Any) -> Any:
        atoms = self._universe.atoms
        for attribute in ATTRIBUTES:
            setattr(atoms, attribute.attrname, timestep.data[attribute.attrname])
        for kind in (ABSENT, *Kind):
            atoms[timestep.data["species"] == kind].types = str(int(kind))
        return timestep


class SkinUniverse(MDAnalysis.Universe):  # type: ignore[misc]
    """A universe whose copies do not share the attributes of their frames."""

    def copy(self) -> SkinUniverse:
        """The same file, opened again, at the same frame."""
        other = open_trajectory(self.trajectory.filename)
        other.trajectory[self.trajectory.frame]
        return other


def open_trajectory(path: str | Path) -> SkinUniverse:
    """Universe of a skin.h5 that `convert` or `TrajectoryWriter` has written.

    There is an atom for every id ever given out; atom n has id n + 1. In each frame, the
    attributes `alive` (1 or 0), `types` (numbers of the model as text, "-1" where there is
    nothing) and those in `CELL_STATE` are those of the frame. The bonds are the links of the
    membrane. Positions are NaN where there is nothing, so select the living before anything
    geometrical.

    Examples
    --------
    >>> universe = open_trajectory("runs/one-stem/skin.h5")
    >>> stem = universe.select_atoms("alive 1 and type 3", updating=True)
    >>> heights = [stem.positions[:, 2].mean() for _ in universe.trajectory]
    """
    path = Path(path)
    try:
        with h5py.File(path) as file:
            slots = file[f"{GROUP}/position/value"].shape[1]
            species = file[f"{GROUP}/species/value"][0]
            links = file["connectivity/links"][:] - 1
    except (OSError, KeyError, IndexError):
        raise SkinError(f"trajectory {path}: is no trajectory in HDF5 with any frame") from None
    universe = SkinUniverse.empty(slots)
    universe.add_TopologyAttr("ids", np.arange(1, slots + 1))
    universe.add_TopologyAttr("types", species.astype(str).astype(object))
    for attribute in ATTRIBUTES:
        universe.add_TopologyAttr(attribute(np.zeros(slots, attribute.dtype)))
    universe.add_TopologyAttr("bonds", [tuple(link) for link in links.tolist()])
    universe.load_new(str(path), format=SkinReader)
    universe.trajectory.add_transformations(FrameAttributes(universe))
    return universe
