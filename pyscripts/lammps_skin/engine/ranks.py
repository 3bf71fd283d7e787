"""An `Engine` on several MPI ranks, in processes of their own."""

from __future__ import annotations

import math
import os
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import AuthenticationError
from multiprocessing.connection import Connection, Listener, wait
from pathlib import Path
from typing import Any

from lammps_skin.engine.engine import lammps_message
from lammps_skin.engine.worker import KEY
from lammps_skin.errors import SimulationError

GRACE = 2.0  # seconds that the other ranks have to report the same error
PATIENCE = 120.0  # seconds for the next rank to start
CLEARANCE = 20.0  # seconds for mpirun to end all ranks when one has ended
SHARED = Path("/dev/shm")  # where the ranks of MPICH exchange messages
SHARED_MEMORY = 2e6  # bytes of it without which a rank cannot begin
AMPLE = 64e6  # bytes of it, below which MPICH crashes at some sizes and not at others
LARGER = "make it larger (docker run --shm-size=1g), or run on one rank"
# what batch systems and other mpiruns leave: ours would start ranks elsewhere, or join theirs;
# of Open MPI and PMIx not what users set: OMPI_ALLOW_RUN_AS_ROOT, OMPI_MCA_btl, PMIX_MCA_gds
LAUNCHERS = (
    "SLURM_", "PMI_", "MPI_LOCAL", "MPIEXEC_", "HYDRA_", "HYDI_", "PALS_", "PBS_", "LSB_",
    "LOADL_", "COBALT_", "SGE_", "PE_HOSTFILE",
    "OMPI_APP_", "OMPI_ARGV", "OMPI_COMM", "OMPI_FILE_", "OMPI_FIRST_", "OMPI_MCA_ess",
    "OMPI_MCA_orte", "OMPI_MCA_pmix", "OMPI_NUM_", "OMPI_UNIVERSE_",
    "PMIX_BFROP_", "PMIX_DSTORE_", "PMIX_GDS_", "PMIX_HOSTNAME", "PMIX_ID", "PMIX_NAMESPACE",
    "PMIX_PTL_", "PMIX_RANK", "PMIX_SECURITY_", "PMIX_SERVER_", "PMIX_SYSTEM_", "PMIX_VERSION",
)  # fmt: skip
CRASHED = "crashed"
ENDED = {  # by number, how a rank ended that has said nothing
    signal.SIGKILL: "was killed",
    signal.SIGTERM: "was killed",
    signal.SIGBUS: f"ended with a bus error: {SHARED} has no more room",
    signal.SIGSEGV: CRASHED,
    signal.SIGABRT: CRASHED,
}


class RanksError(SimulationError):
    """Ranks cannot be started on this machine, whatever they are for."""


class RankedEngine:
    """Has the methods of `Engine`; each call is carried out by all ranks.

    Parameters
    ----------
    ranks : int
    held : int
        Descriptor that the ranks have open too: of what this process holds.
    arguments
        Of `Engine`.
    """

    def __init__(self, ranks: int, held: int, *arguments: Any) -> None:
        check_shared_memory(ranks)
        self._log = Path(arguments[0]) / "log.lammps"
        self._logged = self._log.stat().st_size if self._log.exists() else 0
        self._connections: list[Connection] = []
        key = secrets.token_bytes(32)
        name = f"lammps-skin-{secrets.token_hex(16)}"
        worker = [sys.executable, "-P", "-m", "lammps_skin.engine.worker", name]
        with Listener(f"\0{name}", "AF_UNIX", backlog=ranks, authkey=key) as listener:
            self._output = tempfile.TemporaryFile("w+")  # noqa: SIM115
            self._process = subprocess.Popen(
                [_mpirun(), "-np", str(ranks), *worker],
                env={**_environment(), KEY: key.hex()}, pass_fds=(held,),
                stdin=subprocess.DEVNULL, stdout=self._output, stderr=subprocess.STDOUT,
                start_new_session=True,
            )  # fmt: skip
            try:
                self._connections = self._accept(listener, ranks)
                self._call("open", *arguments)
            except BaseException:
                self._end()
                raise

    def _accept(self, listener: Listener, ranks: int) -> list[Connection]:
        """Connections in the order of ranks; a start that fails ends the wait."""
        connections: dict[int, Connection] = {}
        latest = time.monotonic()

        def accept() -> None:
            nonlocal latest
            while len(connections) < ranks:
                with suppress(AuthenticationError, EOFError, ConnectionError):
                    connection = listener.accept()
                    connections[connection.recv()] = connection
                    latest = time.monotonic()

        waiting = threading.Thread(target=accept, daemon=True)
        waiting.start()
        while waiting.is_alive():
            waiting.join(0.05)
            if self._process.poll() is not None:
                said = lammps_message(self._printed()) or "it does not say why"
                raise RanksError(f"mpirun could not start {ranks} ranks: {said}{_scarce()}")
            if time.monotonic() - latest > PATIENCE:
                raise RanksError(
                    f"mpirun has started {len(connections)} of {ranks} ranks, and no other within "
                    f"{PATIENCE:g} s: {lammps_message(self._printed()) or 'it does not say why'}"
                )
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
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(CLEARANCE)
            code = self._process.poll()
            self._end()
            raise SimulationError(self._last_error(code)) from None
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
                self._end()
                break
            replies |= {c: c.recv() for c in waiting if c in ready}
        return replies

    def _last_error(self, code: int | None) -> str:
        """How the ranks have ended; the code of mpirun is None if it had to be ended."""
        for number, text in ENDED.items():
            if code in (number, 128 + number, -number):
                return f"a rank {text} ({number.name}){_scarce() if text == CRASHED else ''}"
        for said in (self._printed(), self._logged_since()):
            errors = [line for line in said.splitlines() if "ERROR" in line]
            if errors:
                return lammps_message(errors[0])
        if code is None:
            return "a rank has ended, and mpirun did not end the others"
        return f"a rank ended with code {code}{_scarce()}"

    def _printed(self) -> str:
        self._output.seek(0)
        return self._output.read().strip()

    def _logged_since(self) -> str:
        """What the log has got since the ranks were started."""
        try:
            content = self._log.read_bytes()
        except OSError:
            return ""
        begin = self._logged if len(content) > self._logged else 0
        return content[begin:].decode(errors="replace")

    def close(self) -> None:
        """End all ranks."""
        if self._process.poll() is None:
            with suppress(SimulationError):
                self._call("close")
        self._end()
        self._output.close()

    def _end(self) -> None:
        """End what is left of mpirun and its ranks: gently, for `GRACE`, then for good."""
        for connection in self._connections:
            connection.close()  # ranks that wait for the next request end
        for number in (signal.SIGTERM, signal.SIGKILL):
            try:
                self._process.wait(GRACE)
                return
            except subprocess.TimeoutExpired:
                os.killpg(self._process.pid, number)
        self._process.wait()


def check_launcher(ranks: int) -> None:
    """Raise `RanksError` if there is no mpirun, or ranks might crash for want of shared memory."""
    _mpirun()
    check_shared_memory(ranks)
    if (free := _shared_memory()) < AMPLE:
        raise RanksError(f"{SHARED} has only {free / 1e6:.3g} MB for the messages of ranks")


def check_shared_memory(ranks: int) -> None:
    """Raise `RanksError` if ranks cannot exchange messages on this machine."""
    free, needed = _shared_memory(), ranks * SHARED_MEMORY
    if free < needed:
        raise RanksError(
            f"ranks = {ranks}: MPI needs {needed / 1e6:g} MB of shared memory; {SHARED} has "
            f"{free / 1e6:.3g} MB; {LARGER}"
        )


def _shared_memory() -> float:
    """Bytes that are left of it, without limit where there is none of its kind."""
    try:
        found = os.statvfs(SHARED)
    except OSError:
        return math.inf
    return float(found.f_bavail * found.f_frsize)


def _scarce() -> str:
    """What to try after an end without a word, if shared memory may be why."""
    free = _shared_memory()
    return f"; {SHARED} has only {free / 1e6:.3g} MB: {LARGER}" if free < AMPLE else ""


def _environment() -> dict[str, str]:
    """This process' environment without what leads ranks to other machines or to other worlds.

    A rank of MPICH that waits spins, unless it is throttled, and takes its core from the others.
    """
    kept = {k: v for k, v in os.environ.items() if not k.startswith(LAUNCHERS)}
    return {"MPIR_CVAR_CH4_PROGRESS_THROTTLE": "1", **kept, "HYDRA_LAUNCHER": "fork"}


def _mpirun() -> str:
    """The mpirun of the MPI that LAMMPS uses."""
    beside = Path(sys.executable).parent / "mpirun"
    found = str(beside) if beside.exists() else shutil.which("mpirun")
    if not found:
        raise RanksError("ranks: there is no mpirun; install the mpich package")
    return found
