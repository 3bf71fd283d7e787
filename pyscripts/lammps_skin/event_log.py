"""What the rows of events.csv are called."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

COLUMNS = ("time", "kind", "id", "parent", "type", "x", "y", "z", "divisions_left", "cause")

BIRTH, DEATH, REMOVAL, ADDITION = "birth", "death", "removal", "addition"
ENTERING = (BIRTH, ADDITION)
"""Kinds of rows with which a cell begins."""
LEAVING = (DEATH, REMOVAL)
"""Kinds of rows with which a cell ends."""

INTERVENING = {
    REMOVAL: "removed", "conversion": "converted", ADDITION: "added", "change": "changed",
}  # fmt: skip
"""Kinds of rows that interventions write, with their names as causes."""


def by_intervention(kinds: Iterable[str], causes: Iterable[str]) -> dict[str, str]:
    """What was done, by the names of interventions: ``{"wound": "12 removed"}``.

    Parameters
    ----------
    kinds, causes : iterables of str
        Of the rows of an event log.
    """
    rows = Counter(zip(causes, kinds, strict=True))
    return {
        cause: "changed" if kind == "change" else f"{count:,} {INTERVENING[kind]}"
        for (cause, kind), count in rows.items()
        if kind in INTERVENING
    }
