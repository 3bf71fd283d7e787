"""The nearest membrane particle of every cell against a search over all periodic images."""

from itertools import pairwise

import numpy as np
import pytest
from lammps_skin.engine.engine import Cells, Forces
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import lattice
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import CONTACT, FREEZE, HEIGHT, crowd, grid, membrane_scene, place, wave

TIMESTEP = 0.02
STEPS = 150


def image_distances(particles: Forces, cells: Cells, sides: tuple[float, float]) -> np.ndarray:
    """Distances (cells, membrane particles), the least over all images in x and y."""
    membrane = particles.positions[particles.types == Kind.MEMBRANE]
    delta = cells.positions[:, None] - membrane[None]
    for axis, side in enumerate(sides):
        images = delta[..., axis, None] % side - np.array([0.0, side])
        delta[..., axis] = np.abs(images).min(axis=-1)
    return np.linalg.norm(delta, axis=-1)


def check_nearest(particles: Forces, cells: Cells, sides: tuple[float, float]) -> None:
    ids = particles.ids[particles.types == Kind.MEMBRANE]
    distances = image_distances(particles, cells, sides)
    least = distances.min(axis=1)
    chosen = distances[np.arange(len(cells.ids)), np.searchsorted(ids, cells.partner)]
    assert np.isin(cells.partner, ids).all()
    np.testing.assert_allclose(cells.distance, least, rtol=0, atol=1e-10)
    np.testing.assert_allclose(chosen, least, rtol=0, atol=1e-10)


@pytest.mark.parametrize(
    ("ranks", "neighbor_skin"),
    [(1, 0.3), pytest.param(1, 1.0, marks=pytest.mark.slow), (2, 1.0)],
    ids=["short", "long", "two-ranks"],
)
def test_partner_is_the_nearest_at_every_step(ranks: int, neighbor_skin: float) -> None:
    """Crowded cells are dragged over a fold, through the periodic edges and from rank to rank."""
    scene = membrane_scene(
        **{
            "numerics.timestep": TIMESTEP,
            "numerics.neighbor_skin": neighbor_skin,
        }
    )
    sides = scene.box_sides[:2]
    partners: list[dict[int, int]] = []
    moved: list[float] = []

    def check(_time: float, simulation: Simulation) -> None:
        particles, cells = simulation.forces(), simulation.cells()
        check_nearest(particles, cells, sides)
        partners.append(dict(zip(cells.ids.tolist(), cells.partner.tolist(), strict=True)))
        moved.append(displacement(particles, crowded, sides))

    every = (2, 10)[ranks - 1]  # steps
    crowded = crowd(scene, across=6, amplitude=1.5, above=1.9)
    with Simulation.begin(scene, configuration=crowded, ranks=ranks) as simulation:
        simulation.command("fix drag cells addforce 2.0 -1.0 0.0")
        simulation.run(until=STEPS * TIMESTEP, progress=check, every=every * TIMESTEP)

    assert len(partners) == STEPS // every
    assert switches(partners) > 300 / every
    assert moved[-1] > scene.spacing


def switches(partners: list[dict[int, int]]) -> int:
    """How often a cell's nearest particle is another one than a step before."""
    return sum(
        after[cell] != before[cell]
        for before, after in pairwise(partners)
        for cell in after.keys() & before
    )


def displacement(particles: Forces, start: Configuration, sides: tuple[float, float]) -> float:
    """How far the membrane particle that moved furthest is from its first place."""
    membrane = particles.types == Kind.MEMBRANE
    delta = particles.positions[membrane] - start.positions[start.kinds == Kind.MEMBRANE]
    delta[:, :2] -= np.multiply(sides, np.round(delta[:, :2] / sides))
    return float(np.linalg.norm(delta, axis=1).max())


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_partner_is_the_nearest_in_random_places(ranks: int) -> None:
    """Many cells at random around a deep fold, some of them below the membrane's top."""
    scene = membrane_scene(
        **{"cells.adhesion_range": 2.0, "cells.membrane_exclusion_stiffness": 0.0}
    )
    random = np.random.default_rng(11)
    flat = grid(scene, 22, jitter=0.4)
    above = random.uniform(0.3, 1.4, len(flat)) * CONTACT
    heights = HEIGHT + wave(scene, flat, 3.0) + above
    cells = [(Kind.ND, (*xy, z), 0) for xy, z in zip(flat, heights, strict=True)]
    configuration = place(scene, cells, amplitude=3.0)

    with Simulation.begin(scene, configuration=configuration, ranks=ranks) as simulation:
        particles, found = simulation.forces(), simulation.cells()
        check_nearest(particles, found, scene.box_sides[:2])
    assert len(found.ids) == 484
    vertical = np.abs(found.positions[:, :2] - particles.positions[found.partner - 1, :2])
    across_edge = (vertical > np.divide(scene.box_sides[:2], 2)).any(axis=1)
    assert across_edge.sum() > 10


@pytest.mark.parametrize(("ranks", "turned"), [(1, False), (1, True), (2, True)])
def test_of_equally_near_particles_the_one_with_the_lowest_id_counts(
    ranks: int, turned: bool
) -> None:
    """It is the partner, and the plane of divisions is normal to the line to it.

    Cells are above the middles of links, on a sheet whose IDs ascend or descend along x and y.
    """
    scene = membrane_scene(
        **{"cells.cycle_delay": 10.0, "cells.cycle_rate": 1e6, "cells.first_phase": 1e9,
           "numerics.timestep": TIMESTEP}
    )  # fmt: skip
    sheet = lattice.positions(scene.membrane.lattice, scene.spacing, HEIGHT)
    if turned:
        sheet[:, :2] = np.subtract(scene.box_sides[:2], sheet[:, :2])
    links, _ = lattice.links_and_hinges(scene.membrane.lattice)
    a, b = sheet[links].swapaxes(0, 1)
    middles = (a + b) / 2
    inside = (np.abs(2 * middles / scene.box_sides - 1) < 0.8)[:, :2].all(axis=1)
    equally_near = ((a - middles) ** 2 == (b - middles) ** 2).all(axis=1)
    chosen = np.flatnonzero(inside & equally_near & (np.abs(a - b) < 2).all(axis=1))[::5]
    places = middles[chosen] + [0.0, 0.0, CONTACT]
    configuration = place(scene, [(Kind.STEM, xyz, 3) for xyz in places])
    configuration.positions[: len(sheet)] = sheet
    with Simulation.begin(scene, configuration=configuration, ranks=ranks) as simulation:
        found = simulation.cells()
        simulation.command(FREEZE)
        simulation.command("neigh_modify exclude group cells cells")
        simulation.run(until=2 * scene.numerics.event_interval)
        divided = simulation.cells()
    assert len(found.ids) > 100
    lowest = links[chosen].min(axis=1)
    np.testing.assert_array_equal(found.partner, lowest + 1)

    newborn = divided.ids > found.ids.max()
    mother = divided.parent[newborn] - found.ids.min()
    np.testing.assert_array_equal(np.sort(mother), np.arange(len(places)))
    normals = places[mother] - sheet[lowest[mother]]
    directions = divided.positions[newborn] - places[mother]
    np.testing.assert_allclose((normals * directions).sum(axis=1), 0.0, atol=1e-9)


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_partner_jumps_between_the_walls_of_a_trench(ranks: int) -> None:
    """Cells pass the middle of a valley: particles far from each other compete for them.

    Cells and membrane move in opposite directions, so that between two neighbor builds
    distances change by as much as they can.
    """
    scene = membrane_scene(
        **{"numerics.neighbor_skin": 1.0, "numerics.timestep": TIMESTEP,
           "cells.membrane_exclusion_stiffness": 0.0}
    )  # fmt: skip
    jumps: list[np.ndarray] = []
    before = np.empty((0, 3))

    def check(_time: float, simulation: Simulation) -> None:
        nonlocal before
        particles, cells = simulation.forces(), simulation.cells()
        check_nearest(particles, cells, scene.box_sides[:2])
        partners = particles.positions[cells.partner - 1]
        if len(before):
            jumps.append(np.abs(partners - before)[:, 0])
        before = partners

    with Simulation.begin(scene, configuration=trench(scene), ranks=ranks) as simulation:
        simulation.command("group sheet type membrane")
        simulation.command("fix sheet sheet setforce -1.0 0.0 0.0")
        simulation.command("fix procession cells setforce 1.0 0.0 0.0")
        simulation.run(until=60 * TIMESTEP, progress=check, every=(1, 4)[ranks - 1] * TIMESTEP)
    assert (np.max(jumps, axis=0) > 2.0).sum() >= 10


def trench(scene: Scene) -> Configuration:
    """A membrane with a steep valley, and cells that are nearer to its walls than to its floor."""
    depth, count = 4.0, 12
    lx, ly, _ = scene.box_sides
    x = lx / 2 - np.linspace(0.4, 1.4, count)
    y = (np.arange(count) + 0.3) * ly / count
    z = HEIGHT - depth + np.linspace(2.2, 3.5, count)
    configuration = place(scene, [(Kind.ND, spot, 0) for spot in zip(x, y, z, strict=True)])
    sheet = configuration.positions[:-count]
    sheet[:, 2] += depth * np.cos(2 * np.pi * sheet[:, 0] / lx)
    return configuration
