"""Files get their names when they are complete."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace

import pytest
from lammps_skin.errors import SkinError
from lammps_skin.figures import export
from lammps_skin.figures.snapshot import save
from lammps_skin.files import atomic_write
from lammps_skin.model.scene import Scene
from matplotlib.figure import Figure


def test_a_file_is_replaced_when_the_new_one_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "file.txt"
    path.write_text("old")
    with atomic_write(path) as place:
        place.write_text("new")
        assert path.read_text() == "old"
        assert place.suffix == path.suffix
    assert path.read_text() == "new"
    assert [path] == list(tmp_path.iterdir())


def test_a_failure_leaves_the_earlier_file(tmp_path: Path) -> None:
    path = tmp_path / "file.txt"
    path.write_text("old")
    with pytest.raises(OSError, match="full"), atomic_write(path) as place:
        place.write_text("half")
        raise OSError("full")
    assert path.read_text() == "old"
    assert [path] == list(tmp_path.iterdir())


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "link.txt").symlink_to("file.txt")
    with atomic_write(tmp_path / "link.txt") as place:
        place.write_text("new")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "file.txt").read_text() == "new"


def test_a_pipe_is_written_directly(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with atomic_write(tmp_path / "pipe") as place:
        assert place == tmp_path / "pipe"


def test_a_picture_that_fails_leaves_the_earlier_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, figure = tmp_path / "picture.png", Figure()
    path.write_text("old")

    def savefig(place: Path, **_: object) -> None:
        Path(place).write_text("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(figure, "savefig", savefig)
    with pytest.raises(SkinError, match=r"picture\.png: No space left on device$"):
        save(figure, path)
    assert path.read_text() == "old"
    assert [path] == list(tmp_path.iterdir())


def test_a_dump_that_fails_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def write_dump(path: Path, *_: object) -> None:
        path.write_text("half")
        raise OSError(28, "No space left on device")

    frames = SimpleNamespace(scene=Scene.from_dict({}))
    monkeypatch.setattr(export, "open_frames", lambda _: frames)
    monkeypatch.setattr(export, "write_dump", write_dump)
    with pytest.raises(SkinError, match=r"out\.dump: No space left on device$"):
        export.export_dump("run", tmp_path / "out.dump")
    assert not list(tmp_path.iterdir())
