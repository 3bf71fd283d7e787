"""Inverted triangles are seen wherever they are: against a search in plain numpy."""

import itertools
import json
import re
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from lammps_skin.arrays import Floats, Ints
from lammps_skin.start import lattice

from tests.analysis.meshes import icosphere

BIN = Path(sys.executable).parent
INVERTED = -0.5  # cosine of 120 degrees


class Mesh(NamedTuple):
    """Positions, triangles, box; the box is periodic in x and y where `periodic` is true."""

    positions: Floats
    triangles: Ints
    low: Floats
    high: Floats
    periodic: bool

    def hinges(self) -> Ints:
        """Corner, link, corner across it, of each link with two triangles."""
        return self._hinges_and_sides()[0]

    def inverted(self, positions: Floats) -> set[frozenset[int]]:
        """Triangles that are folded by more than 120 degrees against all that they meet."""
        sides = self._hinges_and_sides()[1]
        a, b, c = np.moveaxis(positions[self.triangles], 1, 0)
        normals = np.cross(self._image(b - a), self._image(c - a))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        cosines = (normals[sides[:, 0]] * normals[sides[:, 1]]).sum(axis=1)
        smallest = np.full(len(self.triangles), -1.0)
        for side in sides.T:
            np.maximum.at(smallest, side, cosines)
        return {frozenset(map(int, row)) for row in self.triangles[smallest < INVERTED]}

    def _hinges_and_sides(self) -> tuple[Ints, Ints]:
        """Also the numbers of the two triangles."""
        at = defaultdict(list)
        for n, triangle in enumerate(self.triangles.tolist()):
            for k in range(3):
                corner, i, j = triangle[k:] + triangle[:k]
                at[frozenset((i, j))].append((n, corner, i, j))
        pairs = [found for found in at.values() if len(found) == 2]
        return (
            np.array([(a, i, j, b) for (_, a, i, j), (_, b, _, _) in pairs]),
            np.array([(m, n) for (m, *_), (n, *_) in pairs]),
        )

    def _image(self, way: Floats) -> Floats:
        """The shortest of the ways through the periodic edges."""
        box = self.high - self.low
        periodic = np.array([1, 1, 0]) * self.periodic
        return way - periodic * box * np.round(way / box)

    def pushed(self) -> tuple[Ints, Floats]:
        """Each corner, and places of it just through the link across from it in a triangle."""
        moved, places = [], []
        for corner in range(len(self.positions)):
            around = self.triangles[(self.triangles == corner).any(axis=1)]
            own = self.positions[corner]
            others = around[corner % len(around)]
            ways = [self._image(self.positions[n] - own) for n in others if n != corner]
            moved.append(corner)
            places.append(own + 1.01 * np.mean(ways, axis=0))
        return np.array(moved), np.array(places)


def membrane() -> Mesh:
    """A small periodic membrane, rough so that no normal is that of a neighbor."""
    shape = (8, 10)
    positions = lattice.positions(shape, 0.5, 0.0)
    positions += np.random.default_rng(1).normal(0, 0.01, positions.shape)
    high = np.array([4.0, 10 * np.sqrt(3) / 4, 2.0])
    positions[:, :2] %= high[:2]
    return Mesh(positions, lattice.triangles(shape), np.array([0, 0, -2.0]), high, True)


def sphere() -> Mesh:
    positions, triangles = icosphere(2, 1.4)
    return Mesh(positions, triangles, np.full(3, -2.0), np.full(3, 2.0), False)


def patch() -> Mesh:
    """A membrane with an edge and two holes: of one triangle, and of all around a corner."""
    whole = membrane()
    x = lattice.positions((8, 10), 0.5, 0.0)
    x += np.random.default_rng(1).normal(0, 0.01, x.shape)
    corners = x[whole.triangles]
    kept = np.ptp(corners[:, :, :2], axis=1).max(axis=1) < 1.0
    kept &= ~(whole.triangles == 3 * 8 + 3).any(axis=1)
    kept[np.flatnonzero(kept & (whole.triangles == 6 * 8 + 4).any(axis=1))[0]] = False
    triangles = whole.triangles[kept]
    used, triangles = np.unique(triangles, return_inverse=True)
    low, high = np.full(3, -1.0), np.array([5.0, 5.0, 2.0])
    return Mesh(x[used], triangles.reshape(-1, 3), low, high, False)


MESHES: dict[str, Callable[[], Mesh]] = {"membrane": membrane, "sphere": sphere, "patch": patch}


def in_order(hinges: Ints) -> Ints:
    return hinges


def from_either_end(hinges: Ints) -> Ints:
    """Some from the other end, some with the ends of the link exchanged, some both."""
    mixed, random = hinges.copy(), np.random.default_rng(2)
    other, exchanged = random.random((2, len(hinges))) < 0.5
    mixed[other] = mixed[other, ::-1]
    mixed[exchanged] = mixed[exchanged][:, [0, 2, 1, 3]]
    return mixed


def watch(
    directory: Path, mesh: Mesh, hinges: Ints, moved: Ints, places: Floats, ranks: int, *more: str
) -> list[set[int]]:
    """Corners of the triangle that LAMMPS calls inverted after each move, none if it goes on."""
    inside = places.copy()
    if mesh.periodic:
        inside[:, :2] = mesh.low[:2] + (places - mesh.low)[:, :2] % (mesh.high - mesh.low)[:2]
    boundary = "p p f" if mesh.periodic else "f f f"
    np.savez(
        directory / "mesh.npz", positions=mesh.positions, hinges=hinges, low=mesh.low,
        high=mesh.high, moved=moved, places=inside, boundary=boundary,
    )  # fmt: skip
    launcher = [str(BIN / "mpirun"), "-launcher", "fork", "-np", str(ranks)] if ranks > 1 else []
    program = [sys.executable, str(Path(__file__).with_name("watch.py"))]
    subprocess.run(
        [*launcher, *program, "mesh.npz", "out.json", *more], cwd=directory, check=True, timeout=600
    )
    found = []
    for error in json.loads((directory / "out.json").read_text()):
        named = re.search(r"triangle of atoms (\d+) (\d+) (\d+) is inverted on step \d+: ", error)
        assert not error or named, error
        found.append({int(tag) - 1 for tag in named.groups()} if named else set())
    return found


def assert_seen(mesh: Mesh, moved: Ints, places: Floats, found: list[set[int]]) -> None:
    """LAMMPS names one of the inverted triangles after each move."""
    for number, place, triangle in zip(moved, places, found, strict=True):
        positions = mesh.positions.copy()
        positions[number] = place
        expected = mesh.inverted(positions)
        assert triangle in expected if expected else not triangle, (number, expected, triangle)


# what runs always; the others are slow
QUICK = {
    ("membrane", in_order, 1), ("membrane", in_order, 2), ("membrane", from_either_end, 1),
    ("sphere", from_either_end, 1), ("patch", in_order, 1), ("patch", from_either_end, 1),
}  # fmt: skip
CASES = [
    pytest.param(*case, marks=() if case in QUICK else pytest.mark.slow)
    for case in itertools.product(MESHES, (in_order, from_either_end), (1, 2, 4))
]


@pytest.mark.parametrize(("shape", "order", "ranks"), CASES)
def test_every_corner_is_watched(
    tmp_path: Path, shape: str, order: Callable[[Ints], Ints], ranks: int
) -> None:
    mesh = MESHES[shape]()
    moved, places = mesh.pushed()
    found = watch(tmp_path, mesh, order(mesh.hinges()), moved, places, ranks)
    assert_seen(mesh, moved, places, found)
    assert sum(map(bool, found)) == len(mesh.positions)


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_watched_in_a_hybrid_style(tmp_path: Path, ranks: int) -> None:
    mesh = membrane()
    moved, places = mesh.pushed()
    found = watch(tmp_path, mesh, mesh.hinges(), moved[:12], places[:12], ranks, "hybrid")
    assert_seen(mesh, moved[:12], places[:12], found)
    assert all(found)


@pytest.mark.parametrize("shape", list(MESHES))
def test_a_corner_close_to_its_link_is_no_fault(tmp_path: Path, shape: str) -> None:
    """Some folds there are sharp, no triangle is turned over."""
    mesh = MESHES[shape]()
    moved, places = mesh.pushed()
    places = mesh.positions + 0.95 * (places - mesh.positions)
    found = watch(tmp_path, mesh, from_either_end(mesh.hinges()), moved, places, 1)
    assert_seen(mesh, moved, places, found)
    assert not any(found)
