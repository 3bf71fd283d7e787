"""The trajectory of a run in MDAnalysis: births, deaths and changes of kind in every frame."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from lammps_skin.kinds import Kind
from lammps_skin.trajectory.frame import ABSENT
from lammps_skin.trajectory.readers import SkinDumpReader, SkinReader
from lammps_skin.trajectory.store import DUMP, trajectory_of

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of packages that MDAnalysis imports
    import MDAnalysis
    from MDAnalysis.core.topologyattrs import AtomAttr

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


def follow_frames(universe: MDAnalysis.Universe) -> None:
    """Give a universe of format SKIN or SKINDUMP the attributes that change with its frames.

    They are `alive` (1 or 0), `types` (numbers of the model as text, "-1" where there is
    nothing) and those in `CELL_STATE`.
    """
    slots = len(universe.atoms)
    universe.add_TopologyAttr("types", np.full(slots, str(ABSENT), object))
    for attribute in ATTRIBUTES:
        universe.add_TopologyAttr(attribute(np.zeros(slots, attribute.dtype)))
    universe.trajectory.add_transformations(FrameAttributes(universe))


def open_trajectory(path: str | Path) -> SkinUniverse:
    """Universe of a skin.h5, of a skin.dump or of what is in a run directory.

    There is an atom for every id ever given out; atom n has id n + 1. In each frame, its
    attributes are those of the frame, see `follow_frames`. The bonds are the links of the
    membrane. Positions are NaN where there is nothing, so select the living before anything
    geometrical. Raises `SkinError` for a file that is no trajectory or has no frame.

    Examples
    --------
    >>> universe = open_trajectory("runs/one-stem/skin.h5")
    >>> stem = universe.select_atoms("alive 1 and type 3", updating=True)
    >>> heights = [stem.positions[:, 2].mean() for _ in universe.trajectory]
    """
    path = Path(path)
    if path.is_dir():
        path = trajectory_of(path)
    reader = SkinDumpReader if path.suffix == Path(DUMP).suffix else SkinReader
    form = {"format": reader.format, "topology_format": reader.format}
    universe = SkinUniverse(str(path), **form, to_guess=())
    follow_frames(universe)
    return universe
