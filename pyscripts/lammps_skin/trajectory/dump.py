"""The raw trajectory that LAMMPS writes, frame by frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lammps_skin.errors import SkinError
from lammps_skin.kinds import CELLS, Kind
from lammps_skin.simulation import load_built

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

FIRST_ITEM = b"ITEM: TIME\n"
PARTICLE_COLUMNS = ("id", "type", "x", "y", "z")
# in the order of the columns f_cells[1..6], with the value of what is not a living cell
ABSENT = -1
CELL_STATE: dict[str, float] = {
    "partner": ABSENT,
    "divisions_left": ABSENT,
    "next_division": np.nan,
    "parent": ABSENT,
    "pair": ABSENT,
    "birth_time": np.nan,
}
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
    """

    step: int
    time: float
    edges: Floats
    ids: Ints
    kinds: Ints
    positions: Floats
    state: dict[str, NDArray[np.int64] | NDArray[np.float64]]


def read_dump(path: str | Path, kinds: Sequence[Kind] | None = None) -> Iterator[Frame]:
    """The frames of a dump in the order of their steps, one in memory at a time.

    A frame that is not complete, as the last one of a run that was killed, is left out. A run
    that was resumed goes back to an earlier step and replaces what was written from there on: a
    frame counts only if no later complete frame has the same or a lower step.

    Parameters
    ----------
    path : path
        The skin.dump of a run.
    kinds : sequence of Kind, optional
        Kinds of the LAMMPS types; those of the scene built beside the dump if not given.
    """
    path = Path(path)
    numbers = np.array([0, *(load_built(path.parent).kinds if kinds is None else kinds)])
    try:
        restarts = _restarts(path)
        for place, (lines, step) in enumerate(_complete(path)):
            if all(place >= later or step < first for later, first in restarts):
                yield _frame(lines, step, numbers)
    except OSError as error:
        raise SkinError(f"trajectory {path}: {error.strerror}") from None
    except (ValueError, IndexError, KeyError):
        raise SkinError(f"trajectory {path}: is not a dump of this scene") from None


def _restarts(path: Path) -> list[tuple[int, int]]:
    """Place and step of the frames at which steps go back: one for each resumed run."""
    found, last = [], -1
    for place, (_, step) in enumerate(_complete(path)):
        if step <= last:
            found.append((place, step))
        last = step
    return found


def _complete(path: Path) -> Iterator[tuple[list[bytes], int]]:
    """Lines and step of every complete frame; a header is 11 lines."""
    with path.open("rb") as file:
        for lines in _blocks(file):
            if FIRST_ITEM.startswith(lines[-1]):  # all that there is of the next frame
                lines.pop()
            header = lines[:11]
            if len(header) < 11 or not lines[-1].endswith(b"\n"):
                continue
            if header[2] != b"ITEM: TIMESTEP\n" or header[4] != b"ITEM: NUMBER OF ATOMS\n":
                raise ValueError
            if len(lines) == len(header) + int(header[5]):
                yield lines, int(header[3])


def _blocks(file: Iterable[bytes]) -> Iterator[list[bytes]]:
    """Lines of each frame; the first may be glued to the end of a frame that was cut off."""
    lines: list[bytes] = []
    for line in file:
        if line.endswith(FIRST_ITEM):
            if len(line) > len(FIRST_ITEM):
                lines.append(line.removesuffix(FIRST_ITEM))
            if lines:
                yield lines
            lines = [FIRST_ITEM]
        else:
            lines.append(line)
    if lines:
        yield lines


def _frame(lines: list[bytes], step: int, numbers: Ints) -> Frame:
    """Lines 7 to 9 are the bounds of the box, line 10 names the columns."""
    bounds = np.array([line.split() for line in lines[7:10]], float)
    columns = [name.decode() for name in lines[10].split()[2:]]
    with_cells = [f"f_cells[{n}]" for n in range(1, len(CELL_STATE) + 1)]
    if tuple(columns[:5]) != PARTICLE_COLUMNS or columns[5:] not in ([], with_cells):
        raise ValueError
    values = np.fromstring(b"".join(lines[11:]), sep=" ").reshape(len(lines) - 11, len(columns))
    kinds = numbers[values[:, 1].astype(int)]
    is_cell = np.isin(kinds, CELLS)
    state = {}
    for n, (name, fill) in enumerate(CELL_STATE.items(), 5):
        column = np.where(is_cell, values[:, n], fill) if columns[5:] else np.full(len(kinds), fill)
        state[name] = column.astype(np.int64) if name in WHOLE else column
    return Frame(
        step=step,
        time=float(lines[1]),
        edges=bounds[:, 1] - bounds[:, 0],
        ids=values[:, 0].astype(np.int64),
        kinds=kinds,
        positions=values[:, 2:5].copy(),
        state=state,
    )
