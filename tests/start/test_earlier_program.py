"""The start of the authors' earlier program: the set `earlier-full`, and its keys by themselves."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.arrangements import place_cells
from lammps_skin.start.configuration import Configuration
from lammps_skin.start.packing import dermal_count

from tests.cells.conftest import first_division

FULL = {"parameters": "earlier-full"}
SMALL = {"membrane.lattice": [28, 32], "cells.stem": 5}


def test_ring_and_dermis_of_a_quarter() -> None:
    """16 cells at L_x/4 from the centre, spheres in 17 x 17 columns of 8."""
    scene = Scene.load("quarter-ring").replace(**FULL)
    start = Configuration.from_scene(scene)
    lx, ly = 50.0, 114 * 0.5 * 3**0.5 / 2
    ring = [
        (lx / 2 + lx / 4 * cos(2 * pi * n / 16), ly / 2 + lx / 4 * sin(2 * pi * n / 16), 24.8)
        for n in range(16)
    ]
    np.testing.assert_allclose(start.positions[start.kinds == Kind.STEM], ring, atol=1e-12)

    spheres = start.positions[start.kinds == Kind.DERMAL]
    layer = 21.4 / 8  # below the membrane, which is at 22.4
    cubic = [
        ((i + 0.5) * lx / 17, (j + 0.5) * ly / 17, (k + 0.5) * layer)
        for i in range(17) for j in range(17) for k in range(8)
    ]  # fmt: skip
    assert len(spheres) == dermal_count(scene) == 2312
    away = spheres - cubic
    # only what is next to the wall and to the membrane is out of balance, and rises a little
    assert np.abs(away[:, :2]).max() < 0.01
    by_layer = away[:, 2].reshape(-1, 8)
    assert np.abs(by_layer[:, 1:6]).max() < 0.01
    assert by_layer[:, 0].min() > 0.005 and by_layer[:, 7].max() < 0.25


def test_cells_are_at_the_start_of_their_cycle() -> None:
    """The first division of each is T0 and an exponential time away."""
    scene = Scene.load("demo").replace(**FULL, **SMALL)
    with Simulation.begin(scene) as simulation:
        cells = simulation.cells()
    told = [first_division(scene, scene.cell_seed, int(cell)) for cell in cells.ids]
    np.testing.assert_allclose(cells.next_division, told, rtol=1e-14)
    assert cells.next_division.min() > 36 and np.ptp(cells.next_division) > 1


def test_a_key_that_is_given_wins_over_the_set() -> None:
    keys = {
        "cells.ring_radius": 0.35, "cells.first_phase": 48.0, "cells.removal_in_pair": True,
        "cells.division_distance": 0.5, "dermis.packing": "random",
        "membrane.bending_form": "cosine", "cells.generations": "endless",
    }  # fmt: skip
    scene = Scene.load("demo").replace(**FULL, **keys)
    for key, value in keys.items():
        part, name = key.split(".")
        assert getattr(getattr(scene, part), name) == value
    assert scene.cells.kinds["ta"].paired_stiffness == 25.0


@pytest.mark.parametrize("arrangement", ["ring", "core", "alternating"])
def test_stem_cells_stand_on_a_ring_of_the_radius(arrangement: str) -> None:
    scene = Scene.load("quarter-nd-c").replace(
        **{"cells.arrangement": arrangement, "cells.ring_radius": 0.41}
    )
    places = place_cells(scene)[Kind.STEM] - np.array(scene.box_sides[:2]) / 2
    np.testing.assert_allclose(np.hypot(*places.T), 0.41 * 50.0, rtol=1e-12)


def test_other_arrangements_are_as_they_are() -> None:
    for name in ("quarter-random", "quarter-cluster", "quarter-nd-d"):
        one, other = (Scene.load(name).replace(parameters=p) for p in ("earlier", "earlier-full"))
        for kind, places in place_cells(one).items():
            np.testing.assert_array_equal(place_cells(other)[kind], places)


def test_columns_follow_the_heights() -> None:
    """Under a hill each column has the spheres that there is room for, none above the membrane."""
    scene = Scene.load("one-stem").replace(
        **{"dermis.packing": "cubic", "membrane.lattice": [28, 32], "membrane.height": 9.0}
    )
    y, x = np.mgrid[0:32, 0:28] * 2 * pi / [[[32]], [[28]]]
    start = Configuration.from_scene(scene, 1.5 * (2 - np.cos(x) - np.cos(y)))
    membrane, spheres = (
        start.positions[start.kinds == kind] for kind in (Kind.MEMBRANE, Kind.DERMAL)
    )
    column = np.floor(spheres[:, :2] / [14.0 / 5, scene.box_sides[1] / 4]).astype(int)
    count = np.bincount(column[:, 0] * 4 + column[:, 1], minlength=20)
    assert len(count) == 20 and count.min() == 3 and count.max() >= 5
    nearest = np.linalg.norm(membrane[None, :, :2] - spheres[:, None, :2], axis=2).argmin(axis=1)
    assert (spheres[:, 2] < membrane[nearest, 2] - 0.5).all()
