"""Ensembles: what is run, what is not run again, what a failure costs, what is gathered."""

import gzip
import os
import shutil
import signal

import h5py
import numpy as np
import pytest
import scipy.stats
from lammps_skin.analysis.observables import COLUMNS, observables, read_table, write_table
from lammps_skin.errors import SceneError, SkinError
from lammps_skin.run.simulation import Simulation
from lammps_skin.study.cost import estimate
from lammps_skin.study.ensemble import (
    Member,
    expected_seconds,
    gather,
    member_of,
    members,
    over_time,
    window_mean,
    window_means,
)
from lammps_skin.study.runner import _share, run_all, run_share
from lammps_skin.versions import versions

from tests.run.crates import activities, crate


def test_one_command_and_the_same_again(skin, tmp_path, monkeypatch, request):
    """The first time by two workers, as users run it, and then in this process."""
    monkeypatch.setattr("lammps_skin.cli.ensemble.cores", lambda: 2)
    answer = skin("ensemble", "tiny.toml", "--seeds", "1-2", "-o", "many")
    assert answer.code == 0, answer.out
    assert "2 runs, 0 of them there" in answer.out
    assert "2 to do, 2 at a time" in answer.out
    tables = sorted((tmp_path / "many" / "runs").iterdir())
    assert [path.suffix for path in tables] == [".csv", ".csv"]  # and no run directory
    packed = (tmp_path / "many" / "tiny.csv.gz").read_bytes()
    table = read_table(tmp_path / "many" / "tiny.csv.gz")
    assert table.dtype.names == ("seed", *COLUMNS)
    assert np.unique(table["seed"]).tolist() == [1, 2]
    np.testing.assert_allclose(table["time"], np.tile(np.arange(7) * 0.5, 2))
    assert table["ta"].max() > 0

    (told,) = activities(crate(tmp_path / "many"))
    assert told["result"] == {"@id": "tiny.csv.gz"}

    times = [path.stat().st_mtime_ns for path in tables]
    answer = skin("ensemble", "tiny.toml", "--seeds", "1-2", "-o", "many")
    assert answer.code == 0 and "2 runs, 2 of them there" in answer.out
    assert [path.stat().st_mtime_ns for path in tables] == times
    assert (tmp_path / "many" / "tiny.csv.gz").read_bytes() == packed

    request.getfixturevalue("in_this_process")
    tables[0].unlink()  # what is missing is run, and comes out the same
    answer = skin("ensemble", "tiny.toml", "--seeds", "2,1", "-o", "many", "--keep")
    assert "2 runs, 1 of them there" in answer.out
    assert (tmp_path / "many" / "tiny.csv.gz").read_bytes() == packed
    kept = tables[0].with_suffix("")
    np.testing.assert_allclose(observables(kept)["zeta"], read_table(tables[0])["zeta"], rtol=1e-6)

    # another scene of this name has tables of its own
    answer = skin("ensemble", "tiny.toml", "--seeds", "1", "-o", "many", "--set", "end_time=1")
    assert "1 run, 0 of them there" in answer.out
    assert len([path for path in kept.parent.iterdir() if path.suffix == ".csv"]) == 3


def test_what_is_expected_is_that_of_each_run_with_its_start(scene, tmp_path):
    other = scene.replace(name="other", **{"dermis.present": True, "membrane.lattice": [24, 28]})
    both = members([scene, other], [1, 2, 3], tmp_path)
    assert expected_seconds(both) == pytest.approx(sum(member.seconds for member in both))
    assert expected_seconds(both) > 6 * estimate(scene).start


def test_runs_that_begin_elsewhere(scene, tmp_path):
    """They are known by the state, not by its place; those from another state are others."""
    with Simulation.begin(scene, tmp_path / "parent") as simulation:
        simulation.run()
    shutil.copytree(tmp_path / "parent", tmp_path / "copy")
    fork = {"end_time": scene.end_time + 1}
    one, same, other = (
        members([scene.replace(**fork, **{"start.from": str(tmp_path / run), "start.time": time})],
                [1], tmp_path)[0]
        for run, time in (("parent", 1.0), ("copy", 1.0), ("copy", 1.5))
    )  # fmt: skip
    assert one.key == same.key != other.key
    one.run()
    assert read_table(one.table)["time"][0] == 1.0

    heights = []
    for name in ("a.npy", "b.npy", "c.npy"):
        np.save(tmp_path / name, np.full((2, 2), 0.5 if name < "c" else 1.0))
        changes = {"membrane.heights": str(tmp_path / name)}
        heights.append(members([scene.replace(**changes)], [1], tmp_path)[0].key)
    assert heights[0] == heights[1] != heights[2]


def test_a_failure_does_not_lose_the_others(scene, tmp_path):
    bad = scene.replace(
        name="bad", **{"numerics.timestep": 0.5, "numerics.largest_move": 0.0,
                       "membrane.noise": 0.3, "output.dump_interval": 0.5},
    )  # fmt: skip
    both = members([bad, scene], [3], tmp_path)
    seen = []
    failures = run_all(both, progress=lambda member, time: seen.append((member, time)))
    assert list(failures) == [both[0]] and "after t = " in failures[both[0]]
    assert both[1].done and not both[0].done
    assert (both[1], 3.0) in seen
    assert [path.name for path in gather(both)] == ["tiny.csv.gz"]


@pytest.mark.usefixtures("in_this_process")
def test_the_command_reports_failures(skin, tmp_path):
    answer = skin(
        "ensemble", "tiny.toml", "--seeds", 4, "--set", "numerics.timestep=0.5",
        "--set", "numerics.largest_move=0.0", "--set", "membrane.noise=0.3",
    )  # fmt: skip
    assert answer.code == 1
    assert "failed: tiny, seed 4: " in answer.out and "Traceback" not in answer.out + answer.err


def crash(*_):
    os._exit(7)


def test_a_process_that_dies_is_a_failure(scene, tmp_path, monkeypatch):
    monkeypatch.setattr("lammps_skin.study.runner._tell", crash)
    (member,) = members([scene], [1], tmp_path)
    assert run_share([member]) == {member: "its process ended with exit code 7"}


@pytest.mark.parametrize(("processes", "share"), [(1, "6"), (2, "3"), (9, "1")])
def test_runs_share_the_cores(processes, share, monkeypatch):
    monkeypatch.setenv("LAMMPS_SKIN_CORES", "6")
    monkeypatch.setattr("lammps_skin.study.runner.cores", lambda: 6)
    with _share(processes):
        assert os.environ["LAMMPS_SKIN_CORES"] == share
    assert os.environ["LAMMPS_SKIN_CORES"] == "6"


def test_a_killed_run_goes_on(scene, tmp_path):
    """From its checkpoint; the table is that of a run in one go."""
    (whole,) = members([scene], [2], tmp_path / "whole")
    (killed,) = members([scene], [2], tmp_path / "killed")
    killed.directory.parent.mkdir(parents=True)
    child = os.fork()
    if child == 0:
        kept = {"checkpoint_interval": 0.5}
        with Simulation.begin(
            scene.replace(seed=2), killed.directory, variables=kept
        ) as simulation:
            simulation.run(until=1.7)
            os.kill(os.getpid(), signal.SIGKILL)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL
    began = []
    whole.run()
    killed.run(progress=began.append)
    assert 1.5 < began[0] < 1.6
    assert killed.table.read_bytes() == whole.table.read_bytes()
    assert not killed.directory.exists()


def test_a_directory_that_is_in_use_is_left_alone(scene, tmp_path, monkeypatch):
    monkeypatch.setattr("lammps_skin.run.directory_lock.PATIENCE", 0.1)
    (member,) = members([scene], [1], tmp_path)
    with Simulation.begin(member.scene, member.directory) as simulation:
        with pytest.raises(SkinError, match="runs in"):
            member.run()
        simulation.run()


def test_runs_from_elsewhere(skin, scene, tmp_path):
    done, part = tmp_path / "done", tmp_path / "part"
    with Simulation.begin(scene.replace(seed=7), done) as simulation:
        simulation.run()
    with Simulation.begin(scene.replace(seed=8), part) as simulation:
        simulation.run(until=1.0)
    before = {path: path.stat().st_mtime_ns for path in done.iterdir()}
    answer = skin("ensemble", "--from", done, "--from", part, "--from", tmp_path, "-o", "many")
    assert answer.code == 1
    assert f"failed: {part}: run {part}: its trajectory ends at t = 1 of 3" in answer.out
    assert f"failed: {tmp_path}: directory {tmp_path}: holds no trajectory" in answer.out
    table = read_table(tmp_path / "many" / "tiny.csv.gz")
    assert np.unique(table["seed"]).tolist() == [7]
    np.testing.assert_allclose(table["zeta"], observables(done)["zeta"], rtol=1e-6)
    assert {path: path.stat().st_mtime_ns for path in done.iterdir()} == before
    assert member_of(done, tmp_path / "many").done
    # it is the same as a run of the ensemble itself
    assert skin("ensemble", "tiny.toml", "--seeds", 7, "-o", "many").out.startswith("1 run, 1 of")


def test_a_run_whose_versions_nobody_knows(skin, scene, tmp_path):
    """As a file of another program; what it does not name is unknown."""
    with Simulation.begin(scene.replace(seed=7), tmp_path / "done") as simulation:
        simulation.run()
    assert dict(member_of(tmp_path / "done", tmp_path).made_by) == versions()
    shutil.copytree(tmp_path / "done", tmp_path / "other")
    with h5py.File(tmp_path / "other" / "skin.h5", "r+") as file:
        del file["parameters/versions"]
    unknown = dict.fromkeys(versions(), "unknown")
    assert dict(member_of(tmp_path / "other", tmp_path).made_by) == unknown
    assert skin("ensemble", "--from", tmp_path / "other", "-o", "many").code == 0


def test_the_key_is_what_the_seeds_share(scene, tmp_path):
    def key(**changes):
        return Member(scene.replace(**changes), tmp_path).key

    assert key(seed=5) == key(seed=6) == key(description="words")
    assert len({key(), key(end_time=4.0), key(**{"cells.stem": 2}), key(parameters="weak5")}) == 4


def test_versions_are_in_the_key(scene, tmp_path, monkeypatch):
    keys = {Member(scene, tmp_path).key}
    for name in versions():
        other = {**versions(), name: "x"}
        monkeypatch.setattr("lammps_skin.study.runner.versions", lambda other=other: other)
        keys.add(Member(scene, tmp_path).key)
    assert len(keys) == 4


def test_a_seed_of_the_cells_is_the_seed(scene, tmp_path):
    """Those of the cells differ; the seed of all else belongs to the scene."""
    own = [Member(scene.replace(**{"cells.seed": n}), tmp_path) for n in (3, 4)]
    assert [member.seed for member in own] == [3, 4]
    assert own[0].label == "tiny, seed 3" and own[0].key == own[1].key
    assert own[0].key != Member(scene.replace(seed=3), tmp_path).key
    assert own[0].key != Member(scene.replace(seed=5, **{"cells.seed": 3}), tmp_path).key


def with_table(member):
    """A member that has been run, as far as its table tells."""
    columns = [("time", float), ("zeta", float)]
    write_table(np.array([(0.0, member.seed), (1.0, 0.5)], columns), member.table)
    return member


def test_a_gathered_table_gets_more_seeds(scene, tmp_path):
    """Also of runs whose own tables are not there any more, as in a folder that was passed on."""
    first = [with_table(member) for member in members([scene], [1, 2, 3], tmp_path)]
    (gathered,) = gather(first)
    shutil.rmtree(tmp_path / "runs")
    assert gather([with_table(*members([scene], [4], tmp_path))]) == [gathered]
    table = read_table(gathered)
    assert table["seed"].tolist() == [1, 1, 2, 2, 3, 3, 4, 4]
    assert table["zeta"].tolist() == [1, 0.5, 2, 0.5, 3, 0.5, 4, 0.5]


def test_a_gathered_table_of_another_key_is_kept(scene, tmp_path):
    """The first one has the name, however they take turns: who reads it gets no other scene."""
    other = scene.replace(end_time=2.0)
    plain = tmp_path / "tiny.csv.gz"
    keyed = tmp_path / f"tiny-{Member(other, tmp_path).key}.csv.gz"
    for turn in range(2):
        for one, seeds, path in ((scene, [1, 2], plain), (other, [5 + turn], keyed)):
            named = gather([with_table(member) for member in members([one], seeds, tmp_path)])
            assert named == [path]
    assert np.unique(read_table(plain)["seed"]).tolist() == [1, 2]
    assert np.unique(read_table(keyed)["seed"]).tolist() == [5, 6]
    assert set(tmp_path.glob("*.gz")) == {plain, keyed}
    plain.write_bytes(b"notes")
    ours = tmp_path / f"tiny-{Member(scene, tmp_path).key}.csv.gz"
    assert gather(members([scene], [1], tmp_path)) == [ours]
    assert plain.read_bytes() == b"notes"
    plain.unlink()
    assert gather(members([other], [7], tmp_path)) == [plain]
    assert np.unique(read_table(plain)["seed"]).tolist() == [5, 6]
    assert set(tmp_path.glob("*.gz")) == {plain, ours}


def test_a_run_that_cannot_be_resumed_is_kept(scene, tmp_path):
    (member,) = members([scene], [1], tmp_path)
    with Simulation.begin(
        member.scene, member.directory, variables={"checkpoint_interval": 0.5}
    ) as simulation:
        simulation.run(until=1.0)
    for path in member.directory.glob("skin.step*.restart"):
        path.write_bytes(path.read_bytes().replace(b"22 Jul 2025", b"22 Jul 2019"))
    (member.directory / "checkpoints.json").unlink()
    before = {path.name: path.read_bytes() for path in member.directory.iterdir()}
    with pytest.raises(SkinError, match=r"by LAMMPS 22 Jul 2019.*; the run is kept: move .* away"):
        member.run()
    assert {path.name: path.read_bytes() for path in member.directory.iterdir()} == before


def test_the_version_of_the_observables_is_in_the_key(scene, tmp_path, monkeypatch):
    member = Member(scene, tmp_path)
    before = member.key
    monkeypatch.setattr("lammps_skin.analysis.observables.VERSION", 1000)
    assert member.key != before


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"cells.seed": 3}, "cells.seed = 3: must not be given"),
        ({"output.dump_interval": 0.0}, "output.dump_interval = 0: an ensemble needs"),
    ],
)
def test_scenes_that_make_no_ensemble(scene, tmp_path, change, words):
    with pytest.raises(SceneError, match=words):
        members([scene.replace(**change)], [1, 2], tmp_path)


def test_two_scenes_of_one_name(scene, tmp_path):
    with pytest.raises(SceneError, match="two scenes of an ensemble have this name"):
        members([scene, scene.replace(end_time=2.0)], [1], tmp_path)


@pytest.mark.parametrize("seeds", ["", "0", "3-1", "1-", "-2", "a", "1;2", "1-99999999"])
def test_seeds_that_are_none(skin, seeds):
    answer = skin("ensemble", "tiny.toml", f"--seeds={seeds}")
    assert answer.code == 2 and answer.err.startswith(f"error: --seeds {seeds}")


def test_nothing_to_do(skin):
    assert skin("ensemble").err.startswith("error: scene: give at least one")


def test_statistics_over_seeds():
    seeds, times = np.repeat([1.0, 2.0, 5.0], 4), np.tile([0.0, 10.0, 20.0, 30.0], 3)
    values = np.array([0, 1, 3, 9, 0, 5, np.nan, 9, 0, 6, 8, 9.0])
    table = np.rec.fromarrays([seeds, times, values], names="seed,time,chi_H")
    assert window_means(table, "chi_H", 10, 20).tolist() == [2, 5, 7]
    found = window_mean(table, "chi_H", 10, 20)
    error = np.std([2, 5, 7], ddof=1) / np.sqrt(3)
    assert found.n == 3 and found[:2] == pytest.approx((14 / 3, error))
    assert found[2:4] == pytest.approx(scipy.stats.t(2, 14 / 3, error).interval(0.95))
    assert np.isnan(window_means(table, "chi_H", 40, 50)).all()
    at, means = over_time(table, "chi_H")
    assert at.tolist() == [0, 10, 20, 30]
    assert [mean.value for mean in means] == [0, 4, 5.5, 9] and means[2].n == 2


def test_a_table_that_is_none(tmp_path):
    path = tmp_path / "some.csv.gz"
    for content in (b"words", gzip.compress(b"words\nmore\n"), gzip.compress(b"a,b\n1,2\n")[:-9]):
        path.write_bytes(content)
        with pytest.raises(SkinError, match=r"table .*some.csv.gz"):
            read_table(path)
