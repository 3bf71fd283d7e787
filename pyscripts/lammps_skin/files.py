"""Files get their names when they are complete, and nothing that is there is lost."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def completed(path: Path) -> Iterator[Path]:
    """Yield the place where to write a file; it replaces the one of this name if nothing is raised.

    The place is beside the file, has its suffix, and is that of this process alone. What exists
    and is no regular file, such as ``/dev/stdout``, is written directly.
    """
    path = path.resolve()
    if path.exists() and not path.is_file():
        yield path
        return
    part = path.with_name(f".part-{os.getpid()}-{path.name}")
    try:
        yield part
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


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
