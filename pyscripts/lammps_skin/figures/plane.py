"""A moment in the plane: the maps of heights and of clones, and a vertical section."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PatchCollection, PolyCollection
from matplotlib.patches import Circle

from lammps_skin.analysis.geometry import images, minimum_image, wrapped
from lammps_skin.analysis.surface import height_field
from lammps_skin.arrays import Floats
from lammps_skin.figures.look import Look
from lammps_skin.figures.moments import Moment
from lammps_skin.kinds import Kind, is_cell

NODES_PER_SPACING = 2
PALE = 0.6  # share of white in the colour of what lies behind a section
ROUND = np.linspace(-np.pi / 2, np.pi / 2, 9)  # angles of the end of a rounded line


def draw_heights(axes: Axes, moment: Moment, show: Sequence[Kind]) -> ScalarMappable:
    """Map of the upper side of the membrane, with cells of some kinds; for a colour bar.

    Colours mean the same at all times of a run.
    """
    lx, ly = moment.box
    spacing = moment.scene.spacing / NODES_PER_SPACING
    height = height_field(moment.membrane, moment.triangles, moment.box, spacing)
    low, high = moment.relief
    image = axes.imshow(
        height.T, origin="lower", extent=(0, lx, 0, ly), cmap="cividis", interpolation="bilinear",
        vmin=low, vmax=high,
    )  # fmt: skip
    for kind in show:
        places, _ = images(wrapped(moment.of(kind), moment.box), moment.box, 1.0)
        x, y = places.T[:2]
        axes.scatter(x, y, s=45, color=[kind.colour], edgecolors="black", linewidths=0.8)
    axes.set(xlim=(0, lx), ylim=(0, ly), xlabel="x", ylabel="y")
    return image


def draw_cells_from_above(axes: Axes, moment: Moment, show: Sequence[Kind], look: Look) -> None:
    """Map of cells of some kinds, those that are higher in front; stem cells have a thick edge."""
    cells = is_cell(moment.kinds)
    chosen = np.isin(moment.kinds[cells], show)
    kinds, colours = moment.kinds[cells][chosen], look.of_cells(moment)[chosen]
    radius = moment.scene.cells.radius
    places, index = images(wrapped(moment.positions[cells][chosen], moment.box), moment.box, radius)
    order = np.argsort(places[:, 2])
    stem = kinds[index[order]] == Kind.STEM
    discs = [Circle((x, y), radius) for x, y, _ in places[order]]
    axes.add_collection(
        PatchCollection(discs, facecolor=colours[index[order]], edgecolor="black", linewidth=0.3)
    )
    edges = [disc for disc, thick in zip(discs, stem, strict=True) if thick]
    axes.add_collection(PatchCollection(edges, facecolor="none", edgecolor="black", linewidth=2.0))
    lx, ly = moment.box
    axes.set(xlim=(0, lx), ylim=(0, ly), aspect="equal", xlabel="x", ylabel="y")


# ---- the section


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


def draw_section(axes: Axes, moment: Moment, y: float, show: Sequence[Kind], look: Look) -> None:
    """Vertical section, seen along y, and as far as the diameter of a cell behind it.

    Membrane, dermis and cells that the plane cuts are drawn as it cuts them: those whose centers
    are nearest to it in front, and stem cells before all others, each joined with the membrane
    particle that is its partner. Cells behind the plane are pale.
    """
    lx = moment.box[0]
    cells, colours, radius = _cells_near(moment, y, show, look)
    off = cells[:, 1]
    behind = np.flatnonzero(off > 0)
    behind = behind[np.argsort(-off[behind])]
    _add_circles(
        axes, cells[behind], np.full(len(behind), radius),
        colours[behind] + PALE * (1 - colours[behind]), edgecolor="0.7", linewidth=0.4,
    )  # fmt: skip
    low, high = moment.heights
    bottom = 0.0 if moment.scene.dermis.present else low
    lines = section_lines(moment, y)
    lines = np.concatenate([lines + np.array([shift, 0]) for shift in (-lx, 0, lx)])
    if moment.scene.dermis.present:
        _fill_below(axes, lines, bottom)
        centers, radii = section_circles(moment, y, Kind.DERMAL)
        flat = np.insert(centers, 1, 0.0, axis=1)
        places, index = images(flat, moment.box, radii)
        alone = places[:, 1] == 0.0
        _add_circles(
            axes, places[alone], radii[index[alone]], Kind.DERMAL.colour, edgecolor="0.65",
            linewidth=0.4,
        )  # fmt: skip
    _add_membrane(axes, lines, moment.scene.membrane.radius)
    cut = np.flatnonzero(np.abs(off) < radius)
    cut = cut[np.argsort(-np.abs(off[cut]))]
    stem = cells[cut, 3] == Kind.STEM
    cut = np.concatenate([cut[~stem], cut[stem]])
    widths = np.where(cells[cut, 3] == Kind.STEM, 1.6, 0.6).tolist()
    faces = np.sqrt(radius**2 - off[cut] ** 2)
    _add_circles(axes, cells[cut], faces, colours[cut], edgecolor="black", linewidth=widths)
    if Kind.STEM in show:
        _mark_partners(axes, moment, y)
    axes.set(xlim=(0, lx), ylim=(bottom, high), aspect="equal", xlabel="x", ylabel="z")
    axes.set_title(f"section at y = {y:.4g}, t = {moment.time:g}")


def highest_stem(moment: Moment) -> float:
    """y of the highest stem cell; of the middle of the box without any."""
    stem = wrapped(moment.of(Kind.STEM), moment.box)
    return float(stem[stem[:, 2].argmax(), 1]) if len(stem) else moment.box[1] / 2


def _cells_near(
    moment: Moment, y: float, show: Sequence[Kind], look: Look
) -> tuple[Floats, Floats, float]:
    """Cells from a radius before the plane to a diameter behind it, with images over its ends.

    Returns
    -------
    cells : (k, 4) array
        x, distance behind the plane, z and kind.
    colours : (k, 3) array
    radius : float
    """
    of_cells = is_cell(moment.kinds)
    radius = moment.scene.cells.radius
    places = wrapped(moment.positions[of_cells], moment.box)
    places[:, 1] = minimum_image(places - [0, y, 0], moment.box)[:, 1]
    kinds = moment.kinds[of_cells]
    near = (places[:, 1] > -radius) & (places[:, 1] < 2 * radius) & np.isin(kinds, show)
    rows = np.column_stack([places, kinds])[near]
    found = [rows + np.array([shift, 0, 0, 0]) for shift in (-moment.box[0], 0.0, moment.box[0])]
    return np.concatenate(found), np.tile(look.of_cells(moment)[near], (3, 1)), radius


def _add_circles(
    axes: Axes, places: Floats, radii: Floats, colours: Floats | tuple[float, ...],
    edgecolor: str, linewidth: float | list[float],
) -> None:  # fmt: skip
    """Circles around x and z of places (k, 3 or 4), the last in front."""
    circles = [Circle((p[0], p[2]), r) for p, r in zip(places, radii, strict=True)]
    axes.add_collection(
        PatchCollection(circles, facecolor=colours, edgecolor=edgecolor, linewidth=linewidth)
    )


def _fill_below(axes: Axes, lines: Floats, bottom: float) -> None:
    """Pale ground below the segments (s, 2, 2) of the membrane."""
    floor = lines[:, ::-1].copy()
    floor[..., 1] = bottom
    ground = 1 - 0.5 * (1 - np.array(Kind.DERMAL.colour))
    axes.add_collection(
        PolyCollection(
            list(np.concatenate([lines, floor], axis=1)), facecolor=ground, edgecolor=ground
        )
    )


def _add_membrane(axes: Axes, lines: Floats, radius: float) -> None:
    """The segments (s, 2, 2) of the membrane as a band: all that is within a radius of them."""
    along = lines[:, 1] - lines[:, 0]
    angle = np.arctan2(along[:, 1], along[:, 0])[:, None]
    ends = [
        lines[:, end, None] + radius * np.stack([np.cos(turned), np.sin(turned)], axis=-1)
        for end, turned in ((1, angle + ROUND), (0, angle + np.pi + ROUND))
    ]
    band = list(np.concatenate(ends, axis=1))
    for colour, width in (((0.1, 0.1, 0.1), 1.6), (Kind.MEMBRANE.colour, 0.0)):
        axes.add_collection(
            PolyCollection(band, facecolor=colour, edgecolor=colour, linewidth=width)
        )


def _mark_partners(axes: Axes, moment: Moment, y: float) -> None:
    """Line from each stem cell that the plane cuts to the membrane particle that it is bound to."""
    ends = []
    stem = np.flatnonzero(moment.kinds == Kind.STEM)
    rows = np.searchsorted(moment.ids, moment.state["partner"][stem])
    for cell, row in zip(stem, rows, strict=True):
        place = wrapped(moment.positions[cell], moment.box)
        off = minimum_image(place - [0, y, 0], moment.box)[1]
        if abs(off) < moment.scene.cells.radius and moment.state["partner"][cell] > 0:
            to_partner = minimum_image(moment.positions[row] - moment.positions[cell], moment.box)
            ends.append(np.stack([place, place + to_partner])[:, [0, 2]])
    axes.add_collection(LineCollection(ends, colors="black", linewidths=1.2))
    if ends:
        axes.plot(*np.concatenate(ends).T, "o", color="black", markersize=3, linestyle="none")
