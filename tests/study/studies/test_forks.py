"""Runs of a fork are one run up to its time, and differ afterwards by their treatment alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.errors import SceneError
from lammps_skin.run.simulation import Simulation
from lammps_skin.study.compare.comparison import PAIRED, compare
from lammps_skin.study.compare.conditions import read
from lammps_skin.study.ranges import Window
from lammps_skin.study.studies.runs import Branch, Study
from lammps_skin.study.studies.tables import read_courses, write_tables
from lammps_skin.trajectory.frame import Frame
from lammps_skin.trajectory.store import Store

from tests.study.studies.conftest import made
from tests.trajectory.conftest import same

FORK = 1.5
CONDITIONS = """
[set]
numerics.rounding_interval = 0.5
cells.division_rate = 4.0

[conditions.none]

[conditions.stiff]
membrane.bending_stiffness = 2.0

[conditions.wound]
interventions = [{name = "wound", at = 2.0, remove = "ta"}]
"""


@pytest.fixture(scope="module")
def forked(tmp_path_factory: pytest.TempPathFactory) -> Study:
    """A study with two seeds, three treatments, and all trajectories; it has been run."""
    asked = made(tmp_path_factory.mktemp("forked"), f"fork = {FORK}", CONDITIONS)
    for run in asked.todo():
        run.run(keep=True)
    write_tables(asked)
    return asked


def branches(asked: Study, label: str) -> list[Branch]:
    (point,) = (one for one in asked.points if one.point.label == label)
    return [run for run in point.runs if isinstance(run, Branch)]


def rows(directory: Path) -> list[str]:
    return (directory / "events.csv").read_text().splitlines()[1:]


def inside(frame: Frame) -> Frame:
    """The frame with positions within the periodic sides, in units of these, to 12 digits."""
    positions = frame.positions.copy()
    positions[:, :2] = np.round(positions[:, :2] / frame.edges[:2], 12) % 1
    return replace(frame, positions=positions)


def test_the_untreated_branch_is_the_uninterrupted_run(forked: Study, tmp_path: Path) -> None:
    """To the last bit: events, and frames, at whose times positions are rounded.

    A new run may name a particle at the edge of the box on its other side.
    """
    for branch in branches(forked, "none"):
        whole = tmp_path / str(branch.seed)
        with Simulation.begin(branch.scene, whole) as simulation:
            simulation.run()
        frames = list(Store(whole / "skin.h5"))
        for run, times in (
            (branch.trunk, [frame.time for frame in frames if frame.time <= FORK]),
            (branch, [frame.time for frame in frames if frame.time >= FORK]),
        ):
            mine = list(Store(run.directory / "skin.h5"))
            theirs = [frame for frame in frames if frame.time in times]
            assert [frame.time for frame in mine] == times
            assert all(same(inside(a), inside(b)) for a, b in zip(mine, theirs, strict=True))
        assert rows(branch.trunk.directory) + rows(branch.directory) == rows(whole)
        assert len(rows(branch.trunk.directory)) and len(rows(branch.directory))


def test_treatments_begin_with_the_same_state(forked: Study) -> None:
    """And differ afterwards."""
    by_label = [branches(forked, label) for label in ("none", "stiff", "wound")]
    for of_one_seed in zip(*by_label, strict=True):
        assert len({run.trunk.directory for run in of_one_seed}) == 1
        assert len({run.directory for run in of_one_seed}) == 3
        stores = [list(Store(run.directory / "skin.h5")) for run in of_one_seed]
        assert all(frames[0].time == FORK and same(frames[0], stores[0][0]) for frames in stores)
        assert not any(same(frames[-1], stores[0][-1]) for frames in stores[1:])
        assert any("wound" in row for row in rows(of_one_seed[2].directory))
    one, other = (run.trunk for run in by_label[0])
    assert one.key == other.key and one.directory != other.directory
    assert len({run.key for run in by_label[0]}) == 1


def test_the_trunk_is_run_once(forked: Study) -> None:
    for branch in branches(forked, "none"):
        assert [line["event"] for line in branch.trunk.history] == ["begun", "done"]
    assert not forked.todo()


def test_branches_are_compared_seed_by_seed(forked: Study) -> None:
    courses = read_courses(forked.folder)
    assert list(courses) == ["none", "stiff", "wound"]
    assert all(table["time"].min() == FORK for table in courses.values())
    conditions = read([str(forked.folder)])
    assert [one.name for one in conditions] == ["none", "stiff", "wound"]
    found = compare(conditions, ["height_std"], [Window(FORK, FORK), Window(2.0, 3.0)])
    first, later = (
        [row.difference for row in found if row.difference and row.window.end == end]
        for end in (FORK, 3.0)
    )
    assert all(one.value.value == 0 and one.value.error == 0 for one in first)
    assert later[0].test == PAIRED and later[0].value.value != 0


def test_a_branch_runs_its_trunk_first(study: Callable[..., Study]) -> None:
    """Wherever it runs: nobody has to do so before. What stays is enough for a later branch."""
    asked = study(f"fork = {FORK}", "[conditions.none]\n[conditions.other]\nend_time = 2.0")
    first, second = (branches(asked, label)[0] for label in ("none", "other"))
    assert [run.directory for run in asked.todo()][:2] == [
        branch.trunk.directory for branch in branches(asked, "none")
    ]
    second.run()
    assert second.done and second.trunk.done and not first.done
    assert second.trunk not in asked.todo()
    first.run()
    assert [line["event"] for line in first.trunk.history] == ["begun", "done"]
    assert 0 < first.seconds < asked.design.points[0].scene.end_time * 1e3


def test_windows_are_those_after_the_fork(study: Callable[..., Study]) -> None:
    found = study("fork = 1.0").design.windows
    assert np.ravel(found) == pytest.approx([1.6, 2.2, 2.6, 3.0])
    assert study('fork = 1.0\nwindows = "1-2"').design.windows == (Window(1, 2),)


@pytest.mark.parametrize(
    ("begin", "end", "said"),
    [
        ("fork = 0", "", "fork = 0: must be a time greater than 0"),
        ('fork = "late"', "", "fork = 'late': must be a time greater than 0"),
        ("fork = true", "", "fork = True: must be a time"),
        ("fork = 1.7", "", "fork = 1.7: must be a multiple of output.dump_interval = 0.5"),
        ("fork = 3.0", "", "fork = 3: must be before end_time = 3, of tiny"),
        ('fork = 1.0\nwindows = "0-2"', "", "0-2 must not begin before the fork, at 1"),
        (
            "fork = 1.0",
            '[conditions.a]\ninterventions = [{name = "w", at = 1.0, remove = "ta"}]',
            "a: interventions.w.at = 1: must be after the fork, at 1",
        ),
        (
            "fork = 1.0", "[grid]\ncells.stem = [1, 2]",
            "cells.stem: cannot differ from the fork on; it says how a run begins",
        ),
        (
            "fork = 1.0", "[conditions.a]\ncells.kinds.ta.count = 3",
            "cells.kinds.ta.count: cannot differ from the fork on",
        ),
    ],
)  # fmt: skip
def test_bad_forks(study: Callable[..., Study], begin: str, end: str, said: str) -> None:
    with pytest.raises(SceneError) as error:
        study(begin, end)
    assert said in str(error.value)
