"""What observables are called on the page, and warnings in plain words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from lammps_skin.analysis.basal_layer import COVERED, last_remark
from lammps_skin.kinds import Kind
from lammps_skin.model.remarks import remarks
from lammps_skin.model.scene import Scene

GROUPS = {
    "Cells": {
        "births": "births since the start",
        "deaths": "cells lost since the start",
    },
    "Basal layer": {
        "coverage": "fraction of the membrane within reach of a cell",
        "none_below": "fraction of cells with none straight below",
        "cells_below": "mean number of cells straight below one",
        "most_on_particle": "most cells on one membrane particle",
        "particles_holding": "fraction of membrane particles below a cell",
        "cell_area": "area of cells over that of the membrane",
    },
    "Membrane": {
        "membrane_area": "area of the membrane over that of the box",
        "long_link": "length of long links (99th percentile)",
        "height": "mean height",
        "height_std": "roughness: standard deviation of height",
        "skewness": "skewness of height: positive is outward",
        "skewness_low": "skewness, lower end of its 95 % interval",
        "skewness_high": "skewness, upper end of its 95 % interval",
    },
    "Papillae": {
        "papillae": "number of papillae",
        "papilla_height": "mean height of papillae",
        "papilla_width": "mean width of papillae",
        "papilla_spacing": "mean spacing of papillae",
        "papilla_width_cells": "mean width of papillae, in cells",
    },
    "Cells on tips of papillae": {},
    "Order parameters": {},
}
NAMED = 3  # statistics that a warning names
TIPS = {
    "on_tips": "fraction of {} cells on tips",
    "tips_expected": "fraction of {} cells on tips, by chance",
    "tips_sd": "fraction of {} cells on tips, its spread by chance",
    "tips_z": "{} cells on tips, standard deviations above chance",
    "tips_p": "{} cells on tips, p-value",
}
ORDERS = {
    "chi_H": "χ_H: {} cells stand where the membrane is convex",
    "chi_G": "χ_G: {} cells stand on domes or bowls",
    "zeta": "ζ: {} cells stand higher than all cells",
    "sigma": "σ: {} cells cluster in the plane",
}


def titles(columns: Sequence[str], kinds: Sequence[Kind]) -> list[dict[str, str]]:
    """Name, title and group of each column of a table of observables but the time."""
    known = {
        name: (title, group) for group, named in GROUPS.items() for name, title in named.items()
    }
    for kind in kinds:
        known[kind.label] = f"{kind.name} cells", "Cells"
        for name, title in TIPS.items():
            known[f"{kind.label}_{name}"] = title.format(kind.name), "Cells on tips of papillae"
        for name, title in ORDERS.items():
            column = name if kind == Kind.STEM else f"{name}_{kind.label}"
            known[column] = title.format(kind.name), "Order parameters"
    return [
        {"name": name, "title": known[name][0], "group": known[name][1]}
        for name in columns if name != "time"
    ]  # fmt: skip


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
    called = {one["name"]: one["title"] for one in titles(list(table), scene.kinds_of_cells)}
    moving = [
        called[name] for name, mean in means["means"].items() if mean["trend"] in ("rises", "falls")
    ]
    if moving:
        more = f"; and {len(moving) - NAMED} others" if len(moving) > NAMED else ""
        yield (
            f"Not stationary from t = {means['start']:g} to {means['end']:g}. What still rises or "
            f"falls: {'; '.join(moving[:NAMED])}{more}. A mean over these times is one of these "
            "times alone."
        )
    if found["events"] is None:
        yield "There is no events.csv: births, losses and the histories of cells are not known."
    for remark in remarks(scene):
        yield f"{remark}."
