"""What a stored result depends on, as a key in the name of its file."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from lammps_skin.model.scene import Scene
from lammps_skin.versions import versions

NO_PHYSICS = {"name", "description", "end_time", "output", "numerics", "parameters"}


def result_key(*content: object, made_by: Mapping[str, str] | None = None) -> str:
    """Hash of plain data, and of the versions that made the result: without any, of today's."""
    text = json.dumps([made_by or versions(), *content], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def physics(scene: Scene) -> dict[str, Any]:
    """All keys of a scene that its forces and its first state depend on."""
    return _keys(scene, NO_PHYSICS)


def without_seed(scene: Scene) -> dict[str, Any]:
    """All keys of a scene that its results depend on, but the seed in which its runs differ.

    Where the cells have a seed of their own, that of the scene is the same for all runs.
    """
    content = _keys(scene, {"description"})
    if content["cells"].pop("seed") is None:
        del content["seed"]
    return content


def _keys(scene: Scene, exclude: set[str]) -> dict[str, Any]:
    """Keys of a scene but some; those that name files state what is in them."""
    keys = scene.model_dump(mode="json", exclude=exclude)
    if scene.start.content is not None:
        keys["start"] = scene.start.content
    if scene.membrane.heights is not None and Path(scene.membrane.heights).is_file():
        keys["membrane"]["heights"] = file_hash(Path(scene.membrane.heights))
    return keys


def file_hash(path: Path) -> str:
    """Hash of what is in a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
