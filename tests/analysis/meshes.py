"""Surfaces of known shape: positions, triangles, box."""

from collections.abc import Callable

import numpy as np
from lammps_skin.arrays import Floats, Ints
from lammps_skin.start import lattice
from scipy.spatial import ConvexHull

Surface = tuple[Floats, Ints, tuple[float, float]]


def sheet(
    shape: tuple[int, int], height: Callable[[Floats, Floats], Floats], spacing: float = 0.5
) -> Surface:
    """Membrane lattice with z = height(x, y)."""
    positions = lattice.positions(shape, spacing, 0.0)
    positions[:, 2] = height(positions[:, 0], positions[:, 1])
    box = shape[0] * spacing, shape[1] * spacing * np.sqrt(3) / 2
    return positions, lattice.triangles(shape), box


def rough_sheet(seed: int, shape: tuple[int, int] = (14, 12), noise: float = 0.1) -> Surface:
    """Membrane lattice with every coordinate perturbed."""
    positions, triangles, box = sheet(shape, lambda x, y: 0 * x)
    return positions + np.random.default_rng(seed).normal(0, noise, positions.shape), triangles, box


def icosphere(level: int, radius: float) -> tuple[Floats, Ints]:
    """Icosahedron whose triangles are split in four `level` times, on a sphere; outward."""
    golden = (1 + np.sqrt(5)) / 2
    points = np.array([(0, a, b * golden) for a in (-1, 1) for b in (-1, 1)])
    points = np.concatenate([np.roll(points, turn, axis=1) for turn in range(3)])
    faces = points[ConvexHull(points).simplices]
    inward = np.linalg.det(faces) < 0
    faces[inward] = faces[inward, ::-1]
    faces = on_unit_sphere(faces)
    for _ in range(level):
        a, b, c = np.moveaxis(faces, 1, 0)
        ab, bc, ca = (on_unit_sphere(middle) for middle in (a + b, b + c, c + a))
        parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = np.concatenate([np.stack(part, axis=1) for part in parts])
    positions, triangles = np.unique(faces.reshape(-1, 3), axis=0, return_inverse=True)
    return radius * positions, triangles.reshape(-1, 3)


def on_unit_sphere(points: Floats) -> Floats:
    return points / np.linalg.norm(points, axis=-1, keepdims=True)


def cylinder(shape: tuple[int, int], radius: float) -> Surface:
    """The lattice rolled up around an axis along x, which stays periodic; outward."""
    circumference = 2 * np.pi * radius
    spacing = circumference / (shape[1] * np.sqrt(3) / 2)
    flat, triangles, _ = sheet(shape, lambda x, y: 0 * x, spacing)
    angle = flat[:, 1] / radius
    positions = np.column_stack([flat[:, 0], radius * np.sin(angle), radius * np.cos(angle)])
    return positions, triangles, (shape[0] * spacing, 10 * radius)


class Waves:
    """A random smooth periodic height field with its derivatives."""

    def __init__(self, seed: int, box: tuple[float, float], slope: float) -> None:
        random = np.random.default_rng(seed)
        numbers = np.array([(1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (1, 2)])
        self.q = 2 * np.pi * numbers / box
        self.phase = random.uniform(0, 2 * np.pi, len(numbers))
        amplitude = random.uniform(0.5, 1, len(numbers)) / np.linalg.norm(self.q, axis=1)
        self.amplitude = slope * amplitude / len(numbers)

    def __call__(self, x: Floats, y: Floats) -> Floats:
        return np.cos(self._arguments(x, y)) @ self.amplitude

    def _arguments(self, x: Floats, y: Floats) -> Floats:
        return np.stack([x, y], axis=-1) @ self.q.T + self.phase

    def curvatures(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Mean (positive at maxima) and Gaussian curvature of the graph."""
        sine, cosine = np.sin(self._arguments(x, y)), np.cos(self._arguments(x, y))
        a, (qx, qy) = self.amplitude, self.q.T
        hx, hy = -sine @ (a * qx), -sine @ (a * qy)
        hxx, hyy, hxy = -cosine @ (a * qx**2), -cosine @ (a * qy**2), -cosine @ (a * qx * qy)
        w = 1 + hx**2 + hy**2
        mean = -((1 + hy**2) * hxx - 2 * hx * hy * hxy + (1 + hx**2) * hyy) / (2 * w**1.5)
        return mean, (hxx * hyy - hxy**2) / w**2
