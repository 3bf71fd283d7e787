"""A moment in the plane: the map of heights, and a vertical section."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.patches import Circle

from lammps_skin.analysis.geometry import minimum_image, wrapped
from lammps_skin.analysis.surface import height_field
from lammps_skin.arrays import Floats
from lammps_skin.figures.moments import Moment
from lammps_skin.kinds import Kind

NODES_PER_SPACING = 2


def draw_heights(axes: Axes, moment: Moment, show: Sequence[Kind]) -> ScalarMappable:
    """Map of the upper side of the membrane, with cells of some kinds; for a colour bar."""
    lx, ly = moment.box
    spacing = moment.scene.spacing / NODES_PER_SPACING
    height = height_field(moment.membrane, moment.triangles, moment.box, spacing)
    image = axes.imshow(
        height.T, origin="lower", extent=(0, lx, 0, ly), cmap="pink", interpolation="bilinear"
    )
    for kind in show:
        x, y, _ = wrapped(moment.of(kind), moment.box).T
        axes.scatter(x, y, s=45, color=[kind.colour], edgecolors="black", linewidths=0.8)
    axes.set(xlim=(0, lx), ylim=(0, ly), xlabel="x", ylabel="y")
    return image


def section_lines(moment: Moment, y: float) -> Floats:
    """Where the membrane meets the plane of a y: segments (s, 2, 2) of x and z."""
    a = moment.membrane[moment.triangles[:, 0]]
    edges = [moment.membrane[moment.triangles[:, n]] - a for n in (1, 2)]
    a = minimum_image(a - [0, y, 0], moment.box)
    a[:, 0] %= moment.box[0]
    corners = np.stack([a, *(a + minimum_image(edge, moment.box) for edge in edges)], axis=1)
    above = corners[..., 1] > 0
    corners = corners[above.any(axis=1) & ~above.all(axis=1)]
    above = corners[..., 1] > 0
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    rows = np.arange(len(corners))
    tip = corners[rows, alone]
    ends = []
    for turn in (1, 2):
        other = corners[rows, (alone + turn) % 3]
        part = tip[:, 1] / (tip[:, 1] - other[:, 1])
        ends.append(tip + part[:, None] * (other - tip))
    return np.stack(ends, axis=1)[..., [0, 2]]


def section_circles(moment: Moment, y: float, kind: Kind) -> tuple[Floats, Floats]:
    """Spheres of a kind cut by the plane of a y: centers (k, 2) in x and z, and radii (k,)."""
    dermal = kind == Kind.DERMAL
    radius = moment.scene.dermis.radius if dermal else moment.scene.cells.radius
    centers = wrapped(moment.of(kind), moment.box)
    off = minimum_image(centers - [0, y, 0], moment.box)[:, 1]
    cut = np.abs(off) < radius
    return centers[cut][:, [0, 2]], np.sqrt(radius**2 - off[cut] ** 2)


def draw_section(axes: Axes, moment: Moment, y: float, show: Sequence[Kind]) -> None:
    """Vertical section: membrane, dermis and cells of some kinds."""
    for kind in (Kind.DERMAL, *show):
        centers, radii = section_circles(moment, y, kind)
        circles = [Circle((x, z), r) for (x, z), r in zip(centers, radii, strict=True)]
        edge = "0.6" if kind == Kind.DERMAL else "black"
        axes.add_collection(
            PatchCollection(circles, facecolor=kind.colour, edgecolor=edge, linewidth=0.4)
        )
    axes.add_collection(LineCollection(list(section_lines(moment, y)), colors="0.1", linewidths=2))
    top = moment.positions[moment.kinds != Kind.DERMAL, 2].max() + 2 * moment.scene.cells.radius
    bottom = 0.0 if moment.scene.dermis.present else moment.membrane[:, 2].min() - 2
    axes.set(xlim=(0, moment.box[0]), ylim=(bottom, top), aspect="equal", xlabel="x", ylabel="z")
    axes.set_title(f"section at y = {y:.4g}")


def highest_stem(moment: Moment) -> float:
    """y of the highest stem cell; of the middle of the box without any."""
    stem = wrapped(moment.of(Kind.STEM), moment.box)
    return float(stem[stem[:, 2].argmax(), 1]) if len(stem) else moment.box[1] / 2
