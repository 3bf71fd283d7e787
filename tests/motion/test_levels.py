"""What a level of accuracy gives to scenes."""

import math
from typing import Any

import pytest
from lammps_skin.model.accuracy import LEVELS, stability_limit
from lammps_skin.model.parts import Numerics
from lammps_skin.model.scene import Scene


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
        ({"output.checkpoint_interval": 0.0}, 1.0),
        ({"cells.cycle_delay": 0.5, "cells.cycle_rate": 1.0}, 0.1),
        ({"end_time": 1 / 3}, 0.25),  # that nothing fits
        ({"end_time": 1e11}, 1.0),
        ({"numerics.accuracy": "reference", "end_time": 0.3}, 0.01),
        ({"numerics.timestep": 0.07}, 0.07),
    ],
)
def test_timestep_fits_what_the_scene_asks_for(changes: dict[str, Any], timestep: float) -> None:
    assert numerics(**changes).timestep == timestep


@pytest.mark.parametrize("level", ["balanced", "fast"])
@pytest.mark.parametrize("timestep", [1e-3, 0.02, 0.1, 0.25, 0.5, 0.8, 1.0, 3.0])
def test_stages_keep_the_stability_of_the_level(level: str, timestep: float) -> None:
    """Of the largest eigenvalue, with no stage more than that takes."""

    def stiffest(stages: int, step: float) -> float:
        return stability_limit(LEVELS[level]["integrator"], stages) / step

    found = numerics(**{"numerics.accuracy": level, "numerics.timestep": timestep,
                        "output.thermo_interval": 10.0})  # fmt: skip
    wanted = stiffest(LEVELS[level]["stages"], LEVELS[level]["timestep"])
    assert stiffest(found.stages, timestep) >= wanted * (1 - 1e-12)
    assert found.stages == 3 or stiffest(found.stages - 1, timestep) < wanted


def test_stages_that_are_given_stay() -> None:
    assert numerics(**{"numerics.timestep": 0.1, "numerics.stages": 9}).stages == 9


@pytest.mark.parametrize("value", [True, "x", -1.0, math.nan, math.inf, [1], None])
@pytest.mark.parametrize("key", ["end_time", "numerics.timestep", "cells.cycle_rate"])
def test_what_is_no_number_is_refused_as_such(key: str, value: object) -> None:
    with pytest.raises(Exception, match=key):
        numerics(**{key: value})


@pytest.mark.parametrize("integrator", ["euler", "rkl1", "rkl2"])
@pytest.mark.parametrize("level", ["balanced", "fast"])
def test_another_integrator_is_as_stable(level: str, integrator: str) -> None:
    """The largest eigenvalue for which a step of the level itself is stable."""
    own = numerics(**{"numerics.accuracy": level})
    eigenvalue = stability_limit(own.integrator, own.stages) / own.timestep
    other = numerics(**{"numerics.accuracy": level, "numerics.integrator": integrator})
    assert stability_limit(integrator, other.stages) >= eigenvalue * other.timestep
