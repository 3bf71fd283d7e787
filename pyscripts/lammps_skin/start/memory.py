"""Whether a scene fits into the memory of this machine, before any of it is built."""

from __future__ import annotations

import os
import resource
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from lammps_skin.errors import SceneError, SimulationError
from lammps_skin.model.scene import Scene
from lammps_skin.start.packing import dermal_count

BASE, PER_PARTICLE = 100e6, 2200.0  # bytes of a process, and of every particle with its links


def particle_counts(scene: Scene) -> tuple[int, int, int]:
    """Membrane particles, dermal particles and cells at the start, without building them."""
    nx, ny = scene.membrane.lattice
    dermal = dermal_count(scene) if scene.dermis.present else 0
    return nx * ny, dermal, scene.cell_count


def installed() -> float:
    """Bytes of memory of this machine, or what this process may have of it if that is less."""
    physical = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    own = physical if allowed == resource.RLIM_INFINITY else min(physical, allowed)
    return float(min([own, *group_limits()]))


def group_limits(process: Path = Path("/proc/self")) -> Iterator[int]:
    """Bytes that the control groups of a process allow, and the groups that these are in."""
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
            memory = "memory" in controllers.split(",") and "memory" in options.split(",")
            if kind == "cgroup" and memory:
                yield from _limits(Path(place), root, group, "memory.limit_in_bytes")
            elif kind == "cgroup2" and number == "0":
                yield from _limits(Path(place), root, group, "memory.max")


def _limits(place: Path, root: str, group: str, name: str) -> Iterator[int]:
    """Limits of a group and of all above it, as far as they can be seen where they are mounted."""
    below = Path(group).relative_to(root) if Path(group).is_relative_to(root) else Path()
    for level in (below, *below.parents):
        with suppress(OSError, ValueError):  # "max" is no limit
            yield int((place / level / name).read_text())


def check_memory(scene: Scene) -> None:
    """Raise `SceneError` if the first state of a scene needs more memory than there is."""
    particles = sum(particle_counts(scene))
    needed, available = BASE + PER_PARTICLE * particles, installed()
    if needed > available:
        nx, ny = scene.membrane.lattice
        raise SceneError(
            f"membrane.lattice = [{nx}, {ny}]: the scene has {particles:,} particles, which need "
            f"about {needed / 1e9:.3g} GB of memory; there are {available / 1e9:.3g} GB"
        )


def check_ranks(ranks: int) -> None:
    """Raise `SimulationError` if so many processes need more memory than there is."""
    if ranks * BASE > installed():
        raise SimulationError(
            f"ranks = {ranks}: each needs at least {BASE / 1e9:.3g} GB of memory; there are "
            f"{installed() / 1e9:.3g} GB"
        )
