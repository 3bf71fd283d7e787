"""``skin snapshot``: pictures of a run at a time."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lammps_skin.cli.output import console
from lammps_skin.errors import FigureError

if TYPE_CHECKING:
    from lammps_skin.figures.look import Look

Run = Annotated[
    Path, typer.Argument(metavar="RUN", help="Directory of a run, its skin.h5 or skin.dump.")
]
View = Annotated[
    str, typer.Option(help="3d, below, height, section, clones, lineage, or all the first four.")
]
Show = Annotated[
    str | None,
    typer.Option(help="Kinds of cells to draw, such as stem,ta,nd, or none [default: all]."),
]
Y = Annotated[
    float | None,
    typer.Option("--y", help="Of the section [default: through the highest stem cell]."),
]
Azimuth = Annotated[
    float, typer.Option(help="Where the viewer stands: degrees from x, in the plane.")
]
Elevation = Annotated[
    float | None,
    typer.Option(help="Degrees above the plane [default: 42; -42 of the view below]."),
]
Zoom = Annotated[float, typer.Option(help="How much larger the middle of the picture is.")]
Size = Annotated[int, typer.Option(help="Width, pixels.")]
Dpi = Annotated[int, typer.Option(help="Pixels per inch; letters grow with it.")]
Shift = Annotated[
    str, typer.Option(metavar="X,Y", help="Move all across the sides of the periodic box.")
]
ColourBy = Annotated[
    str,
    typer.Option("--color-by", help="kind, clone, age, generations, height or curvature."),
]
ScaleBar = Annotated[
    bool, typer.Option("--scale-bar", help="Draw a bar of some diameters of a cell.")
]
Print = Annotated[
    bool, typer.Option("--print", help="For a journal: small letters, panels named a, b, c.")
]


def snapshot(
    run: Run,
    time: Annotated[
        float | None, typer.Option("--time", help="Of the frame [default: the last].")
    ] = None,
    view: View = "3d",
    show: Show = None,
    y: Y = None,
    azimuth: Azimuth = -62.0,
    elevation: Elevation = None,
    zoom: Zoom = 1.0,
    size: Size = 750,
    dpi: Dpi = 100,
    shift: Shift = "0,0",
    colour_by: ColourBy = "kind",
    scale_bar: ScaleBar = False,
    for_print: Print = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="[default: in the run's directory]"),
    ] = None,
) -> None:
    """Draw a run at a time: in three dimensions, as maps, as a vertical section, as a tree."""
    from lammps_skin.figures import snapshot as pictures  # MDAnalysis takes a second to import
    from lammps_skin.figures.moments import read_moments
    from lammps_skin.style import printed

    look = look_of(azimuth, elevation, zoom, size, dpi, shift, colour_by, scale_bar)
    shown = None if time is None else read_moments(run, [time])[0].time
    at = "last" if shown is None else f"t{shown:g}"
    folder = run if run.is_dir() else run.parent
    path = output or folder / f"snapshot-{view}-{at}.png"
    nearest = "" if shown == time else f": the frame at t = {shown:g}"
    with printed() if for_print else nullcontext():
        written = pictures.snapshot(run, shown, path, view, words_of(show), y, look)
    console.print(f"{written}{nearest}")


def words_of(show: str | None) -> list[str] | None:
    """The words of a list with commas."""
    return show and [word.strip().lower() for word in show.split(",") if word.strip()]  # type: ignore[return-value]


def look_of(
    azimuth: float, elevation: float | None, zoom: float, size: int, dpi: int, shift: str,
    colour_by: str, scale_bar: bool,
) -> Look:  # fmt: skip
    """How a picture looks, of options."""
    from lammps_skin.figures.look import Look

    try:
        x, y = (float(word) for word in shift.split(","))
    except ValueError:
        raise FigureError(f"shift = {shift!r}: must be two numbers, such as 10,-5") from None
    return Look(azimuth, elevation, zoom, size, dpi, (x, y), colour_by, scale_bar)
