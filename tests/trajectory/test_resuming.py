"""Trajectories that go on: frames after a restart file are replaced, no other one is lost."""

from __future__ import annotations

import dataclasses
import os
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from lammps_skin.errors import SkinError
from lammps_skin.run.simulation import Simulation
from lammps_skin.trajectory.convert import convert
from lammps_skin.trajectory.store import Store
from lammps_skin.trajectory.writer import TrajectoryWriter

from tests.cells.conftest import lmp
from tests.trajectory.conftest import (
    FRAMES,
    equal,
)


def newest_restart(directory: Path) -> str:
    return max(directory.glob("skin.*.restart"), key=lambda file: file.stat().st_mtime_ns).name


@pytest.mark.parametrize(
    "ways",
    [("python", "python"), ("python", "lmp"), ("lmp", "python"), ("lmp", "python", "lmp"),
     ("python", "lmp", "python", "lmp")],
    ids="-".join,
)  # fmt: skip
def test_resumed_runs_go_on_in_one_trajectory(run, built, ways):
    """Frames after the restart file's step are replaced, and none is there twice."""
    given = {"checkpoint_interval": 2.0}

    def by(way: str, until: float, **more: object) -> None:
        if way == "python":
            with Simulation.begin_built(built, variables={**given, **more}) as simulation:
                simulation.run(until)
        else:
            values = {**given, **more, "end_time": until}.items()
            ended = lmp(built, *(word for k, v in values for word in ("-var", k, str(v))))
            assert ended.returncode == 0, ended.stdout

    by(ways[0], 2.5)
    for n, way in enumerate(ways[1:]):
        by(way, 4.5 + 2 * n, restart=newest_restart(built))
    if ways[-1] == "lmp":
        convert(built)
    store = Store(built / "skin.h5")
    assert store.steps.tolist() == list(range(0, 200 * len(ways) + 51, 50))
    for frame, truth in zip(store, run.frames, strict=False):
        np.testing.assert_array_equal(frame.ids, truth.ids)
        np.testing.assert_allclose(frame.positions, truth.positions, atol=1e-9)
    assert store.slots == max(int(frame.ids.max()) for frame in run.frames[: len(store)])


def test_a_damaged_file_is_not_overwritten(run, built):
    shutil.copy(run.directory / "skin.dump", built)
    (built / "skin.h5").write_bytes(b"what can perhaps be saved")
    convert(built)
    assert len(Store(built / "skin.h5")) == FRAMES
    assert (built / "skin.h5.damaged").read_bytes() == b"what can perhaps be saved"


def test_dates_of_files_do_not_decide_where_a_trajectory_goes_on(run, built):
    """Python, lmp and Python again; skin.h5 is dated after the dump."""
    given = {"checkpoint_interval": 2.0}
    with Simulation.begin_built(built, variables=given) as simulation:
        simulation.run(4.0)
    restart = newest_restart(built)
    values = {**given, "end_time": 6.5, "restart": restart}.items()
    assert lmp(built, *(word for k, v in values for word in ("-var", k, str(v)))).returncode == 0
    os.utime(built / "skin.h5", (2**32, 2**32))
    restart = max(built.glob("skin.[12].restart"), key=lambda file: file.stat().st_mtime_ns).name
    with Simulation.begin_built(built, variables={**given, "restart": restart}) as simulation:
        simulation.run(7.0)
    assert Store(built / "skin.h5").steps.tolist() == list(range(0, 701, 50))


def test_a_dump_does_not_replace_what_has_gone_on_after_it(run, built):
    shutil.copy(run.directory / "skin.dump", built)
    shutil.copy(run.directory / "skin.h5", built)
    convert(built)  # as far as the dump: it may be made again
    later = dataclasses.replace(run.frames[-1], step=5000, time=50.0)
    with TrajectoryWriter.append(built / "skin.h5") as writer:
        writer.write(later)
    with pytest.raises(SkinError, match=r"skin\.h5: has gone on after .*skin\.dump was written"):
        convert(built)
    assert len(Store(built / "skin.h5")) == FRAMES + 1
    convert(built, built / "other.h5")
    assert len(Store(built / "other.h5")) == FRAMES


def test_frames_are_cut_back(run, tmp_path):
    path = tmp_path / "a.h5"
    with TrajectoryWriter(path, run.scene, *np.empty((2, 0, 2), int)) as writer:
        for frame in run.frames:
            writer.write(frame)
    for until, kept in ((10_000, FRAMES), (849, 17), (400, 9)):
        with TrajectoryWriter.append(path, until) as writer:
            assert writer.frames == kept and writer.last_step == run.frames[kept - 1].step
            assert writer.slots == max(int(frame.ids.max()) for frame in run.frames[:kept])
    with TrajectoryWriter.append(path) as writer:
        with pytest.raises(SkinError, match="of step 400 cannot come after that of step 400"):
            writer.write(run.frames[8])
        for frame in run.frames[9:]:
            writer.write(frame)
    assert equal(Store(path), run.frames)
    with pytest.raises(SkinError, match="is no trajectory in HDF5"):
        h5py.File(tmp_path / "b.h5", "w").close()
        TrajectoryWriter.append(tmp_path / "b.h5")
