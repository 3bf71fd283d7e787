"""How a run is divided over ranks and threads does not decide what cells do."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import (
    HEIGHT,
    assert_same_events,
    busy_scene,
    place,
    read_events,
)
from tests.reliability.conftest import (
    SNAPSHOT,
    WHOLE_RUN,
    assert_same_state,
    founders,
    run_script,
    try_script,
)

CROWDED_END = 150.0


def script_with(directory: Path, old: str, new: str) -> str:
    """The built skin.in with one statement replaced, and a snapshot at its end."""
    text = (directory / "skin.in").read_text()
    assert text.count(old) == 1
    return text.replace(old, new) + SNAPSHOT


# ---- cuts through pairs


@pytest.fixture(scope="module")
def edge_scene() -> Scene:
    quiet = {"output.dump_interval": 0.0, "output.checkpoint_interval": 0.0}
    return busy_scene(**quiet, **{"end_time": 0.7, "numerics.event_interval": 0.1})


def on_the_cuts(scene: Scene) -> Configuration:
    """Stem cells on the planes between ranks and on the periodic edges, about to divide."""
    lx, ly, _ = scene.box_sides
    height = HEIGHT + 2.4
    spots = [(lx / 2, ly / 4), (lx / 2, ly / 2), (lx / 4, ly / 2), (0.0, ly / 4), (lx / 4, 0.0),
             (0.0, 0.0), (lx / 2, 0.0), (0.0, ly / 2)]  # fmt: skip
    configuration = place(scene, [(Kind.STEM, (x, y, height), 3) for x, y in spots])
    configuration.next_division[-len(spots) :] = np.linspace(0.1, 0.5, len(spots))
    return configuration


@pytest.fixture(scope="module")
def one_rank(edge_scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("one-rank")
    build(edge_scene, directory, on_the_cuts(edge_scene))
    run_script(directory, WHOLE_RUN + SNAPSHOT)
    assert [event.kind for event in read_events(directory)].count("birth") >= 8
    return directory


@pytest.mark.parametrize(
    ("grid", "ranks"),
    [("2 1 1", 2), ("1 2 1", 2), pytest.param("2 2 1", 4, marks=pytest.mark.slow)],
    ids=["x", "y", "both"],
)
def test_cuts_through_pairs_and_through_the_edge(
    grid: str, ranks: int, edge_scene: Scene, one_rank: Path, tmp_path: Path
) -> None:
    build(edge_scene, tmp_path, on_the_cuts(edge_scene))
    run_script(tmp_path, script_with(tmp_path, "* * 1", grid), ranks=ranks)
    assert_same_events(tmp_path, one_rank)
    assert_same_state(tmp_path, one_rank, 1e-12)


# ---- order of atoms, newton


def test_atoms_sorted_or_not(scene: Scene, whole: Path, tmp_path: Path) -> None:
    build(scene, tmp_path, founders(scene))
    unsorted = "atom_style molecular\natom_modify sort 0 0.0"
    run_script(tmp_path, script_with(tmp_path, "atom_style      molecular", unsorted))
    assert_same_log(tmp_path, whole)


def test_newton_off_is_refused(edge_scene: Scene, tmp_path: Path) -> None:
    build(edge_scene, tmp_path, on_the_cuts(edge_scene))
    script = script_with(tmp_path, "newton          on", "newton off")
    process = try_script(tmp_path, script)
    assert process.returncode != 0
    assert re.search(r"ERROR: (Bond|Pair) style skin/\w+ needs newton on", process.stdout)


# ---- a crowded scene of a quarter of the paper's size


def crowded(scene: Scene) -> Configuration:
    """The scene's start, and TA cells all over it at half the density of a full layer."""
    start = Configuration.from_scene(scene)
    draw = np.random.default_rng(1)
    across = 20
    spots = (np.indices((across, across)).reshape(2, -1).T + 0.5) / across * scene.box_sides[:2]
    stem = start.positions[start.kinds == Kind.STEM][:, :2]
    sides = np.array(scene.box_sides[:2])
    apart = spots[:, None] - stem[None]
    apart -= sides * np.round(apart / sides)
    spots = spots[(np.linalg.norm(apart, axis=2) > 2.0).all(axis=1)]
    new = len(spots)
    height = np.full((new, 1), scene.membrane_height + scene.contact)
    return Configuration(
        box=start.box,
        kinds=np.append(start.kinds, np.full(new, int(Kind.TA))),
        positions=np.concatenate([start.positions, np.hstack([spots, height])]),
        links=start.links,
        hinges=start.hinges,
        divisions_left=np.append(start.divisions_left, draw.integers(1, 9, new)),
    )


def assert_same_log(directory: Path, other: Path) -> None:
    """The same events in the same places, to the last digit."""
    ours, theirs = (path.joinpath("events.csv").read_text() for path in (directory, other))
    assert ours.splitlines() == theirs.splitlines()


def run_crowded(
    directory: Path, level: str, grid: str = "* * 1", sort: str = "20 0.0", ranks: int = 1,
    arguments: tuple[str, ...] = (),
) -> Path:  # fmt: skip
    """The crowded scene with a level of accuracy, atoms sorted every so many steps."""
    scene = Scene.load("quarter-ring").replace(
        end_time=CROWDED_END,
        **{
            "numerics.accuracy": level, "output.dump_interval": 0.0,
            "output.checkpoint_interval": 0.0,
        },
    )  # fmt: skip
    build(scene, directory, crowded(scene))
    script = script_with(directory, "processors      * * 1", f"processors {grid}")
    style = "atom_style      molecular"
    assert script.count(style) == 1
    run_script(
        directory, script.replace(style, f"{style}\natom_modify sort {sort}"), *arguments,
        ranks=ranks,
    )  # fmt: skip
    return directory


@pytest.fixture(scope="module", params=["reference", "balanced", "fast"])
def crowded_run(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[str, Path]:
    """Level of accuracy, and directory of the run on one rank."""
    directory = run_crowded(tmp_path_factory.mktemp(request.param), request.param)
    kinds = [event.kind for event in read_events(directory)]
    assert min(kinds.count(kind) for kind in ("birth", "death", "division_end")) > 300
    return request.param, directory


@pytest.mark.slow
@pytest.mark.parametrize(
    "way",
    [
        {"ranks": 2, "grid": "2 1 1"},
        {"ranks": 2, "grid": "1 2 1"},
        {"ranks": 4, "grid": "2 2 1"},
        {"arguments": ("-sf", "omp", "-pk", "omp", "2")},
        {"sort": "0 0.0"},
    ],
    ids=["ranks-along-x", "ranks-along-y", "four-ranks", "threads", "unsorted"],
)
def test_crowded_quarter_scene(
    way: dict[str, Any], crowded_run: tuple[str, Path], tmp_path: Path
) -> None:
    """The same events with the same ids at the same times, however the run is divided."""
    level, expected = crowded_run
    assert_same_log(run_crowded(tmp_path, level, **way), expected)
