"""Expected numbers of cells, against what can be counted on paper."""

import numpy as np
import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.study.cost import estimate
from lammps_skin.study.growth import CROWDED, growth

CYCLE = {"cycle_delay": 8.0, "cycle_rate": 0.5}  # ten time units
BASE = {
    "end_time": 40.0,
    "membrane": {"lattice": [64, 74]},
    "cells": {"stem": 1, "kinds": {"stem": CYCLE, "ta": CYCLE}},
}


def expected(first, **changes):
    """At the times 0, 10, ... 40."""
    scene = Scene.from_dict(BASE).replace(**changes)
    found = growth(scene, first, np.linspace(0, 40, 401))
    return found.cells[::100], found.divisions[::100]


def test_lineages_double_in_each_cycle_of_their_kind():
    cells, divisions = expected({"stem": 1})
    assert cells == pytest.approx([1, 2, 4, 8, 16])
    assert divisions == pytest.approx(cells / 10)
    slow = {"cells.kinds.slow": {"like": "ta", "cycle_delay": 18.0}}
    assert expected({"slow": 3}, **slow)[0][[0, 2, 4]] == pytest.approx([3, 6, 12])


def test_newborn_that_do_not_divide_come_one_by_one():
    for change in ({"cells.kinds.stem.daughter": "nd"}, {"cells.generations": 0}):
        assert expected({"stem": 2}, **change)[0] == pytest.approx([2, 4, 6, 8, 10])


@pytest.mark.parametrize("strength", CROWDED)
def test_there_is_no_more_than_there_is_room(strength):
    """Cells that are bound stay; where adhesion is stronger there is room for more."""
    lx, ly, _ = Scene.from_dict(BASE).box_sides
    changed = {"cells.adhesion_stiffness": strength}
    cells, _ = expected({"ta": 100}, **changed)
    assert cells[-1] == pytest.approx(CROWDED[strength] * lx * ly)
    assert expected({"nd": 10_000}, **changed)[0] == pytest.approx(10_000)


def test_adhesive_cells_that_stay_need_no_room():
    """Not even if there is none that detaches."""
    changed = {"cells.kinds.nd": {"adhesion": "adhesive", "detaches": False}}
    assert expected({"nd": 10_000}, **changed)[0] == pytest.approx(10_000)


def test_generations_end():
    """Of one TA cell come 2^M cells that no longer divide; a stem cell goes on."""
    cells, divisions = expected({"ta": 8}, **{"cells.generations": 2})
    assert cells == pytest.approx([8, 16, 32, 32, 32])
    assert divisions == pytest.approx([0.8, 1.6, 0, 0, 0])
    cells, divisions = expected({"stem": 8}, **{"cells.generations": 1})
    assert cells == pytest.approx([8, 16, 32, 48, 64])  # one TA cell in each cycle, soon two
    assert divisions == pytest.approx([0.8, 1.6, 1.6, 1.6, 1.6])


def test_numbers_of_the_default_ensembles():
    """Means of eight seeds of quarter-ring with earlier-stiff, in docs/data/readings."""
    scene = Scene.load("quarter-ring").replace(parameters="earlier-stiff")
    times = np.array([0, 100, 200, 300, 400, 600, 800, 1000])
    fine = np.linspace(0, 1000, 201)
    found = growth(scene, {"stem": 16}, fine)
    cells = np.interp(times, fine, found.cells)
    assert cells == pytest.approx([16, 72, 312, 617, 649, 562, 644, 686], rel=0.2)


def test_what_interventions_do_is_counted():
    half = {"half_space": [1.0, 0.0, 0.0, Scene.from_dict(BASE).box_sides[0] / 2]}
    done = [
        {"name": "sown", "every": 10.0, "until": 20.0, "add": "nd", "places": [[1, 1], [9, 9]]},
        {"name": "wound", "at": 25.0, "remove": "all", "within": half},
        {"name": "turned", "at": 30.0, "convert": "nd", "to": "ta", "fraction": 0.5},
    ]
    cells, divisions = expected({}, **{"cells.stem": 0, "interventions": done})
    assert cells == pytest.approx([0, 2, 4, 2, 3])
    assert divisions == pytest.approx([0, 0, 0, 0.1, 0.2])


def test_cost_is_of_what_is_added_and_of_the_start():
    """An estimate of many short runs is mostly that of their starts."""
    none = Scene.from_dict(BASE).replace(**{"cells.stem": 0})
    sown = none.replace(
        interventions=[{"name": "x", "at": 1.0, "add": "stem", "places": [[1.0, 1.0]]}]
    )
    assert estimate(none).cells == 0 and estimate(sown).cells > 8
    short = estimate(none.replace(end_time=0.5))
    assert short.seconds > short.start > estimate(none.replace(**{"dermis.present": False})).start
