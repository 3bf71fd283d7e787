"""Whether a scene fits into the memory of this machine, before any of it is built."""

from __future__ import annotations

from lammps_skin.engine.machine import A_PROCESS, installed
from lammps_skin.errors import SceneError, SimulationError
from lammps_skin.model.scene import Scene
from lammps_skin.start.packing import dermal_count

PER_PARTICLE = 2200.0  # bytes of every particle with its links


def particle_counts(scene: Scene) -> tuple[int, int, int]:
    """Membrane particles, dermal particles and cells at the start, without building them."""
    nx, ny = scene.membrane.lattice
    dermal = dermal_count(scene) if scene.dermis.present else 0
    return nx * ny, dermal, scene.cell_count


def check_memory(scene: Scene) -> None:
    """Raise `SceneError` if the first state of a scene needs more memory than there is."""
    particles = sum(particle_counts(scene))
    needed, available = A_PROCESS + PER_PARTICLE * particles, installed()
    if needed > available:
        nx, ny = scene.membrane.lattice
        raise SceneError(
            f"membrane.lattice = [{nx}, {ny}]: the scene has {particles:,} particles, which need "
            f"about {needed / 1e9:.3g} GB of memory; there are {available / 1e9:.3g} GB"
        )


def check_ranks(ranks: int) -> None:
    """Raise `SimulationError` if so many processes need more memory than there is."""
    if ranks * A_PROCESS > installed():
        raise SimulationError(
            f"ranks = {ranks}: each needs at least {A_PROCESS / 1e9:.3g} GB of memory; there are "
            f"{installed() / 1e9:.3g} GB"
        )
