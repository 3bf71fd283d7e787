"""The cores that this process may use, and what to say to who asks for more."""

from __future__ import annotations

import os

from lammps_skin.cli.output import console, counted


def cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def warn_of_crowding(processes: int, what: str, threads: int = 1) -> None:
    """Print a line if processes, whose word is given in the singular, have to take turns."""
    if processes * threads <= (there := cores()):
        return
    each = f" of {counted(threads, 'thread')}" if threads > 1 else ""
    console.print(
        f"{counted(processes, what)}{each} on {counted(there, 'core')}: they take turns, and "
        "nothing is faster than with as many as cores"
    )
