"""The raw trajectory that LAMMPS writes: its frames in any order, and writing it."""

from __future__ import annotations

import mmap
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lammps_skin.build import load_built
from lammps_skin.errors import SkinError
from lammps_skin.kinds import CELLS, Kind
from lammps_skin.trajectory.frame import CELL_STATE, WHOLE, Frame, Ints

FIRST_ITEM = b"ITEM: TIME\n"
HEADER = 11  # lines
PARTICLE_COLUMNS = ("id", "type", "x", "y", "z")
STATE_COLUMNS = tuple(f"f_cells[{n}]" for n in range(1, len(CELL_STATE) + 1))


class Place(NamedTuple):
    """Where the text of a frame begins and ends, its step and its highest id."""

    begin: int
    end: int
    step: int
    highest: int


class Dump:
    """The frames of a dump in the order of their steps; in memory are only their places.

    A frame that is not complete, as the last one of a run that was killed, is left out. A run
    that was resumed goes back to an earlier step and replaces what was written from there on: a
    frame counts only if no later complete frame has the same or a lower step.

    Parameters
    ----------
    path : path
        The skin.dump of a run.
    kinds : sequence of Kind, optional
        Kinds of the LAMMPS types; those of the scene built beside the dump if not given.

    Raises
    ------
    SkinError
        For a file that cannot be read or is not a dump of this scene.
    """

    def __init__(self, path: str | Path, kinds: Sequence[Kind] | None = None) -> None:
        self.path = Path(path)
        self._numbers = np.array(
            [0, *(load_built(self.path.parent).kinds if kinds is None else kinds)]
        )
        self._places: list[Place] = []
        try:
            for place in _complete(self.path):
                while self._places and self._places[-1].step >= place.step:
                    self._places.pop()
                self._places.append(place)
        except OSError as error:
            raise SkinError(f"trajectory {path}: {error.strerror}") from None
        except (ValueError, IndexError):
            raise self._foreign() from None

    def __len__(self) -> int:
        return len(self._places)

    def __getitem__(self, n: int) -> Frame:
        begin, end, step, _ = self._places[n]
        try:
            with self.path.open("rb") as file:
                file.seek(begin)
                return _frame(file.read(end - begin), step, self._numbers)
        except OSError as error:
            raise SkinError(f"trajectory {self.path}: {error.strerror}") from None
        except (ValueError, IndexError):
            raise self._foreign() from None

    def __iter__(self) -> Iterator[Frame]:
        return (self[n] for n in range(len(self)))

    @property
    def steps(self) -> list[int]:
        """Steps of the frames."""
        return [place.step for place in self._places]

    @property
    def slots(self) -> int:
        """The highest id in any frame."""
        return max((place.highest for place in self._places), default=0)

    def _foreign(self) -> SkinError:
        return SkinError(f"trajectory {self.path}: is not a dump of this scene")


def read_dump(path: str | Path, kinds: Sequence[Kind] | None = None) -> Iterator[Frame]:
    """The frames of a dump one after the other, one in memory at a time; see `Dump`."""
    yield from Dump(path, kinds)


def write_dump(path: Path, frames: Iterable[Frame], kinds: Sequence[Kind]) -> int:
    """Write frames as LAMMPS would, in the form of `lammps_inputs/output.in`.

    Parameters
    ----------
    path : Path
    frames : iterable of Frame
    kinds : sequence of Kind
        Kinds of the scene, in the order of the LAMMPS types.

    Returns
    -------
    int
        Number of frames.
    """
    has_cells = any(kind in CELLS for kind in kinds)
    columns = (*PARTICLE_COLUMNS, *(STATE_COLUMNS if has_cells else ()))
    form = "%d %d" + " %.17g" * (len(columns) - 2)
    n = 0
    with path.open("w", encoding="ascii") as file:
        for n, frame in enumerate(frames, 1):  # noqa: B007
            file.write(f"ITEM: TIME\n{frame.time:.16g}\nITEM: TIMESTEP\n{frame.step}\n")
            file.write(f"ITEM: NUMBER OF ATOMS\n{len(frame.ids)}\nITEM: BOX BOUNDS pp pp ff\n")
            file.writelines(f"{0:.16e} {side:.16e}\n" for side in frame.edges)
            file.write(f"ITEM: ATOMS {' '.join(columns)}\n")
            np.savetxt(file, _table(frame, kinds, len(columns)), form)
    return n


def _table(frame: Frame, kinds: Sequence[Kind], columns: int) -> np.ndarray:
    """Rows of a dump (n, columns); LAMMPS has zeros where something is no cell."""
    types = np.searchsorted(np.array(kinds), frame.kinds) + 1
    rows = np.column_stack([frame.ids, types, frame.positions, *frame.state.values()])
    rows[~np.isin(frame.kinds, CELLS), len(PARTICLE_COLUMNS) :] = 0
    return rows[:, :columns]


def _complete(path: Path) -> Iterator[Place]:
    """Every frame that is complete, as it stands in the file."""
    if not path.stat().st_size:
        return
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as text:
        if not FIRST_ITEM.startswith(text[: len(FIRST_ITEM)]):
            raise ValueError
        begin = 0
        while begin >= 0:
            following = text.find(FIRST_ITEM, begin + 1)
            place = _place(text[begin : following if following >= 0 else len(text)], begin)
            if place:
                yield place
            begin = following


def _place(text: bytes, begin: int) -> Place | None:
    """Place of the frame in a text that starts with its first line; None if it is cut off.

    What may follow its last line is the beginning of the next frame's first one.
    """
    end = text.rfind(b"\n") + 1
    header = text.split(b"\n", HEADER)[:HEADER]
    if text.count(b"\n") < HEADER or not FIRST_ITEM.startswith(text[end:]):
        return None
    if header[2] != b"ITEM: TIMESTEP" or header[4] != b"ITEM: NUMBER OF ATOMS":
        raise ValueError
    if text.count(b"\n") != HEADER + int(header[5]):
        return None
    last = text[text.rfind(b"\n", 0, end - 1) + 1 : end].split()
    return Place(begin, begin + end, int(header[3]), int(last[0]))


def _frame(text: bytes, step: int, numbers: Ints) -> Frame:
    """Lines 7 to 9 are the bounds of the box, line 10 names the columns."""
    *header, rows = text.split(b"\n", HEADER)
    bounds = np.array([line.split() for line in header[7:10]], float)
    columns = [name.decode() for name in header[10].split()[2:]]
    if tuple(columns[:5]) != PARTICLE_COLUMNS or tuple(columns[5:]) not in ((), STATE_COLUMNS):
        raise ValueError
    values = np.fromstring(rows, sep=" ").reshape(int(header[5]), len(columns))
    ids = values[:, 0].astype(np.int64)
    if (np.diff(ids, prepend=0) < 1).any():
        raise ValueError
    kinds = numbers[values[:, 1].astype(int)]
    is_cell = np.isin(kinds, CELLS)
    state = {}
    for n, (name, fill) in enumerate(CELL_STATE.items(), 5):
        column = np.where(is_cell, values[:, n], fill) if columns[5:] else np.full(len(kinds), fill)
        state[name] = column.astype(np.int64) if name in WHOLE else column
    return Frame(
        step=step,
        time=float(header[1]),
        edges=bounds[:, 1] - bounds[:, 0],
        ids=ids,
        kinds=kinds,
        positions=values[:, 2:5].copy(),
        state=state,
    )
