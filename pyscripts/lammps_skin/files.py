"""Files get their names when they are complete, and nothing that is there is lost."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def atomic_write(path: Path, on_disk: bool = False) -> Iterator[Path]:
    """Yield the place where to write a file; it replaces the one of this name if nothing is raised.

    The place is beside the file, has its suffix, and is that of this process alone. What exists
    and is no regular file, such as ``/dev/stdout``, is written directly. With `on_disk` the file
    outlasts a power failure once its name is there.
    """
    path = path.resolve()
    if path.exists() and not path.is_file():
        yield path
        return
    part = path.with_name(f".part-{os.getpid()}-{path.name}")
    try:
        yield part
        put_in_place(part, path, on_disk)
    finally:
        part.unlink(missing_ok=True)


def put_in_place(part: Path, path: Path, on_disk: bool = False) -> None:
    """Give a complete file its name, in one step of the file system."""
    if on_disk:
        sync(part)
    part.replace(path)
    if on_disk:
        sync(path.parent)


def sync(path: Path) -> None:
    """Bring a file or a directory to disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def remove_leftovers(path: Path) -> None:
    """Remove what killed processes have written of a file that nobody else writes now."""
    for part in path.parent.glob(f".part-*-{path.name}"):
        part.unlink()


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
