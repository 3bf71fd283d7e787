"""The dump of a run -> the HDF5 file of its trajectory."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import NamedTuple

from lammps_skin.engine.built import load_built
from lammps_skin.errors import DamagedError, SkinError
from lammps_skin.files import atomic_write, remove_leftovers, set_aside
from lammps_skin.trajectory.connectivity import connectivity
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.store import DUMP, STORE, Store, trajectory_of
from lammps_skin.trajectory.writer import TrajectoryWriter, reason


class Converted(NamedTuple):
    """A file that was written: where it is, its frames, and how many ids were ever given out."""

    path: Path
    frames: int
    slots: int


def convert(directory: str | Path, output: str | Path | None = None) -> Converted:
    """Write the trajectory of a run as HDF5, see docs/trajectory.md.

    If a run that Python drove was resumed with `lmp`, skin.h5 has the frames before the dump's
    first, and they are kept. A skin.h5 that is damaged gets another name.

    Parameters
    ----------
    directory : path
        Of a built scene that was run; its skin.dump is read.
    output : path, optional
        The file to write, skin.h5 in the directory if not given. It is replaced when the new
        one is complete.

    Raises
    ------
    SkinError
        For a directory without a dump, if skin.h5 has gone on after it, and for an output that
        is no file.
    """
    directory = Path(directory)
    output = Path(output or directory / STORE)
    if output.exists() and not output.is_file():
        raise SkinError(f"output {output}: is no file")
    scene = load_built(directory)
    dump = Dump(directory / DUMP)
    if not len(dump):
        raise SkinError(f"trajectory {dump.path}: holds no complete frame")
    earlier = _earlier(directory, dump, replacing=output == directory / STORE)
    remove_leftovers(output)
    try:
        with atomic_write(output) as part:
            if earlier:
                shutil.copyfile(directory / STORE, part)
                writer = TrajectoryWriter.append(part, until=dump.steps[0] - 1)
            else:
                writer = TrajectoryWriter(part, scene, *connectivity(directory))
            with writer:
                for frame in dump:
                    writer.write(frame)
    except OSError as error:
        raise SkinError(f"output {output}: {reason(error)}") from None
    return Converted(output, writer.frames, writer.slots)


def _earlier(directory: Path, dump: Dump, replacing: bool) -> bool:
    """Whether skin.h5 has frames before the dump's; one that went on later is not replaced."""
    path = directory / STORE
    if not path.exists():
        return False
    try:
        steps = Store(path).steps
    except DamagedError:
        if replacing:
            set_aside(path)
        return False
    if not len(steps):
        return False
    if replacing and trajectory_of(directory) == path and steps[-1] > dump.steps[-1]:
        raise SkinError(f"trajectory {path}: has gone on after {dump.path} was written")
    return bool(steps[0] < dump.steps[0])
