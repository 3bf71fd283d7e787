"""What a run has left in its directory."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from lammps_skin.event_log import COLUMNS
from lammps_skin.trajectory.store import DUMP, STORE

EVENTS, LOG, MANIFEST = "events.csv", "log.lammps", "checkpoints.json"
PROVENANCE = "ro-crate-metadata.json"
RESTARTS = "skin.*.restart"
TRAJECTORIES = (STORE, DUMP)
REPLACED = (
    EVENTS, LOG, MANIFEST, PROVENANCE, *TRAJECTORIES, f"{STORE}.next", f"{STORE}.former",
)  # fmt: skip
HEADING = f"{','.join(COLUMNS)}\n".encode()  # all that the event log of a run begins with
ASIDE = ".replaced"  # how the folder begins in which earlier files are while a new run begins


def restart_files(directory: Path) -> list[Path]:
    """Restart files that a run has written, by Python or by plain `lmp`."""
    named = re.compile(r"skin\.(step\d+|1|2)\.restart")
    return [path for path in directory.glob(RESTARTS) if named.fullmatch(path.name)]


def holds_results(directory: Path) -> bool:
    """Whether there are events, frames or checkpoints of a run."""
    if any((directory / name).exists() for name in TRAJECTORIES) or restart_files(directory):
        return True
    try:
        with (directory / EVENTS).open("rb") as file:
            return file.read(len(HEADING) + 1) not in (b"", HEADING)
    except (FileNotFoundError, NotADirectoryError):
        return False


@contextmanager
def replaced_results(directory: Path) -> Iterator[None]:
    """Put the files of an earlier run aside; back, if what follows fails, or else away.

    They are aside in a folder that is made for them. Links are moved and removed themselves, not
    what they point to.
    """
    named = [directory / name for name in REPLACED] + restart_files(directory)
    earlier = [path for path in named if path.is_symlink() or path.is_file()]
    if not earlier:
        yield
        return
    aside = Path(tempfile.mkdtemp(prefix=f"{ASIDE}-", dir=directory))
    moved = []
    try:
        for path in earlier:
            path.rename(aside / path.name)
            moved.append(path)
        yield
    except BaseException:
        for path in moved:
            (aside / path.name).replace(path)
        aside.rmdir()
        raise
    for path in moved:
        (aside / path.name).unlink()
    aside.rmdir()
