"""A run that is stopped and taken up again is the run that was not stopped."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.start.build import build

from tests.cells.conftest import assert_same_events, read_events
from tests.reliability.conftest import (
    RESTART,
    SNAPSHOT,
    STATE,
    STEPS,
    WHOLE_RUN,
    assert_same_state,
    founders,
    run_script,
    snapshot,
    variables,
)

ROUNDING = 1e-12  # of places and times after STEPS steps


@pytest.fixture(scope="module")
def half(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a run that has stopped half way, its state there in end.dump."""
    directory = tmp_path_factory.mktemp("half")
    build(scene, directory, founders(scene))
    run_script(directory, WHOLE_RUN + SNAPSHOT, *variables(end_time=scene.end_time / 2))
    return directory


def log(directory: Path) -> str:
    return (directory / "events.csv").read_text()


def test_the_moment_of_the_restart(half: Path, whole: Path, scene: Scene) -> None:
    """Pairs are mid-division, cells about to divide and about to leave; much follows."""
    columns = dict(zip(STATE.split(), snapshot(half / "end.dump")[:, 5:].T, strict=True))
    cell = snapshot(half / "end.dump")[:, 1] > 1
    now = scene.end_time / 2
    waiting = columns["d_next_division"][cell]
    assert (columns["i_pair"][cell] > 0).sum() >= 10
    assert ((waiting >= 0) & (waiting < now + 1)).sum() >= 2
    assert (columns["d_detached_time"][cell] >= 0).any()
    assert len(read_events(half)) > 30
    kinds = [event.kind for event in read_events(whole) if event.time > now]
    assert min(kinds.count(kind) for kind in ("birth", "death", "division_end")) > 20


def test_restart_on_one_rank_is_the_same_to_the_last_bit(
    half: Path, whole: Path, tmp_path: Path
) -> None:
    """Also where the sorting of atoms leaves each of them: sums keep their order."""
    shutil.copytree(half, tmp_path, dirs_exist_ok=True)
    run_script(tmp_path, WHOLE_RUN + SNAPSHOT, *RESTART)
    assert log(tmp_path) == log(whole)
    assert_same_state(tmp_path, whole, 0.0)


@pytest.mark.parametrize(
    ("arguments", "ranks"),
    [
        pytest.param((), 2, marks=pytest.mark.slow),
        (("-sf", "omp", "-pk", "omp", "2"), 1),
        pytest.param((), 4, marks=pytest.mark.slow),
    ],
    ids=["two-ranks", "two-threads", "four-ranks"],
)
def test_restart_on_other_ranks_and_threads(
    arguments: tuple[str, ...], ranks: int, half: Path, whole: Path, tmp_path: Path
) -> None:
    shutil.copytree(half, tmp_path, dirs_exist_ok=True)
    run_script(tmp_path, WHOLE_RUN + SNAPSHOT, *RESTART, *arguments, ranks=ranks)
    assert_same_events(tmp_path, whole)
    assert_same_state(tmp_path, whole, ROUNDING)


def test_restart_of_two_ranks_on_one(scene: Scene, tmp_path: Path) -> None:
    """From a checkpoint after which the run had gone on: the log is cut back to it."""
    whole, again = tmp_path / "whole", tmp_path / "again"
    build(scene, whole, founders(scene))
    times = variables(checkpoint_interval=3, end_time=6)
    run_script(whole, WHOLE_RUN + SNAPSHOT, *times, ranks=2)
    shutil.copytree(whole, again)
    run_script(again, WHOLE_RUN + SNAPSHOT, *RESTART, *times)
    assert_same_events(again, whole)
    assert_same_state(again, whole, ROUNDING)


def test_many_restarts(half: Path, whole: Path, scene: Scene, tmp_path: Path) -> None:
    """Wherever they fall between the steps that handle events."""
    shutil.copytree(half, tmp_path, dirs_exist_ok=True)
    script = WHOLE_RUN + "write_restart ${dir}/skin.1.restart\n" + SNAPSHOT
    for end in (15.0, 18.024, 21.0, scene.end_time):
        run_script(tmp_path, script, *RESTART, *variables(checkpoint_interval=0, end_time=end))
    assert_same_events(tmp_path, whole)
    assert_same_state(tmp_path, whole, ROUNDING)


def test_data_file(half: Path, whole: Path, scene: Scene, tmp_path: Path) -> None:
    """Through write_data and read_data; the log of the second half is one of its own."""
    build(scene, tmp_path, founders(scene))
    end = variables(end_time=scene.end_time / 2)
    write = "write_data ${dir}/half.data nocoeff\nprint 'next_id $(f_cells[11]:%.0f)'\n"
    said = run_script(tmp_path, WHOLE_RUN + write, *end)
    next_id = int(said.split("next_id")[-1].split()[0])
    (tmp_path / "half.data").rename(tmp_path / "skin.data")
    begin = variables(start_step=STEPS, start_time=scene.end_time / 2, next_id=next_id)
    run_script(tmp_path, WHOLE_RUN + SNAPSHOT, *begin)
    rest = read_events(whole)[len(read_events(half)) :]
    late = read_events(tmp_path)
    assert [(e.kind, e.id, e.parent) for e in late] == [(e.kind, e.id, e.parent) for e in rest]
    assert_same_state(tmp_path, whole, ROUNDING)


@pytest.mark.parametrize(
    "interval", [0.6, *(pytest.param(n, marks=pytest.mark.slow) for n in (0, 5.0))]
)
def test_how_often_checkpoints_are_written_changes_nothing(
    interval: float, whole: Path, scene: Scene, tmp_path: Path
) -> None:
    """Neighbor lists are built there, which changes the order of sums: rounding undoes that."""
    build(scene, tmp_path, founders(scene))
    run_script(tmp_path, WHOLE_RUN + SNAPSHOT, *variables(checkpoint_interval=interval))
    assert log(tmp_path) == log(whole)
    assert_same_state(tmp_path, whole, 1e-13)
