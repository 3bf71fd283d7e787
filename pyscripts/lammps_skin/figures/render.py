"""Pictures of surfaces and spheres, drawn in numpy: no display, no graphics library.

The projection is parallel. A depth buffer finds what is in front; a light from the upper left
with shadows, and darker hollows, give the eye the third dimension.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.ndimage import gaussian_filter

from lammps_skin.arrays import Floats, Ints

OVERSAMPLING = 2  # pixels drawn for each of the picture, along a side
LIGHT = np.array([-0.50, 0.42, 0.75])  # towards it: right, up (away from the plane), viewer
AMBIENT, DIFFUSE, SHINE = 0.50, 0.60, 0.10
DEEPEST_SHADOW = 0.75  # of the diffuse light that it takes away
MARGIN = 0.02  # of the picture, on every side
PIXELS_AT_ONCE = 4_000_000


class Surface(NamedTuple):
    """Triangles with smooth shading.

    Attributes
    ----------
    corners : (t, 3, 3) array
        Positions of the three corners of each.
    normals : (t, 3, 3) array
        Unit normals there; the side that is seen is lit, whichever it is.
    colour : (3,) array
        Red, green and blue, 0 to 1.
    """

    corners: Floats
    normals: Floats
    colour: Floats


class Spheres(NamedTuple):
    """Spheres: centers (n, 3), radii (n,) and colours (n, 3)."""

    centers: Floats
    radii: Floats
    colours: Floats


@dataclass(frozen=True)
class Camera:
    """A parallel projection to a picture of (height, width) pixels.

    Attributes
    ----------
    axes : (3, 3) array
        Unit vectors in rows: right, up, towards the viewer.
    origin : (2,) array
        Right and up of the lower left corner of the picture, length.
    scale : float
        Pixels per length.
    shape : (height, width)
    """

    axes: Floats
    origin: Floats
    scale: float
    shape: tuple[int, int]

    @classmethod
    def looking(cls, axes: Floats, points: Floats, width: int) -> Camera:
        """Camera whose picture is filled by points (n, 3)."""
        seen = points @ axes[:2].T
        low, high = seen.min(axis=0), seen.max(axis=0)
        margin = MARGIN * (high - low).max()
        scale = width / (high[0] - low[0] + 2 * margin)
        height = int(np.ceil((high[1] - low[1] + 2 * margin) * scale))
        return cls(axes, low - margin, scale, (height, width))

    def project(self, points: Floats) -> Floats:
        """Column, row from below, and nearness of points (..., 3), in pixels."""
        seen = points @ self.axes.T
        seen[..., :2] -= self.origin
        return np.asarray(seen * self.scale)


def axes_of(azimuth: float, elevation: float) -> Floats:
    """Axes of a camera that stands at an azimuth from x and above the plane, in degrees."""
    a, e = np.deg2rad([azimuth, elevation])
    toward = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return np.stack([right, np.cross(toward, right), toward])


class Canvas:
    """What is nearest to the viewer in each pixel: its nearness, normal and colour."""

    def __init__(self, camera: Camera) -> None:
        self.camera = camera
        pixels = camera.shape[0] * camera.shape[1]
        self.depth = np.full(pixels, -np.inf)
        self.normal = np.zeros((pixels, 3))
        self.colour = np.ones((pixels, 3))

    def draw(self, *things: Surface | Spheres) -> None:
        """Draw what is nearer than all that was drawn before."""
        for thing in things:
            if isinstance(thing, Surface):
                self._draw_surface(thing)
            else:
                self._draw_spheres(thing)

    def _draw_surface(self, surface: Surface) -> None:
        corners = self.camera.project(surface.corners)
        a = corners[:, 0]
        ab, ac = corners[:, 1] - a, corners[:, 2] - a
        flat = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
        flat[flat == 0.0] = np.nan
        for item, place in self._boxes(corners.min(axis=1), corners.max(axis=1)):
            to_place = place - a[item, :2]
            u = (to_place[:, 0] * ac[item, 1] - to_place[:, 1] * ac[item, 0]) / flat[item]
            v = (ab[item, 0] * to_place[:, 1] - ab[item, 1] * to_place[:, 0]) / flat[item]
            inside = np.flatnonzero((u >= 0) & (v >= 0) & (u + v <= 1))
            item, place, u, v = item[inside], place[inside], u[inside], v[inside]
            depth = a[item, 2] + u * ab[item, 2] + v * ac[item, 2]
            pixel, front = self._in_front(place, depth)
            weights = np.stack([1 - u - v, u, v], axis=1)[front]
            normal = np.einsum("nc,ncd->nd", weights, surface.normals[item[front]])
            self.normal[pixel] = normal @ self.camera.axes.T
            self.colour[pixel] = surface.colour

    def _draw_spheres(self, spheres: Spheres) -> None:
        centers, radii = self.camera.project(spheres.centers), spheres.radii * self.camera.scale
        low, high = centers - radii[:, None], centers + radii[:, None]
        for item, place in self._boxes(low, high):
            across = place - centers[item, :2]
            rest = radii[item] ** 2 - (across**2).sum(axis=1)
            inside = np.flatnonzero(rest >= 0)
            item, across, place = item[inside], across[inside], place[inside]
            toward = np.sqrt(rest[inside])
            pixel, front = self._in_front(place, centers[item, 2] + toward)
            normal = np.column_stack([across, toward]) / radii[item, None]
            self.normal[pixel] = normal[front]
            self.colour[pixel] = spheres.colours[item[front]]

    def _boxes(self, low: Floats, high: Floats) -> Iterator[tuple[Ints, Ints]]:
        """Pixels (k, 2) in the rectangle of each item, and the number (k,) of the item."""
        most = np.array(self.camera.shape[::-1]) - 1
        first = np.maximum(np.ceil(low[:, :2]), 0).astype(np.int64)
        last = np.minimum(np.floor(high[:, :2]), most).astype(np.int64)
        wide, tall = np.maximum(last - first + 1, 0).T
        count = wide * tall
        portion = np.cumsum(count) // PIXELS_AT_ONCE
        for n in np.unique(portion):
            items = np.flatnonzero(portion == n)
            item = np.repeat(items, count[items])
            start = np.repeat(np.cumsum(count[items]) - count[items], count[items])
            offset = np.divmod(np.arange(len(item)) - start, tall[item])
            yield item, first[item] + np.stack(offset, axis=1)

    def _in_front(self, place: Ints, depth: Floats) -> tuple[Ints, Ints]:
        """Pixels whose nearest is among these places (k, 2), and which of them it is."""
        pixel = place[:, 1] * self.camera.shape[1] + place[:, 0]
        np.maximum.at(self.depth, pixel, depth)
        front = np.flatnonzero(self.depth[pixel] == depth)
        return pixel[front], front

    def places(self) -> Floats:
        """Positions (k, 3) in space of what is seen in the pixels that are not empty."""
        row, column = np.divmod(np.flatnonzero(np.isfinite(self.depth)), self.camera.shape[1])
        depth = self.depth[np.isfinite(self.depth)]
        seen = np.column_stack([column, row, depth]) / self.camera.scale
        seen[:, :2] += self.camera.origin
        return np.asarray(seen @ self.camera.axes)

    def hollow(self, distance: float) -> Floats:
        """How far each pixel lies behind its surroundings within a distance, in distances."""
        depth = self.depth.reshape(self.camera.shape)
        seen = np.isfinite(depth)
        reach = distance * self.camera.scale
        weight = gaussian_filter(seen.astype(float), reach, truncate=2)
        mean = gaussian_filter(np.where(seen, depth, 0.0), reach, truncate=2)
        mean /= np.maximum(weight, 1e-9)
        behind = np.where(seen, mean - np.where(seen, depth, 0.0), 0.0) / reach
        return np.asarray(np.maximum(behind, 0.0).ravel())


def picture(
    things: list[Surface | Spheres], frame: Floats, azimuth: float, elevation: float, width: int,
    roughness: float,
) -> Floats:  # fmt: skip
    """Picture of lit surfaces and spheres on white.

    Parameters
    ----------
    things : list of Surface and Spheres
    frame : (n, 3) array
        Points that the picture is to hold.
    azimuth, elevation : float
        Where the viewer stands: angle from x in the plane, and above it; degrees.
    width : int
        Pixels of the picture; the height follows.
    roughness : float
        Size of the hollows that are to be dark, length.

    Returns
    -------
    (height, width, 3) array
        Red, green and blue, 0 to 1; the top row first.
    """
    axes = axes_of(azimuth, elevation)
    canvas = Canvas(Camera.looking(axes, frame, OVERSAMPLING * width))
    canvas.draw(*things)
    seen = np.isfinite(canvas.depth)

    normal = canvas.normal[seen]
    normal *= np.where(normal[:, 2:] < 0, -1, 1) / np.linalg.norm(normal, axis=1, keepdims=True)
    light = LIGHT * [1, np.sign(elevation), 1] / np.linalg.norm(LIGHT)
    halfway = light + np.array([0, 0, 1])
    halfway /= np.linalg.norm(halfway)
    lit = 1 - DEEPEST_SHADOW * _shadow(canvas, things, light @ axes, roughness)
    bright = AMBIENT * np.exp(-0.8 * canvas.hollow(roughness)[seen])
    bright += DIFFUSE * np.maximum(normal @ light, 0.0) * lit
    shine = SHINE * np.maximum(normal @ halfway, 0.0) ** 30 * lit

    image = np.ones((len(canvas.depth), 3))
    image[seen] = np.clip(canvas.colour[seen] * bright[:, None] + shine[:, None], 0, 1)
    rows, columns = (side // OVERSAMPLING for side in canvas.camera.shape)
    full = image.reshape(*canvas.camera.shape, 3)[: rows * OVERSAMPLING, : columns * OVERSAMPLING]
    blocks = full.reshape(rows, OVERSAMPLING, columns, OVERSAMPLING, 3)
    return np.asarray(blocks.mean(axis=(1, 3))[::-1])


def _shadow(
    canvas: Canvas, things: list[Surface | Spheres], light: Floats, roughness: float
) -> Floats:
    """How much of the light is kept from each pixel that is not empty, with soft edges."""
    across = np.cross([0.0, 0.0, 1.0], light)
    across /= np.linalg.norm(across)
    axes = np.stack([across, np.cross(light, across), light])
    places = canvas.places()
    camera = Camera.looking(axes, places, canvas.camera.shape[1] // OVERSAMPLING)
    from_light = Canvas(camera)
    from_light.draw(*things)
    seen = camera.project(places)
    covered = seen[:, 2] + 0.25 * roughness * camera.scale
    softness = 0.12 * roughness * camera.scale
    shade = np.zeros(len(places))
    for offset in np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1]), axis=-1).reshape(-1, 2):
        place = np.round(seen[:, :2] + softness * offset).astype(np.int64)
        column, row = np.clip(place, 0, np.array(camera.shape[::-1]) - 1).T
        shade += from_light.depth[row * camera.shape[1] + column] > covered
    return shade / 9
