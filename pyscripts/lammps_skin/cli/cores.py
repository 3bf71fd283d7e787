"""What to say to who asks for more processes than there are cores."""

from __future__ import annotations

from lammps_skin.cli.output import console, counted
from lammps_skin.engine.machine import cores


def warn_of_crowding(processes: int, what: str, threads: int = 1) -> None:
    """Print a line if processes, whose word is given in the singular, have to take turns."""
    if processes * threads <= (there := cores()):
        return
    each = f" of {counted(threads, 'thread')}" if threads > 1 else ""
    console.print(
        f"{counted(processes, what)}{each} on {counted(there, 'core')}: they take turns, and "
        "nothing is faster than with as many as cores"
    )
