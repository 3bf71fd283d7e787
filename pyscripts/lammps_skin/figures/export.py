"""The trajectory of a run in files of other programs: ParaView, OVITO, VMD, LAMMPS."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lammps_skin.analysis.curvature import curvature
from lammps_skin.analysis.geometry import minimum_image
from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import SkinError
from lammps_skin.figures.atoms import radius_of, write_vmd, write_xyz
from lammps_skin.figures.paraview_script import paraview_script
from lammps_skin.figures.polydata import write_polydata, write_series
from lammps_skin.files import atomic_write
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.clones import clones
from lammps_skin.trajectory.dump import write_dump
from lammps_skin.trajectory.frame import Frame
from lammps_skin.trajectory.frames import open_frames
from lammps_skin.trajectory.writer import reason

SCRIPT = "view.py"
CELL_DATA = ("divisions_left", "partner", "parent", "pair", "birth_time", "next_division")


# ---- ParaView


def export_vtk(run: str | Path, output: Path) -> list[Path]:
    """Write membrane, cells and dermis of every frame for ParaView, and the script view.py.

    There are the time series membrane.pvd, cells.pvd and, of a scene with a dermis, dermis.pvd, of
    one file .vtp for each frame. Points of the membrane have id, height, mean_curvature and
    gaussian_curvature; those of cells have id, kind, radius, clone and their state; those of the
    dermis id and radius. Triangles that pass through a periodic edge are left out.

    Parameters
    ----------
    run : path
        Run directory, or a skin.h5.
    output : Path
        Directory, made if it is not there.

    Returns
    -------
    list of Path
        The time series, and the script.
    """
    frames = open_frames(run)
    scene, founders = frames.scene, clones(frames)
    names = ("membrane", "cells", *(["dermis"] if scene.dermis.present else []))
    series: dict[str, list[tuple[float, str]]] = {name: [] for name in names}
    try:
        output.mkdir(parents=True, exist_ok=True)
        for frame in frames:
            surfaces = {
                "membrane": _membrane(frame, frames.triangles),
                "cells": _cells(frame, scene, founders),
                "dermis": _dermis(frame, scene),
            }
            for name in series:
                surface = surfaces[name]
                file = f"{name}.{frame.step:010d}.vtp"
                write_polydata(output / file, *surface)
                series[name].append((frame.time, file))
        for name, files in series.items():
            write_series(output / f"{name}.pvd", files)
        script = paraview_script(scene.kinds_of_cells, scene.dermis.present)
        (output / SCRIPT).write_text(script, "utf-8")
    except OSError as error:
        raise SkinError(f"output {output}: {reason(error)}") from None
    return [*(output / f"{name}.pvd" for name in series), output / SCRIPT]


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


def _cells(frame: Frame, scene: Scene, founders: Ints) -> Surface:
    """The cells as points, with the founders (s,) of the cells of all ids."""
    cells = is_cell(frame.kinds)
    data = {
        "id": frame.ids[cells], "kind": frame.kinds[cells],
        "radius": np.full(cells.sum(), scene.cells.radius),
        "clone": founders[frame.ids[cells] - 1],
        **{name: frame.state[name][cells] for name in CELL_DATA},
    }  # fmt: skip
    return Surface(frame.positions[cells], data)


def _dermis(frame: Frame, scene: Scene) -> Surface:
    """The particles of the dermis as points."""
    chosen = frame.kinds == Kind.DERMAL
    radius = np.full(chosen.sum(), radius_of(scene, Kind.DERMAL))
    return Surface(frame.positions[chosen], {"id": frame.ids[chosen], "radius": radius})


# ---- OVITO, VMD


def export_xyz(run: str | Path, output: Path) -> Path:
    """Write extended XYZ, with names, radii, colours and clones, for OVITO and ASE.

    Parameters
    ----------
    run : path
        Run directory, or a skin.h5.
    output : Path
        The file.
    """
    frames = open_frames(run)
    return _written(output, lambda place: write_xyz(place, frames.scene, frames, clones(frames)))


def export_vmd(run: str | Path, output: Path) -> list[Path]:
    """Write a trajectory for VMD, and the script view.tcl that shows it.

    Parameters
    ----------
    run : path
        Run directory, or a skin.h5.
    output : Path
        Directory, made if it is not there.

    Returns
    -------
    list of Path
        What has been written.
    """
    frames = open_frames(run)
    try:
        output.mkdir(parents=True, exist_ok=True)
        return write_vmd(output, frames.scene, frames, clones(frames))
    except OSError as error:
        raise SkinError(f"output {output}: {reason(error)}") from None


# ---- LAMMPS


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
    return _written(output, lambda place: write_dump(place, frames, frames.scene.kinds))


def _written(output: Path, write: Callable[[Path], object]) -> Path:
    """A file that is written as a whole; raises `SkinError` if it cannot be."""
    try:
        with atomic_write(output) as place:
            write(place)
    except OSError as error:
        raise SkinError(f"output {output}: {reason(error)}") from None
    return output
