"""The trajectory of a run in files of other programs: ParaView, and the dump of LAMMPS."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from lammps_skin.analysis.curvature import curvature
from lammps_skin.analysis.geometry import minimum_image
from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import SkinError
from lammps_skin.figures.polydata import write_polydata, write_series
from lammps_skin.files import atomic_write
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.dump import write_dump
from lammps_skin.trajectory.frame import Frame
from lammps_skin.trajectory.frames import open_frames
from lammps_skin.trajectory.writer import reason

CELL_DATA = ("divisions_left", "partner", "parent", "pair", "birth_time", "next_division")


# ---- ParaView


def export_vtk(run: str | Path, output: Path) -> list[Path]:
    """Write membrane and cells of every frame for ParaView.

    There are two time series, membrane.pvd and cells.pvd, of one file .vtp for each frame. Points
    of the membrane have id, height, mean_curvature and gaussian_curvature; those of cells have
    id, kind, radius and their state. Triangles that pass through a periodic edge are left out.

    Parameters
    ----------
    run : path
        Run directory, or a skin.h5.
    output : Path
        Directory, made if it is not there.

    Returns
    -------
    list of Path
        The time series.
    """
    frames = open_frames(run)
    series: dict[str, list[tuple[float, str]]] = {"membrane": [], "cells": []}
    try:
        output.mkdir(parents=True, exist_ok=True)
        for frame in frames:
            surfaces = {
                "membrane": _membrane(frame, frames.triangles),
                "cells": _cells(frame, frames.scene),
            }
            for name, surface in surfaces.items():
                file = f"{name}.{frame.step:010d}.vtp"
                write_polydata(output / file, *surface)
                series[name].append((frame.time, file))
        for name, files in series.items():
            write_series(output / f"{name}.pvd", files)
    except OSError as error:
        raise SkinError(f"output {output}: {reason(error)}") from None
    return [output / f"{name}.pvd" for name in series]


class Surface(NamedTuple):
    """Points (n, 3), their data (n,) each, and triangles (m, 3) of them, if there are any."""

    points: Floats
    data: dict[str, Floats | Ints]
    triangles: Ints | None = None


def _membrane(frame: Frame, triangles: Ints) -> Surface:
    """The membrane particles and the triangles that do not pass through a periodic edge."""
    is_membrane = frame.kinds == Kind.MEMBRANE
    ids, positions = frame.ids[is_membrane], frame.positions[is_membrane]
    corners = np.searchsorted(ids, triangles)
    bent = curvature(positions, corners, (frame.edges[0], frame.edges[1]))
    sides = positions[corners] - positions[np.roll(corners, 1, axis=1)]
    inside = (sides == minimum_image(sides, tuple(frame.edges[:2]))).all(axis=(1, 2))
    data = {
        "id": ids, "height": positions[:, 2], "mean_curvature": bent.mean,
        "gaussian_curvature": bent.gaussian,
    }  # fmt: skip
    return Surface(positions, data, corners[inside])


def _cells(frame: Frame, scene: Scene) -> Surface:
    """The cells as points."""
    cells = is_cell(frame.kinds)
    data = {
        "id": frame.ids[cells], "kind": frame.kinds[cells],
        "radius": np.full(cells.sum(), scene.cells.radius),
        **{name: frame.state[name][cells] for name in CELL_DATA},
    }  # fmt: skip
    return Surface(frame.positions[cells], data)


# ---- LAMMPS, OVITO


def export_dump(run: str | Path, output: Path) -> Path:
    """Write a dump as LAMMPS would have written it; never over one that is there.

    Parameters
    ----------
    run : path
        Run directory, or a skin.h5.
    output : Path
        The file.
    """
    frames = open_frames(run)
    if output.exists():
        raise SkinError(f"output {output}: is there already")
    try:
        with atomic_write(output) as place:
            write_dump(place, frames, frames.scene.kinds)
    except OSError as error:
        raise SkinError(f"output {output}: {reason(error)}") from None
    return output
