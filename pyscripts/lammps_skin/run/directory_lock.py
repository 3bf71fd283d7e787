"""One process at a time has a run directory, from its first look to its end."""

from __future__ import annotations

import errno
import fcntl
import os
import socket
import time
from contextlib import suppress
from pathlib import Path
from typing import Self

from lammps_skin.errors import SceneError, SimulationError

PATIENCE = 10.0  # seconds for the ranks of a killed run to end

_held: set[int] = set()  # descriptors of this process, which its forks do not hold with it


class DirectoryBusy(SimulationError):
    """Another process goes on with a run."""


class DirectoryLock:
    """A directory that nobody else runs in until `close`; a context manager that closes it.

    The system lets go of it when this process and the ranks that it started have ended, however
    they do. Where the file system has no locks, processes of this machine respect each other.

    Parameters
    ----------
    directory : Path
    make : bool
        Whether to make the directory, and those that it is in, if they are not there; those that
        are empty at the end are removed.

    Attributes
    ----------
    descriptor : int
        For processes that hold the directory too.

    Raises
    ------
    SceneError
        If the directory cannot be made or read.
    DirectoryBusy
        If another process goes on with it; ranks outlive a killed run for some steps.
    """

    def __init__(self, directory: str | Path, make: bool = False) -> None:
        self._directory = Path(directory)
        self._made: list[Path] = []  # the innermost first
        deadline = time.monotonic() + PATIENCE
        try:
            while (descriptor := self._try(make)) is None:
                if time.monotonic() > deadline:
                    raise DirectoryBusy(
                        f"directory {directory}: another process still runs in it"
                    )
                time.sleep(0.05)
        except OSError as error:
            self._remove_made()
            raise SceneError(f"directory {directory}: {error.strerror}") from None
        self.descriptor = descriptor
        _held.add(descriptor)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the directory."""
        if self.descriptor not in _held:
            return
        self._remove_made()
        _held.remove(self.descriptor)
        os.close(self.descriptor)

    def _remove_made(self) -> None:
        """Remove the directories that were made, up to the first in which there is something."""
        for made in self._made:
            with suppress(OSError):
                made.rmdir()

    def _try(self, make: bool) -> int | None:
        """A descriptor, or None if somebody else holds the directory, or has just removed it."""
        if make and not self._directory.exists():
            places = (self._directory, *self._directory.parents)
            self._made = [place for place in places if not place.exists()]
            self._directory.mkdir(parents=True, exist_ok=True)
        opened = os.open(self._directory, os.O_RDONLY | os.O_DIRECTORY)
        try:
            fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(opened)
            return None
        except OSError:
            found = os.fstat(opened)
            os.close(opened)
            return _bound(f"lammps-skin-{found.st_dev}-{found.st_ino}")
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(opened), os.stat(self._directory)):
                return opened
        os.close(opened)
        return None


def is_held(directory: Path) -> bool:
    """Whether a process goes on with the run in a directory, as far as locks of the system tell."""
    opened = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(opened, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:  # the file system has none
        return False
    finally:
        os.close(opened)
    return False


def _bound(name: str) -> int | None:
    """A socket of a name that one process of this machine can have; None if another has it."""
    held = socket.socket(socket.AF_UNIX)
    try:
        held.bind(f"\0{name}")
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            held.close()
            return None
    return held.detach()


def _let_go() -> None:
    while _held:
        os.close(_held.pop())


os.register_at_fork(after_in_child=_let_go)
