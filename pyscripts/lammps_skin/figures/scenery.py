"""Three-dimensional pictures of the membrane and its cells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lammps_skin.analysis.geometry import minimum_image, wrapped
from lammps_skin.arrays import Floats
from lammps_skin.figures.moments import Moment
from lammps_skin.figures.render import Spheres, Surface, picture
from lammps_skin.kinds import Kind

AZIMUTH, ABOVE, BELOW = -62.0, 42.0, -42.0  # degrees: where the viewer stands


def membrane_surface(moment: Moment) -> Surface:
    """The membrane in one box, cut off straight at its sides, with smooth normals."""
    membrane, triangles = moment.membrane, moment.triangles
    a = wrapped(membrane[triangles[:, 0]], moment.box)
    edges = [membrane[triangles[:, n]] - membrane[triangles[:, 0]] for n in (1, 2)]
    ab, ac = (minimum_image(edge, moment.box) for edge in edges)
    normals = np.zeros_like(membrane)
    np.add.at(normals, triangles, np.cross(ab, ac)[:, None])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)

    corners, of = [], []
    sides = np.array([*moment.box, np.inf])
    for i, j in np.ndindex(3, 3):
        image = np.stack([a, a + ab, a + ac], axis=1)
        image[..., :2] += (np.array([i, j]) - 1) * sides[:2]
        inside = ((image.max(axis=1) > 0) & (image.min(axis=1) < sides))[:, :2].all(axis=1)
        corners.append(np.clip(image[inside], [0, 0, -np.inf], sides))
        of.append(normals[triangles[inside]])
    return Surface(np.concatenate(corners), np.concatenate(of), np.array(Kind.MEMBRANE.colour))


def cell_spheres(moment: Moment, show: Sequence[Kind]) -> Spheres:
    """The cells of some kinds in one box, at their radius R_c."""
    chosen = np.isin(moment.kinds, show)
    centers = wrapped(moment.positions[chosen], moment.box)
    kinds = moment.kinds[chosen].tolist()
    colours = np.array([moment.scene.kind(kind).colour for kind in kinds]).reshape(-1, 3)
    return Spheres(centers, np.full(len(centers), moment.scene.cells.radius), colours)


def view(moment: Moment, show: Sequence[Kind], width: int, below: bool = False) -> Floats:
    """Picture (height, width, 3) of a moment, from above or from the dermis below it.

    Parameters
    ----------
    moment : Moment
    show : sequence of Kind
        Kinds of cells to draw.
    width : int
        Pixels.
    below : bool
        Whether the viewer stands in the dermis, which is not drawn.
    """
    surface, spheres = membrane_surface(moment), cell_spheres(moment, show)
    frame = _frame(moment, spheres)
    elevation = BELOW if below else ABOVE
    things: list[Surface | Spheres] = [surface, spheres]
    return picture(things, frame, AZIMUTH, elevation, width, moment.scene.cells.radius)


def _frame(moment: Moment, spheres: Spheres) -> Floats:
    """Corners (8, 3) of a box that holds the membrane and, whole, the cells that are drawn."""
    reach = spheres.radii[:, None]
    around = np.concatenate([moment.membrane, spheres.centers - reach, spheres.centers + reach])
    low, high = around.min(axis=0), around.max(axis=0)
    low[:2], high[:2] = np.minimum(low[:2], 0.0), np.maximum(high[:2], moment.box[:2])
    return np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
