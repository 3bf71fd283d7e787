"""Attributes of atoms that are, in every frame, those of the frame.

MDAnalysis keeps the attributes of atoms once for all frames. Here they are looked up in the
timestep at which the trajectory of the universe stands, so they are right in whatever order frames
are read, in copies, in other processes and in memory. The keywords of selections use them too.
"""

from __future__ import annotations

import warnings
from collections import defaultdict
from typing import Any, Self

import numpy as np

from lammps_skin.errors import SkinError
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.frame import ABSENT

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of packages that MDAnalysis imports
    import MDAnalysis
    from MDAnalysis.core.groups import GroupBase
    from MDAnalysis.core.topologyattrs import AtomAttr, Atomnames, Atomtypes, Radii

NOTHING = "absent"  # label of a slot in which there is no particle


def labels(scene: Scene) -> Any:
    """Labels of the kinds of particles of a scene; the place of each is its number."""
    return np.array([NOTHING, *(kind.label for kind in scene.all_kinds)], object)


class FrameAttr(AtomAttr):  # type: ignore[misc]
    """An attribute that is looked up in the frame.

    What is given values, as in a merged universe or by the user, has those in all frames.
    """

    source = ""  # in the data of a timestep
    trajectory: Any = None

    @classmethod
    def following(cls, atoms: int) -> Self:
        """The attribute of so many atoms, without values of its own."""
        attribute = cls.__new__(cls)
        attribute._guessed = False
        attribute.atoms = atoms
        return attribute

    @property
    def is_given(self) -> bool:
        """Whether it has values of its own."""
        return "atoms" not in self.__dict__

    @property
    def values(self) -> Any:
        """Values of all atoms (s,)."""
        return self._given if self.is_given else self._moment()

    @values.setter
    def values(self, given: Any) -> None:
        self._given = given

    def _moment(self) -> Any:
        return self._of_frame(self.source)

    def _of_frame(self, name: str) -> Any:
        """What the timestep holds by a name."""
        reader = self.trajectory
        data = {} if reader is None else reader.ts.data
        if name not in data:
            raise SkinError(
                f"{self.attrname}: change from frame to frame, and "
                f"{getattr(reader, 'filename', None) or 'this trajectory'} does not hold them"
            )
        return data[name]

    def __len__(self) -> int:
        return len(self._given) if self.is_given else self.atoms

    def copy(self) -> Self:
        return super().copy() if self.is_given else self.following(self.atoms)

    def set_atoms(self, ag: Any, values: Any) -> None:
        if not self.is_given:
            raise SkinError(f"{self.attrname}: are those of each frame and cannot be set")
        super().set_atoms(ag, values)


class KindAttr(FrameAttr):
    """The label of the kind. Selections by text take the number of the kind as well."""

    source = "species"

    @property
    def namedict(self) -> dict[str, int]:
        """Places in `labels` of all that a selection may say."""
        if self.is_given:
            return self._namedict
        places = {label: place for place, label in enumerate(self._of_frame("labels"))}
        return places | {str(place or ABSENT): place for place in places.values()}

    @namedict.setter
    def namedict(self, given: dict[str, int]) -> None:
        self._namedict = given

    @property
    def nmidx(self) -> Any:
        """Place of the label of each atom (s,)."""
        return self._nmidx if self.is_given else np.maximum(super()._moment(), 0)

    @nmidx.setter
    def nmidx(self, given: Any) -> None:
        self._nmidx = given

    def _moment(self) -> Any:
        return self._of_frame("labels")[self.nmidx]


class Owner:
    """Makes a plain universe one whose atoms follow its frames, as soon as it has a group."""

    def __get__(self, group: Any, owner: Any = None) -> Any:
        return self if group is None else group.__dict__["_u"]

    def __set__(self, group: Any, universe: MDAnalysis.Universe) -> None:
        group.__dict__["_u"] = universe
        if type(universe) is MDAnalysis.Universe:
            universe.__class__ = SkinUniverse


class Alive(FrameAttr):
    attrname = singular = source = "alive"
    dtype = int
    transplants = defaultdict(list, {GroupBase: [("_u", Owner())]})  # noqa: RUF012


class Types(KindAttr, Atomtypes):  # type: ignore[misc]
    pass


class Names(KindAttr, Atomnames):  # type: ignore[misc]
    pass


class KindRadii(FrameAttr, Radii):  # type: ignore[misc]
    source = "radius"


class Partner(FrameAttr):
    attrname = singular = source = "partner"
    dtype = int


class DivisionsLeft(FrameAttr):
    attrname = singular = source = "divisions_left"
    dtype = int


class NextDivision(FrameAttr):
    attrname = singular = source = "next_division"
    dtype = float


class Parent(FrameAttr):
    attrname = singular = source = "parent"
    dtype = int


class Pair(FrameAttr):
    attrname = singular = source = "pair"
    dtype = int


class BirthTime(FrameAttr):
    attrname = singular = source = "birth_time"
    dtype = float


class DivisionsDone(FrameAttr):
    attrname = singular = source = "divisions_done"
    dtype = int


class PairStart(FrameAttr):
    attrname = singular = source = "pair_start"
    dtype = float


class DetachedTime(FrameAttr):
    attrname = singular = source = "detached_time"
    dtype = float


ATTRIBUTES = (
    Alive, Types, Names, KindRadii, Partner, DivisionsLeft, NextDivision, Parent, Pair, BirthTime,
    DivisionsDone, PairStart, DetachedTime,
)  # fmt: skip


class SkinUniverse(MDAnalysis.Universe):  # type: ignore[misc]
    """A universe whose atoms have, in every frame, the attributes of the frame."""

    @property
    def trajectory(self) -> Any:
        return super().trajectory

    @trajectory.setter
    def trajectory(self, reader: Any) -> None:
        MDAnalysis.Universe.trajectory.fset(self, reader)
        for attribute in self._topology.attrs:
            if isinstance(attribute, FrameAttr):
                attribute.trajectory = reader

    def transfer_to_memory(
        self, start: int | None = None, stop: int | None = None, step: int | None = None,
        verbose: bool = False, **options: Any,
    ) -> None:  # fmt: skip
        """Read frames into memory, with their times and all that they hold of the atoms."""
        if hasattr(self.trajectory, "in_memory"):
            self.trajectory = self.trajectory.in_memory(start, stop, step, verbose)
        else:
            super().transfer_to_memory(start, stop, step, verbose, **options)
