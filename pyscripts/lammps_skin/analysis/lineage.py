"""Who descends from whom: clones, their sizes, births and removals, and how clones mix.

A clone is a cell that was not born in the run (its founder) and all its descendants: a cell of the
initial state, or one that an intervention has added. In a run that begins with the state of another
one, the cells of that state are founders.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lammps_skin.analysis.geometry import Box, periodic_tree
from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import SkinError
from lammps_skin.event_log import ADDITION, BIRTH, COLUMNS, ENTERING, LEAVING


class Events(NamedTuple):
    """The e events of a run in the order of their times: the columns of events.csv.

    Attributes
    ----------
    time : (e,) array
    kind : (e,) array of str
        birth, death or division_end, and removal, conversion, addition or change of an
        intervention, whose name is the cause.
    id, parent : (e,) arrays of int
        The cell (0 of a change) and its mother (0: none is known); at the end of a division the
        younger and the older cell of the pair.
    type : (e,) array of int
        `Kind` of the cell.
    position : (e, 3) array
    divisions_left : (e,) array of int
    cause : (e,) array of str
    """

    time: Floats
    kind: NDArray[np.str_]
    id: Ints
    parent: Ints
    type: Ints
    position: Floats
    divisions_left: Ints
    cause: NDArray[np.str_]

    @classmethod
    def from_rows(cls, rows: Iterable[Mapping[str, str]]) -> Events:
        """Events of the rows of events.csv, as from ``csv.DictReader``, in any order."""
        ordered = sorted(rows, key=lambda row: float(row["time"]))

        def column(name: str) -> NDArray[np.str_]:
            return np.array([row[name] for row in ordered], np.str_)

        return cls(
            time=column("time").astype(np.float64),
            kind=column("kind"),
            id=column("id").astype(np.int64),
            parent=column("parent").astype(np.int64),
            type=column("type").astype(np.int64),
            position=np.column_stack([column(axis).astype(np.float64) for axis in "xyz"]),
            divisions_left=column("divisions_left").astype(np.int64),
            cause=column("cause"),
        )

    def of(self, *kinds: str) -> Events:
        """The events of one kind or of several."""
        chosen: Any = np.isin(self.kind, kinds)
        return Events(*(column[chosen] for column in self))


class Turnover(NamedTuple):
    """Births and removals of f clones in t intervals of time.

    Attributes
    ----------
    births, removals : (t, f) arrays of int
        Numbers of events, without cells that interventions add; their sums over the last axis are
        those of all clones, divided by the lengths of the intervals they are rates.
    """

    births: Ints
    removals: Ints


def read_events(path: str | Path) -> Events:
    """Events of an events.csv, also of a run that has not ended.

    A last line that is not complete is left out.

    Raises
    ------
    SkinError
        If there is no such file, or if it is no event log.
    """
    try:
        lines = Path(path).read_text("utf-8").splitlines(keepends=True)
        whole = [line for line in lines if line.endswith("\n")]
        rows = csv.DictReader(whole)
        if whole and tuple(rows.fieldnames or ()) == COLUMNS:
            events = Events.from_rows(rows)
            founder_of(events.id, events)  # raises for what cannot be
            return events
    except OSError as error:
        raise SkinError(f"event log {path}: {error.strerror}") from None
    except (ValueError, TypeError):  # of what stands in the columns
        pass
    raise SkinError(f"event log {path}: is not the events.csv of a run")


def founder_of(ids: Ints, events: Events) -> Ints:
    """Founder (n,) of every cell in ids (n,): the first ancestor, itself if it was never born."""
    births = events.of(BIRTH)
    order = np.argsort(births.id)
    born, mother = births.id[order], births.parent[order]
    twice = born[1:][born[1:] == born[:-1]]
    if len(twice):
        raise ValueError(f"events: the cell {twice[0]} is born twice")
    if (mother >= born).any():
        wrong = born[mother >= born][0]
        raise ValueError(f"events: the cell {wrong} is older than its parent")

    ancestor = np.array(ids, np.int64)
    if not len(born):
        return ancestor
    while True:
        place = np.minimum(np.searchsorted(born, ancestor), len(born) - 1)
        has_mother = born[place] == ancestor
        if not has_mother.any():
            return ancestor
        ancestor[has_mother] = mother[place[has_mother]]


def with_added(founders: Ints, events: Events) -> Ints:
    """Ids of the founders (f,) of the initial state, followed by those that were added later."""
    return np.concatenate([founders, events.of(ADDITION).id])


def living(events: Events, founders: Ints, time: float) -> Ints:
    """Ids, sorted, of the cells that live at a time; an event counts from its time on."""
    begun, ended = events.of(*ENTERING), events.of(*LEAVING)
    cells = np.concatenate([founders, begun.id[begun.time <= time]])
    return np.setdiff1d(cells, ended.id[ended.time <= time])


def clone_sizes(events: Events, founders: Ints, times: Floats | Sequence[float]) -> Ints:
    """Number (t, f) of living cells of each clone at each time, the founder included.

    Parameters
    ----------
    events : Events
    founders : (f,) array of int
        Ids of the cells of the initial state, and of those that were added: see `with_added`. A
        cell that never divides leaves no event.
    times : (t,) array
        In any order; an event counts from its time on.
    """
    times = np.asarray(times, float)
    first = ~np.isin(founders, events.of(ADDITION).id)
    size = np.tile(first.astype(np.int64), (len(times), 1))
    for kinds, change in ((ENTERING, 1), (LEAVING, -1)):
        chosen = events.of(*kinds)
        clone = _clone_index(chosen, events, founders)
        for number in range(len(founders)):
            # already in the order of time
            size[:, number] += change * np.searchsorted(
                chosen.time[clone == number], times, side="right"
            )
    return size


def turnover(events: Events, founders: Ints, edges: Floats | Sequence[float]) -> Turnover:
    """Births and removals by clone between successive times.

    Parameters
    ----------
    events : Events
    founders : (f,) array of int
    edges : (t + 1,) array
        Ascending; an event at an edge belongs to the interval that begins there, at the last
        edge to the last interval.
    """
    bins = [np.asarray(edges, float), np.arange(len(founders) + 1) - 0.5]
    counts = []
    for kinds in ((BIRTH,), LEAVING):
        chosen = events.of(*kinds)
        clone = _clone_index(chosen, events, founders)
        counts.append(np.histogram2d(chosen.time, clone, bins)[0].astype(np.int64))
    return Turnover(*counts)


def mixing(positions: Floats, clones: Ints, box: Box, reach: float) -> float:
    """Mixing index of clones: 0 where only relatives touch, 1 where clones do not matter.

    The fraction of touching pairs that are of different clones, over the fraction expected when
    the same clones are dealt out to the same cells at random, 1 - sum n_k (n_k - 1)/(n (n - 1)).

    Parameters
    ----------
    positions : (n, 3) array
        Of cells.
    clones : (n,) array of int
        Founder of each.
    box : (L_x, L_y)
    reach : float
        Largest distance of centres of a touching pair, length; lambda 2 R_c, for example, where
        cell-cell adhesion ends.

    Returns
    -------
    float
        NaN if no pair touches or all are of one clone. Above 1 where relatives avoid each other.
    """
    clones = np.asarray(clones)
    n = len(clones)
    size = np.unique(clones, return_counts=True)[1]
    if len(size) < 2:
        return float("nan")
    i, j = periodic_tree(positions, box).query_pairs(reach, output_type="ndarray").T
    if not len(i):
        return float("nan")
    expected = 1 - (size * (size - 1)).sum() / (n * (n - 1))
    return float((clones[i] != clones[j]).mean() / expected)


def _clone_index(chosen: Events, events: Events, founders: Ints) -> Ints:
    """Place in founders of the clone of each chosen event."""
    founders = np.asarray(founders, np.int64)
    founder = founder_of(chosen.id, events)
    unknown = np.setdiff1d(founder, founders)
    if len(unknown):
        raise ValueError(f"founders: the cell {unknown[0]} has events but is not among them")
    order = np.argsort(founders)
    index: Ints = order[np.searchsorted(founders, founder, sorter=order)]
    return index
