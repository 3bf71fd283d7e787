"""What `skin export` writes is what other programs read."""

from __future__ import annotations

import shutil
import subprocess

import numpy as np
import pytest
import pyvista
from lammps_skin.analysis.curvature import curvature
from lammps_skin.cli import main
from lammps_skin.kinds import CELLS, Kind
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


def frames_of(series):
    """Times and surfaces of a time series, as ParaView reads it."""
    reader = pyvista.PVDReader(series)
    for time in reader.time_values:
        reader.set_active_time_value(time)
        yield time, reader.read()[0]


def test_membrane_in_every_frame(run, exported):
    corners = lattice.triangles(run.scene.membrane.lattice)
    sides = np.array(run.scene.box_sides)
    found = list(frames_of(exported / "membrane.pvd"))
    assert [time for time, _ in found] == pytest.approx([n * INTERVAL for n in range(FRAMES)])
    for (_, surface), told in zip(found, run.particles, strict=True):
        places = told.positions[told.types == Kind.MEMBRANE]
        np.testing.assert_array_equal(surface.points, places)
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
        kept = {frozenset(face) for face in surface.regular_faces.tolist()}
        assert kept == {frozenset(face) for face in corners[inside].tolist()}
        assert 0 < len(kept) < len(corners)
    first = pyvista.read(exported / "membrane.0000000000.vtp")
    assert (first.compute_normals(consistent_normals=False)["Normals"][:, 2] > 0).all()


def test_cells_in_every_frame(run, exported):
    for (_, points), told in zip(frames_of(exported / "cells.pvd"), run.cells, strict=True):
        np.testing.assert_array_equal(points.points, told.positions)
        np.testing.assert_array_equal(points["id"], told.ids)
        np.testing.assert_array_equal(points["kind"], told.types)
        assert set(points["kind"]) <= set(CELLS)
        assert (points["radius"] == run.scene.cells.radius).all()
        for name in ("divisions_left", "partner", "parent", "pair", "birth_time"):
            np.testing.assert_array_equal(points[name], getattr(told, name))


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
