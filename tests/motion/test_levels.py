"""What a level of accuracy gives to scenes."""

import math
from typing import Any

import pytest
from lammps_skin.model.accuracy import LEVELS, stability_limit
from lammps_skin.model.parts import Numerics
from lammps_skin.model.scene import Scene
from lammps_skin.model.stiffness import evaluations, stiffest, warning


def numerics(**changes: Any) -> Numerics:
    return Scene.load("quarter-ring").replace(**changes).numerics


@pytest.mark.parametrize("level", LEVELS)
def test_of_the_paper_are_those_of_the_level(level: str) -> None:
    found = numerics(**{"numerics.accuracy": level}).model_dump()
    assert found | LEVELS[level] == found


@pytest.mark.parametrize(
    ("changes", "timestep"),
    [
        ({"end_time": 0.3}, 0.1),
        ({"output.dump_interval": 0.25}, 0.25),
        ({"output.dump_interval": 0.35}, 0.05),
        ({"output.checkpoint_interval": 0.0}, 0.5),
        ({"cells.cycle_delay": 0.5, "cells.cycle_rate": 1.0}, 0.1),
        ({"end_time": 1 / 3}, 0.25),  # that nothing fits
        ({"end_time": 1e11}, 0.5),
        ({"numerics.accuracy": "reference", "end_time": 0.3}, 0.01),
        ({"numerics.timestep": 0.07}, 0.07),
    ],
)
def test_timestep_fits_what_the_scene_asks_for(changes: dict[str, Any], timestep: float) -> None:
    assert numerics(**changes).timestep == timestep


@pytest.mark.parametrize("level", ["balanced", "fast"])
@pytest.mark.parametrize("integrator", ["rkl1", "rkl2"])
@pytest.mark.parametrize("timestep", [1e-3, 0.1, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("bending", [0.5, 10.0, 1e4])
def test_stages_are_those_that_the_stiffness_needs(
    level: str, integrator: str, timestep: float, bending: float
) -> None:
    """Stable for half more than the largest eigenvalue, with no stage more than that takes."""
    scene = Scene.load("quarter-ring").replace(
        **{"numerics.accuracy": level, "numerics.integrator": integrator,
           "numerics.timestep": timestep, "membrane.bending_stiffness": bending,
           "output.thermo_interval": 10.0}
    )  # fmt: skip
    found, wanted = evaluations(scene), 1.5 * stiffest(scene).eigenvalue * timestep
    assert stability_limit(integrator, found) >= wanted
    assert found == 3 or stability_limit(integrator, found - 1) < wanted


def test_stages_that_are_given_stay() -> None:
    scene = Scene.load("quarter-ring").replace(**{"numerics.stages": 9})
    assert evaluations(scene) == 9


def test_stages_end_at_the_most_that_there_are() -> None:
    """A timestep that is too long for them is told of."""
    times = ("output.thermo_interval", "output.dump_interval", "output.checkpoint_interval")
    long = dict.fromkeys((*times, "numerics.timestep", "end_time"), 1e4)
    scene = Scene.load("quarter-ring").replace(**long)
    assert evaluations(scene) == 99
    assert "rkl1 with 99 stages is stable up to 396" in warning(scene)


@pytest.mark.parametrize("value", [True, "x", -1.0, math.nan, math.inf, [1], None])
@pytest.mark.parametrize("key", ["end_time", "numerics.timestep", "cells.cycle_rate"])
def test_what_is_no_number_is_refused_as_such(key: str, value: object) -> None:
    with pytest.raises(Exception, match=key):
        numerics(**{key: value})


@pytest.mark.parametrize("level", ["balanced", "fast"])
def test_euler_has_the_timestep_of_the_reference(level: str) -> None:
    found = numerics(**{"numerics.accuracy": level, "numerics.integrator": "euler"})
    assert found.timestep == numerics(**{"numerics.accuracy": "reference"}).timestep
