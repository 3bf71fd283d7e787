"""Whether mpirun has started this process together with others."""

from __future__ import annotations

import os

from lammps_skin.errors import SimulationError

COUNTS = (
    ("PMI_RANK", "PMI_SIZE"),
    ("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"),
    ("SLURM_PROCID", "SLURM_STEP_NUM_TASKS"),
)
"""Variables by which MPICH, Open MPI and Slurm tell rank and number of ranks."""


def place_in_world() -> tuple[int, int]:
    """Rank of this process among those that mpirun has started together, and their number."""
    for rank, size in COUNTS:
        if os.environ.get(size, "").isdigit():
            return int(os.environ.get(rank, "0")), int(os.environ[size])
    return 0, 1


def launched() -> bool:
    """Whether mpirun or srun has started this process, even if no others together with it."""
    return any(os.environ.get(size, "").isdigit() for _, size in COUNTS)


def check_alone() -> None:
    """Raise `SimulationError` if mpirun has started this process together with others."""
    _, size = place_in_world()
    if size > 1:
        raise SimulationError(
            f"mpirun has started {size} processes, and each would do the same: start one, with "
            f"--ranks {size}, or ranks={size} in Python"
        )
