"""Files that get another name: nothing that is there is lost."""

from __future__ import annotations

import os
from pathlib import Path


def free_name(path: Path) -> Path:
    """The path, or the first of path.2, path.3, ... at which there is nothing, not even a link."""
    number, free = 1, path
    while os.path.lexists(free):
        number += 1
        free = path.with_name(f"{path.name}.{number}")
    return free


def set_aside(path: Path) -> Path:
    """Give a damaged file a name that says so and that nothing else has."""
    aside = free_name(path.with_name(f"{path.name}.damaged"))
    path.rename(aside)
    return aside
