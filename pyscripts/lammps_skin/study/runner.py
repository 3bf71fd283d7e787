"""Many runs at a time, on workers of dask.distributed; the one way to run many.

By default the workers are processes of this machine and end with this one. They may as well be
those of any scheduler, on other machines that have the same file system.
"""

from __future__ import annotations

import logging
import os
import signal
import threading
import time
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from importlib.util import find_spec
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any, Self, TypeVar
from uuid import uuid4

from lammps_skin.engine.machine import LIMIT, cores
from lammps_skin.errors import SkinError, one_line
from lammps_skin.run.directory_lock import DirectoryBusy
from lammps_skin.versions import versions

if TYPE_CHECKING:
    from distributed import Client

Progress = Callable[[float], None]

NEEDS = "needs dask: pip install 'lammps-skin[study]'"
TIMES = "skin-times"  # topic of the events with which workers tell how far their runs are
SILENCE = 0.5  # seconds between these events
PATIENCE = 10  # seconds for a scheduler to answer
LIVES = 3  # workers that may die with a run, before it is taken for the cause
CONFIG = {
    "distributed.scheduler.allowed-failures": LIVES - 1,
    "distributed.scheduler.worker-saturation": 1.0,  # who waits does not die with a worker
    "distributed.worker.memory.terminate": False,
    "distributed.worker.memory.pause": False,
    "distributed.admin.tick.limit": "1h",  # no warnings of a busy machine
}

_turn = threading.Lock()  # LAMMPS runs once at a time in a process


class SchedulerLost(SkinError):
    """The scheduler has ended, or cannot be reached."""


class Abandoned(Exception):
    """Ends a run whose worker is about to close; its last checkpoint is written."""


@dataclass(frozen=True, kw_only=True)
class Job(ABC):
    """One of many runs.

    Attributes
    ----------
    made_by : tuple of (name, version)
        What runs it, or has run it.
    """

    made_by: tuple[tuple[str, str], ...] = field(default_factory=lambda: tuple(versions().items()))

    @property
    @abstractmethod
    def label(self) -> str: ...

    @property
    @abstractmethod
    def length(self) -> float:
        """What is reached at its end, as it tells of its progress."""

    @abstractmethod
    def run(self, keep: bool = False, progress: Progress | None = None) -> None:
        """Run, and store what is found; with `keep` what it was found from stays, too."""

    def placed(self) -> Self:
        """The same for a process that may be in another folder."""
        return self

    def note(self, event: str, error: str = "") -> None:  # noqa: B027
        """Note that it has begun, is resumed, done or failed; by default there is no history."""


J = TypeVar("J", bound=Job)


def run_all(
    todo: Sequence[J],
    jobs: int = 1,
    keep: bool = False,
    progress: Callable[[J, float], None] | None = None,
    scheduler: str | None = None,
) -> dict[J, str]:
    """Run on workers, `jobs` at a time, which share the cores.

    Without dask they run one after the other.

    Parameters
    ----------
    todo : sequence of Job
    jobs : int
        Not of a scheduler, which has the workers that it has.
    keep : bool
        Keep the run directories.
    progress : callable, optional
        Called as ``progress(job, reached)``, in another thread.
    scheduler : str, optional
        Address of a scheduler of dask.

    Returns
    -------
    dict of Job to str
        What went wrong in those that failed; their directories are kept.

    Raises
    ------
    SchedulerLost
        If the scheduler cannot be reached, or any more. What has not ended is not lost.
    """
    if not todo:
        return {}
    if scheduler is None and find_spec("distributed") is None:
        return run_share(todo, keep, progress)
    try:
        with _ended_by_sigterm(), _client(scheduler, min(jobs, len(todo))) as client:
            return _run(client, todo, keep, progress)
    except (CancelledError, OSError, TimeoutError):
        if scheduler is None:
            raise
        raise SchedulerLost(
            f"scheduler {scheduler}: has ended; what is not done goes on with another one"
        ) from None


def _run(
    client: Client, todo: Sequence[J], keep: bool, progress: Callable[[J, float], None] | None
) -> dict[J, str]:
    """As many at a time as there are workers: the client holds no more than these."""
    from distributed import KilledWorker, as_completed

    names = {uuid4().hex: job for job in todo}
    if progress:

        def hear(event: tuple[float, Any]) -> None:
            for name, reached in event[1].items():
                if name in names:
                    progress(names[name], reached)

        client.subscribe_topic(TIMES, hear)
    waiting = list(reversed(names))
    running: dict[Any, str] = {}
    failures = {}
    completed = as_completed(loop=client.loop)
    while waiting or running:
        while waiting and len(running) < max(sum(_workers(client).values()), 1):
            name = waiting.pop()
            job = names[name].placed()
            key = ("run", f"{job.label}-{name}")  # of each first part dask keeps statistics
            future = client.submit(
                _work, job, keep, name, dict(_workers(client)), key=key, pure=False
            )
            running[future.key] = name
            completed.add(future)
            del future
        future = next(completed)
        name = running.pop(future.key)
        job = names[name]
        try:
            error = future.result()
        except Abandoned:
            waiting.append(name)
            continue
        except KilledWorker:
            error = f"{LIVES} processes that ran it were killed"
            job.note("failed", error)
        finally:
            del future
        if error:
            failures[job] = error
        elif progress:
            progress(job, job.length)
    return failures


def _workers(client: Client) -> Counter[str]:
    """How many workers there are on each machine."""
    found: Mapping[str, Any] = client.scheduler_info(n_workers=-1)["workers"]
    return Counter(one["host"] for one in found.values())


@contextmanager
def _client(scheduler: str | None, jobs: int) -> Iterator[Client]:
    """A client of a scheduler, by default of one of its own with so many workers."""
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError:
        raise SkinError(NEEDS) from None
    if scheduler is not None:
        for name in ("distributed", "distributed.client"):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            client = Client(scheduler, set_as_default=False, timeout=PATIENCE)
        except (OSError, ValueError) as error:
            raise SchedulerLost(f"scheduler {scheduler}: {one_line(str(error))}") from None
        with client:
            yield client
        return
    with dask.config.set(CONFIG):
        cluster = LocalCluster(
            n_workers=jobs, threads_per_worker=1, memory_limit=0, dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
        )  # fmt: skip
        try:
            with Client(cluster, set_as_default=False) as client:
                yield client
        finally:
            with suppress(TimeoutError):  # a worker that is slow to end does so with this process
                cluster.close()


@contextmanager
def _ended_by_sigterm() -> Iterator[None]:
    """SIGTERM ends this process as SystemExit, so that the workers end before it."""

    def terminate(number: int, _: object) -> None:
        raise SystemExit(128 + number)

    former = signal.getsignal(signal.SIGTERM)
    if former != signal.SIG_DFL or threading.current_thread() is not threading.main_thread():
        yield
        return
    signal.signal(signal.SIGTERM, terminate)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, former)


# ---- in the processes of workers


def _work(job: Job, keep: bool, name: str, workers: Mapping[str, int]) -> str | None:
    """Run on a worker with its share of the cores of its machine; None or an error."""
    from distributed import Status, get_worker
    from distributed.comm.addressing import get_address_host

    worker = get_worker()
    told = 0.0

    def report(reached: float) -> None:
        nonlocal told
        if worker.status not in (Status.running, Status.paused):
            raise Abandoned
        if time.monotonic() - told > SILENCE:
            told = time.monotonic()
            worker.log_event(TIMES, {name: float(reached)})

    host = get_address_host(worker.address)
    with _turn, _share(workers.get(host, 1)):
        return _attempt(job, keep, report)


def _attempt(job: Job, keep: bool, report: Progress | None = None) -> str | None:
    """Run; None, or what went wrong, which the job notes.

    What another process runs is waited for.
    """
    try:
        if dict(job.made_by) != versions():
            theirs, ours = (", ".join(f"{name} {number}" for name, number in sorted(one.items()))
                            for one in (versions(), dict(job.made_by)))  # fmt: skip
            raise SkinError(f"the worker has {theirs}; what has started it has {ours}")
        while True:
            with suppress(DirectoryBusy):
                job.run(keep, report)
                return None
    except Abandoned:
        raise
    except Exception as error:  # whatever it is, the others go on
        text = str(error) if isinstance(error, (SkinError, OSError)) else repr(error)
        job.note("failed", text)
        return text


@contextmanager
def _share(processes: int) -> Iterator[None]:
    """A part of the cores of this machine, for one of so many processes."""
    former = os.environ.get(LIMIT)
    os.environ[LIMIT] = str(max(cores() // max(processes, 1), 1))
    try:
        yield
    finally:
        del os.environ[LIMIT]
        if former is not None:
            os.environ[LIMIT] = former


# ---- without a scheduler


def run_share(
    todo: Sequence[J], keep: bool = False, progress: Callable[[J, float], None] | None = None
) -> dict[J, str]:
    """Run one after the other on all cores, without a scheduler.

    Each runs in a process of its own: if that dies, the others go on. Returns as `run_all`.
    """
    context, failures = get_context("spawn"), {}
    with _ended_by_sigterm():
        for job in todo:
            receiver, sender = context.Pipe(duplex=False)
            process = context.Process(target=_tell, args=(job, keep, sender), daemon=True)
            process.start()
            sender.close()
            try:
                error = receiver.recv()
            except EOFError:
                process.join()
                error = f"its process ended with exit code {process.exitcode}"
                job.note("failed", error)
            finally:
                receiver.close()
                process.terminate()
                process.join()
            if error:
                failures[job] = error
            elif progress:
                progress(job, job.length)
    return failures


def _tell(job: Job, keep: bool, sender: Connection) -> None:
    """Run in a process of its own, and say what went wrong."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends its children
    sender.send(_attempt(job, keep))
