"""Membranes that are no sheet over the box: closed, open at one side, and open at all."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from lammps_skin import Configuration, Scene, Simulation
from lammps_skin.analysis.geometry import minimum_image
from lammps_skin.analysis.observables import observables
from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import MembraneError
from lammps_skin.figures import snapshot as pictures
from lammps_skin.figures.look import Look
from lammps_skin.kinds import Kind
from matplotlib.image import imread
from meshes import icosphere, sheet

RADIUS, HEIGHT = 3.3, 12.0
UNDEFINED = ("skewness", "papillae", "papilla_height", "stem_on_tips", "nd_tips_p")
DEFINED = ("stem", "coverage", "height", "height_std", "chi_H", "zeta", "sigma")
SCENE = Scene.from_dict(
    {
        "end_time": 1.0,
        "dermis": {"present": False},
        "membrane": {"lattice": [40, 46]},
        "cells": {"stem": 2, "arrangement": "cluster"},
        "output": {"dump_interval": 1.0},
    }
)


def sphere() -> tuple[Floats, Ints]:
    positions, triangles = icosphere(3, RADIUS)
    return positions + np.array([10, 10, HEIGHT]), triangles


def patch() -> tuple[Floats, Ints]:
    """A lattice without what passes through the edges of its box."""
    positions, triangles, box = sheet((20, 20), lambda x, y: 0 * x, 0.5)
    sides = positions[triangles] - positions[np.roll(triangles, 1, axis=1)]
    inside = (sides == minimum_image(sides, box)).all(axis=(1, 2))
    return positions + np.array([5, 5, HEIGHT]), triangles[inside]


def tube() -> tuple[Floats, Ints]:
    """Along x, which it passes through periodically."""
    columns, rows = 40, 34
    n, k = np.meshgrid(np.arange(columns), np.arange(rows))
    angle = 2 * np.pi * k / rows
    radius = rows * np.sqrt(3) / 4 / (2 * np.pi)
    y, z = 10 + radius * np.sin(angle), HEIGHT + radius * np.cos(angle)
    positions = np.stack([0.5 * n + 0.25 * (k % 2), y, z], axis=-1).reshape(-1, 3)
    _, triangles, _ = sheet((columns, rows), lambda x, y: 0 * x, 0.5)
    return positions, triangles


def hinges_of(triangles: Ints) -> Ints:
    """Dihedrals (h, 4): the ends of a link, between the corners opposite to it."""
    opposite = {}
    for a, b, c in triangles.tolist():
        opposite |= {(a, b): c, (b, c): a, (c, a): b}
    pairs = [(a, b) for a, b in opposite if a < b and (b, a) in opposite]
    return np.array([(opposite[a, b], a, b, opposite[b, a]) for a, b in pairs])


def links_of(triangles: Ints) -> Ints:
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(sides, axis=1), axis=0)


@pytest.fixture(scope="module", params=[sphere, patch, tube], ids=lambda make: make.__name__)
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short run of a membrane with two stem cells on top of it."""
    make: Callable[[], tuple[Floats, Ints]] = request.param
    membrane, triangles = make()
    off_centre = np.linalg.norm(membrane[:, :2] - 10, axis=1)
    top = membrane[(membrane[:, 2] - 0.1 * off_centre).argmax()]
    cells = top + np.array([[-1.5, 0, SCENE.contact], [1.5, 0, SCENE.contact]])
    configuration = Configuration(
        box=np.array(SCENE.box_sides),
        kinds=np.repeat([Kind.MEMBRANE, Kind.STEM], [len(membrane), 2]),
        positions=np.concatenate([membrane, cells]),
        links=links_of(triangles),
        hinges=hinges_of(triangles),
        divisions_left=np.repeat([0, 10], [len(membrane), 2]),
    )
    directory = tmp_path_factory.mktemp(make.__name__)
    with Simulation.begin(SCENE, directory, configuration) as simulation:
        simulation.run()
    return directory


def test_what_needs_no_sheet_is_measured(run: Path) -> None:
    table = observables(run)
    for name in DEFINED:
        assert np.isfinite(table[name]).all(), name
    for name in UNDEFINED:
        assert np.isnan(table[name]).all(), name
    assert table["height"][0] == pytest.approx(HEIGHT, abs=0.1)


def test_its_own_triangles_are_drawn(run: Path, tmp_path: Path) -> None:
    look = Look(size=200)
    for view in ("3d", "section"):
        image = imread(pictures.snapshot(run, None, tmp_path / f"{view}.png", view, look=look))
        brown = image[..., 0] > image[..., 1] + 0.05  # the membrane, unlike stem cells and letters
        assert brown.sum() > 200, view
    with pytest.raises(MembraneError, match=r"^membrane: has no height at \d+ of \d+ places"):
        pictures.snapshot(run, None, tmp_path / "height.png", "height", look=look)
