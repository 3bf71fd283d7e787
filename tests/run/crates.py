"""What the profile Process Run Crate wants of an RO-Crate."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

Crate = dict[str, dict[str, Any]]


def crate(directory: Path) -> Crate:
    """Entities by their identifiers, each there once; what the profile wants is there."""
    graph = json.loads((directory / "ro-crate-metadata.json").read_text())["@graph"]
    found = {one["@id"]: one for one in graph}
    assert len(found) == len(graph)
    linked = [link for one in graph for value in one.values() for link in links(value)]
    outside = {"https://w3id.org/ro/crate/1.1"}
    assert {*linked} <= found.keys() | outside
    root = found["./"]
    assert found["ro-crate-metadata.json"]["about"] == {"@id": "./"}
    assert root["conformsTo"] == {"@id": "https://w3id.org/ro/wfrun/process/0.5"}
    assert {"name", "description", "datePublished", "license"} <= root.keys()
    named = {one["@id"] for one in graph if one["@type"] == "File"}
    assert named == {*links(root["hasPart"])}
    assert all((directory / name).is_file() for name in named)
    assert [*links(root["mentions"])] == [one["@id"] for one in activities(found)]
    for one in activities(found):
        assert all(
            found[name]["@type"] == "SoftwareApplication" for name in links(one["instrument"])
        )
    return found


def links(value: Any) -> list[str]:
    values = value if isinstance(value, list) else [value]
    return [one["@id"] for one in values if isinstance(one, dict)]


def activities(found: Crate) -> list[dict[str, Any]]:
    return [one for one in found.values() if one["@type"] == "CreateAction"]
