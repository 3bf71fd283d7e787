"""read_dump gives what the simulation said, whatever befell the file."""

import shutil
import tracemalloc
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.errors import SkinError
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.start.build import build
from lammps_skin.trajectory.convert import convert
from lammps_skin.trajectory.dump import Dump, read_dump
from lammps_skin.trajectory.frame import ABSENT, CELL_STATE, Frame

from tests.cells.conftest import lmp
from tests.trajectory.conftest import FRAMES, INTERVAL, Run, same, small_scene

KINDS = (Kind.MEMBRANE, Kind.STEM, Kind.TA, Kind.EXHAUSTED, Kind.ND)


def blocks(run: Run) -> list[bytes]:
    """The text of each frame."""
    first = b"ITEM: TIME\n"
    return [first + rest for rest in (run.directory / "skin.dump").read_bytes().split(first)[1:]]


def frames_of(run: Run, path: Path, *parts: bytes) -> list[Frame]:
    """Frames of a dump made of these parts, beside the event log of the run."""
    shutil.copy(run.directory / "events.csv", path.parent)
    path.write_bytes(b"".join(parts))
    return list(read_dump(path, KINDS))


def moved(block: bytes) -> bytes:
    """A frame in which one number is another: the place along z of the first particle."""
    head, columns, rows = block.partition(b"d_detached_time\n")
    words = rows.split(b" ", 5)
    words[4] = b"22.5"
    return head + columns + b" ".join(words)


def test_frames_are_those_of_the_simulation(run):
    assert len(run.frames) == FRAMES
    for n, (frame, truth) in enumerate(zip(run.frames, run.particles, strict=True)):
        assert frame.step == round(n * INTERVAL / 0.01)
        assert frame.time == pytest.approx(n * INTERVAL, rel=1e-12)
        np.testing.assert_array_equal(frame.edges, run.scene.box_sides)
        np.testing.assert_array_equal(frame.ids, truth.ids)
        np.testing.assert_array_equal(frame.kinds, truth.types)
        np.testing.assert_array_equal(frame.positions, truth.positions)


def test_state_of_cells_is_that_of_the_simulation(run):
    for frame, truth in zip(run.frames, run.cells, strict=True):
        is_cell = frame.kinds != Kind.MEMBRANE
        np.testing.assert_array_equal(frame.ids[is_cell], truth.ids)
        for name in CELL_STATE:
            told = getattr(truth, name)
            np.testing.assert_array_equal(frame.state[name][is_cell], told, err_msg=name)
        assert (frame.state["divisions_left"][~is_cell] == ABSENT).all()
        assert np.isnan(frame.state["birth_time"][~is_cell]).all()


def test_the_run_has_what_is_difficult(run):
    """Births and removals that cancel between frames, and cells that change their kind."""
    ids = [set(cells.ids.tolist()) for cells in run.cells]
    steps = list(pairwise(ids))
    assert any(len(a) == len(b) and a != b for a, b in steps)
    assert any(len(a) > len(b) for a, b in steps) and any(len(a) < len(b) for a, b in steps)
    kinds = [dict(zip(c.ids.tolist(), c.types.tolist(), strict=True)) for c in run.cells]
    assert any(a[k] != b[k] for a, b in pairwise(kinds) for k in a.keys() & b)


@pytest.mark.parametrize("cut", [1, 2, 40, 5000, -5, -90, -300])
def test_a_truncated_last_frame_is_left_out(run, tmp_path, cut):
    """Cut off so many bytes, or all but so many of its frame."""
    *whole, last = blocks(run)
    found = frames_of(run, tmp_path / "skin.dump", *whole, last[:-cut])
    assert [frame.step for frame in found] == [frame.step for frame in run.frames[:-1]]
    assert all(map(same, found, run.frames[:-1]))


def test_of_frames_of_one_step_the_later_counts(run, tmp_path):
    """A run resumed twice; the second time from further back."""
    text = blocks(run)
    again = [moved(block) for block in text]
    found = frames_of(run, tmp_path / "skin.dump", *text[:9], *again[6:8], *text[5:7], *again[7:12])
    assert [frame.step for frame in found] == [frame.step for frame in run.frames[:12]]
    assert [frame.positions[0, 2] == 22.5 for frame in found] == [False] * 7 + [True] * 5
    assert all(map(same, found[:7], run.frames[:7]))


def test_frames_after_the_point_of_resumption_are_gone(run, tmp_path):
    """Even those that the resumed run has not come to, or writes at other steps."""
    text = blocks(run)
    found = frames_of(run, tmp_path / "skin.dump", *text[:9], text[5])
    assert [frame.step for frame in found] == [frame.step for frame in run.frames[:6]]


@pytest.mark.parametrize("left", [3, 11, 14, 100, 5000, -1, -20])
def test_a_frame_cut_off_before_the_run_was_resumed(run, tmp_path, left):
    text = blocks(run)
    found = frames_of(run, tmp_path / "skin.dump", *text[:6], text[6][:left], *text[5:8])
    assert len(found) == 8
    assert all(map(same, found, run.frames[:8]))


def test_a_really_resumed_run(tmp_path):
    scene = small_scene().replace(**{"output.checkpoint_interval": 2.0})
    ended = [run_lmp(scene, tmp_path / "twice", "-var", "end_time", "3.5")]
    directory = tmp_path / "twice"
    restart = min(directory.glob("skin.*.restart"), key=lambda file: file.stat().st_mtime_ns).name
    ended.append(lmp(directory, "-var", "restart", restart, "-var", "end_time", "5"))
    ended.append(run_lmp(scene, tmp_path / "once", "-var", "end_time", "5"))
    assert all(one.returncode == 0 for one in ended), ended
    found = list(read_dump(directory / "skin.dump"))
    assert [frame.step for frame in found] == list(range(0, 501, 50))
    assert (directory / "skin.dump").read_text().count("ITEM: TIMESTEP") == len(found) + 3
    for frame, other in zip(found, read_dump(tmp_path / "once" / "skin.dump"), strict=True):
        np.testing.assert_array_equal(frame.ids, other.ids)
        np.testing.assert_allclose(frame.positions, other.positions, atol=1e-9)
    assert convert(directory)[1:] == (len(found), max(int(f.ids.max()) for f in found))


def run_lmp(scene, directory, *arguments):
    build(scene, directory)
    return lmp(directory, *arguments)


def test_a_scene_without_cells(tmp_path):
    changes = {"output.dump_interval": 0.1, "membrane.lattice": [12, 14]}
    run_lmp(Scene.load("bare-membrane").replace(**changes), tmp_path, "-var", "end_time", "0.2")
    found = list(read_dump(tmp_path / "skin.dump"))
    assert len(found) == 3
    assert (found[2].kinds == Kind.MEMBRANE).all() and found[2].positions.shape == (168, 3)
    assert (found[2].state["partner"] == ABSENT).all()


def test_frames_in_any_order(run):
    dump = Dump(run.directory / "skin.dump")
    assert dump.steps == [frame.step for frame in run.frames]
    assert dump.slots == max(int(frame.ids.max()) for frame in run.frames)
    for n in (5, 0, len(dump) - 1, 3):
        assert same(dump[n], run.frames[n])


def test_memory_does_not_grow_with_the_number_of_frames(run, tmp_path):
    text = blocks(run)[0]

    def peak(copies: int) -> int:
        path = tmp_path / "skin.dump"
        with path.open("wb") as file:
            for step in range(copies):
                file.write(text.replace(b"STEP\n0\n", b"STEP\n%d\n" % step))
        tracemalloc.start()
        for frame in read_dump(path, KINDS):
            last = frame.step
        assert last == copies - 1
        used = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return used

    grown = (peak(60) - peak(6)) / 54  # a place and its numbers, not what is in the frame
    assert grown < len(text) / 100


def test_what_cannot_be_read_is_said(run, tmp_path):
    with pytest.raises(SkinError, match="No such file"):
        list(read_dump(tmp_path / "skin.dump", KINDS))
    text = blocks(run)[0]
    for wrong in (text.replace(b" z ", b" w "), text.replace(b"NUMBER", b"NAMES")):
        with pytest.raises(SkinError, match=r"skin\.dump: is not a dump of this scene"):
            frames_of(run, tmp_path / "skin.dump", wrong)
    (tmp_path / "skin.dump").write_bytes(text)
    with pytest.raises(SkinError, match="is not a dump of this scene"):
        list(read_dump(tmp_path / "skin.dump", KINDS[:2]))
    shutil.copy(run.directory / "skin.dump", tmp_path)
    with pytest.raises(SkinError, match="holds no built scene"):
        list(read_dump(tmp_path / "skin.dump"))
