"""LAMMPS on a number of MPI ranks, by default on as many as pay off."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lammps_skin.engine.built import particle_count
from lammps_skin.engine.engine import Engine
from lammps_skin.engine.machine import A_PROCESS, cores, idle_cores, installed
from lammps_skin.engine.ranks import RankedEngine, RanksError, check_launcher
from lammps_skin.engine.world import launched

PARTICLES = 2000
"""Of a rank, at least; two with 2,000 each are 1.4 times faster than one (docs/scaling.md)."""

LOST = 600
"""Particles that a rank could compute in the time in which it waits for others (likewise)."""


def open_engine(
    ranks: int | None, threads: int, held: int, directory: Path, *arguments: Any
) -> tuple[Engine | RankedEngine, int, str]:
    """LAMMPS with the scene that is built in a directory, in this process or on ranks.

    Parameters
    ----------
    ranks : int or None
        None is as many as pay off here and now, and one if no more can be started.
    threads : int
        Threads of each.
    held : int
        Descriptor that the ranks have open too: of what this process holds.
    directory, arguments
        Of `Engine`.

    Returns
    -------
    Engine or RankedEngine, int, str
        How many ranks it has, and a line that says why they are fewer than would pay off; an empty
        one if they are not.
    """
    arguments = (directory, *arguments, threads)
    wanted, why = (ranks, "") if ranks else choose(particle_count(directory), threads)
    if wanted > 1:
        try:
            return RankedEngine(wanted, held, *arguments), wanted, why
        except RanksError as error:
            if ranks:
                raise
            why = f"ranks = 1: {error}"
    return Engine(*arguments), 1, why


def worthwhile(particles: int, cores: int) -> int:
    """How many ranks pay off for so many particles, of so many cores."""
    return max(1, min(cores, particles // PARTICLES))


def efficiency(particles: float) -> float:
    """Share of the time of a rank with so many particles in which it computes."""
    return particles / (particles + LOST)


def choose(particles: int, threads: int = 1) -> tuple[int, str]:
    """How many ranks of `threads` threads pay off here and now, and why no more.

    Cores that other programs use are left to them: ranks wait for each other all the time, and
    one that has to share its core makes all of them wait.
    """
    ranks = worthwhile(particles, min(cores() // threads, int(installed() // A_PROCESS)))
    if ranks == 1:
        return 1, ""
    if launched():
        return 1, "ranks = 1: mpirun or srun has started this process; --ranks N starts more"
    try:
        check_launcher(ranks)
    except RanksError as error:
        return 1, f"ranks = 1: {error}"
    idle = idle_cores()
    if idle is None or idle >= ranks * threads:
        return ranks, ""
    fewer = max(idle // threads, 1)
    return fewer, (
        f"ranks = {fewer}: other programs use the rest of {cores()} cores; --ranks {ranks} starts "
        f"{ranks}"
    )
