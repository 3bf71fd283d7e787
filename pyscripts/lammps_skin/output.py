"""Output files get their names when they are complete."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def completed(path: Path) -> Iterator[Path]:
    """Yield the place where to write a file; it replaces the one of this name if nothing is raised.

    The place is beside the file and has its suffix. What exists and is no regular file, such as
    ``/dev/stdout``, is written directly.
    """
    path = path.resolve()
    if path.exists() and not path.is_file():
        yield path
        return
    part = path.with_name(f".part-{path.name}")
    try:
        yield part
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
