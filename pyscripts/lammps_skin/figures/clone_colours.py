"""Colours of clones: those that begin close to one another have colours that differ."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from matplotlib import colormaps

from lammps_skin.analysis.geometry import Box, minimum_image
from lammps_skin.arrays import Floats, Ints
from lammps_skin.kinds import is_cell
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.store import Store

PALETTE = np.array(colormaps["tab20"].colors)  # type: ignore[attr-defined]
SAME = 0.03  # difference that a colour is taken to have from itself; from others it is more


def clone_colours(founders: Ints, frames: Store | Dump) -> Ints:
    """Numbers (n,) in `PALETTE` of the colours of the clones of some founders (n,).

    They are the same in all frames of a run. A clone whose founder was not there at first has the
    colour of its id.
    """
    known = _of_first_frame(frames)
    return np.array([known.get(one, one % len(PALETTE)) for one in founders.tolist()], np.int64)


@lru_cache(maxsize=4)
def _of_first_frame(frames: Store | Dump) -> dict[int, int]:
    first = frames[0]
    cells = is_cell(first.kinds)
    numbers = apart(first.positions[cells, :2], frames.scene.box_sides[:2])
    return dict(zip(first.ids[cells].tolist(), numbers.tolist(), strict=True))


def apart(places: Floats, box: Box) -> Ints:
    """Numbers (n,) of colours for places (n, 2): one after the other, each differs most.

    What counts is the least product of the distance in the plane and of the difference of colours,
    of all places before.
    """
    differences = np.linalg.norm(PALETTE[:, None] - PALETTE, axis=-1)
    differences[differences == 0] = SAME
    numbers = np.zeros(len(places), np.int64)
    for n in range(1, len(places)):
        distances = np.linalg.norm(minimum_image(places[:n] - places[n], box), axis=1)
        nearness = (distances[:, None] * differences[numbers[:n]]).min(axis=0)
        numbers[n] = nearness.argmax()
    return numbers
