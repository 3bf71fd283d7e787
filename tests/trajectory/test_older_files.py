"""Files without the elements that were added later are read; no run can begin with them."""

from __future__ import annotations

import shutil

import h5py
import numpy as np
import pytest
from lammps_skin import Configuration, SceneError, open_trajectory
from lammps_skin.analysis.observables import observables
from lammps_skin.trajectory.check import NEXT_ID
from lammps_skin.trajectory.dump import PARTICLE_COLUMNS, STATE_COLUMNS, Dump
from lammps_skin.trajectory.frame import ABSENT, ADDED
from lammps_skin.trajectory.store import Store
from lammps_skin.trajectory.writer import TrajectoryWriter

WIDTH = len(PARTICLE_COLUMNS) + len(STATE_COLUMNS)


@pytest.fixture
def older_dump(run, tmp_path):
    """A dump of the columns that there were, in a directory that is otherwise the same."""
    for name in ("skin.in", "scene.toml", "scene.in", "skin.data", "events.csv"):
        shutil.copyfile(run.directory / name, tmp_path / name)
    lines = (run.directory / "skin.dump").read_text().splitlines()
    missing = len(ADDED)
    shorter = (
        line.rsplit(" ", missing)[0] if len(line.split()) >= WIDTH else line for line in lines
    )
    (tmp_path / "skin.dump").write_text("\n".join(shorter) + "\n")
    return tmp_path


@pytest.fixture
def older(run, tmp_path):
    path = tmp_path / "skin.h5"
    shutil.copyfile(run.driven / "skin.h5", path)
    with h5py.File(path, "r+") as file:
        for name in (*(f"particles/trajectory/{name}" for name in ADDED), NEXT_ID):
            del file[name]
    return path


def test_what_they_hold_is_read_and_what_they_lack_is_absent(run, older):
    for old, new in zip(Store(older), Store(run.driven / "skin.h5"), strict=True):
        assert np.array_equal(old.positions, new.positions)
        assert np.array_equal(old.state["next_division"], new.state["next_division"], True)
        assert (old.state["divisions_done"] == ABSENT).all()
        assert np.isnan(old.state["pair_start"]).all()
        assert old.next_id == ABSENT
    before = observables(run.driven)
    assert np.array_equal(observables(older)["zeta"], before["zeta"], True)
    assert len(open_trajectory(older).trajectory) == len(before)


def test_dumps_alike(run, older_dump):
    for old, new in zip(Dump(older_dump / "skin.dump"), run.frames, strict=True):
        assert np.array_equal(old.positions, new.positions)
        assert np.array_equal(old.state["pair"], new.state["pair"])
        assert np.isnan(old.state["detached_time"]).all()
    parents = [Dump(place / "skin.dump").parents(5, 0) for place in (older_dump, run.directory)]
    assert np.array_equal(*parents)


def test_they_go_on_with_all_that_is_kept_now(run, older):
    whole = run.frames[-1]
    with TrajectoryWriter.append(older, run.frames[-2].step) as writer:
        writer.write(whole)
    before, last = list(Store(older))[-2:]
    assert before.next_id == ABSENT and (before.state["divisions_done"] == ABSENT).all()
    assert last.next_id == whole.next_id
    for name, column in whole.state.items():
        assert np.array_equal(last.state[name], column, True), name
    assert len(observables(older)) == len(run.frames)


@pytest.mark.parametrize("form", ["older", "older_dump"])
def test_no_run_begins_with_them(form, request):
    with pytest.raises(SceneError, match="is of an older version, which did not keep all of"):
        Configuration.from_run(request.getfixturevalue(form))
