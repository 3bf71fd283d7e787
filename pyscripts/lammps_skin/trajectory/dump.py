"""The raw trajectory that LAMMPS writes: its frames in any order, and writing it."""

from __future__ import annotations

import csv
import math
import mmap
import warnings
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lammps_skin.arrays import Floats, Ints
from lammps_skin.engine.built import box_sides, load_built, variable
from lammps_skin.errors import DamagedError, reading
from lammps_skin.event_log import LEAVING
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.check import check_frame
from lammps_skin.trajectory.connectivity import connectivity
from lammps_skin.trajectory.frame import ABSENT, ADDED, CELL_STATE, WHOLE, Frame

FIRST_ITEM = b"ITEM: TIME\n"
HEADER = 11  # lines
ITEMS = {
    2: b"ITEM: TIMESTEP",
    4: b"ITEM: NUMBER OF ATOMS",
    6: b"ITEM: BOX BOUNDS",
    10: b"ITEM: ATOMS",
}
PARTICLE_COLUMNS = ("id", "type", "x", "y", "z")
STATE_COLUMNS = (
    *(f"f_cells[{n}]" for n in range(1, 7)),
    "i_divisions_done", "d_pair_start", "d_detached_time",
)  # fmt: skip
OLDER_COLUMNS = PARTICLE_COLUMNS + STATE_COLUMNS[: -len(ADDED)]
WHOLE_COLUMNS = [n for n, name in enumerate(CELL_STATE, len(PARTICLE_COLUMNS)) if name in WHOLE]
PARENT = len(PARTICLE_COLUMNS) + list(CELL_STATE).index("parent")


class Place(NamedTuple):
    """Where the text of a frame begins and ends, its step and time, and its highest id."""

    begin: int
    end: int
    step: int
    time: float
    highest: int


class Dump:
    """The frames of a dump in the order of their steps; in memory are only their places.

    A frame that was cut off, as the last one of a run that was killed, is left out. A run that
    was resumed goes back to an earlier step and replaces what was written from there on: a
    frame counts only if no later complete frame has the same or a lower step.

    Parameters
    ----------
    path : path
        The skin.dump of a run.
    kinds : sequence of Kind, optional
        Kinds of the LAMMPS types. If not given, they are those of the scene built beside the
        dump, and all frames must have the box of its skin.data.

    Raises
    ------
    DamagedError
        For a file that is not a dump of this scene, or cannot be right.
    SkinError
        For one that cannot be read now.
    """

    def __init__(self, path: str | Path, kinds: Sequence[Kind] | None = None) -> None:
        self.path = Path(path)
        self._box: tuple[float, ...] | None = None
        if kinds is None:
            kinds = self.scene.kinds
            self._box = box_sides(self.path.parent / "skin.data")
        self._kinds = np.array(kinds, np.int64)
        self._membrane: Ints | None = None
        self._places: list[Place] = []
        with self._reading():
            for place in _complete(self.path):
                while self._places and self._places[-1].step >= place.step:
                    self._places.pop()
                self._places.append(place)

    def __len__(self) -> int:
        return len(self._places)

    def __getitem__(self, n: int) -> Frame:
        if self._membrane is None and n:
            self[0]
        n = range(len(self))[n]  # counted from the end if it is negative
        place, next_id = self._places[n], self._next_id(n)
        with self._reading(place.step):
            frame = _frame(self._text(place), place, self._kinds, next_id)
            check_frame(frame, self._kinds, self._membrane, self.slots)
            if self._box and not np.allclose(frame.edges, self._box, rtol=1e-9, atol=0):
                told = " x ".join(f"{side:g}" for side in frame.edges)
                raise DamagedError(f"its box is {told}, that of skin.data another")
        if self._membrane is None:
            self._membrane = frame.ids[frame.kinds == Kind.MEMBRANE]
        return frame

    def __iter__(self) -> Iterator[Frame]:
        return (self[n] for n in range(len(self)))

    @cached_property
    def scene(self) -> Scene:
        """The scene built beside the dump."""
        return load_built(self.path.parent)

    @property
    def seed(self) -> int:
        """Of the cells, as the scene has it; a dump does not tell another one."""
        return self.scene.cell_seed

    @property
    def links(self) -> Ints:
        """Ids of linked membrane particles (l, 2)."""
        return self._members[0]

    @property
    def triangles(self) -> Ints:
        """Ids of the corners of its triangles (t, 3), as in `Store`."""
        return self._members[1]

    @cached_property
    def _members(self) -> tuple[Ints, Ints]:
        return connectivity(self.path.parent)

    @property
    def steps(self) -> list[int]:
        """Steps of the frames."""
        return [place.step for place in self._places]

    @property
    def times(self) -> Floats:
        """Times of the frames."""
        return np.array([place.time for place in self._places])

    @property
    def slots(self) -> int:
        """The highest id in any frame."""
        return max((place.highest for place in self._places), default=0)

    def parents(self, n: int, above: int) -> tuple[Ints, Ints]:
        """Ids of the cells of a frame that are higher than some id, and of their mothers."""
        place = self._places[n]
        with self._reading(place.step):
            *header, rows = self._text(place).split(b"\n", HEADER)
            if len(header[10].split()) <= 2 + PARENT:
                return np.empty(0, np.int64), np.empty(0, np.int64)
            lines = rows.splitlines()
            first = bisect_right(lines, above, key=lambda line: int(line.split(None, 1)[0]))
            if first == len(lines):
                return np.empty(0, np.int64), np.empty(0, np.int64)
            values = _numbers(b"\n".join(lines[first:]), len(lines) - first)
            cells = is_cell(self._kinds[values[:, 1].astype(int) - 1])
            return values[cells, 0].astype(np.int64), values[cells, PARENT].astype(np.int64)

    def _next_id(self, n: int) -> int:
        """One above the ids that the cells of this frame, and of those before it, have or had.

        Cells that were born and removed between two frames are in the event log alone, and those
        that a run began after in its scene.in.
        """
        highest = max(place.highest for place in self._places[: n + 1])
        times, removed = self._removals
        gone = np.searchsorted(times, self._places[n].time * (1 + 1e-9), side="right")
        return int(max(highest + 1, removed[gone]))

    @cached_property
    def _removals(self) -> tuple[Floats, Ints]:
        """Times (r,) of the removals that are logged, and the next id (r + 1,) before and after."""
        log = self.path.parent / "events.csv"
        begun = variable(self.path.parent, "next_id", 1)
        if not log.is_file():
            return np.empty(0), np.array([begun])
        with reading(f"event log {log}"):
            lines = log.read_text("utf-8").splitlines(keepends=True)
            rows = csv.DictReader(line for line in lines if line.endswith("\n"))
            removals = [(row["time"], row["id"]) for row in rows if row["kind"] in LEAVING]
            times, ids = np.array(removals, float).reshape(-1, 2).T
        order = np.argsort(times)
        next_ids = np.concatenate([[begun], ids[order].astype(np.int64) + 1])
        return times[order], np.maximum.accumulate(next_ids)

    def _text(self, place: Place) -> bytes:
        with self.path.open("rb") as file:
            file.seek(place.begin)
            return file.read(place.end - place.begin)

    @contextmanager
    def _reading(self, step: int | None = None) -> Iterator[None]:
        """What goes wrong within becomes a line about this dump, or about one of its frames."""
        what = f"trajectory {self.path}"
        frame = "" if step is None else f"frame of step {step}: "
        try:
            with reading(what):
                yield
        except DamagedError as error:
            why = f"{error}".removeprefix(f"{what}: ").replace("is damaged", "no numbers or lines")
            raise DamagedError(f"{what}: is not a dump of this scene ({frame}{why})") from None


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
    has_cells = any(map(is_cell, kinds))
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
    rows[~is_cell(frame.kinds), len(PARTICLE_COLUMNS) :] = 0
    return rows[:, :columns]


# ---- the text


def _complete(path: Path) -> Iterator[Place]:
    """Every frame that is complete, as it stands in the file."""
    size = path.stat().st_size
    if not size:
        return
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as text:
        if not FIRST_ITEM.startswith(text[: len(FIRST_ITEM)]):
            raise DamagedError(f"it does not begin with {FIRST_ITEM.decode().strip()}")
        begin, cut = 0, None  # step of a frame that was cut off: the run goes on from before it
        while begin >= 0:
            following = text.find(FIRST_ITEM, begin + 1)
            found = _place(text[begin : following if following >= 0 else size], begin, size)
            if isinstance(found, Place):
                if cut is not None and found.step > cut:
                    raise DamagedError(f"frame of step {cut}: lacks lines")
                yield found
            cut = None if isinstance(found, Place) else found
            begin = following


def _place(text: bytes, begin: int, size: int) -> Place | int | None:
    """Place of the frame in a text that starts with its first line.

    If it is cut off: its step, or None if not even that is there. What may follow its last line
    is the beginning of the next frame's first one.
    """
    end = text.rfind(b"\n") + 1
    header = text.split(b"\n", HEADER)[:HEADER]
    lines = text.count(b"\n")
    if lines < HEADER:
        return int(header[3]) if lines >= 4 else None
    for line, item in ITEMS.items():
        if not header[line].startswith(item):
            raise DamagedError(f"its line {line + 1} is not {item.decode()}")
    step, time, rows = int(header[3]), float(header[1]), int(header[5])
    what = f"frame of step {step}"
    if lines < HEADER + rows:
        return step
    if lines > HEADER + rows or not FIRST_ITEM.startswith(text[end:]):
        raise DamagedError(f"{what}: has more lines than the {rows:,} of its particles")
    if rows < 1 or step < 0 or not 0 <= time < math.inf:
        raise DamagedError(f"{what}: has {rows} particles and the time {time:g}")
    last = text[text.rfind(b"\n", 0, end - 1) + 1 : end].split()
    if not last or not 0 < int(last[0]) <= size:  # so many ids need more text
        raise DamagedError(f"{what}: its last line has no possible id")
    return Place(begin, begin + end, step, time, int(last[0]))


def _frame(text: bytes, place: Place, kinds: Ints, next_id: int) -> Frame:
    """Lines 7 to 9 are the bounds of the box, line 10 names the columns."""
    *header, rows = text.split(b"\n", HEADER)
    bounds = np.array([line.split() for line in header[7:10]], float)
    if bounds.shape != (3, 2) or bounds[:, 0].any():
        raise DamagedError("its box does not begin at the origin, or is tilted")
    columns = tuple(name.decode() for name in header[10].split()[2:])
    if columns not in (PARTICLE_COLUMNS, OLDER_COLUMNS, PARTICLE_COLUMNS + STATE_COLUMNS):
        raise DamagedError(f"its columns are {' '.join(columns)}")
    values = _numbers(rows, int(header[5]))
    whole = values[:, [0, 1, *(n for n in WHOLE_COLUMNS if n < len(columns))]]
    if not (np.isfinite(whole).all() and (whole == np.rint(whole)).all()):
        raise DamagedError("has an id, a type or a count that is not a whole number")
    ids, types = values[:, 0].astype(np.int64), values[:, 1].astype(int)
    if (np.diff(ids, prepend=0) < 1).any():
        raise DamagedError("its ids do not rise from 1 on")
    if types.min() < 1 or types.max() > len(kinds):
        raise DamagedError(f"has types from {types.min()} to {types.max()}, of {len(kinds)}")
    numbers = kinds[types - 1]
    cells = is_cell(numbers)
    state = {}
    for n, (name, fill) in enumerate(CELL_STATE.items(), len(PARTICLE_COLUMNS)):
        given = values[:, n] if n < len(columns) else fill
        column = np.where(cells, given, fill)
        state[name] = column.astype(np.int64) if name in WHOLE else column
    return Frame(
        step=place.step,
        time=place.time,
        edges=bounds[:, 1],
        ids=ids,
        kinds=numbers.astype(np.int64),
        positions=values[:, 2:5].copy(),
        state=state,
        next_id=ABSENT if columns == OLDER_COLUMNS else next_id,
    )


def _numbers(text: bytes, rows: int) -> Floats:
    """Numbers of so many lines; raises `ValueError` if it holds anything else, or a blank line."""
    if b"\n\n" in text or text.startswith(b"\n"):
        raise DamagedError("has a blank line")
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # what is no number ends the reading, and is told thus
        try:
            return np.fromstring(text, sep=" ").reshape(rows, -1)
        except DeprecationWarning:
            raise ValueError from None
