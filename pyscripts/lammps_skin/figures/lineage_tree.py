"""The tree of the ancestors of the cells that live at a moment."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from lammps_skin.analysis.lineage import Events, founder_of, living, read_events, with_added
from lammps_skin.arrays import Floats, Ints
from lammps_skin.event_log import ADDITION, BIRTH, LEAVING
from lammps_skin.figures.clone_colours import PALETTE, clone_colours
from lammps_skin.figures.look import Look
from lammps_skin.figures.moments import Moment
from lammps_skin.kinds import is_cell
from lammps_skin.text import counted

LABEL = 0.02  # of the width of the tree: from one label to the next, at least


class Tree(NamedTuple):
    """Cells that live at a time and their ancestors, in the order in which they are drawn.

    A cell stands directly before its daughters, the last one of them first, and each daughter
    before hers: no line of the tree crosses another one.

    Attributes
    ----------
    ids, parents : (n,) arrays of int
        The parent of a founder is 0.
    begin, end : (n,) arrays
        Times from which and to which a cell is drawn: to its removal, or now.
    """

    ids: Ints
    parents: Ints
    begin: Floats
    end: Floats


def tree_of(events: Events, founders: Ints, time: float, start: float = 0.0) -> Tree:
    """Tree of the cells that live at a time.

    Parameters
    ----------
    events : Events
    founders : (f,) array of int
        Ids of the cells of the initial state, at the time `start`.
    time, start : float
    """
    births, added = events.of(BIRTH), events.of(ADDITION)
    begin = dict.fromkeys(founders.tolist(), start)
    begin |= dict(zip(added.id.tolist(), added.time.tolist(), strict=True))
    begin |= dict(zip(births.id.tolist(), births.time.tolist(), strict=True))
    parent = dict(zip(births.id.tolist(), births.parent.tolist(), strict=True))
    gone = events.of(*LEAVING)
    end = dict(zip(gone.id.tolist(), gone.time.tolist(), strict=True))

    wanted: set[int] = set()
    for cell in living(events, with_added(founders, events), time).tolist():
        while cell and cell not in wanted:
            wanted.add(cell)
            cell = parent.get(cell, 0)
    daughters: dict[int, list[int]] = {}
    for cell in sorted(wanted, key=lambda cell: (begin[cell], cell)):
        daughters.setdefault(parent.get(cell, 0), []).append(cell)
    order: list[int] = []
    left = daughters.get(0, [])[::-1]
    while left:
        cell = left.pop()
        order.append(cell)
        left += daughters.get(cell, [])  # the last one is next
    return Tree(
        np.array(order, np.int64),
        np.array([parent.get(cell, 0) for cell in order], np.int64),
        np.array([begin[cell] for cell in order]),
        np.array([min(end.get(cell, time), time) for cell in order]),
    )


def draw_lineage(axes: Axes, moment: Moment, look: Look) -> None:
    """Draw the tree: a vertical line for the life of each cell, a horizontal one at its birth."""
    frames = moment.frames
    events = read_events(frames.path.parent / "events.csv")
    first = frames[0]
    founders = first.ids[is_cell(first.kinds)]
    tree = tree_of(events, founders, moment.time, first.time)
    place = {cell: n for n, cell in enumerate(tree.ids.tolist())}
    column = np.arange(len(place), dtype=float)
    lives = np.stack(
        [np.column_stack([column, tree.begin]), np.column_stack([column, tree.end])], axis=1
    )
    has_mother = tree.parents > 0
    mothers = np.array([place[cell] for cell in tree.parents[has_mother].tolist()], float)
    births = np.stack(
        [
            np.column_stack([mothers, tree.begin[has_mother]]),
            np.column_stack([column[has_mother], tree.begin[has_mother]]),
        ],
        axis=1,
    )
    colours = _colours(moment, look, tree, events)
    founding = ~has_mother
    width = float(np.clip(300 / max(len(column), 1), 0.4, 2.0))
    for lines, chosen, line_width in (
        (births, has_mother, width),
        (lives[has_mother], has_mother, width),
        (lives[founding], founding, 2.0),
    ):
        axes.add_collection(
            LineCollection(
                list(lines), colors=colours[chosen], linewidths=line_width, capstyle="butt"
            )
        )
    named = _apart(column[founding], LABEL * len(column))
    axes.set_xticks(
        column[founding][named], [f"{cell}" for cell in tree.ids[founding][named]], rotation=90
    )
    axes.set(
        xlim=(-1, len(column)), ylim=(first.time, max(moment.time, first.time + 1e-9)),
        xlabel="id of the founder", ylabel="t",
    )  # fmt: skip
    cells = counted(int(is_cell(moment.kinds).sum()), "cell")
    axes.set_title(f"ancestors of {cells} at t = {moment.time:g}")


def _apart(places: Floats, least: float) -> list[int]:
    """Which of some ascending places have room for a label, each a distance from the one before."""
    found: list[int] = []
    for n, place in enumerate(places):
        if not found or place - places[found[-1]] >= least:
            found.append(n)
    return found


def _colours(moment: Moment, look: Look, tree: Tree, events: Events) -> Floats:
    """Colours (n, 3) of the cells: of their clones, or of the kinds with which they began."""
    if look.colour_by != "kind":
        founders = founder_of(tree.ids, events)
        return np.asarray(PALETTE[clone_colours(founders, moment.frames)])
    first = moment.frames[0]
    kinds = dict(zip(first.ids.tolist(), first.kinds.tolist(), strict=True))
    entered = events.of(BIRTH, ADDITION)
    kinds |= dict(zip(entered.id.tolist(), entered.type.tolist(), strict=True))
    return np.array([moment.scene.kind(kinds[cell]).colour for cell in tree.ids.tolist()])
