"""A kind of cells that only a scene file tells of is in all that a run leaves and in every view."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np
import pytest
from lammps_skin.analysis.lineage import read_events
from lammps_skin.cli import main
from lammps_skin.figures.moments import read_moments
from lammps_skin.figures.snapshot import kinds_of, legend
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.build import build
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.store import Store
from lammps_skin.trajectory.universe import open_trajectory
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tests.cells.conftest import lmp

SCENE = """
name = "own"
end_time = 8.0
dermis.present = false
membrane.lattice = [24, 28]

[cells]
stem = 1
cycle_delay = 1.0
cycle_rate = 1.0
first_phase = 1.0
division_rate = 5.0

[cells.kinds.mutant]
like = "stem"
count = 1
stiffness = 50.0
daughter = "ta2"
color = "#ff0080"

[cells.kinds.ta2]
like = "ta"
generations = 2

[output]
dump_interval = 2.0
checkpoint_interval = 4.0
"""
MUTANT, TA2 = 7, 8


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scene") / "own.toml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def run(scene: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a run by the command."""
    directory = tmp_path_factory.mktemp("own") / "run"
    with pytest.raises(SystemExit) as end:
        main(["run", str(scene), "-o", str(directory)])
    assert end.value.code == 0
    return directory


def test_the_command_counts_it(skin, scene, run):
    answer = skin("check", scene)
    assert "mutant particles" in answer.out and "bound, K = 50" in " ".join(answer.out.split())
    answer = skin("run", scene, "--until", "0.5", "--set", "cells.kinds.mutant.count=2")
    assert "1 stem, 2 mutant" in answer.out
    answer = skin("build", scene, "-o", "built")
    assert "1 stem, 1 mutant" in answer.out


def test_the_event_log_has_its_number(run):
    events = read_events(run / "events.csv")
    births = events.of("birth")
    assert set(births.type.tolist()) >= {4, TA2}
    mutant = open_trajectory(run).select_atoms("type mutant").ids[0]
    assert set(births.type[births.parent == mutant].tolist()) == {TA2}
    assert set(births.divisions_left[births.parent == mutant].tolist()) == {2}


def test_the_trajectory_has_its_number_and_name(run):
    with h5py.File(run / "skin.h5") as file:
        numbers = dict(file["parameters/species"].attrs)
    assert (numbers["mutant"], numbers["ta2"], numbers["nd"]) == (MUTANT, TA2, 6)
    universe = open_trajectory(run)
    for frame, _ in zip(Store(run / "skin.h5"), universe.trajectory, strict=True):
        for label, number in (("mutant", MUTANT), ("ta2", TA2)):
            found = universe.select_atoms(f"type {label}")
            assert found.ids.tolist() == frame.ids[frame.kinds == number].tolist()
            assert universe.select_atoms(f"name {label}") == found
            assert universe.select_atoms(f"type {number} and alive 1") == found
            assert set(found.radii) <= {1.4}


def test_tables_have_its_columns(skin, run):
    told = json.loads(skin("stats", run, "--json").out)
    table = told["observables"]
    frames = list(Store(run / "skin.h5"))
    for label, number in (("mutant", MUTANT), ("ta2", TA2)):
        assert table[label] == [(frame.kinds == number).sum() for frame in frames]
    assert {f"{name}_mutant" for name in ("chi_H", "chi_G", "zeta", "sigma")} < set(table)
    assert {"mutant_on_tips", "ta2_tips_p"} < set(table)
    last = frames[-1]
    heights = last.positions[last.kinds > 2, 2]
    zeta = (last.positions[last.kinds == MUTANT, 2].mean() - heights.mean()) / 1.4
    assert table["zeta_mutant"][-1] == pytest.approx(zeta)
    assert {clone["kind"] for clone in told["events"]["clones"]} == {"stem", "mutant"}
    assert " mutant " in skin("stats", run).out


def test_pictures_have_its_colour_and_name(skin, run):
    (moment,) = read_moments(run, [None])
    figure = Figure()
    legend(figure, moment, kinds_of(moment.scene, ["mutant", "ta"]))
    (box,) = figure.legends
    shown = {
        text.get_text(): to_hex(patch.get_facecolor())
        for text, patch in zip(box.get_texts(), box.get_patches(), strict=True)
    }
    assert shown["mutant"] == "#ff0080" and "ta2" not in shown
    assert skin("snapshot", run, "--show", "mutant", "-o", "mutant.png").code == 0
    assert Path("mutant.png").stat().st_size > 0
    answer = skin("snapshot", run, "--show", "mutnt")
    assert answer.code == 2 and "did you mean mutant?" in answer.err


def test_exports_have_its_number(skin, run):
    assert skin("export", run, "--to", "dump", "-o", "own.dump").code == 0
    kinds = Store(run / "skin.h5").scene.kinds
    assert {MUTANT, TA2} <= {kind for frame in Dump("own.dump", kinds) for kind in frame.kinds}
    assert skin("export", run, "--to", "vtk", "-o", "vtk").code == 0
    assert len(list(Path("vtk").glob("cells.*.vtp"))) == len(Store(run / "skin.h5"))


def test_single_points_read_it_by_name(skin, text_file):
    """A bound cell of a further kind has the energy and force of a stem cell with its stiffness."""
    kinds = ("--set", "cells.kinds.mutant.like='stem'")
    stiff = ("--set", "cells.binding_stiffness=50")
    Path("stem.txt").write_text("\n".join(text_file))
    Path("own.txt").write_text("\n".join(text_file).replace("\nS ", "\nmutant "))
    answer = skin("evaluate", "own.txt", *kinds, "--set", "cells.kinds.mutant.stiffness=50")
    assert answer.code == 0, answer.err
    assert answer.out.replace(" mutant ", " S ") == skin("evaluate", "stem.txt", *stiff).out
    answer = skin("evaluate", "own.txt")
    assert answer.code == 2 and "line 170" in answer.err


def test_lineage_is_that_of_two_ranks_of_a_resumed_run_and_of_lmp(scene, run, tmp_path):
    expected = (run / "events.csv").read_bytes()
    with Simulation.begin(scene, tmp_path / "two", ranks=2) as simulation:
        simulation.run(until=5.0)
    with Simulation.resume(tmp_path / "two", ranks=2) as simulation:
        assert simulation.time == 5.0
        simulation.run()
    assert (tmp_path / "two" / "events.csv").read_bytes() == expected
    build(Store(run / "skin.h5").scene, tmp_path / "plain")
    lmp(tmp_path / "plain")
    assert (tmp_path / "plain" / "events.csv").read_bytes() == expected
    np.testing.assert_array_equal(
        Dump(tmp_path / "plain" / "skin.dump")[-1].kinds, Store(run / "skin.h5")[-1].kinds
    )
