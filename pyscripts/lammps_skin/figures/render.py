"""Pictures of surfaces and spheres, drawn in numpy: no display, no graphics library.

The projection is parallel. A depth buffer finds what is in front; a light from the upper left
with shadows, and darker hollows, give the eye the third dimension. A surface may be cut by the
sides of a box.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.figures.camera import Camera
from lammps_skin.figures.raster import NOTHING, Canvas, Thing

OVERSAMPLING = 2  # pixels drawn for each of the picture, along a side
LIGHT = np.array([-0.50, 0.42, 0.75])  # towards it: right, up (away from the plane), viewer
AMBIENT, DIFFUSE, SHINE = 0.50, 0.60, 0.10
GLOSS = 5  # halvings of the size of a highlight
DEEPEST_SHADOW = 0.75  # of the diffuse light that it takes away
ROWS_AT_ONCE = 32 * OVERSAMPLING  # lit together: what they need fits into a cache
HOLLOW_BLOCKS = 3  # for each distance within which hollows are looked for
SPARSE = 8  # pixels of which one tells where a shadow may fall

# Where the shadow of a pixel is looked for: each of the 2 x 2 pixels that are drawn for one of the
# picture looks at two of the eight places around it.
AROUND = np.array(
    [[[(-1, -1), (1, 0)], [(0, -1), (-1, 1)]], [[(1, -1), (0, 1)], [(-1, 0), (1, 1)]]], np.float32
)


def picture(
    things: Sequence[Thing], camera: Camera, roughness: float, sides: Sequence[float] | None = None
) -> Floats:
    """Picture of lit surfaces and spheres on white.

    Parameters
    ----------
    things : sequence of Surface and Spheres
    camera : Camera
        Of the picture.
    roughness : float
        Size of the hollows that are to be dark, length.
    sides : (L_x, L_y), optional
        What of surfaces lies outside of 0 to L_x and 0 to L_y is cut off.

    Returns
    -------
    (height, width, 3) array
        Red, green and blue, 0 to 1; the top row first.
    """
    canvas = Canvas(camera.finer(OVERSAMPLING), things, sides)
    image = np.ones((*camera.shape, 3), np.float32)
    if (canvas.owner == NOTHING).all():
        return np.asarray(image, np.float64)
    light = LIGHT * [1, 1 if camera.axes[2, 2] >= 0 else -1, 1] / np.linalg.norm(LIGHT)
    halfway = light + np.array([0, 0, 1])
    halfway /= np.linalg.norm(halfway)
    shadow = Shadow(canvas, things, light, roughness, sides)
    hollows = hollow(canvas.depth, roughness * canvas.camera.scale)

    for start in range(0, len(canvas.owner), ROWS_AT_ONCE):
        rows = slice(start, min(start + ROWS_AT_ONCE, len(canvas.owner)))
        normal, colour = canvas.looks(rows)
        normal /= np.sqrt((normal**2).sum(axis=0)) * np.where(normal[2] < 0, -1, 1) + 1e-9
        lit = 1 - DEEPEST_SHADOW * shadow.of(rows)
        toward_light, shine = (
            np.maximum(np.tensordot(way.astype(np.float32), normal, 1), 0.0)
            for way in (light, halfway)
        )
        for _ in range(GLOSS):
            shine *= shine
        bright = AMBIENT * np.exp(-0.8 * hollows[rows]) + DIFFUSE * toward_light * lit
        shown = np.clip(colour * bright + SHINE * shine * lit, 0, 1)
        shown[:, canvas.owner[rows] == NOTHING] = 1.0
        blocks = shown.reshape(3, -1, OVERSAMPLING, camera.shape[1], OVERSAMPLING)
        part = slice(rows.start // OVERSAMPLING, rows.stop // OVERSAMPLING)
        image[part] = blocks.mean(axis=(2, 4)).transpose(1, 2, 0)
    return np.asarray(image[::-1], np.float64)


class Shadow:
    """What the light does not reach: a depth buffer as the light sees it.

    Parameters
    ----------
    canvas : Canvas
        What the viewer sees.
    things : sequence of Surface and Spheres
    light : (3,) array
        Unit vector towards the light, as the camera sees it.
    roughness : float
    sides : (L_x, L_y) or None
    """

    def __init__(
        self, canvas: Canvas, things: Sequence[Thing], light: Floats, roughness: float,
        sides: Sequence[float] | None,
    ) -> None:  # fmt: skip
        toward = light @ canvas.camera.axes
        across = np.cross([0.0, 0.0, 1.0], toward)
        across /= np.linalg.norm(across)
        axes = np.stack([across, np.cross(toward, across), toward])
        width = canvas.camera.shape[1] // OVERSAMPLING
        self.canvas = canvas
        places, around = canvas.places(SPARSE), SPARSE / canvas.camera.scale
        corners = np.concatenate([places - around, places + around])
        self.camera = Camera.looking(axes, corners, width)
        self.nearest = Canvas(self.camera, things, sides).depth.astype(np.float32)
        self.clearance = 0.25 * roughness * self.camera.scale
        offsets = 0.12 * roughness * self.camera.scale * AROUND
        tiles = ROWS_AT_ONCE // OVERSAMPLING, width, 1, 1
        self.offsets = np.tile(offsets, tiles).transpose(2, 3, 0, 1)

    def of(self, rows: slice) -> Floats:
        """How much of the light is kept from each pixel of some rows, with soft edges."""
        depth = self.canvas.depth[rows]
        row, column = np.ogrid[rows, : depth.shape[1]]
        places = column, row, np.where(depth > -np.inf, depth, 0.0)
        seen = self.canvas.camera
        turn = self.camera.axes @ seen.axes.T * self.camera.scale / seen.scale
        start = self.camera.scale * (
            self.camera.axes @ seen.axes[:2].T @ seen.origin - [*self.camera.origin, 0.0]
        )
        x, y, nearness = (
            sum((turn[k, a] * places[a] for a in range(3)), start[k]).astype(np.float32)
            for k in range(3)
        )
        nearness += self.clearance
        shade = np.zeros(depth.shape, np.float32)
        high, wide = self.camera.shape
        for right, up in self.offsets[..., : len(depth), :]:
            column = np.clip(np.rint(x + right), 0, wide - 1).astype(np.int32)
            row = np.clip(np.rint(y + up), 0, high - 1).astype(np.int32)
            shade += self.nearest[row, column] > nearness
        return shade / len(self.offsets)


def hollow(depth: Floats, reach: float) -> Floats:
    """How far each pixel lies behind its surroundings.

    Parameters
    ----------
    depth : (h, w) array
        Nearness in pixels, minus infinity where nothing is.
    reach : float
        Standard deviation in pixels of the Gaussian weights of the surroundings.

    Returns
    -------
    (h, w) array
        In units of the reach, 0 where the surroundings are not nearer.
    """
    size = max(1, int(reach / HOLLOW_BLOCKS))
    seen = depth > -np.inf
    starts = [np.arange(0, side, size) for side in depth.shape]
    nearness, number = (
        np.add.reduceat(np.add.reduceat(values, starts[0], axis=0), starts[1], axis=1)
        for values in (np.where(seen, depth, 0.0), seen.astype(float))
    )
    down, along = (
        _gaussian(np.arange(side)[:, None] - (start + (size - 1) / 2), reach)
        for side, start in zip(depth.shape, starts, strict=True)
    )
    mean, weight = (
        (down @ blocks).astype(np.float32) @ along.T.astype(np.float32)
        for blocks in (nearness, number)
    )
    mean /= np.maximum(weight, 1e-9)
    return np.asarray(np.maximum(np.where(seen, mean - depth, 0.0), 0.0) / reach, np.float64)


def _gaussian(distance: Floats, reach: float) -> Floats:
    """Weights at distances, none beyond twice the reach."""
    weights = np.exp(-0.5 * (distance / reach) ** 2)
    return np.asarray(np.where(np.abs(distance) <= 2 * reach, weights, 0.0))
