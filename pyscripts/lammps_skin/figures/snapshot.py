"""Snapshots of a run: three-dimensional, as a map of heights, as a vertical section."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from lammps_skin.errors import FigureError
from lammps_skin.figures.moments import Moment, Source, read_moments
from lammps_skin.figures.plane import draw_heights, draw_section, highest_stem
from lammps_skin.figures.scenery import view
from lammps_skin.files import atomic_write
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import near
from lammps_skin.style import plain

NAMES = {Kind.EXHAUSTED: "TA, exhausted"}  # in a legend, of kinds with another name than theirs
DOTS_PER_INCH = 100
WIDTH = 750  # of a picture in three dimensions, pixels


def kinds_of(scene: Scene, show: Sequence[str] | None) -> tuple[Kind, ...]:
    """Kinds of cells of a scene by their labels; "ta" are the exhausted, too; None is all."""
    labels = [kind.label for kind in scene.kinds_of_cells]
    show = labels if show is None else show
    unknown = [word for word in show if word not in labels]
    if unknown or not show:
        guess = near(unknown[0], labels) if unknown else ""
        raise FigureError(f"show = {','.join(show)!r}: must be some of {', '.join(labels)}{guess}")
    words = {*show, *([Kind.EXHAUSTED.label] if Kind.TA.label in show else [])}
    return tuple(kind for kind in scene.kinds_of_cells if kind.label in words)


def on_map(scene: Scene) -> tuple[Kind, ...]:
    """Kinds of cells on a map of heights: stem and ND cells, and others that are bound."""
    table = scene.cell_table.values()
    old = Kind.STEM, Kind.ND
    return tuple(row.kind for row in table if row.kind in old or row.adhesion == "bound")


def draw_view(
    axes: Axes, moment: Moment, kinds: Sequence[Kind], width: int, below: bool = False
) -> None:
    """The picture in three dimensions, of a width in pixels, with its time."""
    axes.imshow(view(moment, kinds, width, below))
    axes.set_axis_off()
    axes.set_title(f"t = {moment.time:g}" + (", from the dermis" if below else ""))


def legend(figure: Figure, moment: Moment, kinds: Sequence[Kind]) -> None:
    """Names of the kinds of cells that there are."""
    there = [kind for kind in kinds if kind in moment.kinds]
    patches = [
        Patch(facecolor=kind.colour, edgecolor="0.3", label=NAMES.get(kind, kind.name))
        for kind in there
    ]
    if patches:
        figure.legend(handles=patches, loc="outside lower center", ncols=len(there), frameon=False)


def _heights(axes: Axes, moment: Moment, kinds: Sequence[Kind], _: float) -> None:
    image = draw_heights(axes, moment, [kind for kind in kinds if kind in on_map(moment.scene)])
    axes.set_title(f"height of the membrane, t = {moment.time:g}")
    assert axes.figure is not None
    axes.figure.colorbar(image, ax=axes, label="z", shrink=0.8)


VIEWS: dict[str, Callable[[Axes, Moment, Sequence[Kind], float], None]] = {
    "3d": lambda axes, moment, kinds, _: draw_view(axes, moment, kinds, WIDTH),
    "below": lambda axes, moment, kinds, _: draw_view(axes, moment, kinds, WIDTH, below=True),
    "height": _heights,
    "section": lambda axes, moment, kinds, y: draw_section(axes, moment, y, kinds),
}


@plain
def snapshot(
    source: Source, time: float | None, path: str | Path, view: str = "3d",
    show: Sequence[str] | None = None, y: float | None = None,
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
        One of `VIEWS`, or "all" for all of them.
    show : sequence of str, optional
        Labels of the kinds of cells to draw, all if not given; "ta" are the exhausted, too. On the
        map of heights are only those of them that are bound.
    y : float, optional
        Of the section; through the highest stem cell if not given.

    Raises
    ------
    FigureError
        If there is no such frame, view or kind of cell, or if the file cannot be written.
    """
    if view != "all" and view not in VIEWS:
        raise FigureError(
            f"view = {view!r}: must be one of {', '.join(VIEWS)}, all{near(view, [*VIEWS, 'all'])}"
        )
    check_output(path)
    (moment,) = read_moments(source, [time])
    kinds = kinds_of(moment.scene, show)
    if y is not None and not 0 <= y <= moment.box[1]:
        raise FigureError(f"y = {y:g}: must be from 0 to L_y = {moment.box[1]:g}")
    views = list(VIEWS) if view == "all" else [view]
    columns = 2 if view == "all" else 1
    figure = Figure(figsize=(7.5 * columns, 6.0 * columns), layout="constrained")
    for n, name in enumerate(views):
        axes = figure.add_subplot(columns, columns, n + 1)
        VIEWS[name](axes, moment, kinds, highest_stem(moment) if y is None else y)
    legend(figure, moment, on_map(moment.scene) if view == "height" else kinds)
    return save(figure, path)


def check_output(path: str | Path) -> Path:
    """The path of a picture that can be written; its folder is made if need be."""
    path = Path(path)
    formats = FigureCanvasAgg.get_supported_filetypes()
    if path.suffix.removeprefix(".") not in formats:
        raise FigureError(f"output {path}: its suffix must be one of {', '.join(sorted(formats))}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FigureError(f"output {path}: {error.strerror}") from None
    return path


@plain
def save(figure: Figure, path: str | Path) -> Path:
    """Write a figure."""
    path = check_output(path)
    try:
        with atomic_write(path) as place:
            figure.savefig(place, dpi=DOTS_PER_INCH, facecolor="white")
    except OSError as error:
        raise FigureError(f"output {path}: {error.strerror}") from None
    return path
