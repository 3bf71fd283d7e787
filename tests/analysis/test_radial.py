"""The radial distribution in the plane has the limits that it must have."""

from __future__ import annotations

import MDAnalysis
import numpy as np
import pytest
from lammps_skin import open_trajectory
from lammps_skin.analysis.radial import InPlaneRDF, pairs_within
from lammps_skin.errors import SkinError
from lammps_skin.start import lattice
from MDAnalysis.coordinates.memory import MemoryReader

BOX = np.array([10.0, 8.0])


def universe_of(places: np.ndarray, box: np.ndarray = BOX) -> MDAnalysis.Universe:
    """Frames (f, n, 3) in memory."""
    universe = MDAnalysis.Universe.empty(places.shape[1])
    universe.trajectory = MemoryReader(places, dimensions=np.array([*box, 100, 90, 90, 90]))
    return universe


def test_an_ideal_gas_has_none():
    """Within five standard deviations of Poisson's counts; particles outside the box as well."""
    rng = np.random.default_rng(5)
    places = rng.uniform(-1, 2, (40, 300, 3)) * [*BOX, 30]
    universe = universe_of(places)
    for first, second in ((universe.atoms, None), (universe.atoms[:100], universe.atoms[100:])):
        found = InPlaneRDF(first, second, bins=20).run().results
        assert found.edges[-1] == BOX.min() / 2
        assert (np.abs(found.rdf - 1) < 5 / np.sqrt(found.counts / 2)).all()
        assert found.counts.min() > 1000


def test_pairs_are_those_of_all_distances():
    rng = np.random.default_rng(6)
    first, second = rng.uniform(-20, 20, (50, 2)), rng.uniform(-20, 20, (70, 2))
    apart = first[:, None] - second
    apart -= BOX * np.round(apart / BOX)
    distances = np.linspace(0.3, 4, 9)
    expected = (np.linalg.norm(apart, axis=2)[..., None] <= distances).sum(axis=(0, 1))
    np.testing.assert_array_equal(pairs_within(first, second, BOX, distances), expected)


def test_a_triangular_lattice_has_its_shells():
    """Six neighbors each at 1, sqrt(3) and 2 spacings, and nobody between; whatever the heights."""
    sites = lattice.positions((24, 28), 0.5, 20.0)
    sites[:, 2] += np.random.default_rng(7).normal(size=len(sites))
    box = np.array([12.0, 14 * np.sqrt(3) / 2])
    found = InPlaneRDF(universe_of(sites[None], box).atoms, bins=110, furthest=1.1).run().results
    around = found.counts / len(sites)
    peaks = {round(float(found.bins[n]), 3): around[n] for n in np.flatnonzero(around)}
    near = {0.5: 6, 0.866: 6, 1.0: 6}
    for distance, neighbors in near.items():
        shell = np.abs(found.bins - distance) < 0.011
        assert around[shell].sum() == neighbors, peaks
    assert around.sum() == 18


def test_groups_follow_the_frames_in_other_processes_too(run):
    universe = open_trajectory(run.directory)
    cells, ta = (
        universe.select_atoms(text, updating=True)
        for text in ("type stem ta exhausted nd", "type ta")
    )
    found = InPlaneRDF(cells, ta, bins=12).run().results
    width, height = run.scene.box_sides[:2]
    counts, density = np.zeros(12), 0.0
    for told in run.cells:
        some = told.positions[told.types == 4, :2]
        within = pairs_within(told.positions[:, :2], some, np.array([width, height]), found.edges)
        counts += np.diff(within)
        density += (len(told.ids) - 1) * len(some) / (width * height)
    np.testing.assert_allclose(found.counts, counts, atol=2)  # of single precision
    assert found.pair_density == pytest.approx(density, rel=1e-6)
    spread = InPlaneRDF(cells, ta, bins=12).run(backend="multiprocessing", n_workers=2).results
    np.testing.assert_array_equal(spread.counts, found.counts)
    np.testing.assert_allclose(spread.rdf, found.rdf)


def test_what_does_not_exist_is_left_out(run):
    universe = open_trajectory(run.directory)
    universe.trajectory[-1]
    alive = InPlaneRDF(universe.select_atoms("alive 1"), bins=5).run(start=-1).results
    whole = InPlaneRDF(universe.atoms, bins=5).run(start=-1).results
    assert np.isnan(universe.atoms.positions).any()
    np.testing.assert_array_equal(whole.counts, alive.counts)
    empty = InPlaneRDF(universe.select_atoms("type dermal"), bins=5).run().results
    assert np.isnan(empty.rdf).all()


@pytest.mark.parametrize("options", [{"furthest": 4.1}, {"furthest": 0.0}, {"bins": 0}])
def test_bad_distances_are_refused(options):
    with pytest.raises(SkinError, match=next(iter(options))):
        InPlaneRDF(universe_of(np.zeros((1, 3, 3))).atoms, **options)
