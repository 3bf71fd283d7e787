"""A run that Python drives writes skin.h5 itself, and is the same run as without that."""

from __future__ import annotations

import errno
import os
import shutil
from contextlib import ExitStack
from pathlib import Path

import h5py
import numpy as np
import pytest
from lammps_skin.engine.engine import Cells, Forces
from lammps_skin.errors import SkinError
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.run.simulation import Simulation
from lammps_skin.trajectory.frame import CELL_STATE
from lammps_skin.trajectory.recorder import Recorder
from lammps_skin.trajectory.store import Store

from tests.trajectory.conftest import (
    FRAMES,
    INTERVAL,
    Replay,
    equal,
    high_cells,
    replay,
    same,
)

IO = Path("/proc/self/io")


# ---- what is in the file


def test_every_frame_is_that_of_the_dump_and_of_lammps(run):
    """Also where births and removals cancel between frames, see test_dump."""
    store = Store(run.driven / "skin.h5")
    assert len(store) == FRAMES
    for n, frame in enumerate(store):
        assert same(frame, run.frames[n])
        np.testing.assert_array_equal(frame.ids, run.particles[n].ids)
        np.testing.assert_array_equal(frame.kinds, run.particles[n].types)
        np.testing.assert_array_equal(frame.positions, run.particles[n].positions)
        cells = is_cell(frame.kinds)
        for name in CELL_STATE:
            np.testing.assert_array_equal(frame.state[name][cells], getattr(run.cells[n], name))


def test_the_file_is_the_converted_one(run):
    def contents(path: Path) -> dict[str, object]:
        found: dict[str, object] = {}

        def note(name: str, item: object) -> None:
            found.update({f"{name}@{key}": value for key, value in item.attrs.items()})
            if isinstance(item, h5py.Dataset):
                found[name] = item[:]

        with h5py.File(path) as file:
            file.visititems(note)
        return found

    driven, converted = (contents(d / "skin.h5") for d in (run.driven, run.directory))
    assert driven.keys() == converted.keys()
    for name, value in driven.items():
        if not name.endswith("@particles_group"):
            np.testing.assert_array_equal(value, converted[name], err_msg=name)
    assert not [path for path in run.driven.iterdir() if path.name.startswith("skin.h5.")]
    assert not (run.driven / "skin.dump").exists()


def test_what_is_given_to_lammps_is_in_the_file(run, tmp_path):
    given = {"seed": 77, "dump_interval": 0.25}
    with Simulation.begin(
        run.scene, tmp_path, high_cells(run.scene), variables=given
    ) as simulation:
        simulation.run(until=0.6)
    assert Store(tmp_path / "skin.h5").steps.tolist() == [0, 25, 50]
    with h5py.File(tmp_path / "skin.h5") as file:
        assert file["parameters"].attrs["seed"] == 77
        assert dict(file["parameters/variables"].attrs) == {"seed": "77", "dump_interval": "0.25"}


@pytest.mark.parametrize("ranks", [1, 2])
def test_the_box_is_that_of_the_run(run, tmp_path, ranks):
    """That of the scene but for the digits that were given, until a command changes it."""
    configuration = high_cells(run.scene)
    configuration.box = configuration.box + np.array([-2e-4, 3e-4, 5e-4])
    x, y, z = configuration.box.tolist()
    with Simulation.begin(run.scene, tmp_path, configuration, ranks=ranks) as simulation:
        simulation.run(until=0.5)
        (tmp_path / "skin.data").unlink()  # nobody needs it any more
        simulation.command("change_box all z final 0 60")
        simulation.run(until=1.0)
        simulation.command("change_box all z final -1 60")
        with pytest.raises(SkinError, match="the box does not begin at the origin, or is tilted"):
            simulation.run(until=1.5)
    boxes = [frame.edges.tolist() for frame in Store(tmp_path / "skin.h5")]
    assert boxes == [[x, y, z], [x, y, z], [x, y, 60.0]]


def history(path: Path) -> list[tuple[int, float, str]]:
    with h5py.File(path) as file:
        told = file["parameters/history"][:]
    return [(int(step), float(time), text.decode()) for step, time, text in told]


def test_what_is_changed_on_the_way_is_in_the_file(run, built):
    """Variables of a resumed run, and commands, also after the last frame; not those undone."""
    with Simulation.begin_built(built, variables={"checkpoint_interval": 0.5}) as simulation:
        simulation.run(until=0.5)
        simulation.command("group some id 1:10")
        simulation.run(until=1.0)
        simulation.command("group others id 11:20")
    told = [(50, 0.5, "group some id 1:10"), (100, 1.0, "group others id 11:20")]
    assert history(built / "skin.h5") == told
    (built / "skin.step100.restart").unlink()
    with Simulation.resume(built, variables={"timestep": 0.005}) as simulation:
        simulation.run(until=1.0)
    restart = "skin.step50.restart"
    resumed = (50, 0.5, f"resumed with timestep = 0.005, restart = {restart}")
    assert history(built / "skin.h5") == [told[0], resumed]
    with h5py.File(built / "skin.h5") as file:
        assert dict(file["parameters/variables"].attrs) == {
            "checkpoint_interval": "0.5", "timestep": "0.005", "restart": restart,
        }  # fmt: skip


# ---- the run


@pytest.mark.parametrize("refused", [errno.EPERM, errno.EOPNOTSUPP, errno.EMLINK])
def test_without_hard_links_files_are_copied(run, tmp_path, monkeypatch, refused):
    def link(*_):
        raise OSError(refused, os.strerror(refused))

    monkeypatch.setattr(os, "link", link)
    with Simulation.begin(run.scene, tmp_path, high_cells(run.scene)) as simulation:
        simulation.run(until=2.0)
    assert equal(Store(tmp_path / "skin.h5"), run.frames[:5])
    assert not list(tmp_path.glob("skin.h5.*"))


def test_frames_do_not_change_under_a_reader_where_nothing_is_locked(run, built, monkeypatch):
    """HDF5 could not tell that somebody has the file open; what he has open stays as it is."""
    usual = h5py.File

    def unlocked(*arguments, locking=True, **more):
        if locking:
            raise OSError(errno.ENOLCK, "No locks available")
        return usual(*arguments, locking=False, **more)

    monkeypatch.setattr(h5py, "File", unlocked)
    recorder, opened, before = Recorder(built, run.scene, {}), [], []
    with ExitStack() as readers:
        for _ in zip(range(4), replay(run, recorder), strict=False):
            opened.append(readers.enter_context((built / "skin.h5").open("rb")))
            contents = [os.pread(file.fileno(), 10**8, 0) for file in opened]
            assert contents[:-1] == before
            before = contents
    monkeypatch.undo()
    assert equal(Store(built / "skin.h5"), run.frames[:4])


@pytest.mark.parametrize(
    ("ranks", "every", "end"), [(1, None, 4.0), (1, 0.07, 4.0), (2, 0.31, 1.5)]
)
def test_recording_changes_nothing(run, tmp_path, ranks, every, end):
    """Frames are at their times whatever the pieces, and the run is the same to the last bit."""
    watch = {} if every is None else {"progress": lambda *_: None, "every": every}
    ends = []
    for name, interval in (("with", INTERVAL), ("without", 0.0)):
        scene = run.scene.replace(**{"output.dump_interval": interval})
        configuration = high_cells(run.scene)
        with Simulation.begin(scene, tmp_path / name, configuration, ranks) as simulation:
            for until in (0.005, 1.33, end):
                simulation.run(until, **(watch if interval else {}))
            ends.append(simulation.forces())
    for with_frames, without in zip(*ends, strict=True):
        np.testing.assert_array_equal(with_frames, without)
    logs = [(tmp_path / name / "events.csv").read_bytes() for name in ("with", "without")]
    assert logs[0] == logs[1] and logs[0].count(b"birth") > end
    assert not (tmp_path / "without" / "skin.h5").exists()
    store = Store(tmp_path / "with" / "skin.h5")
    assert store.steps.tolist() == list(range(0, int(100 * end) + 1, 50))
    if ranks == 1:
        assert all(map(same, store, run.frames))


def test_a_new_run_replaces_the_results_of_another(run, built):
    for name in ("skin.h5", "skin.dump", "skin.h5.next"):
        shutil.copy(run.directory / "skin.dump", built / name)
    with Simulation.begin(run.scene, built, high_cells(run.scene), replace=True) as simulation:
        simulation.run(until=0.5)
    assert Store(built / "skin.h5").steps.tolist() == [0, 50]
    assert {path.name for path in built.glob("skin.*")} == {"skin.h5", "skin.data", "skin.in"}


def test_no_frame_goes_back(run, built):
    recorder = Recorder(built, run.scene, {})
    assert list(zip(range(4), replay(run, recorder), strict=False))
    with pytest.raises(SkinError, match="of step 0 cannot come after that of step 150"):
        next(replay(run, recorder))
    assert equal(Store(built / "skin.h5"), run.frames[:4])


@pytest.mark.parametrize("interval", ["often", -1, "inf"])
def test_an_interval_that_cannot_be_is_refused(run, interval):
    with pytest.raises(SkinError, match=f"variable dump_interval = {interval}: must be a number"):
        Simulation.begin(run.scene, variables={"dump_interval": interval})


# ---- cost


def coming_and_going(frames: int, births: int, membrane: int, living: int):
    """Moments in each of which so many cells are born and so many leave."""
    rng = np.random.default_rng(1)
    for n in range(frames):
        first = membrane + 1 + n * births
        ids = np.concatenate([np.arange(1, membrane + 1), np.arange(first, first + living)])
        types = np.where(ids <= membrane, Kind.MEMBRANE, Kind.TA)
        places = rng.uniform(0, 12, (len(ids), 3))
        state = np.arange(living)
        cells = Cells(ids[membrane:], types[membrane:], places[membrane:], *[state] * 10)
        yield Forces(ids, types, places, places), cells, int(ids[-1]) + 1


@pytest.mark.skipif(not IO.exists(), reason="the system does not count what is read and written")
def test_a_frame_costs_the_same_after_ten_thousand_births(run, built):
    """Bytes and calls to read and write are counted by the system, in all that a frame takes."""
    frames, births = 160, 100
    engine = Replay(coming_and_going(frames, births, membrane=672, living=400))
    recorder, costs = Recorder(built, run.scene, {}), []
    for n in range(frames):
        before = IO.read_text()
        recorder.record(engine)
        pairs = zip(before.split()[1::2], IO.read_text().split()[1::2], strict=True)
        costs.append([int(b) - int(a) for a, b in pairs][:4])
        if n + 1 < frames:
            engine.advance()
    assert Store(built / "skin.h5").slots == 672 + 400 + (frames - 1) * births > 10_000
    middle, late = np.mean(costs[70:100], axis=0), np.mean(costs[-30:], axis=0)
    assert (late < 1.1 * middle).all(), (middle, late)
