"""Files that are damaged are recognised, and an older checkpoint takes their place."""

from __future__ import annotations

import errno
import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from lammps_skin.errors import SkinError
from lammps_skin.run import checkpoints
from lammps_skin.run.checkpoints import content_hash, find_resumption
from lammps_skin.run.simulation import Simulation
from lammps_skin.trajectory.store import Store

from tests.run.disturbed import (
    Outcome,
    assert_same,
    cut,
    finish,
)
from tests.trajectory.conftest import same

KEPT = (150, 200, 250)  # steps of the checkpoints that the run of `halfway` has


@pytest.fixture
def run(halfway: Path, tmp_path: Path) -> Path:
    """Copy of a run with three checkpoints."""
    directory = tmp_path / "run"
    shutil.copytree(halfway, directory)
    names = sorted(path.name for path in directory.glob("skin.*.restart"))
    assert names == [f"skin.step{step}.restart" for step in KEPT]
    return directory


def newest(directory: Path) -> Path:
    return directory / "skin.step250.restart"


def cut_events(restart: Path) -> None:
    """The last line of the log that goes with a checkpoint."""
    entries = json.loads(restart.with_name("checkpoints.json").read_text())["checkpoints"]
    length, _ = entries[-1]["files"]["events.csv"]
    os.truncate(restart.with_name("events.csv"), length - 5)


def flip(path: Path, share: float = 0.5, bit: int = 4) -> None:
    """Change one bit."""
    content = bytearray(path.read_bytes())
    content[int(len(content) * share)] ^= 1 << bit
    path.write_bytes(content)


def replace_by_directory(path: Path) -> None:
    path.unlink()
    path.mkdir()


def as_of_another_version(path: Path) -> None:
    """The version that LAMMPS states in it; without a list there are no hashes."""
    path.write_bytes(path.read_bytes().replace(b"22 Jul 2025", b"22 Jul 2019"))
    (path.parent / "checkpoints.json").unlink()


# ---- restart files


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (cut, "is damaged"),
        (flip, "is damaged"),
        (lambda path: flip(path, 0.0), "is damaged"),
        (lambda path: flip(path, 0.9999), "is damaged"),
        (lambda path: cut(path, 0), "is damaged"),
        (replace_by_directory, "Is a directory"),
        (as_of_another_version, r"was written by LAMMPS 22 Jul 2019, and this is \d"),
        (cut_events, "events.csv does not go with it"),
        (lambda path: path.with_name("checkpoints.json").unlink() or cut(path), "is damaged"),
    ],
)  # fmt: skip
def test_a_damaged_checkpoint_is_passed_over(
    damage: Callable[[Path], None], said: str, run: Path
) -> None:
    log = (run / "events.csv").read_text()
    damage(newest(run))
    found = find_resumption(run)
    if (run / "events.csv").read_text() == log:
        assert found.restart == "skin.step200.restart"
    (note,) = found.notes[:1]
    assert note.startswith(f"checkpoint {newest(run)}: ")
    assert re.search(said, note)


@pytest.mark.parametrize("damage", [cut, flip])
def test_a_run_goes_on_from_the_checkpoint_before(
    damage: Callable[[Path], None], run: Path, undisturbed: Outcome
) -> None:
    damage(newest(run))
    assert_same(finish(run), undisturbed)
    assert find_resumption(run).notes == []


def test_the_newest_is_the_one_of_the_last_step(run: Path) -> None:
    """The clock may have jumped, and steps may have fewer digits."""
    for step, year in zip(KEPT, (2100, 1980, 2001), strict=True):
        moment = time.mktime((year, 1, 1, 0, 0, 0, 0, 0, 0))
        os.utime(run / f"skin.step{step}.restart", (moment, moment))
    last = newest(run).name
    (run / "skin.step99.restart").touch()
    found = find_resumption(run)
    assert found.restart == last and not found.passed_over


def test_no_checkpoint_is_good(run: Path) -> None:
    for step in KEPT:
        flip(run / f"skin.step{step}.restart")
    before = {path.name: path.read_bytes() for path in run.iterdir()}
    with pytest.raises(SkinError, match=r"has no good checkpoint; .*step250.* .*step150.*damaged"):
        Simulation.resume(run)
    assert before == {path.name: path.read_bytes() for path in run.iterdir()}


def test_no_run(built: Path) -> None:
    with pytest.raises(SkinError, match="holds no checkpoint to resume from"):
        Simulation.resume(built)


def test_the_list_is_damaged(run: Path, undisturbed: Outcome) -> None:
    cut(run / "checkpoints.json")
    assert find_resumption(run).notes == [
        f"checkpoints {run / 'checkpoints.json'}: is damaged; hashes are not compared"
    ]
    assert_same(finish(run), undisturbed)
    assert len(json.loads((run / "checkpoints.json").read_text())["checkpoints"]) == 3


@pytest.fixture
def all_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """No process tries whether LAMMPS reads a restart file: it does."""
    monkeypatch.setattr(checkpoints, "_fault_of_content", lambda *_: None)


@pytest.mark.usefixtures("all_are_read")
def test_any_bit_of_the_list_is_damaged(run: Path) -> None:
    """The files that it lists are not blamed."""
    path = run / "checkpoints.json"
    content, draw = path.read_bytes(), np.random.default_rng(4)
    for bit in draw.integers(0, 8 * len(content), 3):
        changed = bytearray(content)
        changed[bit // 8] ^= 1 << bit % 8
        path.write_bytes(changed)
        assert find_resumption(run).notes == [
            f"checkpoints {path}: is damaged; hashes are not compared"
        ]


@pytest.mark.usefixtures("all_are_read")
@pytest.mark.parametrize("text", ["[" * 100_000, "3", "[]", "{}", '{"hash": null}', "\0"])
def test_the_list_is_another_text(text: str, run: Path) -> None:
    (run / "checkpoints.json").write_text(text)
    assert find_resumption(run).restart == newest(run).name


def test_a_restart_file_without_a_hash_is_read_elsewhere_first(run: Path) -> None:
    """Its form is whole; what LAMMPS cannot read it may crash on: the one before is taken."""
    (run / "checkpoints.json").unlink()
    content = newest(run).read_bytes()
    place = content.index(b"skin/cells\0") + len(b"skin/cells\0")
    size = int.from_bytes(content[place : place + 4], sys.byteorder)
    longer = (size ^ 1 << 30).to_bytes(4, sys.byteorder)
    newest(run).write_bytes(content[:place] + longer + content[place + 4 :])
    found = find_resumption(run)
    assert found.restart == "skin.step200.restart"
    assert found.notes[0].startswith(f"checkpoint {newest(run)}: ")


def test_a_checkpoint_from_before_there_were_interventions(run: Path) -> None:
    """Its number of the form is another one, and it lacks the last of what is stored now."""
    content = newest(run).read_bytes()
    size = content.index(b"skin/cells\0") + len(b"skin/cells\0")
    stored = int.from_bytes(content[size : size + 4], sys.byteorder)
    values = np.frombuffer(content, float, stored // 8, size + 4).copy()
    values[0] = -1.0
    shorter = (stored - 8).to_bytes(4, sys.byteorder)
    rest = values[:-1].tobytes() + content[size + 4 + stored :]
    newest(run).write_bytes(content[:size] + shorter + rest)
    (run / "checkpoints.json").unlink()
    assert find_resumption(run).restart == newest(run).name


def test_another_version_of_the_plugin(run: Path) -> None:
    """Its own number of the form stands before what it stores: 2 of them, as a double."""
    content = newest(run).read_bytes()
    assert content.count(b"skin/cells\0") == 1
    place = content.index(b"skin/cells\0") + len(b"skin/cells\0") + 4
    form = np.frombuffer(content, float, 1, place)
    changed = content[:place] + (form - 1).tobytes() + content[place + 8 :]
    newest(run).write_bytes(changed)
    (run / "checkpoints.json").unlink()
    found = find_resumption(run)
    assert found.restart == "skin.step200.restart"
    assert "was written by another version of this fix" in found.notes[0]


# ---- what else a run is made of


@pytest.mark.parametrize("name", ["scene.in", "skin.in", "cell_cell_adhesion.table", "scene.toml"])
def test_inputs_that_have_changed(name: str, run: Path) -> None:
    (run / name).write_text((run / name).read_text() + "\n# changed\n")
    with pytest.raises(SkinError, match=f"input .*{name}: is not what it was when the run began"):
        Simulation.resume(run)


def test_the_data_file_counts_where_a_run_begins(run: Path, undisturbed: Outcome) -> None:
    flip(run / "skin.data")
    assert find_resumption(run).restart == newest(run).name
    for step in KEPT:
        (run / f"skin.step{step}.restart").unlink()
    listed = {**json.loads((run / "checkpoints.json").read_text()), "checkpoints": []}
    del listed["hash"]
    listed["hash"] = content_hash(listed)
    (run / "checkpoints.json").write_text(json.dumps(listed))
    with pytest.raises(SkinError, match=r"input .*skin\.data: is not what it was"):
        Simulation.resume(run)
    flip(run / "skin.data")
    assert find_resumption(run).restart is None
    assert_same(finish(run), undisturbed)


def damage_in_a_chunk(path: Path) -> None:
    """In the packed positions of a frame, where only their checksum tells."""
    with h5py.File(path) as file:
        chunk = file["particles/trajectory/position/value"].id.get_chunk_info(7)
    content = bytearray(path.read_bytes())
    content[chunk.byte_offset + chunk.size // 2] ^= 16
    path.write_bytes(content)


@pytest.mark.parametrize("damage", [cut, damage_in_a_chunk, lambda path: cut(path, 0)])
@pytest.mark.parametrize("spare", [True, False])
def test_the_trajectory_is_damaged(
    damage: Callable[[Path], None], spare: bool, run: Path, undisturbed: Outcome
) -> None:
    """It is set aside; the run is what it was, and frames are there or plainly not."""
    (run / "skin.h5.next").unlink(missing_ok=True)
    if spare:
        shutil.copy(run / "skin.h5", run / "skin.h5.next")
    damage(run / "skin.h5")
    with Simulation.resume(run) as resumed:
        resumed.run(until=6.0)
    (note,) = resumed.notes
    assert note.startswith(f"trajectory {run / 'skin.h5'}: ")
    assert (run / "skin.h5.damaged").exists()
    begun = 0 if spare else KEPT[-1]
    frames = [frame for frame in undisturbed.frames if begun <= frame.step <= 300]
    found = list(Store(run / "skin.h5"))
    assert len(found) == len(frames)
    assert all(map(same, found, frames))


def test_a_start_that_fails_tells_what_was_set_aside(run: Path) -> None:
    (run / "skin.h5.next").unlink(missing_ok=True)
    cut(run / "skin.h5")
    told = r"dump_interval = -1: must be a number >= 0; trajectory .*, now skin\.h5\.damaged; "
    with pytest.raises(SkinError, match=told):
        Simulation.resume(run, variables={"dump_interval": -1})
    assert (run / "skin.h5.damaged").exists()


def test_nothing_damaged_is_overwritten(run: Path) -> None:
    """One after the other: both are there in the end."""
    (run / "skin.h5.next").unlink(missing_ok=True)
    contents = []
    for _ in range(2):
        cut(run / "skin.h5")
        contents.append((run / "skin.h5").read_bytes())
        with Simulation.resume(run) as resumed:
            resumed.run(until=resumed.time + 0.4)
    aside = [run / "skin.h5.damaged", run / "skin.h5.damaged.2"]
    assert [path.read_bytes() for path in aside] == contents


def test_a_damaged_checkpoint_is_kept(run: Path) -> None:
    """Under another name, once the run has gone on from an older one."""
    flip(newest(run))
    content = newest(run).read_bytes()
    with Simulation.resume(run) as resumed:
        assert newest(run).read_bytes() == content
        resumed.run(until=resumed.time + 0.1)
    assert newest(run).with_name("skin.step250.restart.damaged").read_bytes() == content


# ---- what is no damage


def assert_refused(run: Path, reason: str) -> None:
    """In one line, and nothing is changed."""
    before = {path.name: path.stat().st_mtime_ns for path in run.iterdir()}
    with pytest.raises(SkinError, match=reason) as refused:
        Simulation.resume(run)
    assert "\n" not in str(refused.value)
    assert {path.name: path.stat().st_mtime_ns for path in run.iterdir()} == before


def test_a_trajectory_that_is_locked(run: Path) -> None:
    """By a program of the user that has it open to write."""
    holder = "import h5py, sys; file = h5py.File(sys.argv[1], 'a'); print(flush=True); input()"
    command = [sys.executable, "-c", holder, str(run / "skin.h5")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        assert other.stdout and other.stdin
        other.stdout.readline()
        assert_refused(run, r"trajectory .*skin\.h5")
        other.stdin.close()
    Simulation.resume(run).close()


@pytest.mark.parametrize("number", [errno.EIO, errno.EACCES, errno.ESTALE, errno.EMFILE])
@pytest.mark.parametrize("name", ["skin.step250.restart", "events.csv"])
def test_a_checkpoint_that_cannot_be_read_now(
    name: str, number: int, run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No older one is taken for it."""
    usual = Path.open

    def fail(path: Path, *arguments: Any, **more: Any) -> Any:
        if path.name == name:
            raise OSError(number, os.strerror(number), str(path))
        return usual(path, *arguments, **more)

    with monkeypatch.context() as sick:
        sick.setattr(Path, "open", fail)
        assert_refused(run, os.strerror(number))
    assert find_resumption(run).restart == newest(run).name
