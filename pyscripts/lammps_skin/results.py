"""What a run has left in its directory."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from lammps_skin.analysis.lineage import COLUMNS
from lammps_skin.trajectory.store import DUMP, STORE

EVENTS, LOG, MANIFEST = "events.csv", "log.lammps", "checkpoints.json"
RESTARTS = "skin.*.restart"
TRAJECTORIES = (STORE, DUMP)
HEADING = f"{','.join(COLUMNS)}\n".encode()  # all that the event log of a run begins with
ASIDE = ".replaced"  # while a new run begins


def holds_results(directory: Path) -> bool:
    """Whether there are events, frames or checkpoints of a run."""
    if any((directory / name).exists() for name in TRAJECTORIES) or any(directory.glob(RESTARTS)):
        return True
    try:
        with (directory / EVENTS).open("rb") as file:
            return file.read(len(HEADING) + 1) not in (b"", HEADING)
    except (FileNotFoundError, NotADirectoryError):
        return False


@contextmanager
def replaced_results(directory: Path) -> Iterator[None]:
    """Put the files of an earlier run aside; back, if what follows fails, or else away."""
    aside = directory / ASIDE
    patterns = (EVENTS, LOG, MANIFEST, RESTARTS, *TRAJECTORIES, "skin.h5.*")
    earlier = {path for pattern in patterns for path in directory.glob(pattern)}
    if not earlier:
        yield
        return
    aside.mkdir(exist_ok=True)
    for path in earlier:
        path.replace(aside / path.name)
    try:
        yield
    except BaseException:
        for path in earlier:
            (aside / path.name).replace(path)
        with suppress(OSError):  # what a killed attempt has left there stays
            aside.rmdir()
        raise
    for path in aside.iterdir():
        path.unlink()
    aside.rmdir()
