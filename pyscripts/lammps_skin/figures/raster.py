"""What is in front of what: spheres and triangles in a depth buffer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from lammps_skin.arrays import Bools, Floats, Ints
from lammps_skin.figures.camera import Camera, Sides

NOTHING = -1
PIXELS_AT_ONCE = 4_000_000
TOLERANCE = 1e-6  # pixels: those on an edge belong to both triangles
HORIZONTAL = 1e-9  # change of a weight in a pixel along the row of an edge that lies along it


class Surface(NamedTuple):
    """Triangles with smooth shading.

    Attributes
    ----------
    corners : (t, 3, 3) array
        Positions of the three corners of each.
    normals : (t, 3, 3) array
        Unit normals there; the side that is seen is lit, whichever it is.
    colours : (t, 3, 3) array
        Red, green and blue there, 0 to 1.
    """

    corners: Floats
    normals: Floats
    colours: Floats


class Spheres(NamedTuple):
    """Spheres: centers (n, 3), radii (n,) and colours (n, 3)."""

    centers: Floats
    radii: Floats
    colours: Floats


Thing: TypeAlias = Surface | Spheres


class Canvas:
    """What is nearest to the viewer in each pixel.

    Parameters
    ----------
    camera : Camera
    sides : (L_x, L_y), optional
        What of surfaces lies outside of 0 to L_x and 0 to L_y is cut off; spheres stay whole.

    Attributes
    ----------
    depth : (height, width) array
        Nearness in pixels, minus infinity where nothing is; row 0 is the lowest.
    owner : (height, width) array of int
        Number of the sphere, or the number of all spheres plus that of the triangle; `NOTHING`.
    """

    def __init__(
        self, camera: Camera, things: Sequence[Thing], sides: Sequence[float] | None = None
    ) -> None:
        self.camera = camera
        self.depth = np.full(camera.shape, -np.inf)
        self.owner = np.full(camera.shape, NOTHING, np.int32)
        self.sides = None if sides is None else Sides(camera, sides)
        none = np.zeros((0, 3))
        self.spheres = _together(things, Spheres(none, none[:, 0], none))
        self.surface = _together(things, Surface(*[none[:, None].repeat(3, axis=1)] * 3))
        self.centers = camera.project(self.spheres.centers)
        self.radii = self.spheres.radii * camera.scale
        corners = camera.project(self.surface.corners)
        self.weights = _weights(corners)
        self._draw_spheres()
        self._draw_surface(corners)

    def _draw_spheres(self) -> None:
        low = np.maximum(np.ceil(self.centers[:, :2] - self.radii[:, None]), 0)
        high = np.floor(self.centers[:, :2] + self.radii[:, None]) + 1
        high = np.minimum(high, self.camera.shape[::-1])
        seen = np.flatnonzero((high > low).all(axis=1)).tolist()
        (left, bottom), (right, top) = (ends.astype(int).T.tolist() for ends in (low, high))
        (x, y, z), radii = self.centers.T.tolist(), self.radii.tolist()
        pixels = np.arange(float(max(self.camera.shape)))
        for n in seen:
            place = slice(bottom[n], top[n]), slice(left[n], right[n])
            rows, columns = pixels[place[0], None], pixels[place[1]]
            rest = (radii[n] ** 2 - (rows - y[n]) ** 2) - (columns - x[n]) ** 2
            inside = rest >= 0
            half = np.sqrt(np.maximum(rest, 0.0, out=rest), out=rest)
            nearness = np.add(half, z[n], out=half)
            inside &= nearness > self.depth[place]
            np.copyto(self.depth[place], nearness, where=inside)
            np.copyto(self.owner[place], n, where=inside)

    def _draw_surface(self, corners: Floats) -> None:
        depths = np.einsum("tkc,tk->tc", self.weights, corners[..., 2])  # of column, row and 1
        cut = self._cut(self.surface.corners)
        depth, owner = self.depth.ravel(), self.owner.ravel()  # views
        for triangle, row, span, column in _spans(corners, self.weights, self.camera.shape):
            by_column, by_row, start = depths[triangle].T
            nearness = by_column[span] * column + (by_row * row + start)[span]
            pixel = (row * self.camera.shape[1])[span] + column
            if self.sides is not None:
                check = np.flatnonzero(cut[triangle][span])
                far, near = self.sides.limits(column[check], row[span[check]])
                outside = (nearness[check] < far) | (nearness[check] > near)
                nearness[check[outside]] = -np.inf
            np.maximum.at(depth, pixel, nearness)
            front = np.flatnonzero((depth[pixel] == nearness) & (nearness > -np.inf))
            owner[pixel[front]] = len(self.radii) + triangle[span[front]]

    def _cut(self, corners: Floats) -> Bools:
        """Which triangles (t, 3, 3) are not whole within the box."""
        if self.sides is None:
            return np.zeros(len(corners), bool)
        places = corners[..., :2]
        outside = (places < 0) | (places > self.sides.lengths)
        return np.asarray(outside.any(axis=(1, 2)))

    def places(self, every: int = 1) -> Floats:
        """Positions (k, 3) in space of what is seen in the pixels that are not empty.

        Only one of so many columns and rows is looked at.
        """
        row, column = every * np.stack(np.nonzero(self.owner[::every, ::every] != NOTHING))
        seen = np.column_stack([column, row, self.depth[row, column]]) / self.camera.scale
        seen[:, :2] += self.camera.origin
        return np.asarray(seen @ self.camera.axes)

    def looks(self, rows: slice) -> tuple[Floats, Floats]:
        """Normals, as the camera sees them, and colours (3, rows, width) of some rows."""
        owner = self.owner[rows]
        normal = np.zeros((3, *owner.shape), np.float32)
        colour = np.ones((3, *owner.shape), np.float32)

        row, column = np.nonzero((owner >= 0) & (owner < len(self.radii)))
        item = owner[row, column]
        place = np.stack([column, row + rows.start, self.depth[rows][row, column]])
        place = (place - self.centers.T[:, item]) / self.radii[item]
        normal[:, row, column] = place
        colour[:, row, column] = self.spheres.colours.T[:, item]

        row, column = np.nonzero(owner >= len(self.radii))
        item = owner[row, column] - len(self.radii)
        weights = self.weights[item]
        share = weights[..., 0] * column[:, None] + weights[..., 1] * (row + rows.start)[:, None]
        share += weights[..., 2]
        for found, values in ((normal, self.surface.normals), (colour, self.surface.colours)):
            found[:, row, column] = np.einsum("nk,nkc->cn", share, values[item])
        return normal, colour


def _together(things: Sequence[Thing], none: Any) -> Any:
    """All things of the kind of an empty one, as a single one."""
    chosen = [thing for thing in things if isinstance(thing, type(none))]
    return type(none)(*map(np.concatenate, zip(none, *chosen, strict=True)))


def _weights(corners: Floats) -> Floats:
    """Weights of the corners of triangles (t, 3, 3), as linear functions in pixels.

    Returns
    -------
    (t, 3, 3) array
        Of triangle and corner: its change from column to column and from row to row, and its
        value at column 0 and row 0. Not finite for a triangle that is seen from its side.
    """
    a = corners[:, 0, :2]
    ab, ac = (corners[:, k, :2] - a for k in (1, 2))
    change = np.stack([ac[:, 1], -ac[:, 0], -ab[:, 1], ab[:, 0]], axis=1).reshape(-1, 2, 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        change /= (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])[:, None, None]
    weights = np.empty((len(corners), 3, 3))
    weights[:, 1:, :2] = change
    weights[:, 1:, 2] = -(change * a[:, None]).sum(axis=2)
    weights[:, 0] = [0.0, 0.0, 1.0] - weights[:, 1] - weights[:, 2]
    return weights


def _spans(
    corners: Floats, weights: Floats, shape: tuple[int, int]
) -> Iterator[tuple[Ints, Ints, Ints, Ints]]:
    """Pixels within triangles, row by row.

    Yields
    ------
    triangle, row : (s,) arrays of int
        Of each span of pixels side by side.
    span, columns : (k,) arrays of int
        Of each pixel: its span and its column.
    """
    low, high = corners[:, :, 1].min(axis=1), corners[:, :, 1].max(axis=1)
    first = np.maximum(np.ceil(low - TOLERANCE), 0).astype(np.int64)
    last = np.minimum(np.floor(high + TOLERANCE), shape[0] - 1).astype(np.int64)
    last[~np.isfinite(weights[:, 1, 0])] = -1
    triangle, row = _ranges(first, last)
    left, right = np.full(len(row), -np.inf), np.full(len(row), np.inf)
    for k in range(3):
        change, along, start = weights[triangle, k].T
        with np.errstate(divide="ignore", invalid="ignore"):
            edge = -(along * row + start) / change
        np.copyto(left, np.maximum(left, edge), where=change > HORIZONTAL)
        np.copyto(right, np.minimum(right, edge), where=change < -HORIZONTAL)
    first = np.maximum(np.ceil(left - TOLERANCE), 0).astype(np.int64)
    last = np.minimum(np.floor(right + TOLERANCE), shape[1] - 1).astype(np.int64)
    portion = np.cumsum(np.maximum(last - first + 1, 0)) // PIXELS_AT_ONCE
    for n in np.unique(portion):
        part = np.flatnonzero((portion == n) & (last >= first))
        yield triangle[part], row[part], *_ranges(first[part], last[part])


def _ranges(first: Ints, last: Ints) -> tuple[Ints, Ints]:
    """All numbers from the first to the last of each range, and the range to which each belongs."""
    count = np.maximum(last - first + 1, 0)
    of = np.repeat(np.arange(len(count)), count)
    return of, np.arange(len(of)) + (first - np.cumsum(count) + count)[of]
