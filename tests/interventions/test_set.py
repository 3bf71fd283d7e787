"""Keys that are set in a run are what a scene with these values would have."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.engine.built import variable
from lammps_skin.kinds import Kind
from lammps_skin.model.changes import changes
from lammps_skin.model.remarks import remarks
from lammps_skin.model.scene import Scene
from lammps_skin.model.stiffness import evaluations, stiffest
from lammps_skin.model.terms import TERMS, Terms
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import lmp

TIME = 3.0
EVERY = {  # a value of each key that can be set
    "dermis.stiffness": 0.06, "dermis.membrane_stiffness": 0.05, "dermis.wall_stiffness": 0.03,
    "membrane.stretch_stiffness": 0.05, "membrane.elasticity": 1.5,
    "membrane.bending_stiffness": 0.7, "membrane.exclusion_stiffness": 0.05,
    "cells.exclusion_stiffness": 0.05, "cells.membrane_exclusion_stiffness": 0.06,
    "cells.cell_adhesion_stiffness": 0.05, "cells.adhesion_stiffness": 20.0,
    "cells.adhesion_range": 1.3, "cells.binding_stiffness": 15.0, "cells.cycle_delay": 1.0,
    "cells.cycle_rate": 2.0, "cells.generations": 3,
    "cells.kinds.nd.adhesion": "adhesive", "cells.kinds.nd.stiffness": 10.0,
    "cells.kinds.nd.range": 1.25, "cells.kinds.nd.detaches": True,
    "cells.kinds.mutant.cycle_delay": 3.0, "cells.kinds.mutant.cycle_rate": 1.5,
    "cells.kinds.ta.generations": 4, "cells.kinds.stem.paired_stiffness": 9.0,
}  # fmt: skip


@pytest.fixture(scope="module")
def changing(scene: Scene) -> Scene:
    """Everything is set at once, and some of it back at the end."""
    return scene.replace(**{
        "end_time": 6.0,
        "cells.kinds.stem": {"paired_with": "ta", "paired_stiffness": 20.0},
        "interventions": [
            {"name": "all", "at": TIME, "set": EVERY},
            {"name": "back", "at": 5.0, "set": {"membrane.bending_stiffness": 0.5}},
        ],
    })  # fmt: skip


@pytest.mark.parametrize("form", ["skin", "analytic", "table"])
def test_all_keys_are_as_in_a_scene_that_has_them(
    changing: Scene, tmp_path: Path, form: str
) -> None:
    """Energies by term and forces are those of the other scene in the same state."""
    numerics = {"numerics.pair_form": form, "numerics.table_points": 2000}
    scene = changing.replace(**numerics, **{"cells.stem": 4})
    with Simulation.begin(scene, tmp_path) as simulation:
        simulation.run(until=4.0)
        found, forces = simulation.energies(), simulation.forces()
    then = scene.replace(**{**EVERY, "interventions": []})
    state = replace(Configuration.from_run(tmp_path, 4.0, then), origin=None)
    with Simulation.begin(then, configuration=state) as other:
        other.run(until=4.0)
        expected, expected_forces = other.energies(), other.forces()
    assert {term for term in TERMS if not found[term]} == {"membrane_exclusion"}
    for term in TERMS:
        assert found[term] == pytest.approx(expected[term], rel=1e-6, abs=1e-9), term
    np.testing.assert_allclose(forces.forces, expected_forces.forces, rtol=1e-6, atol=1e-8)


def test_every_key_is_told(changing: Scene) -> None:
    """One command for each term and kind; what does not change is not mentioned."""
    first, second = changes(changing)
    starts = [command.split(" ")[:2] for command in first.commands]
    assert starts.count(["pair_coeff", "dermal"]) == 2
    assert ["fix", "wall"] in starts and ["bond_coeff", "1"] in starts
    kinds = [command.split()[3] for command in first.commands if command.startswith("fix_modify")]
    assert kinds == [row.label for row in changing.cell_kinds]
    nd = next(command for command in first.commands if " kind nd " in command)
    assert "law adhesive 24.0 1.25" in nd and "detach 1.25" in nd and "cycle" not in nd
    assert second.commands == ("dihedral_coeff 1 0.5 ${bending_form}",)


def test_what_is_derived_is_enough_for_all_of_the_run(changing: Scene, tmp_path: Path) -> None:
    """Ghost particles, timesteps, the longest range: the largest of what is set."""
    plain = changing.replace(**{"interventions": []})
    assert Terms(changing).cutoffs["adhesion"] == 1.3 * plain.contact
    assert Terms(changing).cutoffs["cell_cell_adhesion"] == pytest.approx(1.3 * 2.8)
    far = plain.replace(**{"interventions": [
        {"name": "f", "at": 1.0, "set": {"cells.kinds.ta.range": 2.0}},
    ]})  # fmt: skip
    for scene, name in ((plain, "plain"), (far, "far")):
        build(scene, tmp_path / name)
    reach = [variable(tmp_path / name, "ghost_cutoff") for name in ("plain", "far")]
    assert reach[0] < 4.8 < reach[1]
    stiff = plain.replace(**{"interventions": [
        {"name": "s", "at": 1.0, "set": {"cells.binding_stiffness": 900.0}},
    ]})  # fmt: skip
    assert stiffest(stiff).name == "binding"
    assert evaluations(stiff) > evaluations(plain)
    few = stiff.replace(**{"numerics.stages": 3})
    assert any("numerics.timestep = " in line for line in remarks(few))


def test_a_faster_cycle_has_a_shorter_timestep() -> None:
    """The level of accuracy fits itself to what comes later, too."""
    slow = Scene.load("one-stem")
    fast = slow.replace(**{"interventions": [
        {"name": "f", "at": 5.0, "set": {"cells.cycle_delay": 0.5, "cells.cycle_rate": 2.0}},
    ]})  # fmt: skip
    assert fast.numerics.timestep < slow.numerics.timestep
    assert fast.numerics == fast.later_stages[0].numerics
    rates = {"cells.cycle_delay": 0, "cells.cycle_rate": 2.0}
    assert slow.replace(**rates).numerics.timestep < fast.numerics.timestep


def test_generations_that_are_endless_until_then(scene: Scene, tmp_path: Path) -> None:
    """Cells that had none to count get those of the kind, once: also with a restart after it."""
    keys = {
        "cells.kinds.ta": {"generations": "endless"}, "cells.stem": 4, "end_time": 14.0,
        "interventions": [{"name": "limit", "at": 8.0, "set": {"cells.kinds.ta.generations": 2}}],
    }  # fmt: skip
    limited = scene.replace(**keys)
    with Simulation.begin(limited, tmp_path / "whole") as whole:
        for time, expected in ((8.0, 0), (8.25, 2)):  # no event step is between
            whole.run(until=time)
            cells = whole.cells()
            assert set(cells.divisions_left[cells.types == Kind.TA]) == {expected}
        whole.run()
    with Simulation.begin(limited, tmp_path / "cut") as cut:
        cut.run(until=11.0)
    with Simulation.resume(tmp_path / "cut") as cut:
        cut.run()
    events = [(tmp_path / name / "events.csv").read_text() for name in ("whole", "cut")]
    assert events[0] == events[1]
    assert f",{Kind.EXHAUSTED:d}," in events[0]


@pytest.mark.parametrize(("end", "count"), [(2.0, 0), (3.0, 0), (3.5, 1), (6.0, 2)])
def test_a_run_is_divided_as_far_as_it_goes(
    changing: Scene, tmp_path: Path, end: float, count: int
) -> None:
    """Where plain LAMMPS ends earlier, it changes what was due before."""
    build(changing, tmp_path)
    assert lmp(tmp_path, "-var", "end_time", str(end)).returncode == 0
    told = (tmp_path / "log.lammps").read_text()
    assert len(re.findall(r"\ndihedral_coeff 1 0\.\d cosine\n", told)) == count
    assert math.isclose(float(told.split("Loop time")[-2].split("\n")[-2].split()[1]), end)
