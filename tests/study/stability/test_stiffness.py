"""The longest timestep that can be stable, told before a run, beside the Hessian's eigenvalue."""

import re
from typing import Any

import numpy as np
import pytest
from lammps_skin.errors import SceneError, SimulationError
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.model.scenes import BUILT_IN
from lammps_skin.model.stiffness import longest_timestep, stiffest, warning
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import lattice
from lammps_skin.start.configuration import Configuration
from lammps_skin.study.stability.hessian import largest_eigenvalue

from tests.cells.conftest import CONTACT, HALF_SEPARATION, HEIGHT, place

LEVELS = ["reference", "balanced", "fast"]
SOFT = {"membrane.stretch_stiffness": 0.0, "membrane.bending_stiffness": 0.0,
        "cells.binding_stiffness": 0.0, "cells.adhesion_stiffness": 0.0}  # fmt: skip


def small(**changes: Any) -> Scene:
    scene = {
        "name": "small", "dermis": {"present": False}, "membrane": {"lattice": [12, 14]},
        "cells": {"stem": 1}, "numerics": {"accuracy": "reference"}, "end_time": 0.1,
    }  # fmt: skip
    return Scene.from_dict(scene).replace(**changes)


def eigenvalue(scene: Scene, start: Configuration) -> float:
    with Simulation.begin(scene, configuration=start) as simulation:
        return largest_eigenvalue(simulation, np.ones(len(simulation.forces().ids)))


@pytest.mark.parametrize("kind", [Kind.STEM, Kind.TA])
@pytest.mark.parametrize("scale", ["printed", "direct"])
def test_one_bond(kind: Kind, scale: str) -> None:
    """A cell a little further from the particle below it than it would like."""
    key = "cells.binding_stiffness" if kind == Kind.STEM else "cells.adhesion_stiffness"
    scene = small(**{**SOFT, key: 70.0, "force_scale": scale})
    x, y, z = lattice.positions(scene.membrane.lattice, scene.spacing, HEIGHT)[50]
    found = eigenvalue(scene, place(scene, [(kind, (x, y, z + CONTACT + 1e-3), 3)]))
    assert stiffest(scene).name == ("binding" if kind == Kind.STEM else "adhesion")
    assert stiffest(scene).eigenvalue == pytest.approx(found, rel=0.02)


@pytest.mark.parametrize("spring", ["length", "reduced"])
def test_a_dividing_pair(spring: str) -> None:
    scene = small(**{**SOFT, "cells.division_spring": spring, "cells.division_stiffness": 70.0})
    at = (3.0, 3.0, HEIGHT + 1.1 * CONTACT)
    beside = (3.0 + 2 * HALF_SEPARATION, 3.0, HEIGHT + 1.1 * CONTACT)
    start = place(scene, [(Kind.STEM, at, 0), (Kind.EXHAUSTED, beside, 0)])
    start.pair[-2:] = len(start.pair) - np.array([0, 1])
    start.pair_start[-2:] = 0.0
    assert stiffest(scene).name == "division springs"
    assert stiffest(scene).eigenvalue == pytest.approx(eigenvalue(scene, start), rel=0.02)


def test_links_of_a_flat_membrane() -> None:
    """At rest, where the slope of stretch has a kink: differences of forces see both sides."""
    scene = small(**{"cells.stem": 0, "membrane.bending_stiffness": 0.0})
    found = eigenvalue(scene, Configuration.from_scene(scene))
    assert stiffest(scene).name == "links of the membrane"
    assert stiffest(scene).eigenvalue == pytest.approx(found, rel=0.02)


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("name", BUILT_IN)
def test_no_scene_comes_with_a_warning(name: str, level: str) -> None:
    scene = Scene.load(name).replace(parameters="earlier-stiff", **{"numerics.accuracy": level})
    assert scene.numerics.timestep <= longest_timestep(scene)
    assert warning(scene) == ""


@pytest.mark.parametrize("size", [1e-300, 1e-170, 1e-30, 1e30, 1e170, 1e300])
@pytest.mark.parametrize(
    "key", ["membrane.radius", "cells.radius", "membrane.spacing_ratio", "cells.division_stiffness",
            "membrane.stretch_stiffness", "membrane.elasticity", "cells.binding_stiffness"]
)  # fmt: skip
def test_sizes_beyond_all_measure(key: str, size: float) -> None:
    """A scene may say what is not too large, and cells may not be too small for the membrane."""
    changes = {key: size, "cells.division_spring": "reduced"}
    if size < 1 and key != "cells.radius":
        assert "nan" not in warning(small(**changes))
    else:
        with pytest.raises(SceneError, match=re.escape(f"{key} = {size:g}: must be ")):
            small(**changes)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"numerics.timestep": 0.1}, "timestep = 0.1: euler is stable up to 0.0308 with folds as"),
        ({"numerics.timestep": 0.1, "numerics.largest_move": 0.0}, "likely to end in an error"),
        ({"membrane.bending_stiffness": 1e4}, "up to 0.00308 with folds as"),
        ({"cells.binding_stiffness": 2500.0}, r"up to 0.00096 with binding \(stiffness 2.08e"),
        (
            {"numerics.accuracy": "balanced", "numerics.stages": 3},
            "timestep = 0.5: rkl1 with 3 stages is stable up to 0.185 with folds as runs of",
        ),
        (
            {"numerics.accuracy": "fast", "cells.adhesion_stiffness": 250000.0},
            "with 99 stages is stable .* with adhesion .*; beyond, steps will be divided",
        ),
    ],
)
def test_command_warns(skin, changes: dict[str, Any], told: str) -> None:
    """`skin check` and `skin run` say so, and go on."""
    settings = [f"--set={key}={value}" for key, value in changes.items()]
    level = [] if "numerics.accuracy" in changes else ["--set=numerics.accuracy=reference"]
    level.append("--parameters=earlier-stiff")
    for command in (["check", "two-cells"], ["build", "two-cells", "-o", "here"]):
        answer = skin(*command, *level, *settings)
        assert answer.code == 0, answer.err
        if command[0] == "check":
            assert re.search(told, " ".join(answer.out.split()))
    answer = skin("run", "here", "--until", 1)
    assert re.search(told, " ".join(answer.out.split()))


def test_an_unstable_run_tells_a_timestep_that_may_be_stable() -> None:
    """Not just half of one that was 50 times too long."""
    wild = {"numerics.timestep": 0.5, "numerics.largest_move": 0.0, "membrane.noise": 0.3}
    scene = small(**wild, end_time=5.0, **{"output.thermo_interval": 5.0})
    told = pytest.raises(SimulationError, match=r"timestep = 0\.5; try 0\.08")
    with Simulation.begin(scene) as simulation, told:
        simulation.run()
