"""What to do after an error of a run."""

from __future__ import annotations

import errno
import os
from pathlib import Path

# of errors that a shorter timestep can prevent: of our styles, and of LAMMPS
UNSTABLE = (
    "smaller timestep", "Lost atoms", "atoms missing", "missing on proc", "Out of range atoms",
    "Non-numeric", "NaN", "inner cutoff", "outer cutoff", "Bond length", "half of periodic box",
    "moved too far", "Atom coords",
)  # fmt: skip


def remedy(error: str, directory: Path, timestep: float, shorter: float) -> str:
    """What to do after an error of a run."""
    if not directory.is_dir():
        return f"{directory} is no longer there: put it back, and resume the run"
    if any(os.strerror(full) in error for full in (errno.ENOSPC, errno.EFBIG, errno.EDQUOT)):
        return "make room for its files, and resume the run"
    if "was killed" in error:
        return (
            "as the system does when memory runs out, or a batch system at its limits: resume the "
            "run, with more of them or on fewer ranks"
        )
    if "the state that this run began with" in error:
        return "change it or the scene"
    if "leaves the box" in error:
        return (
            f"numerics.timestep = {timestep:g}; try {shorter:.3g}, or, for a tissue that moves "
            "as a whole, other membrane.height and box_height"
        )
    if any(sign in error for sign in UNSTABLE):
        return f"numerics.timestep = {timestep:g}; try {shorter:.3g}"
    return "mend that, and resume the run"
