"""A run that Python drives writes skin.h5 itself, and is the same run as without that."""

from __future__ import annotations

import dataclasses
import errno
import io
import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from lammps_skin.engine.engine import Cells, Forces
from lammps_skin.errors import SkinError
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.run.simulation import Simulation
from lammps_skin.trajectory import writer as writer_module
from lammps_skin.trajectory.convert import convert
from lammps_skin.trajectory.frame import CELL_STATE
from lammps_skin.trajectory.recorder import Recorder
from lammps_skin.trajectory.store import Store
from lammps_skin.trajectory.universe import open_trajectory
from lammps_skin.trajectory.writer import TrajectoryWriter

from tests.cells.conftest import lmp
from tests.trajectory.conftest import (
    FRAMES,
    INTERVAL,
    Replay,
    equal,
    high_cells,
    replay,
    same,
)

SKIN = [sys.executable, "-c", "from lammps_skin.cli import main; main()"]
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


@pytest.mark.parametrize(("ranks", "every"), [(1, None), (1, 0.07), (2, 0.31)])
def test_recording_changes_nothing(run, tmp_path, ranks, every):
    """Frames are at their times whatever the pieces, and the run is the same to the last bit."""
    watch = {} if every is None else {"progress": lambda *_: None, "every": every}
    ends = []
    for name, interval in (("with", INTERVAL), ("without", 0.0)):
        scene = run.scene.replace(**{"output.dump_interval": interval})
        configuration = high_cells(run.scene)
        with Simulation.begin(scene, tmp_path / name, configuration, ranks) as simulation:
            for until in (0.005, 3.33, 8.0):
                simulation.run(until, **(watch if interval else {}))
            ends.append(simulation.forces())
    for with_frames, without in zip(*ends, strict=True):
        np.testing.assert_array_equal(with_frames, without)
    logs = [(tmp_path / name / "events.csv").read_bytes() for name in ("with", "without")]
    assert logs[0] == logs[1] and logs[0].count(b"birth") > 10
    assert not (tmp_path / "without" / "skin.h5").exists()
    store = Store(tmp_path / "with" / "skin.h5")
    assert store.steps.tolist() == list(range(0, 801, 50))
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


# ---- resuming


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


# ---- mishaps


def moments_of_writing(monkeypatch: pytest.MonkeyPatch, tick) -> None:
    """Call `tick` before and after everything that changes a file, in HDF5 each single write."""

    def around(function):
        def wrapped(*arguments, **more):
            tick()
            result = function(*arguments, **more)
            tick()
            return result

        return wrapped

    class Watched(io.FileIO):
        write = around(io.FileIO.write)

    opened = h5py.File
    modes = {"w": "w+b", "r+": "r+b"}
    watched = lambda path, mode: opened(Watched(path, modes[mode]), mode)  # noqa: E731
    monkeypatch.setattr(
        writer_module, "h5py", SimpleNamespace(File=watched, string_dtype=h5py.string_dtype)
    )
    for module, name in ((os, "link"), (shutil, "copyfile"), (Path, "replace")):
        monkeypatch.setattr(module, name, around(getattr(module, name)))


def test_killed_at_any_moment_the_file_is_complete(run, built, monkeypatch):
    """A process of its own is killed in the middle of what it writes, everywhere."""
    ticks = 0

    def count() -> None:
        nonlocal ticks
        ticks += 1

    with monkeypatch.context() as patch:
        moments_of_writing(patch, count)
        frames = replay(run, Recorder(built, run.scene, {}))
        per_frame = [ticks for _ in zip(range(5), frames, strict=False)]
    assert per_frame[-1] > 200
    for last in np.linspace(per_frame[0] + 1, per_frame[-1], 24).astype(int).tolist():
        written = killed_after(last, run, built, monkeypatch)
        assert written == sum(n < last for n in per_frame)
        store = Store(built / "skin.h5")
        assert len(store) in (written, written + 1)
        assert all(map(same, store, run.frames))


def killed_after(last: int, run, built: Path, monkeypatch) -> int:
    """Record in a child that kills itself at a tick; number of frames that it had finished."""
    receiving, sending = os.pipe()
    child = os.fork()
    if child == 0:
        ticks = 0

        def kill() -> None:
            nonlocal ticks
            ticks += 1
            if ticks == last:
                os.kill(os.getpid(), signal.SIGKILL)

        moments_of_writing(monkeypatch, kill)
        for _ in replay(run, Recorder(built, run.scene, {})):
            os.write(sending, b".")
        os._exit(0)
    os.close(sending)
    with os.fdopen(receiving, "rb") as pipe:
        written = len(pipe.read())
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL
    return written


def test_a_killed_command_leaves_its_frames(tmp_path):
    settings = (
        "membrane.lattice=[12,14]",
        "output.dump_interval=0.01",
        "numerics.accuracy=reference",
    )
    changes = [word for setting in settings for word in ("--set", setting)]
    command = [*SKIN, "run", "two-cells", *changes, "--until", "10000", "-o", str(tmp_path / "x")]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    path, deadline = tmp_path / "x" / "skin.h5", time.monotonic() + 60
    while not (path.exists() and len(Store(path)) > 5) and time.monotonic() < deadline:
        time.sleep(0.02)
    process.kill()
    process.wait()
    store = Store(path)
    assert store.steps.tolist() == list(range(len(store))) and len(store) > 5
    assert len(open_trajectory(path).trajectory) == len(store)
    assert all(np.isfinite(frame.positions).all() and len(frame.ids) == 170 for frame in store)


def test_a_failure_to_write_loses_nothing(run, built, monkeypatch):
    """And the next frame is written as if nothing had been."""
    recorder = Recorder(built, run.scene, {})
    engine = Replay(zip(run.particles, run.cells, run.next_ids, strict=True))
    for n in range(6):
        with monkeypatch.context() as patch:
            if n in (2, 4):
                full = OSError(28, "No space left on device")
                patch.setattr(
                    TrajectoryWriter, "_append", lambda *_, e=full: (_ for _ in ()).throw(e)
                )
                with pytest.raises(SkinError, match=r"skin\.h5: No space left on device"):
                    recorder.record(engine)
                assert len(Store(built / "skin.h5")) == n
        recorder.record(engine)
        engine.advance()
    assert all(map(same, Store(built / "skin.h5"), run.frames))
    assert len(Store(built / "skin.h5")) == 6


def test_who_reads_during_a_run_is_not_disturbed(run, built):
    """What was open stays as it was; what is opened now has all frames."""
    opened = {}
    for n in replay(run, Recorder(built, run.scene, {})):
        if n in (1, 2, 7):
            opened[n] = open_trajectory(built)
        assert len(Store(built / "skin.h5")) == n
    assert equal(Store(built / "skin.h5"), run.frames)
    for n, universe in opened.items():
        assert len(universe.trajectory) == n
        for ts, frame in zip(universe.trajectory, run.frames, strict=False):
            np.testing.assert_array_equal(ts.data["position"][frame.ids - 1], frame.positions)


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
