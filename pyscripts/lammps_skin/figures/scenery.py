"""Three-dimensional pictures of the membrane and its cells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lammps_skin.analysis.geometry import images, minimum_image, wrapped
from lammps_skin.arrays import Floats
from lammps_skin.figures.camera import Camera, axes_of
from lammps_skin.figures.look import Look
from lammps_skin.figures.moments import Moment
from lammps_skin.figures.raster import Spheres, Surface
from lammps_skin.figures.render import picture
from lammps_skin.kinds import Kind, is_cell

ABOVE = 42.0  # degrees: where the viewer stands, or as far below


def membrane_surface(moment: Moment, look: Look) -> Surface:
    """The membrane with smooth normals: all triangles that reach into the box."""
    membrane, triangles = moment.membrane, moment.triangles
    a = wrapped(membrane[triangles[:, 0]], moment.box)
    edges = [membrane[triangles[:, n]] - membrane[triangles[:, 0]] for n in (1, 2)]
    ab, ac = (minimum_image(edge, moment.box) for edge in edges)
    normals = np.zeros_like(membrane)
    np.add.at(normals, triangles, np.cross(ab, ac)[:, None])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    colours = look.of_membrane(moment)
    if colours is None:
        colours = np.broadcast_to(Kind.MEMBRANE.colour, membrane.shape)

    reach = np.abs([ab, ac])[..., :2].max(axis=(0, 2))
    first, index = images(a, moment.box, reach)
    corners = np.stack([first, first + ab[index], first + ac[index]], axis=1)
    return Surface(corners, normals[triangles[index]], colours[triangles[index]])


def cell_spheres(moment: Moment, show: Sequence[Kind], look: Look) -> Spheres:
    """The cells of some kinds, each once and whole, at their radius R_c."""
    cells = is_cell(moment.kinds)
    chosen = np.isin(moment.kinds[cells], show)
    radius = moment.scene.cells.radius
    centers = wrapped(moment.positions[cells][chosen], moment.box)
    return Spheres(centers, np.full(len(centers), radius), look.of_cells(moment)[chosen])


def camera_of(moment: Moment, look: Look, below: bool = False) -> Camera:
    """The camera of all pictures of a run that look alike, from above or from the dermis."""
    elevation = look.elevation
    if elevation is None:
        elevation = -ABOVE if below else ABOVE
    (wide, deep), radius = moment.box, moment.scene.cells.radius
    ends = [-radius, wide + radius], [-radius, deep + radius], moment.heights
    corners = np.stack(np.meshgrid(*ends), axis=-1).reshape(-1, 3)
    return Camera.looking(axes_of(look.azimuth, elevation), corners, look.size, look.zoom)


def view(moment: Moment, show: Sequence[Kind], look: Look, below: bool = False) -> Floats:
    """Picture (height, width, 3) of a moment, from above or from the dermis below it.

    Parameters
    ----------
    moment : Moment
    show : sequence of Kind
        Kinds of cells to draw.
    look : Look
    below : bool
        Whether the viewer stands in the dermis, which is not drawn.
    """
    shifted = moment.shifted(look.shift)
    things = membrane_surface(shifted, look), cell_spheres(shifted, show, look)
    camera = camera_of(moment, look, below)
    return picture(things, camera, moment.scene.cells.radius, moment.box)
