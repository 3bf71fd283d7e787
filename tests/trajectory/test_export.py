"""What `skin export` writes is what other programs read."""

from __future__ import annotations

import ast
import base64
import re
import shutil
import subprocess
import xml.etree.ElementTree as xml

import numpy as np
import pytest
from lammps_skin.analysis.curvature import curvature
from lammps_skin.cli import main
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.start import lattice
from scipy.spatial import cKDTree

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


def test_clones_of_cells_are_those_of_their_mothers(run, exported):
    clone, mothers = {}, {}
    for _, points in frames_of(exported / "cells.pvd"):
        clone |= dict(zip(points["id"].tolist(), points["clone"].tolist(), strict=True))
        mothers |= dict(zip(points["id"].tolist(), points["parent"].tolist(), strict=True))
    born = {cell: mother for cell, mother in mothers.items() if mother in clone}
    assert len(born) > 5
    assert all(clone[cell] == clone[mother] for cell, mother in born.items())
    first = read(exported / "cells.0000000000.vtp")
    np.testing.assert_array_equal(first["clone"], first["id"])


def test_the_script_for_paraview_is_python_and_names_the_kinds(run, exported):
    text = (exported / "view.py").read_text()
    body = compile(text, "view.py", "exec", ast.PyCF_ONLY_AST).body
    values = {
        one.targets[0].id: ast.literal_eval(one.value)
        for one in body
        if isinstance(one, ast.Assign) and ast.unparse(one.targets[0]) in ("KINDS", "DERMIS")
    }
    assert values["KINDS"] == {int(k): (k.name, k.colour) for k in run.scene.kinds_of_cells}
    assert values["DERMIS"] is False
    names = {one.args[0].value for one in ast.walk(ast.Module(body, [])) if is_call(one, "spheres")}
    assert {"cells", "dermis"} == names


def is_call(node, name):
    return isinstance(node, ast.Call) and getattr(node.func, "id", "") == name


def test_extended_xyz(run, tmp_path):
    """Read line by line, as its description says."""
    output = tmp_path / "skin.xyz"
    assert export(run.driven, "--to", "xyz", "-o", output) == 0
    lines = iter(output.read_text().splitlines())
    kinds = {int(kind): kind for kind in run.scene.kinds}
    for told, frame in zip(run.particles, run.frames, strict=True):
        assert int(next(lines)) == len(told.ids)
        header = next(lines)
        lattice_vectors = re.search(r'Lattice="([^"]*)"', header)[1].split()
        assert [float(lattice_vectors[n]) for n in (0, 4, 8)] == list(run.scene.box_sides)
        assert f"Time={frame.time:.16g}" in header
        widths = re.search(r"Properties=(\S+)", header)[1].split(":")[2::3]
        rows = [next(lines).split() for _ in told.ids]
        assert {len(row) for row in rows} == {sum(map(int, widths))}
        assert [row[0] for row in rows] == [kinds[kind].label for kind in told.types.tolist()]
        np.testing.assert_allclose(
            np.array([row[1:4] for row in rows], float), told.positions, rtol=1e-7
        )
        assert [int(row[4]) for row in rows] == told.ids.tolist()
        radii = {Kind.MEMBRANE: run.scene.membrane.radius}
        assert [float(row[5]) for row in rows] == [
            radii.get(kind, run.scene.cells.radius) for kind in told.types.tolist()
        ]
    assert next(lines, None) is None


def test_vmd_has_a_fixed_number_of_atoms_and_all_that_is_there(run, tmp_path):
    output = tmp_path / "vmd"
    assert export(run.driven, "--to", "vmd", "-o", output) == 0
    clone_of_place = np.loadtxt(output / "clones.dat", dtype=int)
    lines = iter((output / "skin.xyz").read_text().splitlines())
    names = None
    kinds = {int(kind): kind.label for kind in run.scene.kinds}
    for told in run.particles:
        number = int(next(lines))
        assert number == len(clone_of_place)
        next(lines)
        rows = [next(lines).split() for _ in range(number)]
        assert names in (None, [row[0] for row in rows])  # the same in all frames
        names = [row[0] for row in rows]
        places = np.array([row[1:] for row in rows], float)
        there = places[:, 2] > -500
        assert there.sum() == len(told.ids)
        for kind, label in kinds.items():
            chosen = there & (np.array(names) == label)
            wanted = told.positions[told.types == kind]
            assert chosen.sum() == len(wanted)
            if len(wanted):
                distance, which = cKDTree(wanted).query(places[chosen])
                assert distance.max() < 1e-5 and len(set(which)) == len(wanted)
    script = (output / "view.tcl").read_text()
    calls = tcl_calls(output / "view.tcl")
    there = {kind.label for kind in run.scene.kinds if kind.label in names}
    assert {call for call in calls if call.startswith("mol selection")} == {
        f"mol selection {{name {label} and z > -500}}" for label in there
    }
    assert f"mol new {output}/skin.xyz type xyz waitfor all" in calls
    assert [call for call in calls if " set resid " in call] == [
        "all set resid " + " ".join(map(str, clone_of_place))
    ]
    for kind in run.scene.kinds:
        assert (f"\n  {kind.label} " in script) == (kind.label in names)
    assert script.count("{") == script.count("}")


def tcl_calls(script):
    """What a script calls of VMD, in the interpreter of Tcl that Python brings along."""
    tcl = pytest.importorskip("tkinter").Tcl()
    tcl.eval(
        "proc mol args {lappend ::calls [concat mol $args]}\n"
        "proc color args {lappend ::calls [concat color $args]}\n"
        "proc atomselect {molecule text} {return $text}\n"
        'proc unknown {text args} {lappend ::calls "$text [join $args]"}\n'
        f"source {script}"
    )
    return list(tcl.splitlist(tcl.getvar("calls")))


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
        (run.directory, "--to", "pdb"): "--to pdb: must be one of vtk, xyz, vmd, dump",
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
