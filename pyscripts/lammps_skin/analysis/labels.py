"""What observables are called in words, with symbol and unit: the same on all charts and pages."""

from __future__ import annotations

from typing import NamedTuple

from lammps_skin.analysis.observables import LESS, ORDERS, REACHES, TIPS
from lammps_skin.kinds import KINDS

TIME = "time (time units)"
BY_CHANCE = "_on_tips", "_tips_expected"  # ends of two columns whose difference has its own label
NAMES = {kind.label: kind.name for kind in KINDS}
SYMBOLS = {"chi_H": "χ_H", "chi_G": "χ_G", "zeta": "ζ", "sigma": "σ"}


class Label(NamedTuple):
    """What a column is called, and the group of columns to which it belongs."""

    text: str
    group: str


GROUPS = {
    "Cells": {
        "births": "births since the start",
        "deaths": "removals since the start",
    },
    "Basal layer": {
        "coverage": "covered fraction of the membrane",
        "none_below": "fraction of cells with none straight below",
        "cells_below": "mean number of cells straight below one",
        "most_on_particle": "most cells on one membrane particle",
        "particles_holding": "fraction of membrane particles below a cell",
        "cell_area": "area of cells / area of the membrane",
    },
    "Membrane": {
        "membrane_area": "area of the membrane / area of the box",
        "long_link": "length of long links, 99th percentile (length units)",
        "height": "mean height (length units)",
        "height_std": "roughness: standard deviation of height (length units)",
        "skewness": "skewness of height (positive: outward)",
        "skewness_low": "skewness of height, lower end of its 95 % interval",
        "skewness_high": "skewness of height, upper end of its 95 % interval",
    },
    "Papillae": {
        "papillae": "number of papillae",
        "papilla_height": "mean height of papillae (length units)",
        "papilla_width": "mean width of papillae (length units)",
        "papilla_spacing": "mean spacing of papillae (length units)",
        "papilla_width_cells": "mean width of papillae (cell diameters)",
    },
}
OF_TIPS = {
    "on_tips": "fraction of {} cells on tips",
    "tips_expected": "fraction of {} cells on tips by chance",
    "tips_sd": "fraction of {} cells on tips, spread by chance",
    "tips_z": "{} cells on tips, standard deviations above chance",
    "tips_p": "{} cells on tips, p-value",
}
OF_ORDERS = {
    "chi_H": "χ_H: {} cells on convex places",
    "chi_G": "χ_G: {} cells on domes or bowls (1/length)",
    "zeta": "ζ: {} cells higher than all cells (R_c)",
    "sigma": "σ: {} cells cluster in the plane",
}
ON_TIPS, IN_ORDER = "Cells on tips of papillae", "Order parameters"
KNOWN = {
    name: Label(text, group) for group, texts in GROUPS.items() for name, text in texts.items()
}


def label(column: str) -> Label:
    """Label of a column of the table of observables, or of what is made of columns.

    Examples
    --------
    >>> label("zeta_nd").text
    'ζ: ND cells higher than all cells (R_c)'
    >>> label("papillae-births").text
    'number of papillae less births since the start'
    """
    first, minus, other = column.partition(LESS)
    if minus:
        kind = first.removesuffix(BY_CHANCE[0])
        if (first, other) == (f"{kind}{BY_CHANCE[0]}", f"{kind}{BY_CHANCE[1]}"):
            return Label(f"{_name(kind)} cells on tips, more than by chance", ON_TIPS)
        return Label(f"{label(first).text} less {label(other).text}", label(first).group)
    first, reaches, level = column.partition(REACHES)
    if reaches:
        return Label(f"time until {label(first).text} exceeds {level}", label(first).group)
    if column in KNOWN:
        return KNOWN[column]
    for name in TIPS:
        if column.endswith(f"_{name}"):
            kind = column.removesuffix(f"_{name}")
            return Label(OF_TIPS[name].format(_name(kind)), ON_TIPS)
    for name in ORDERS:
        if column == name or column.startswith(f"{name}_"):
            kind = column.removeprefix(name).removeprefix("_") or "stem"
            return Label(OF_ORDERS[name].format(_name(kind)), IN_ORDER)
    return Label(f"{_name(column)} cells", "Cells")


def _name(kind: str) -> str:
    return NAMES.get(kind, kind)
