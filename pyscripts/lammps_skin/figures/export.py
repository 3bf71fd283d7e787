"""The trajectory of a run in files of other programs: ParaView, and the dump of LAMMPS."""

from __future__ import annotations

import xml.etree.ElementTree as xml
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyvista

from lammps_skin.analysis.curvature import curvature
from lammps_skin.analysis.geometry import minimum_image
from lammps_skin.arrays import Ints
from lammps_skin.errors import SkinError
from lammps_skin.files import completed
from lammps_skin.kinds import CELLS, Kind
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.dump import Dump, write_dump
from lammps_skin.trajectory.frame import Frame
from lammps_skin.trajectory.store import DUMP, Store, trajectory_of
from lammps_skin.trajectory.writer import reason

CELL_DATA = ("divisions_left", "partner", "parent", "pair", "birth_time", "next_division")


class Recorded(NamedTuple):
    """A run as it was recorded: its frames and what does not change with them."""

    frames: Dump | Store
    scene: Scene
    triangles: Ints


def recorded(run: str | Path) -> Recorded:
    """The trajectory of a run directory, or a skin.h5."""
    path = Path(run)
    if path.is_dir():
        path = trajectory_of(path)
    frames = (Dump if path.suffix == Path(DUMP).suffix else Store)(path)
    if not len(frames):
        raise SkinError(f"trajectory {path}: holds no complete frame")
    return Recorded(frames, frames.scene, frames.triangles)


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
    frames, scene, triangles = recorded(run)
    series: dict[str, list[tuple[float, str]]] = {"membrane": [], "cells": []}
    try:
        output.mkdir(parents=True, exist_ok=True)
        for frame in frames:
            surfaces = {"membrane": _membrane(frame, triangles), "cells": _cells(frame, scene)}
            for name, surface in surfaces.items():
                file = f"{name}.{frame.step:010d}.vtp"
                with completed(output / file) as place:
                    surface.save(place)
                series[name].append((frame.time, file))
        return [_write_series(output / f"{name}.pvd", files) for name, files in series.items()]
    except OSError as error:
        raise SkinError(f"output {output}: {reason(error)}") from None


def _membrane(frame: Frame, triangles: Ints) -> Any:
    """The membrane particles and the triangles that do not pass through a periodic edge."""
    is_membrane = frame.kinds == Kind.MEMBRANE
    ids, positions = frame.ids[is_membrane], frame.positions[is_membrane]
    corners = np.searchsorted(ids, triangles)
    bent = curvature(positions, corners, (frame.edges[0], frame.edges[1]))
    sides = positions[corners] - positions[np.roll(corners, 1, axis=1)]
    inside = (sides == minimum_image(sides, tuple(frame.edges[:2]))).all(axis=(1, 2))
    surface = pyvista.PolyData.from_regular_faces(positions, corners[inside])
    surface["id"] = ids
    surface["height"] = positions[:, 2]
    surface["mean_curvature"] = bent.mean
    surface["gaussian_curvature"] = bent.gaussian
    return surface


def _cells(frame: Frame, scene: Scene) -> Any:
    """The cells as points."""
    is_cell = np.isin(frame.kinds, CELLS)
    points = pyvista.PolyData(frame.positions[is_cell])
    points["id"], points["kind"] = frame.ids[is_cell], frame.kinds[is_cell]
    points["radius"] = np.full(is_cell.sum(), scene.cells.radius)
    for name in CELL_DATA:
        points[name] = frame.state[name][is_cell]
    return points


def _write_series(path: Path, files: Iterable[tuple[float, str]]) -> Path:
    """A collection of files at times, in ParaView's format."""
    root = xml.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection = xml.SubElement(root, "Collection")
    for time, file in files:
        xml.SubElement(collection, "DataSet", timestep=repr(time), part="0", file=file)
    xml.indent(root)
    with completed(path) as place:
        xml.ElementTree(root).write(place, encoding="utf-8", xml_declaration=True)
    return path


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
    frames, scene, _ = recorded(run)
    if output.exists():
        raise SkinError(f"output {output}: is there already")
    try:
        with completed(output) as place:
            write_dump(place, frames, scene.kinds)
    except OSError as error:
        raise SkinError(f"output {output}: {reason(error)}") from None
    return output
