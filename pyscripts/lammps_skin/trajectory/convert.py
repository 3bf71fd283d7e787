"""The dump of a run -> the HDF5 file of its trajectory."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from lammps_skin.errors import SkinError
from lammps_skin.simulation import load_built
from lammps_skin.trajectory.dump import Ints, read_dump
from lammps_skin.trajectory.writer import TrajectoryWriter


class Converted(NamedTuple):
    """A file that was written: where it is, its frames, and how many ids were ever given out."""

    path: Path
    frames: int
    slots: int


def convert(directory: str | Path, output: str | Path | None = None) -> Converted:
    """Write the trajectory of a run as HDF5, see docs/trajectory.md.

    Parameters
    ----------
    directory : path
        Of a built scene that was run; its skin.dump is read.
    output : path, optional
        The file to write, skin.h5 in the directory if not given. It is replaced when the new
        one is complete.
    """
    directory = Path(directory)
    output = Path(output or directory / "skin.h5")
    part = output.with_name(output.name + ".part")
    scene = load_built(directory)
    links = _section(directory / "skin.data", "Bonds")
    hinges = _section(directory / "skin.data", "Dihedrals").reshape(-1, 4)
    try:
        with TrajectoryWriter(part, scene, links.reshape(-1, 2), _triangles(hinges)) as writer:
            for frame in read_dump(directory / "skin.dump", scene.kinds):
                writer.write(frame)
        if not writer.frames:
            raise SkinError(f"trajectory {directory / 'skin.dump'}: holds no complete frame")
        part.replace(output)
    except OSError as error:
        raise SkinError(f"output {output}: {error.strerror or error}") from None
    finally:
        part.unlink(missing_ok=True)
    return Converted(output, writer.frames, writer.slots)


def _section(path: Path, title: str) -> Ints:
    """Ids in a section of a data file, without the number and the type of each line."""
    rows: list[list[int]] = []
    try:
        with path.open(encoding="utf-8") as file:
            for line in file:
                if line.strip() == title:
                    break
            next(file, None)
            for line in file:
                if not line.strip():
                    break
                rows.append([int(word) for word in line.split()[2:]])
    except (OSError, ValueError):
        raise SkinError(f"data file {path}: cannot be read; build the scene again") from None
    return np.array(rows, np.int64)


def _triangles(hinges: Ints) -> Ints:
    """The triangles (t, 3) at the hinges (h, 4), each once, lowest id first."""
    both = np.concatenate([hinges[:, [0, 1, 2]], hinges[:, [3, 2, 1]]])
    if not len(both):
        return both
    turned = (both.argmin(axis=1)[:, None] + np.arange(3)) % 3
    unique: Ints = np.unique(np.take_along_axis(both, turned, axis=1), axis=0)
    return unique
