"""skin.h5 holds what the dump holds, and says what it is."""

import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import h5py
import numpy as np
import pytest
from lammps_skin.cli import main
from lammps_skin.errors import SkinError
from lammps_skin.kinds import KINDS
from lammps_skin.model.parameters import DEFAULT
from lammps_skin.model.scene import Scene
from lammps_skin.start import lattice
from lammps_skin.trajectory import writer
from lammps_skin.trajectory import writer as writer_module
from lammps_skin.trajectory.convert import convert
from lammps_skin.trajectory.frame import CELL_STATE
from lammps_skin.trajectory.store import Store
from lammps_skin.trajectory.writer import TrajectoryWriter, source_commit

NONE = np.empty((0, 2), int)


@pytest.fixture
def file(run):
    with h5py.File(run.directory / "skin.h5") as opened:
        yield opened


def test_every_frame_is_that_of_the_dump(run, file):
    group = file["particles/trajectory"]
    slots = max(int(frame.ids.max()) for frame in run.frames)
    assert group["position/value"].shape == (len(run.frames), slots, 3)
    for n, frame in enumerate(run.frames):
        present = frame.ids - 1
        absent = np.setdiff1d(np.arange(slots), present)
        values = {"position": frame.positions, "id": frame.ids, "species": frame.kinds}
        for name, told in (values | frame.state).items():
            stored = group[name]["value"][n]
            np.testing.assert_array_equal(stored[present], told, err_msg=name)
            nothing = np.nan if stored.dtype.kind == "f" else -1
            np.testing.assert_array_equal(stored[absent], nothing, err_msg=name)
        np.testing.assert_array_equal(group["box/edges/value"][n], frame.edges)
    assert any(len(frame.ids) < slots for frame in run.frames)


def test_layout_is_h5md(run, file):
    np.testing.assert_array_equal(file["h5md"].attrs["version"], [1, 1])
    assert file["h5md/author"].attrs["name"]
    assert file["h5md/creator"].attrs["name"] == "lammps-skin"
    group = file["particles/trajectory"]
    assert group["box"].attrs["dimension"] == 3
    assert group["box"].attrs["boundary"].tolist() == [b"periodic", b"periodic", b"none"]
    for name in ("position", "id", "species", "box/edges", *CELL_STATE):
        element = group[name]
        assert element["step"][:].tolist() == [frame.step for frame in run.frames]
        assert element["time"][:].tolist() == [frame.time for frame in run.frames]
        assert len(element["value"]) == len(run.frames)


def test_datasets_can_grow_and_are_packed(file):
    for name in ("position", "id", "species", *CELL_STATE):
        value = file[f"particles/trajectory/{name}/value"]
        assert value.maxshape[:2] == (None, None)
        assert value.chunks[:2] == (1, 4096)
        assert value.compression == "gzip"


def test_membrane_is_under_connectivity(run, file):
    links, _ = lattice.links_and_hinges(run.scene.membrane.lattice)
    stored = file["connectivity/links"]
    assert file[stored.attrs["particles_group"]].name == "/particles/trajectory"
    np.testing.assert_array_equal(stored[:], links + 1)
    corners = lattice.triangles(run.scene.membrane.lattice) + 1
    turned = {tuple(np.roll(corner, -corner.argmin()).tolist()) for corner in corners}
    assert {tuple(row) for row in file["connectivity/triangles"][:].tolist()} == turned
    assert len(file["connectivity/triangles"]) == len(corners)


def test_metadata_make_the_scene_again(run, file):
    parameters = file["parameters"].attrs
    keys = tomllib.loads(parameters["scene"])
    assert Scene.from_dict(keys).model_dump() == run.scene.model_dump()
    assert keys["cells"]["adhesion_range"] == 1.2  # resolved: of the parameter set
    assert parameters["seed"] == run.scene.cell_seed and parameters["parameters"] == DEFAULT
    assert dict(file["parameters/species"].attrs) == {kind.label: int(kind) for kind in KINDS}
    versions = dict(file["parameters/versions"].attrs)
    assert {"python", "lammps-skin", "lammps", "numpy", "h5py"} <= versions.keys()
    assert versions.get("commit") == source_commit()


def test_commit_is_that_of_the_source_tree():
    """Of a package that runs in place; an installed one has no commit."""
    tree = Path(__file__).resolve().parents[2]
    told = subprocess.run(
        ["git", "-C", str(tree), "rev-parse", "HEAD"], capture_output=True, text=True
    )
    in_place = Path(writer.__file__).resolve().is_relative_to(tree / "pyscripts")
    if in_place and told.returncode == 0:
        assert (source_commit() or "").removesuffix("-dirty") == told.stdout.strip()
    else:
        assert source_commit() is None


def test_no_commit_of_a_tree_that_only_surrounds_the_package(tmp_path, monkeypatch):
    """As in an environment that lies in the repository of something else."""
    subprocess.run(["git", "init", "-q", str(tmp_path)], check=True)
    commit = ["commit", "-q", "--allow-empty", "-m", "other", "--no-gpg-sign"]
    name = ["-c", "user.name=A", "-c", "user.email=a@example.org"]
    subprocess.run(["git", "-C", str(tmp_path), *name, *commit], check=True)
    monkeypatch.setattr(writer_module, "__file__", str(tmp_path / "trajectory" / "writer.py"))
    assert source_commit() is None
    (tmp_path / "errors.py").touch()
    subprocess.run(["git", "-C", str(tmp_path), "add", "errors.py"], check=True)
    assert re.fullmatch(r"[0-9a-f]{40}-dirty", source_commit())


def test_every_frame_is_on_disk_when_written(run, tmp_path):
    with TrajectoryWriter(tmp_path / "a.h5", run.scene, NONE, NONE, author="A. Name") as writer:
        for n, frame in enumerate(run.frames[:3], 1):
            writer.write(frame)
            there = shutil.copy(tmp_path / "a.h5", tmp_path / f"{n}.h5")
            with h5py.File(there) as copy:
                assert copy["particles/trajectory/birth_time/value"].shape[0] == n
                stored = copy["particles/trajectory/position/value"][n - 1]
                np.testing.assert_array_equal(stored[frame.ids - 1], frame.positions)
                assert copy["h5md/author"].attrs["name"] == "A. Name"
            assert len(Store(there)) == n


def test_command_converts(run, tmp_path, capsys):
    output = tmp_path / "out.h5"
    with pytest.raises(SystemExit) as end:
        main(["convert", str(run.directory), "-o", str(output)])
    assert end.value.code == 0
    slots = max(int(frame.ids.max()) for frame in run.frames)
    said = f"{output}: {len(run.frames)} frames, {slots} particles in all\n"
    assert said in capsys.readouterr().out
    with h5py.File(output) as file:
        assert len(file["particles/trajectory/id/value"]) == len(run.frames)


def test_what_cannot_be_converted_is_refused_in_one_line(run, tmp_path, capsys):
    (tmp_path / "empty").mkdir()
    for name, why in [("nowhere", "No such file or directory"), ("empty", "holds no built scene")]:
        with pytest.raises(SystemExit) as end:
            main(["convert", str(tmp_path / name)])
        assert end.value.code == 2
        assert f"error: directory {tmp_path / name}: {why}" in capsys.readouterr().err
    broken = tmp_path / "broken"
    shutil.copytree(run.directory, broken)
    before = (broken / "skin.h5").read_bytes()
    (broken / "skin.dump").write_bytes(b"ITEM: TIME\n0\n")
    with pytest.raises(SkinError, match=r"skin\.dump: holds no complete frame"):
        convert(broken)
    (broken / "skin.dump").unlink()
    with pytest.raises(SkinError, match=r"skin\.dump: No such file"):
        convert(broken)
    with pytest.raises(SkinError, match=r"output .*nowhere"):
        convert(run.directory, tmp_path / "nowhere" / "skin.h5")
    assert (broken / "skin.h5").read_bytes() == before
    assert not list(broken.glob("*.part"))
