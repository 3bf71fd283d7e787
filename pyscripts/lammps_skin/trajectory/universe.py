"""The trajectory of a run in MDAnalysis: births, deaths and changes of kind in every frame."""

from __future__ import annotations

from pathlib import Path

from lammps_skin.trajectory.attributes import SkinUniverse
from lammps_skin.trajectory.readers import SkinDumpReader, SkinReader
from lammps_skin.trajectory.store import DUMP, trajectory_of


def open_trajectory(path: str | Path) -> SkinUniverse:
    """Universe of a skin.h5, of a skin.dump or of what is in a run directory.

    There is an atom for every id ever given out; atom n has id n + 1. In each frame, its
    attributes are those of the frame: `alive` (1 or 0), `types` and `names` (label of the kind,
    "absent" where there is nothing), `radii`, and those in `CELL_STATE`. Residues are clones.
    Masses are 1. The bonds are the links of the membrane. Positions are NaN where there is
    nothing, so select the living before anything geometrical. Raises `SkinError` for a file that
    is no trajectory or has no frame.

    Examples
    --------
    >>> universe = open_trajectory("runs/one-stem/skin.h5")
    >>> stem = universe.select_atoms("type stem", updating=True)
    >>> heights = [stem.positions[:, 2].mean() for _ in universe.trajectory]
    """
    path = Path(path)
    if path.is_dir():
        path = trajectory_of(path)
    form = (SkinDumpReader if path.suffix == Path(DUMP).suffix else SkinReader).format
    while True:
        before = _version(path)
        try:
            return SkinUniverse(str(path), format=form, topology_format=form, to_guess=())
        except ValueError:  # more atoms: a run has gone on between the two looks of MDAnalysis
            if _version(path) == before:
                raise


def _version(path: Path) -> tuple[int, int, int] | None:
    """What is another once a run has replaced the file or added to it."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_size, found.st_mtime_ns
