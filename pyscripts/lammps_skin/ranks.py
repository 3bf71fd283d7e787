"""An `Engine` on several MPI ranks, in processes of their own."""

from __future__ import annotations

import os
import secrets
import shutil
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection, Listener, wait
from pathlib import Path
from typing import Any

from lammps_skin.engine import one_line
from lammps_skin.errors import SimulationError
from lammps_skin.worker import KEY

GRACE = 2.0  # seconds that the other ranks have to report the same error


class RankedEngine:
    """Has the methods of `Engine`; each call is carried out by all ranks."""

    def __init__(self, ranks: int, *arguments: Any) -> None:
        self._log = Path(arguments[0]) / "log.lammps"
        self._folder = tempfile.TemporaryDirectory(prefix="skin-")
        key = secrets.token_bytes(32)
        address = str(Path(self._folder.name) / "socket")
        worker = [sys.executable, "-m", "lammps_skin.worker", address]
        with Listener(address, "AF_UNIX", backlog=ranks, authkey=key) as listener:
            self._output = tempfile.TemporaryFile("w+")  # noqa: SIM115
            self._process = subprocess.Popen(
                [_mpirun(), "-np", str(ranks), *worker], env={**os.environ, KEY: key.hex()},
                stdin=subprocess.DEVNULL, stdout=self._output, stderr=subprocess.STDOUT,
                start_new_session=True,
            )  # fmt: skip
            self._connections = self._accept(listener, ranks)
        self._call("open", *arguments)

    def _accept(self, listener: Listener, ranks: int) -> list[Connection]:
        """Connections in the order of ranks; a start that fails ends the wait."""
        connections: dict[int, Connection] = {}

        def accept() -> None:
            while len(connections) < ranks:
                connection = listener.accept()
                connections[connection.recv()] = connection

        waiting = threading.Thread(target=accept, daemon=True)
        waiting.start()
        while waiting.is_alive():
            waiting.join(0.05)
            if self._process.poll() is not None:
                raise SimulationError(f"mpirun could not start {ranks} ranks: {self._printed()}")
        return [connections[rank] for rank in range(ranks)]

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("_"):
            raise AttributeError(name)
        return lambda *arguments: self._call(name, *arguments)

    def _call(self, method: str, *arguments: Any) -> Any:
        try:
            for connection in self._connections:
                connection.send((method, arguments))
            replies = self._replies()
        except (EOFError, OSError):
            self._process.wait()
            raise SimulationError(self._last_error()) from None
        for succeeded, result in replies.values():
            if not succeeded:
                raise SimulationError(result)
        return replies[self._connections[0]][1]

    def _replies(self) -> dict[Connection, tuple[bool, Any]]:
        """Replies of all ranks; when one has failed the others may wait for it for ever."""
        replies: dict[Connection, tuple[bool, Any]] = {}
        while len(replies) < len(self._connections):
            failed = not all(succeeded for succeeded, _ in replies.values())
            waiting = [c for c in self._connections if c not in replies]
            ready = wait(waiting, timeout=GRACE if failed else None)
            if not ready:
                self._process.terminate()
                self._process.wait()
                break
            replies |= {c: c.recv() for c in waiting if c in ready}
        return replies

    def _last_error(self) -> str:
        """What LAMMPS said before it ended all ranks."""
        written = self._log.read_text(errors="replace") if self._log.exists() else ""
        for text in (self._printed(), written):
            errors = [line for line in text.splitlines() if "ERROR" in line]
            if errors:
                return one_line(errors[0])
        return f"a rank ended with code {self._process.returncode}"

    def _printed(self) -> str:
        self._output.seek(0)
        return self._output.read().strip()

    def close(self) -> None:
        """End all ranks."""
        if self._process.poll() is None:
            try:
                self._call("close")
            except SimulationError:
                self._process.kill()
            self._process.wait()
        for connection in self._connections:
            connection.close()
        self._output.close()
        self._folder.cleanup()


def _mpirun() -> str:
    """The mpirun of the MPI that LAMMPS uses."""
    beside = Path(sys.executable).parent / "mpirun"
    found = str(beside) if beside.exists() else shutil.which("mpirun")
    if not found:
        raise SimulationError("ranks: there is no mpirun; install the mpich package")
    return found
