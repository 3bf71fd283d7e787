"""What this process may use of the machine: cores and memory."""

from __future__ import annotations

import os
import resource
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from lammps_skin.errors import SkinError

LIMIT = "LAMMPS_SKIN_CORES"
"""Variable of the environment by which a user, or an ensemble, sets how many cores are used."""
MOST = 4096  # cores that it may name
A_PROCESS = 100e6  # bytes of memory of a process with LAMMPS
WATCH = 0.2  # seconds for which the idle cores are watched
PROCESS = Path("/proc/self")
STATISTICS = Path("/proc/stat")


def cores() -> int:
    """Number of cores that this process may use: by affinity, control groups, `LIMIT`."""
    most = [float(len(_own_cores())), *quotas()]
    if text := os.environ.get(LIMIT, ""):
        if not text.isdecimal() or not 1 <= int(text) <= MOST:
            raise SkinError(f"{LIMIT} = {text}: must be a whole number from 1 to {MOST}")
        most.append(float(text))
    return max(int(min(most)), 1)


def idle_cores() -> int | None:
    """About how many of them nobody uses at the moment; None if the system does not say."""
    first = _idle_ticks()
    began = time.monotonic()
    time.sleep(WATCH)
    seconds, second = time.monotonic() - began, _idle_ticks()
    if first is None or second is None:
        return None
    return round((second - first) / os.sysconf("SC_CLK_TCK") / seconds)


def _own_cores() -> set[int]:
    if hasattr(os, "sched_getaffinity"):
        return os.sched_getaffinity(0)
    return set(range(os.cpu_count() or 1))


def _idle_ticks() -> int | None:
    """Clock ticks that the cores of this process have been idle, or waited for a disk."""
    own = {f"cpu{core}" for core in _own_cores()}
    try:
        rows = [line.split() for line in STATISTICS.read_text().splitlines()]
        return sum(int(row[4]) + int(row[5]) for row in rows if row[:1] and row[0] in own)
    except (OSError, ValueError, IndexError):
        return None


def installed() -> float:
    """Bytes of memory of this machine, or what this process may have of it if that is less."""
    physical = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    own = physical if allowed == resource.RLIM_INFINITY else min(physical, allowed)
    return float(min([own, *memory_limits()]))


def memory_limits(process: Path = PROCESS) -> Iterator[int]:
    """Bytes that the control groups of a process allow, and the groups that these are in."""
    for level, unified in _groups(process, "memory"):
        with suppress(OSError, ValueError):  # "max" is no limit
            yield int((level / ("memory.max" if unified else "memory.limit_in_bytes")).read_text())


def quotas(process: Path = PROCESS) -> Iterator[float]:
    """Cores that the control groups of a process allow, as shares of time, likewise."""
    for level, unified in _groups(process, "cpu"):
        names = ("cpu.max",) if unified else ("cpu.cfs_quota_us", "cpu.cfs_period_us")
        with suppress(OSError, ValueError):  # "max" and -1 are no limit
            quota, period = " ".join((level / name).read_text() for name in names).split()
            if int(quota) > 0 and int(period) > 0:
                yield int(quota) / int(period)


def _groups(process: Path, controller: str) -> Iterator[tuple[Path, bool]]:
    """Folders of the control groups of a process, and whether they are of version 2.

    Each group and all above it, as far as they can be seen where they are mounted.
    """
    try:
        groups = [line.split(":", 2) for line in (process / "cgroup").read_text().splitlines()]
        mounts = (process / "mountinfo").read_text().splitlines()
    except OSError:
        return
    for mount in mounts:
        where, _, what = mount.partition(" - ")
        root, place = where.split()[3:5]
        kind, _, options = what.split()[:3]
        for number, controllers, group in groups:
            old = controller in controllers.split(",") and controller in options.split(",")
            if (kind == "cgroup" and old) or (kind == "cgroup2" and number == "0"):
                inside = Path(group).is_relative_to(root)
                below = Path(group).relative_to(root) if inside else Path()
                for level in (below, *below.parents):
                    yield Path(place) / level, kind == "cgroup2"
