"""Titles of the columns of tables, and warnings in plain words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from lammps_skin.analysis.basal_layer import COVERED, last_remark
from lammps_skin.analysis.labels import label
from lammps_skin.model.remarks import remarks
from lammps_skin.model.scene import Scene
from lammps_skin.text import counted

NAMED = 3  # statistics that a warning names


def titles(columns: Sequence[str]) -> list[dict[str, str]]:
    """Name, title and group of each column of a table of observables but the time."""
    labels = {name: label(name) for name in columns if name != "time"}
    return [{"name": name, "title": one.text, "group": one.group} for name, one in labels.items()]


def warnings(scene: Scene, found: dict[str, Any]) -> Iterator[str]:
    """What one should know before one believes the page.

    Parameters
    ----------
    scene : Scene
    found : dict
        Of `analysis.summary.summary`.
    """
    told, table, means = found["run"], found["observables"], found["window"]
    if told["to"] < told["end_time"] * (1 - 1e-9):
        yield (
            f"The run has reached t = {told['to']:g} of {told['end_time']:g}: it goes on, or was "
            "stopped."
        )
    if line := last_remark(table):
        yield f"{line[0].upper()}{line[1:]}."
    covered = table["coverage"][-1]
    if scene.divides and covered < COVERED:
        yield (
            f"Cells cover {covered:.0%} of the membrane at the end. A tissue is taken for covered "
            f"from {COVERED:.0%} on; before, the order parameters tell of a growing colony."
        )
    called = {one["name"]: one["title"] for one in titles(list(table))}
    moving = [
        called[name] for name, mean in means["means"].items() if mean["trend"] in ("rises", "falls")
    ]
    if moving:
        more = f"; and {counted(len(moving) - NAMED, 'other')}" if len(moving) > NAMED else ""
        yield (
            f"Not stationary from t = {means['start']:g} to {means['end']:g}. What still rises or "
            f"falls: {'; '.join(moving[:NAMED])}{more}. A mean over these times is one of these "
            "times alone."
        )
    if found["events"] is None:
        yield "There is no events.csv: births, removals and the histories of cells are not known."
    for remark in remarks(scene):
        yield f"{remark}."
