"""The table of the kinds of cells: the four rows of every scene, and what a scene says of more.

Everything else asks this table what a kind does; nothing depends on the name of a kind.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from lammps_skin.kinds import KINDS, Colour, Kind
from lammps_skin.model.parts import Cells, KindKeys
from lammps_skin.model.scene_keys import near, shown

ROWS: dict[str, dict[str, Any]] = {
    "stem": {"adhesion": "bound", "daughter": "ta", "generations": "endless"},
    "ta": {"adhesion": "adhesive", "daughter": "ta", "after_last": "exhausted"},
    "exhausted": {"adhesion": "none"},
    "nd": {"adhesion": "bound"},
}
"""Keys of the kinds that every scene knows. The generations of ta are those of `cells`."""

# of the kinds that a scene adds, in turn: far from each other and from those of the four rows
COLOURS = (
    "#1f77d4", "#ff8c1a", "#12a5a5", "#e8c814", "#e0559d", "#1c7a34", "#8a5a2b", "#555555",
)  # fmt: skip

NAME = re.compile("[a-z][a-z0-9]{0,31}")
MOST = 100  # kinds of which a scene may tell
NONE = "none"  # says that there is no such kind
RESERVED = {
    "dermal", "membrane", "absent", "all", NONE,
    # words of selections
    "and", "or", "not", "global", "group", "same", "prop", "bonded", "around", "point",
    # columns of tables
    "time", "births", "deaths", "coverage", "height", "skewness", "papillae", "zeta", "sigma",
    "seed",
    # attributes of results of analyses
    "clear", "copy", "data", "fromkeys", "get", "items", "keys", "pop", "popitem", "rows",
    "setdefault", "table", "update", "values",
}  # fmt: skip
REFERENCES = ("daughter", "after_last", "paired_with", "like")
NOT_INHERITED = {"like", "count", "color"}


@dataclass(frozen=True)
class CellKind:
    """What cells of a kind do.

    Attributes
    ----------
    kind : Kind
    count : int
        Cells at the start.
    adhesion : str
        "bound" (a spring without end to the membrane), "adhesive" (one with a range) or "none".
    stiffness : float
        K of that, without the factor of direct forces.
    range : float
        lambda: end of adhesion, and where a cell detaches, in contact lengths.
    detaches : bool
        Whether it leaves the tissue beyond the range.
    cycle_delay, cycle_rate, first_phase : float
    daughter : str or None
        Label of the kind of its newborn; None: it never divides.
    generations : int or None
        Divisions of a cell that becomes one of this kind; None: without end.
    after_last : str or None
        Label of the kind that it becomes with its last division.
    paired_with : str or None
        Label of the kind beside which, in a dividing pair, its stiffness is `paired_stiffness`.
    paired_stiffness : float
    """

    kind: Kind
    count: int
    adhesion: str
    stiffness: float
    range: float
    detaches: bool
    cycle_delay: float
    cycle_rate: float
    first_phase: float
    daughter: str | None
    generations: int | None
    after_last: str | None
    paired_with: str | None
    paired_stiffness: float

    @property
    def label(self) -> str:
        return self.kind.label

    @property
    def cycle(self) -> float:
        """Mean duration of a cycle."""
        return self.cycle_delay + 1 / self.cycle_rate

    @property
    def next_kinds(self) -> tuple[str, ...]:
        """Labels of the kinds that come of it."""
        return tuple(label for label in (self.daughter, self.after_last) if label)


def cell_kinds(cells: Cells) -> dict[str, CellKind]:
    """All kinds of cells by their labels, in the order of their numbers."""
    rows = {label: cells.kinds.get(label, KindKeys()) for label in (*ROWS, *cells.kinds)}
    known = {kind.label: kind for kind in KINDS}
    counts = {"stem": cells.stem, "nd": cells.nd}
    table = {}
    for place, (label, row) in enumerate(rows.items()):
        keys = _given(label, rows, cells)
        further = place - len(ROWS)
        kind = known.get(label) or Kind(
            len(KINDS) + further + 1, label, colour=_rgb(COLOURS[further % len(COLOURS)])
        )
        if row.color:
            kind = Kind(int(kind), label, kind.name, _rgb(row.color))
        table[label] = _resolved(kind, counts.get(label, row.count), keys, cells)
    return table


def _given(label: str, rows: Mapping[str, KindKeys], cells: Cells) -> dict[str, Any]:
    """Keys that are stated of a kind: its own over those of the kind it is like, or its row."""
    own = rows[label].model_dump(exclude_none=True, exclude=NOT_INHERITED)
    like = rows[label].like
    if like is None:
        if label == "ta":
            own = {"generations": cells.generations, **own}
        return {**ROWS.get(label, {}), **own}
    inherited = _given(like, rows, cells)
    if inherited.get("daughter") == like:  # who breeds its own kind is copied as one who does
        inherited["daughter"] = label
    return {**inherited, **own}


def _resolved(kind: Kind, count: int, keys: Mapping[str, Any], cells: Cells) -> CellKind:
    """A row in full: what is not stated comes from the keys of `cells`."""

    def label_of(key: str) -> str | None:
        named = keys.get(key)
        return None if named == NONE else named

    bound = keys["adhesion"] == "bound"
    daughter = label_of("daughter")
    stated = keys.get("generations", "endless")
    generations = int(stated) if daughter and stated != "endless" else None
    stiffness = cells.binding_stiffness if bound else cells.adhesion_stiffness
    stiffness = 0.0 if keys["adhesion"] == "none" else keys.get("stiffness", stiffness)
    return CellKind(
        kind=kind,
        count=count,
        adhesion=keys["adhesion"],
        stiffness=stiffness,
        range=keys.get("range", cells.adhesion_range),
        detaches=keys.get("detaches", not bound),
        cycle_delay=keys.get("cycle_delay", cells.cycle_delay),
        cycle_rate=keys.get("cycle_rate", cells.cycle_rate),
        first_phase=keys.get("first_phase", cells.first_phase),
        daughter=daughter,
        generations=generations,
        after_last=None if generations is None else label_of("after_last"),
        paired_with=label_of("paired_with"),
        paired_stiffness=keys.get("paired_stiffness", stiffness),
    )


def _rgb(color: str) -> Colour:
    red, green, blue = (int(color[n : n + 2], 16) / 255 for n in (1, 3, 5))
    return red, green, blue


def reached(table: Mapping[str, CellKind], made: Iterable[str] = ()) -> tuple[CellKind, ...]:
    """The kinds that can occur: those of the first cells, and all that can come of them.

    Parameters
    ----------
    table : mapping
    made : iterable of str
        Labels of kinds of which there are cells later.
    """
    found: set[str] = set()
    new = {label for label, kind in table.items() if kind.count} | {*made}
    while new:
        found |= new
        new = {label for one in new for label in table[one].next_kinds} - found
    return tuple(kind for label, kind in table.items() if label in found)


def divisions_left(kind: CellKind, table: Mapping[str, CellKind]) -> int:
    """Divisions that a first cell has left: its own, or without end those of its newborn."""
    if kind.daughter is None:
        return 0
    return kind.generations or table[kind.daughter].generations or 0


# ---- what the single keys cannot know


def contradictions(cells: Cells) -> Iterator[str]:
    """Faults of the table, each as `key = value: what is allowed`."""
    if len(cells.kinds) > MOST:
        yield f"cells.kinds: has {len(cells.kinds)} kinds, must have at most {MOST}"
    yield from _names(cells.kinds)
    labels = (*ROWS, *(label for label in cells.kinds if label not in ROWS))
    for label, row in cells.kinds.items():
        place = f"cells.kinds.{label}"
        for key in REFERENCES:
            named = getattr(row, key)
            allowed = labels if key == "like" else (*labels, NONE)
            if named is not None and named not in allowed:
                yield (
                    f"{place}.{key} = {shown(named)}: must be a kind of cells, one of "
                    f"{', '.join(allowed)}{near(named, allowed)}"
                )
    yield from _circles(cells.kinds)
    for label, row in cells.kinds.items():
        if label not in ROWS and row.like is None and row.adhesion is None:
            yield (
                f"cells.kinds.{label}: needs adhesion, or like, the kind that it is like"
                f"{near(label, ROWS)}"
            )
    for key, count in (("stem", cells.stem), ("nd", cells.nd)):
        given = cells.kinds.get(key, KindKeys()).count
        if given and given != count:
            yield f"cells.kinds.{key}.count = {given}: must be cells.{key} = {count}, or left out"
    table = cell_kinds(cells)
    for label, row in cells.kinds.items():
        yield from _of_row(label, row, table)
    yield from _endings(table)


def _names(kinds: Mapping[str, KindKeys]) -> Iterator[str]:
    for label in kinds:
        if label in RESERVED:
            yield f"cells.kinds.{label}: is reserved, a kind of cells needs another name"
        elif not NAME.fullmatch(label):
            yield (
                f"cells.kinds.{shown(label)}: the name must be up to 32 lower-case letters and "
                f"digits, a letter first{near(label, ROWS)}"
            )


def _circles(kinds: Mapping[str, KindKeys]) -> Iterator[str]:
    for label in kinds:
        chain = [label]
        while (like := kinds.get(chain[-1], KindKeys()).like) is not None:
            if like in chain:
                yield f"cells.kinds.{label}.like: is circular, {' -> '.join([*chain, like])}"
                break
            chain.append(like)


def _of_row(label: str, row: KindKeys, table: Mapping[str, CellKind]) -> Iterator[str]:
    """What the keys of a row say against each other."""
    kind, place = table[label], f"cells.kinds.{label}"
    if row.stiffness is not None and kind.adhesion == "none":
        yield f"{place}.stiffness = {row.stiffness:g}: its adhesion is 'none'"
    if row.range is not None and kind.adhesion != "adhesive" and not kind.detaches:
        yield f"{place}.range = {row.range:g}: it has no adhesion that ends, and does not detach"
    if row.generations not in (None, "endless") and kind.daughter is None:
        yield f"{place}.generations = {row.generations}: needs daughter, or it never divides"
    if row.after_last not in (None, NONE) and kind.generations is None:
        yield f"{place}.after_last = '{row.after_last}': needs generations, or none is the last"
    if (row.paired_with or NONE) != NONE and row.paired_stiffness is None:
        yield f"{place}.paired_with = '{row.paired_with}': needs paired_stiffness"
    if row.paired_stiffness is None or row.paired_with == NONE:
        return
    if kind.paired_with is None:
        yield f"{place}.paired_stiffness = {row.paired_stiffness:g}: needs paired_with"
    if kind.adhesion == "none":
        yield f"{place}.paired_stiffness = {row.paired_stiffness:g}: its adhesion is 'none'"


def _endings(table: Mapping[str, CellKind]) -> Iterator[str]:
    """Kinds whose divisions end, and do not say in what."""
    for label, kind in table.items():
        if kind.generations is None:
            continue
        place = f"cells.kinds.{label}"
        if kind.count and not kind.generations:
            yield f"{place}.count = {kind.count}: has no divisions, so that there can be none"
        if kind.after_last is None:
            yield (
                f"{place}.generations = {kind.generations}: needs after_last, the kind after the "
                "last division"
            )
            continue
        chain = [label]
        while (last := table[chain[-1]].after_last) and table[chain[-1]].generations == 0:
            if last in chain:
                circle = " -> ".join([*chain, last])
                yield f"{place}.after_last = '{kind.after_last}': no one divides in {circle}"
                break
            chain.append(last)
