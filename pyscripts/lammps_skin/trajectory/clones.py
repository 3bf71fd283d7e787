"""Which cells descend from which, as far as the frames of a trajectory tell."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from lammps_skin.arrays import Ints
from lammps_skin.model.scene import Scene


class Frames(Protocol):
    """The frames of a `Store` or a `Dump`."""

    @property
    def slots(self) -> int: ...

    @property
    def scene(self) -> Scene: ...

    def __len__(self) -> int: ...

    def parents(self, n: int, above: int) -> tuple[Ints, Ints]: ...


def clones(frames: Frames) -> Ints:
    """Id of the first known ancestor of the cell in each slot (s,); 0 where no cell was seen.

    A cell that was born and left between two frames is known as the mother of its daughters
    alone, so they are a clone of their own, with its id. In a run that begins with the state of
    another one, the cells of that state are the first ones. Of each frame, only the cells that are
    new in it are read.
    """
    found = np.zeros(frames.slots, np.int64)
    above = 0
    continues = frames.scene.start.run is not None
    for n in range(len(frames)):
        ids, mothers = frames.parents(n, above)
        if continues and n == 0:
            mothers = np.zeros_like(ids)
        for cell, mother in zip(ids.tolist(), mothers.tolist(), strict=True):
            older = 0 < mother < cell  # mothers come first, so that theirs is known
            found[cell - 1] = (found[mother - 1] or mother) if older else cell
        above = max(above, int(ids.max(initial=0)))
    return found
