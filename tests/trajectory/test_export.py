"""What `skin export` writes is what other programs read."""

from __future__ import annotations

import base64
import shutil
import subprocess
import xml.etree.ElementTree as xml

import numpy as np
import pytest
from lammps_skin.analysis.curvature import curvature
from lammps_skin.cli import main
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.start import lattice

from tests.trajectory.conftest import FRAMES, INTERVAL


def export(*arguments: object) -> int:
    with pytest.raises(SystemExit) as end:
        main(["export", *map(str, arguments)])
    return int(end.value.code)


@pytest.fixture(scope="module")
def exported(run, tmp_path_factory):
    """Directory with the series of the run that Python has driven."""
    output = tmp_path_factory.mktemp("vtk") / "new"
    assert export(run.driven, "--to", "vtk", "-o", output) == 0
    return output


def read(path):
    """The arrays of a file .vtp by name, as VTK's page on its XML formats describes them."""
    root = xml.parse(path).getroot()
    assert root.attrib == {
        "type": "PolyData", "version": "1.0", "byte_order": "LittleEndian",
        "header_type": "UInt64",
    }  # fmt: skip
    found = {}
    for array in root.iter("DataArray"):
        content = base64.b64decode(array.text, validate=True)
        assert int.from_bytes(content[:8], "little") == len(content) - 8
        layout = {"Float64": "<f8", "Int64": "<i8"}[array.get("type")]
        found[array.get("Name")] = np.frombuffer(content[8:], layout)
    corners = {"Polys": 3, "Verts": 1}
    (piece,) = root.iter("Piece")
    (shape,) = (part for part in piece if part.tag in corners)
    size = corners[shape.tag]
    found["faces"] = found.pop("connectivity").reshape(-1, size)
    found["Points"] = found["Points"].reshape(-1, 3)
    told = {"Points": len(found["Points"]), shape.tag: len(found["faces"])}
    assert piece.attrib == {f"NumberOf{name}": str(number) for name, number in told.items()}
    np.testing.assert_array_equal(found.pop("offsets"), size * np.arange(1, told[shape.tag] + 1))
    return found


def frames_of(series):
    """Times and surfaces of a time series."""
    for frame in xml.parse(series).getroot().iter("DataSet"):
        yield float(frame.get("timestep")), read(series.parent / frame.get("file"))


def test_membrane_in_every_frame(run, exported):
    corners = lattice.triangles(run.scene.membrane.lattice)
    sides = np.array(run.scene.box_sides)
    found = list(frames_of(exported / "membrane.pvd"))
    assert [time for time, _ in found] == pytest.approx([n * INTERVAL for n in range(FRAMES)])
    for (_, surface), told in zip(found, run.particles, strict=True):
        places = told.positions[told.types == Kind.MEMBRANE]
        np.testing.assert_array_equal(surface["Points"], places)
        np.testing.assert_array_equal(surface["id"], np.arange(1, len(places) + 1))
        np.testing.assert_array_equal(surface["height"], places[:, 2])
        bent = curvature(places, corners, tuple(sides[:2]))
        np.testing.assert_allclose(surface["mean_curvature"], bent.mean, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(surface["gaussian_curvature"], bent.gaussian, atol=1e-9)


def test_no_triangle_crosses_the_box(run, exported):
    """Those at the edge are left out, all others are there, with the cells on their outside."""
    corners = lattice.triangles(run.scene.membrane.lattice)
    for (_, surface), told in zip(frames_of(exported / "membrane.pvd"), run.particles, strict=True):
        flat = told.positions[told.types == Kind.MEMBRANE][:, :2]
        extent = np.ptp(flat[corners], axis=1)
        inside = (extent < np.array(run.scene.box_sides[:2]) / 2).all(axis=1)
        kept = {frozenset(face) for face in surface["faces"].tolist()}
        assert kept == {frozenset(face) for face in corners[inside].tolist()}
        assert 0 < len(kept) < len(corners)
    first = read(exported / "membrane.0000000000.vtp")
    a, b, c = np.moveaxis(first["Points"][first["faces"]], 1, 0)
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_cells_in_every_frame(run, exported):
    for (_, points), told in zip(frames_of(exported / "cells.pvd"), run.cells, strict=True):
        np.testing.assert_array_equal(points["Points"], told.positions)
        np.testing.assert_array_equal(points["id"], told.ids)
        np.testing.assert_array_equal(points["kind"], told.types)
        assert is_cell(points["kind"]).all()
        np.testing.assert_array_equal(points["faces"][:, 0], np.arange(len(told.ids)))
        assert (points["radius"] == run.scene.cells.radius).all()
        for name in ("divisions_left", "partner", "parent", "pair", "birth_time"):
            np.testing.assert_array_equal(points[name], getattr(told, name))


@pytest.mark.parametrize("name", ["membrane", "cells"])
def test_vtk_reads_the_same(name, exported):
    """Where it is installed: it is 566 MB."""
    pyvista = pytest.importorskip("pyvista")
    reader = pyvista.PVDReader(exported / f"{name}.pvd")
    for n, (time, told) in enumerate(frames_of(exported / f"{name}.pvd")):
        reader.set_active_time_point(n)
        (found,) = reader.read()
        assert reader.time_values[n] == time
        np.testing.assert_array_equal(found.points, told.pop("Points"))
        faces = found.verts.reshape(-1, 2)[:, 1:] if name == "cells" else found.regular_faces
        np.testing.assert_array_equal(faces, told.pop("faces"))
        assert set(found.point_data) == set(told)
        for title, values in told.items():
            np.testing.assert_array_equal(found[title], values)


def test_a_dump_is_the_one_of_lammps(run, tmp_path):
    """To the last byte."""
    output = tmp_path / "skin.dump"
    assert export(run.driven / "skin.h5", "--to", "dump", "-o", output) == 0
    assert output.read_bytes() == (run.directory / "skin.dump").read_bytes()


def test_a_dump_is_a_source_too(run, tmp_path, exported):
    (tmp_path / "run").mkdir()
    for name in ("skin.in", "scene.toml", "skin.data", "skin.dump"):
        shutil.copy(run.directory / name, tmp_path / "run")
    assert export(tmp_path / "run", "--to", "vtk") == 0
    for path in exported.iterdir():
        assert (tmp_path / "run" / "vtk" / path.name).read_bytes() == path.read_bytes()


def test_what_cannot_be_exported_is_refused(run, tmp_path, capsys):
    (tmp_path / "file").touch()
    cases = {
        (tmp_path, "--to", "vtk"): "holds no trajectory (neither skin.h5 nor skin.dump)",
        (run.directory, "--to", "dump"): "skin.dump: is there already",
        (run.directory, "--to", "vtk", "-o", tmp_path / "file"): "file: File exists",
        (tmp_path / "none.h5", "--to", "vtk"): "none.h5: No such file or directory",
        (run.directory, "--to", "xyz"): "'xyz' is not one of",
    }
    for arguments, text in cases.items():
        assert export(*arguments) == 2
        error = capsys.readouterr().err
        assert error.startswith("error: ") and text in error and error.count("\n") == 1


@pytest.mark.skipif(not shutil.which("h5dump"), reason="there is no h5dump on this machine")
def test_h5dump_opens_the_file(run):
    ended = subprocess.run(
        ["h5dump", "-d", "/particles/trajectory/position/step", run.driven / "skin.h5"],
        capture_output=True, text=True,
    )  # fmt: skip
    assert ended.returncode == 0 and "(0): 0, 50, 100" in ended.stdout
