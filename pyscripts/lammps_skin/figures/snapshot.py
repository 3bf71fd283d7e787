"""Snapshots of a run: three-dimensional, as maps, as a vertical section, as a tree."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from lammps_skin.errors import FigureError
from lammps_skin.figures.lineage_tree import draw_lineage
from lammps_skin.figures.look import COLOURINGS, Look
from lammps_skin.figures.moments import Moment, Source, read_moments
from lammps_skin.figures.plane import (
    draw_cells_from_above,
    draw_heights,
    draw_section,
    highest_stem,
)
from lammps_skin.figures.scenery import camera_of, view
from lammps_skin.files import atomic_write
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import near
from lammps_skin.style import dots, name_panels, plain
from lammps_skin.text import counted

NONE = "none"  # word for no cells
STRIP, BAR = 0.34, 0.75  # of a title or a legend, of colours that stand for numbers: inches
SCALE_BAR = 0.25  # of the width of a picture, at most
CELLS_LONG = (1, 2, 5, 10, 20, 50, 100)  # a scale bar, diameters of a cell


class Shown(NamedTuple):
    """What a snapshot shows: kinds of cells, place of the section, look."""

    kinds: tuple[Kind, ...]
    y: float
    look: Look


def kinds_of(scene: Scene, show: Sequence[str] | None) -> tuple[Kind, ...]:
    """Kinds of cells of a scene by their labels; "ta" are the exhausted, too; None is all."""
    labels = [kind.label for kind in scene.kinds_of_cells]
    show = labels if show is None else show
    if list(show) == [NONE]:
        return ()
    unknown = [word for word in show if word not in labels]
    if unknown or not show:
        guess = near(unknown[0], labels) if unknown else ""
        raise FigureError(
            f"show = {','.join(show)!r}: must be some of {', '.join(labels)}, or {NONE}{guess}"
        )
    words = {*show, *([Kind.EXHAUSTED.label] if Kind.TA.label in show else [])}
    return tuple(kind for kind in scene.kinds_of_cells if kind.label in words)


def on_map(scene: Scene) -> tuple[Kind, ...]:
    """Kinds of cells on a map of heights: stem and ND cells, and others that are bound."""
    table = scene.cell_table.values()
    old = Kind.STEM, Kind.ND
    return tuple(row.kind for row in table if row.kind in old or row.adhesion == "bound")


def draw_view(
    axes: Axes, moment: Moment, kinds: Sequence[Kind], look: Look, below: bool = False
) -> None:
    """The picture in three dimensions, with its time."""
    image = np.ascontiguousarray(np.rint(255 * view(moment, kinds, look, below)).astype(np.uint8))
    axes.imshow(image, interpolation="antialiased")
    axes.set_axis_off()
    axes.set_title(f"t = {moment.time:g}" + (", from the dermis" if below else ""))
    if look.scale_bar:
        pixels = 2 * moment.scene.cells.radius * camera_of(moment, look, below).scale
        _add_scale_bar(axes, moment, pixels, image.shape[1], image.shape[0])


def legend(figure: Figure, moment: Moment, kinds: Sequence[Kind]) -> None:
    """Names of the kinds of cells that there are."""
    there = [kind for kind in kinds if kind in moment.kinds]
    patches = [
        Patch(facecolor=kind.colour, edgecolor="0.3", label=kind.name)
        for kind in there
    ]
    if patches:
        outside = figure.get_layout_engine() is not None
        figure.legend(
            handles=patches, loc="outside lower center" if outside else "lower center",
            ncols=len(there), frameon=False,
        )  # fmt: skip


def _heights(axes: Axes, moment: Moment, shown: Shown) -> None:
    kinds = [kind for kind in shown.kinds if kind in on_map(moment.scene)]
    image = draw_heights(axes, moment.shifted(shown.look.shift), kinds)
    axes.set_title(f"height of the membrane, t = {moment.time:g}")
    assert axes.figure is not None
    axes.figure.colorbar(image, ax=axes, label="height z", shrink=0.8)
    _add_bar_of_lengths(axes, moment, shown.look)


def _section(axes: Axes, moment: Moment, shown: Shown) -> None:
    draw_section(axes, moment.shifted(shown.look.shift), shown.y, shown.kinds, shown.look)
    _add_bar_of_lengths(axes, moment, shown.look)


def _clones(axes: Axes, moment: Moment, shown: Shown) -> None:
    look = shown.look if shown.look.colour_by != "kind" else shown.look.by_clone()
    draw_cells_from_above(axes, moment.shifted(look.shift), shown.kinds, look)
    axes.set_title(f"cells by {look.colour_by}, t = {moment.time:g}")
    _add_bar_of_lengths(axes, moment, look)


class View(NamedTuple):
    """A way to draw a moment; the height of its figure over its width."""

    draw: Callable[[Axes, Moment, Shown], None]
    tall: float = 0.8


VIEWS = {
    "3d": View(lambda axes, moment, shown: draw_view(axes, moment, shown.kinds, shown.look)),
    "below": View(
        lambda axes, moment, shown: draw_view(axes, moment, shown.kinds, shown.look, below=True)
    ),
    "height": View(_heights),
    "section": View(_section, 0.6),
    "clones": View(_clones, 0.95),
    "lineage": View(lambda axes, moment, shown: draw_lineage(axes, moment, shown.look), 0.6),
}
TOGETHER = ("3d", "below", "height", "section")  # in the view "all"
ALONE = ("3d", "below")  # drawn pixel by pixel in a figure of their own
BY_KIND = ("3d", "below", "height", "section")  # cells have colours of their kinds


@plain
def snapshot(
    source: Source, time: float | None, path: str | Path, view: str = "3d",
    show: Sequence[str] | None = None, y: float | None = None, look: Look | None = None,
) -> Path:  # fmt: skip
    """Write a picture of a run at a time.

    Parameters
    ----------
    source : path or Universe
        Of a run, see `read_moments`.
    time : float or None
        The frame nearest to it is drawn; None is the last, or the present one of a Universe.
    path : path
        File to write; its suffix gives the format.
    view : str
        One of `VIEWS`, or "all" for those of `TOGETHER`.
    show : sequence of str, optional
        Labels of the kinds of cells to draw, all if not given, none for ["none"]; "ta" are the
        exhausted, too. On the map of heights are only those of them that are bound.
    y : float, optional
        Of the section; through the highest stem cell if not given.
    look : Look, optional
        Camera, colours, size.

    Raises
    ------
    FigureError
        If there is no such frame, view or kind of cell, or if the file cannot be written.
    """
    check_view(view)
    check_output(path)
    (moment,) = read_moments(source, [time])
    look = look or Look()
    return save(figure_of(moment, view, shown_of(moment, show, y, look)), path)


def check_view(view: str) -> None:
    """Raise `FigureError` unless there is such a view."""
    if view != "all" and view not in VIEWS:
        raise FigureError(
            f"view = {view!r}: must be one of {', '.join(VIEWS)}, all{near(view, [*VIEWS, 'all'])}"
        )


def shown_of(moment: Moment, show: Sequence[str] | None, y: float | None, look: Look) -> Shown:
    """What is shown of a moment, with the place of the section where none is given."""
    if y is not None and not 0 <= y <= moment.box[1]:
        raise FigureError(f"y = {y:g}: must be from 0 to L_y = {moment.box[1]:g}")
    place = highest_stem(moment.shifted(look.shift)) if y is None else y
    return Shown(kinds_of(moment.scene, show), place, look)


@plain
def figure_of(moment: Moment, view: str, shown: Shown) -> Figure:
    """Figure of a moment in a view."""
    if view in ALONE:
        return _alone(moment, view, shown)
    look = shown.look
    names = TOGETHER if view == "all" else (view,)
    across = 2 if view == "all" else 1
    tall = 0.8 if view == "all" else VIEWS[view].tall
    pixels = across * look.size
    dpi = dots(pixels, look.dpi)
    inches = pixels / dpi
    figure = Figure(figsize=(inches, inches * tall), layout="constrained", dpi=dpi)
    panels = [figure.add_subplot(across, across, n + 1) for n in range(len(names))]
    for name, axes in zip(names, panels, strict=True):
        VIEWS[name].draw(axes, moment, shown)
    name_panels(panels)
    colours = look.colours(moment)
    if colours is not None and view not in ("height", "lineage"):
        figure.colorbar(
            colours, ax=panels, label=COLOURINGS[look.colour_by].label, extend="both", shrink=0.7,
            location="bottom", aspect=40,
        )  # fmt: skip
    if view in ("all", *BY_KIND) and _by_kind(look):
        legend(figure, moment, on_map(moment.scene) if view == "height" else shown.kinds)
    return figure


def _alone(moment: Moment, view: str, shown: Shown) -> Figure:
    """A picture in three dimensions, pixel by pixel, between its title and what colours mean."""
    look = shown.look
    high, wide = camera_of(moment, look).shape
    colours = look.colours(moment)
    by_kind = _by_kind(look) and any(kind in moment.kinds for kind in shown.kinds)
    dpi = dots(wide, look.dpi)
    top, bar, names = (
        round(dpi * inches) for inches in (STRIP, 0 if colours is None else BAR, STRIP * by_kind)
    )
    pixels = high + top + bar + names
    figure = Figure(figsize=(wide / dpi, pixels / dpi), dpi=dpi)
    axes = figure.add_axes((0, (bar + names) / pixels, 1, high / pixels))
    VIEWS[view].draw(axes, moment, shown)
    if colours is not None:
        place = figure.add_axes((0.2, (names + 0.72 * bar) / pixels, 0.6, 0.18 * bar / pixels))
        label = COLOURINGS[look.colour_by].label
        figure.colorbar(colours, cax=place, label=label, extend="both", orientation="horizontal")
    if by_kind:
        legend(figure, moment, shown.kinds)
    return figure


def _by_kind(look: Look) -> bool:
    colouring = COLOURINGS.get(look.colour_by)
    return look.colour_by == "kind" or (colouring is not None and not colouring.of_cells)


def _add_bar_of_lengths(axes: Axes, moment: Moment, look: Look) -> None:
    if look.scale_bar:
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        diameter = 2 * moment.scene.cells.radius
        _add_scale_bar(axes, moment, diameter, right - left, bottom - top)


def _add_scale_bar(axes: Axes, moment: Moment, diameter: float, wide: float, high: float) -> None:
    """A bar of some diameters of a cell at the lower left of axes of a width and a height."""
    fitting = [n for n in CELLS_LONG if n * diameter <= SCALE_BAR * wide]
    count = fitting[-1] if fitting else 1
    length = count * 2 * moment.scene.cells.radius
    left, bottom = axes.get_xlim()[0], axes.get_ylim()[0]
    x, y = left + 0.03 * wide, bottom - 0.04 * high
    axes.plot([x, x + count * diameter], [y, y], color="black", linewidth=3, solid_capstyle="butt")
    axes.text(
        x, y - 0.015 * high, f"{counted(count, 'cell diameter')} ({length:g})", va="bottom",
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.6, "pad": 1},
    )  # fmt: skip
    axes.set(xlim=axes.get_xlim(), ylim=axes.get_ylim())


def check_output(path: str | Path) -> Path:
    """The path of a picture that can be written; its folder is made if need be."""
    path = Path(path)
    check_suffix(path, FigureCanvasAgg.get_supported_filetypes())
    return path


def check_suffix(path: Path, formats: Collection[str]) -> None:
    """Raise `FigureError` for a suffix of another format; make the folder of a file."""
    if path.suffix.removeprefix(".") not in formats:
        raise FigureError(f"output {path}: its suffix must be one of {', '.join(sorted(formats))}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FigureError(f"output {path}: {error.strerror}") from None


@plain
def save(figure: Figure, path: str | Path) -> Path:
    """Write a figure."""
    path = check_output(path)
    try:
        with atomic_write(path) as place:
            figure.savefig(place, facecolor="white")
    except OSError as error:
        raise FigureError(f"output {path}: {error.strerror}") from None
    return path
