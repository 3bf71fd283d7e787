"""The page on parameters names each parameter, with the values of the code and a source."""

from __future__ import annotations

import json
from typing import Any

import pytest
from lammps_skin.model.parameters import DEFAULT, SETS
from lammps_skin.model.parts import Cells, Dermis, Membrane, Part
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import value_of
from pages import codes, rows, section

COLUMNS = 7  # key, what it is, unit, two sets, other sets, source
SOURCES = ("paper", "earlier program", "later work", "choice", "not recorded")
PARTS: dict[str, tuple[str, type[Part]]] = {
    "Dermis": ("dermis.", Dermis), "Membrane": ("membrane.", Membrane), "Cells": ("cells.", Cells),
}  # fmt: skip
NO_PARAMETERS = {
    "name",
    "description",
    "parameters",
    "start",
    "interventions",
    "numerics",
    "output",
}
TABLE = {
    row[0].strip("`"): row
    for title in ("The scene itself", *PARTS)
    for row in rows(section("parameters.md", title))
    if len(row) == COLUMNS
}


def value(name: str, key: str) -> str:
    """Of a key in a set, as the page writes it."""
    found: Any = value_of(Scene.from_dict({"parameters": name}), key)
    if key == "cells.kinds":
        found = {kind: own.model_dump(exclude_defaults=True) for kind, own in found.items()}
    return "none" if found is None or found == {} else f"`{json.dumps(found)}`"


def test_every_parameter_is_there() -> None:
    wanted = {f"{prefix}{name}" for prefix, part in PARTS.values() for name in part.model_fields}
    parts = {prefix.rstrip(".") for prefix, _ in PARTS.values()}
    wanted |= set(Scene.model_fields) - NO_PARAMETERS - parts
    assert set(TABLE) == wanted


@pytest.mark.parametrize("key", TABLE)
def test_values_are_those_of_the_code(key: str) -> None:
    _, what, unit, printed, default, others, source = TABLE[key]
    assert what and unit and any(word in source.lower() for word in SOURCES)
    assert (printed, default) == (value("printed", key), value(DEFAULT, key))
    told = dict(zip(codes(others)[::2], codes(others)[1::2], strict=True))
    unlike = {name: value(name, key) for name in SETS if name != "printed"}
    unlike = {name: found.strip("`") for name, found in unlike.items() if found != default}
    assert told == unlike
