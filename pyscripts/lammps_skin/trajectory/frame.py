"""The particles of one moment, and the slots in which files keep them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from lammps_skin.arrays import Floats, Ints
from lammps_skin.engine.engine import Cells, Forces
from lammps_skin.kinds import is_cell

ABSENT = -1
# with the value of what is not a living cell
CELL_STATE: dict[str, float] = {
    "partner": ABSENT,
    "divisions_left": ABSENT,
    "next_division": np.nan,
    "parent": ABSENT,
    "pair": ABSENT,
    "birth_time": np.nan,
    "divisions_done": ABSENT,
    "pair_start": np.nan,
    "detached_time": np.nan,
}
ADDED = ("divisions_done", "pair_start", "detached_time")  # older files lack them
WHOLE = tuple(name for name, fill in CELL_STATE.items() if fill == ABSENT)


@dataclass(frozen=True)
class Frame:
    """The n particles of one moment, sorted by id.

    Attributes
    ----------
    step : int
    time : float
    edges : (3,) array
        Sides of the box, which starts at the origin.
    ids : (n,) array of int
    kinds : (n,) array of int
        `Kind` of each particle, the type numbers of the model.
    positions : (n, 3) array
    state : dict of (n,) arrays
        The names in `CELL_STATE`; the values given there for particles that are no cells.
    next_id : int
        The ID that the next newborn gets, above all that were ever given out; `ABSENT` in files
        that do not tell.
    """

    step: int
    time: float
    edges: Floats
    ids: Ints
    kinds: Ints
    positions: Floats
    state: Mapping[str, Ints | Floats]
    next_id: int

    @classmethod
    def of_engine(
        cls, step: int, time: float, edges: Sequence[float], particles: Forces, cells: Cells,
        next_id: int,
    ) -> Frame:  # fmt: skip
        """Frame of what LAMMPS holds: all particles, and the state of the cells among them."""
        of_cells = is_cell(particles.types)
        state: dict[str, Any] = {}
        for name, fill in CELL_STATE.items():
            kind = np.int64 if name in WHOLE else np.float64
            state[name] = np.full(len(of_cells), fill, kind)
            state[name][of_cells] = getattr(cells, name)
        ids, kinds, positions = particles[:3]
        return cls(step, time, np.asarray(edges, float), ids, kinds, positions, state, next_id)

    def over_slots(self, slots: int) -> dict[str, Any]:
        """Arrays over all slots, slot n for id n + 1, with fill values where nothing is.

        The names are position, id, species and those in `CELL_STATE`.
        """
        kept = {"position": self.positions, "id": self.ids, "species": self.kinds, **self.state}
        spread = {}
        for name, values in kept.items():
            fill = np.nan if values.dtype.kind == "f" else ABSENT
            spread[name] = np.full((slots, *values.shape[1:]), fill, values.dtype)
            spread[name][self.ids - 1] = values
        return spread
