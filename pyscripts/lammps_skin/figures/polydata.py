"""Points and triangles in a file .vtp, and a series of such files .pvd, in VTK's XML format."""

from __future__ import annotations

import xml.etree.ElementTree as xml
from base64 import b64encode
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from lammps_skin.arrays import Floats, Ints
from lammps_skin.files import atomic_write

TYPES = {"f": ("Float64", "<f8"), "i": ("Int64", "<i8")}  # by kind of numpy: in VTK, in the file


def write_polydata(
    path: Path,
    points: Floats,
    data: Mapping[str, Floats | Ints],
    triangles: Ints | None = None,
) -> None:
    """Write points (n, 3) with data (n,) each, and triangles (m, 3) of them or the points alone."""
    shapes = np.arange(len(points))[:, None] if triangles is None else triangles
    name = "Verts" if triangles is None else "Polys"
    root = _root("PolyData")
    counts = {"NumberOfPoints": str(len(points)), f"NumberOf{name}": str(len(shapes))}
    piece = xml.SubElement(xml.SubElement(root, "PolyData"), "Piece", counts)
    point_data = xml.SubElement(piece, "PointData")
    for title, values in data.items():
        _add_array(point_data, title, values)
    _add_array(xml.SubElement(piece, "Points"), "Points", points, columns=3)
    corners, size = xml.SubElement(piece, name), shapes.shape[1]
    _add_array(corners, "connectivity", shapes)
    _add_array(corners, "offsets", size * np.arange(1, len(shapes) + 1))
    _write(root, path)


def write_series(path: Path, files: Iterable[tuple[float, str]]) -> None:
    """Write a collection of files at times."""
    root = _root("Collection")
    collection = xml.SubElement(root, "Collection")
    for time, file in files:
        xml.SubElement(collection, "DataSet", timestep=repr(time), part="0", file=file)
    _write(root, path)


def _root(kind: str) -> xml.Element:
    order = {"byte_order": "LittleEndian", "header_type": "UInt64"}
    return xml.Element("VTKFile", {"type": kind, "version": "1.0", **order})


def _add_array(parent: xml.Element, name: str, values: Floats | Ints, columns: int = 1) -> None:
    """Add an array as VTK's "binary" has it: in base64, after the number of its bytes."""
    kind, layout = TYPES[values.dtype.kind]
    content = values.astype(layout).tobytes()
    array = xml.SubElement(parent, "DataArray", type=kind, Name=name, format="binary")
    array.set("NumberOfComponents", str(columns))
    array.text = b64encode(np.array(len(content), "<u8").tobytes() + content).decode()


def _write(root: xml.Element, path: Path) -> None:
    xml.indent(root)
    with atomic_write(path) as place:
        xml.ElementTree(root).write(place, encoding="utf-8", xml_declaration=True)
