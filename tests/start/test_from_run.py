"""A run that begins with the state of another goes on as that did, until something differs."""

from __future__ import annotations

import os
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.analysis.lineage import founder_of, read_events
from lammps_skin.analysis.summary import summary
from lammps_skin.engine.built import load_built
from lammps_skin.errors import SceneError, SkinError
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration
from lammps_skin.trajectory.clones import clones
from lammps_skin.trajectory.convert import convert
from lammps_skin.trajectory.store import Store

from tests.cells.conftest import lmp
from tests.trajectory.conftest import same

KEYS = {
    "name": "busy",
    "end_time": 24.0,
    "membrane": {"lattice": [24, 28], "height": 8.0},
    "cells": {
        "seed": 2, "stem": 2, "nd": 1, "arrangement": "random", "generations": 2,
        "cycle_delay": 2.0, "cycle_rate": 1.0, "first_phase": 2.0, "division_rate": 1.0,
    },
    "output": {"dump_interval": 2.0, "checkpoint_interval": 4.0},
}  # fmt: skip
FORK = 12.0


@pytest.fixture(scope="module")
def scene() -> Scene:
    """Short cycles on a small membrane, with a dermis: pairs, detached cells, removals."""
    return Scene.from_dict(KEYS)


@pytest.fixture(scope="module")
def parent(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("parent")
    with Simulation.begin(scene, directory) as simulation:
        simulation.run()
    return directory


def begun(scene: Scene, run: Path, time: float | None = FORK, **changes: Any) -> Scene:
    return scene.replace(**{"start.from": str(run), "start.time": time, **changes})


def run_in(directory: Path, scene: Scene, ranks: int = 1) -> Path:
    with Simulation.begin(scene, directory, ranks=ranks) as simulation:
        simulation.run()
    return directory


def rows(directory: Path) -> list[str]:
    return (directory / "events.csv").read_text().splitlines()[1:]


def test_the_state_has_what_is_difficult(parent: Path) -> None:
    """Pairs that divide, removals that wait, cells that have left."""
    state = Configuration.from_run(parent, FORK)
    cells = state.is_cell
    assert state.pair[cells].any() and (state.detached_time[cells] >= 0).any()
    assert state.divisions_done[cells].max() > 1
    assert (np.diff(state.ids) > 1).any() and state.next_id > state.ids.max()


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_fork_goes_on_as_its_parent_did(
    scene: Scene, parent: Path, tmp_path: Path, ranks: int
) -> None:
    fork = run_in(tmp_path, begun(scene, parent), ranks)
    mine, theirs = rows(fork), rows(parent)
    assert len(mine) > 40
    assert mine == theirs[-len(mine) :]
    ours, all_of_them = Store(fork / "skin.h5"), Store(parent / "skin.h5")
    later = [frame for frame in all_of_them if frame.time >= FORK]
    assert all(same(*pair) for pair in zip(ours, later, strict=True))


def test_every_moment_of_plain_lammps_too(scene: Scene, parent: Path, tmp_path: Path) -> None:
    """From its dump, with plain LAMMPS; and the fork of a fork of one moment is the same."""
    build(scene, tmp_path / "lmp")
    assert lmp(tmp_path / "lmp").returncode == 0
    assert rows(tmp_path / "lmp") == rows(parent)
    build(begun(scene, tmp_path / "lmp"), tmp_path / "fork")
    assert lmp(tmp_path / "fork").returncode == 0
    mine = rows(tmp_path / "fork")
    assert mine == rows(parent)[-len(mine) :]
    build(begun(scene, tmp_path / "fork"), tmp_path / "again")
    data = [(tmp_path / name / "skin.data").read_bytes() for name in ("fork", "again")]
    assert data[0] == data[1]
    for time in Store(parent / "skin.h5").times[:-1]:
        one, other = (Configuration.from_run(run, time) for run in (parent, tmp_path / "lmp"))
        assert one.origin.content == other.origin.content
        one.check(scene)


def test_a_difference_shows_when_it_has_a_consequence(
    scene: Scene, parent: Path, tmp_path: Path
) -> None:
    """Another number of generations counts from the first division of a stem cell on."""
    fork = run_in(tmp_path, begun(scene, parent, **{"cells.generations": 7}))
    mine, theirs = rows(fork), [row for row in rows(parent)]
    theirs = theirs[-next(n for n in range(1, len(theirs)) if theirs[-n] == mine[0]) :]
    differs = next(
        n for n, pair in enumerate(zip(mine, theirs, strict=False)) if len(set(pair)) > 1
    )
    _, kind, _, mother, *_ = mine[differs].split(",")
    assert differs > 5 and kind == "birth" and mine[differs].split(",")[8] == "7"
    first = Configuration.from_run(parent, FORK)
    assert first.kinds[first.ids == int(mother)] == Kind.STEM


def test_the_fork_outlives_its_parent(scene: Scene, parent: Path, tmp_path: Path) -> None:
    """Once it is built it needs no file of it, and it tells where it came from."""
    moved = shutil.copytree(parent, tmp_path / "moved")
    with Simulation.begin(begun(scene, moved), tmp_path / "fork") as simulation:
        simulation.run(until=18.0)
    shutil.rmtree(moved)
    with Simulation.resume(tmp_path / "fork") as simulation:
        simulation.run()
    mine = rows(tmp_path / "fork")
    assert mine == rows(parent)[-len(mine) :]
    store = Store(tmp_path / "fork" / "skin.h5")
    origin = Configuration.from_run(parent, FORK).origin
    for told in (load_built(tmp_path / "fork"), store.scene):
        assert told.start.run == str(moved) and told.start.time == told.begins == FORK
        assert told.start.content == origin.content
        assert told.start.versions == origin.versions and "plugin" in origin.versions
    for name in ("scene.in", "log.lammps"):
        assert (
            f"# begins with the state of {moved} at t = {FORK:g}"
            in (tmp_path / "fork" / name).read_text()
        )


def test_cells_of_the_state_are_founders(scene: Scene, parent: Path, tmp_path: Path) -> None:
    fork = run_in(tmp_path, begun(scene, parent))
    store, events = Store(fork / "skin.h5"), read_events(fork / "events.csv")
    first, last = store[0], store[len(store) - 1]
    cells = first.ids[first.state["partner"] >= 0]
    assert (first.state["parent"] > 0).any()
    living = last.ids[last.state["partner"] >= 0]
    assert set(founder_of(living, events)) <= set(cells)
    np.testing.assert_array_equal(clones(store)[living - 1], founder_of(living, events))
    np.testing.assert_array_equal(clones(store)[cells - 1], cells)
    told = summary(fork)["events"]
    assert len(told["clones"]) == len(cells)
    assert sum(clone["size"] for clone in told["clones"]) == len(living) == told["cells"]
    assert sum(clone["births"] for clone in told["clones"]) == told["births"] > 10


def test_a_frame_between_two_of_its_own(scene: Scene, parent: Path, tmp_path: Path) -> None:
    """The first frame is the state at T, the others are at multiples of the interval."""
    changed = begun(scene, parent, **{"output.dump_interval": 8.0})
    driven = run_in(tmp_path / "driven", changed)
    build(changed, tmp_path / "lmp")
    assert lmp(tmp_path / "lmp").returncode == 0
    convert(tmp_path / "lmp")
    for directory in (driven, tmp_path / "lmp"):
        assert Store(directory / "skin.h5").times.tolist() == [FORK, 16.0, 24.0]


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "time": ({"start.time": 13.0}, r"start.time = 13: .* has no frame of .* are at 12 and 14"),
    "late": ({"start.time": 99.0, "end_time": 100.0}, "the nearest is at 24"),
    "run": ({"start.from": "nowhere"}, "start.from = .*nowhere': there is no such run"),
    "end": ({"start.time": None}, "end_time = 24: must be after 24, the time of the state"),
    "lattice": ({"membrane.lattice": [24, 30]}, r"lattice = \[24, 30\]: must be \[24, 28\], that"),
    "height": ({"box_height": 90.0}, "box_height = 90.0: must be 100.0, that of the run"),
    "R_c": ({"cells.radius": 1.3}, "cells.radius = 1.3: must be 1.4, that of the run"),
    "R_d": ({"dermis.radius": 1.3}, "dermis.radius = 1.3: must be 1.4, that of the run"),
    "kinds": ({"cells.nd": 0}, "kind nd, which the state has; give it some with cells.nd"),
    "dermis": ({"dermis.present": False}, "the scene has no particles of kind dermal"),
    "content": ({"start.content": "0" * 16}, "start.content = '0000000000000000': the state of"),
}


@pytest.mark.parametrize(("changes", "refusal"), REFUSED.values(), ids=REFUSED)
def test_what_does_not_fit(
    scene: Scene, parent: Path, changes: dict[str, Any], refusal: str
) -> None:
    with pytest.raises(SkinError, match=refusal) as error:
        Configuration.from_scene(begun(scene, parent, **changes))
    assert "\n" not in str(error.value)


def test_kinds_are_those_of_their_labels(scene: Scene, parent: Path) -> None:
    """Whatever numbers they have in the two scenes."""

    def with_kinds(*names: str) -> Scene:
        return scene.replace(**{"cells.kinds": {n: {"like": "nd", "count": 1} for n in names}})

    origin = Configuration.from_run(parent).origin
    origin = replace(origin, scene=with_kinds("one", "two"))
    kinds = np.array([1, 2, 3, 7, 8, 8])
    found = origin.numbered_in(with_kinds("two", "one"), kinds)
    assert found.tolist() == [1, 2, 3, 8, 7, 7]
    with pytest.raises(SkinError, match=r"give it some with cells\.kinds\.two\.count"):
        origin.numbered_in(with_kinds("one"), kinds)


def test_a_pipe_is_no_run(scene: Scene, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(SceneError, match="there is no such run directory or trajectory"):
        Configuration.from_scene(begun(scene, tmp_path / "pipe"))


def test_keys_that_need_a_run() -> None:
    for key, value in {"time": 3.0, "content": "x", "versions": "x"}.items():
        with pytest.raises(SceneError, match=rf"start\.{key} = .*: needs start\.from"):
            Scene.from_dict({"start": {key: value}})
    with pytest.raises(SceneError, match=r"end_time = 24: must be after start\.time = 30"):
        Scene.from_dict({**KEYS, "start": {"from": "a", "time": 30.0}})


def test_a_run_does_not_begin_in_the_directory_of_its_parent(scene: Scene, parent: Path) -> None:
    for run in (parent, parent / "skin.h5"):
        with pytest.raises(SceneError, match="is that of the run from which the scene begins"):
            build(begun(scene, run), parent)


@pytest.mark.slow
@pytest.mark.parametrize("level", ["balanced", "fast"])
def test_a_quarter_scene(level: str, tmp_path: Path) -> None:
    """Many cells on a membrane over its dermis: forks on one rank and on two, events and frames."""
    changes: dict[str, Any] = {
        "numerics.accuracy": level, "end_time": 100.0, "output.dump_interval": 20.0,
        "cells.cycle_delay": 6.0, "cells.cycle_rate": 0.3, "cells.first_phase": 8.0,
    }  # fmt: skip
    scene = Scene.load("quarter-ring").replace(**changes)
    parent = run_in(tmp_path / "parent", scene)
    assert len(rows(parent)) > 500
    later = [frame for frame in Store(parent / "skin.h5") if frame.time >= 60.0]
    for ranks in (1, 2):
        fork = run_in(tmp_path / f"fork-{ranks}", begun(scene, parent, 60.0), ranks)
        mine = rows(fork)
        assert len(mine) > 200 and mine == rows(parent)[-len(mine) :]
        frames = Store(fork / "skin.h5")
        assert all(same(*pair) for pair in zip(frames, later, strict=True))
