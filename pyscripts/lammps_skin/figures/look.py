"""How a snapshot looks: where the viewer stands, what is drawn in which colours, how large."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from lammps_skin.analysis.curvature import curvature
from lammps_skin.arrays import Floats
from lammps_skin.errors import FigureError
from lammps_skin.figures.clone_colours import PALETTE, clone_colours
from lammps_skin.figures.moments import Moment
from lammps_skin.kinds import is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import near

UNKNOWN = (0.6, 0.6, 0.6)  # colour of what has no value


def mean_cycle(scene: Scene) -> float:
    """Mean time from a division of a cell to its next one: T0 + 1/gamma."""
    return float(scene.cells.cycle_delay + 1 / scene.cells.cycle_rate)


class Colouring(NamedTuple):
    """Numbers of cells or of membrane particles, shown as colours.

    Attributes
    ----------
    label : str
        Beside the colours.
    of_cells : bool
        Or else of membrane particles.
    values : callable
        The numbers (n,) at a moment.
    limits : callable
        Lowest and highest number that has a colour of its own, the same at all times of a run.
    colours : str
        Name of the colours in matplotlib.
    """

    label: str
    of_cells: bool
    values: Callable[[Moment], Floats]
    limits: Callable[[Moment], tuple[float, float]]
    colours: str


def _curvature(moment: Moment) -> Floats:
    return curvature(moment.membrane, moment.triangles, moment.box).mean


def _age(moment: Moment) -> Floats:
    return moment.time - moment.state["birth_time"][is_cell(moment.kinds)]


def _generations(moment: Moment) -> Floats:
    left = moment.state["divisions_left"][is_cell(moment.kinds)].astype(float)
    return np.where(left < 0, np.nan, left)


def _two_cycles(moment: Moment) -> tuple[float, float]:
    return 0.0, 2 * mean_cycle(moment.scene)


def _most_generations(moment: Moment) -> tuple[float, float]:
    most = moment.scene.cells.generations
    return 0.0, 20.0 if most == "endless" else max(float(most), 1.0)


COLOURINGS = {
    "age": Colouring("age of cells", True, _age, _two_cycles, "viridis"),
    "generations": Colouring(
        "divisions that cells have left", True, _generations, _most_generations, "viridis"
    ),
    "height": Colouring(
        "height of the membrane", False, lambda moment: moment.membrane[:, 2],
        lambda moment: moment.relief, "cividis",
    ),
    "curvature": Colouring(
        "mean curvature of the membrane", False, _curvature,
        lambda moment: (-1 / moment.scene.cells.radius, 1 / moment.scene.cells.radius), "RdBu_r",
    ),
}  # fmt: skip
COLOUR_BY = ("kind", "clone", *COLOURINGS)


@dataclass(frozen=True)
class Look:
    """How a snapshot looks.

    Parameters
    ----------
    azimuth : float
        Where the viewer of a picture in three dimensions stands: angle from x in the plane.
    elevation : float, optional
        And above it, in degrees; 42, and -42 for the view from the dermis.
    zoom : float
        How many times larger the middle of the picture is.
    size : int
        Width, pixels.
    dpi : int
        Pixels per inch: the larger, the larger are letters, as long as they fit.
    shift : (x, y)
        How far all particles are moved across the sides of the periodic box.
    colour_by : str
        One of `COLOUR_BY`.
    scale_bar : bool

    Raises
    ------
    FigureError
        If a value is not allowed.
    """

    azimuth: float = -62.0
    elevation: float | None = None
    zoom: float = 1.0
    size: int = 750
    dpi: int = 100
    shift: tuple[float, float] = (0.0, 0.0)
    colour_by: str = "kind"
    scale_bar: bool = False

    def __post_init__(self) -> None:
        if self.colour_by not in COLOUR_BY:
            raise FigureError(
                f"color-by = {self.colour_by!r}: must be one of {', '.join(COLOUR_BY)}"
                f"{near(self.colour_by, list(COLOUR_BY))}"
            )
        for name, value, low, high in (
            ("azimuth", self.azimuth, -360, 360), ("elevation", self.elevation or 0, -90, 90),
            ("zoom", self.zoom, 0.1, 100), ("size", self.size, 100, 8000),
            ("dpi", self.dpi, 30, 1200), ("shift", self.shift[0], -1e6, 1e6),
            ("shift", self.shift[1], -1e6, 1e6),
        ):  # fmt: skip
            if not low <= value <= high:
                raise FigureError(f"{name} = {value:g}: must be from {low:g} to {high:g}")

    def by_clone(self) -> Look:
        """The same in the colours of clones."""
        return replace(self, colour_by="clone")

    def colours(self, moment: Moment) -> ScalarMappable | None:
        """From numbers to colours; None where the colours stand for no numbers."""
        if self.colour_by not in COLOURINGS:
            return None
        colouring = COLOURINGS[self.colour_by]
        limits = Normalize(*colouring.limits(moment))
        return ScalarMappable(limits, colormaps[colouring.colours].with_extremes(bad=UNKNOWN))

    def of_cells(self, moment: Moment) -> Floats:
        """Colours (n, 3) of the cells of a moment."""
        cells = is_cell(moment.kinds)
        if self.colour_by == "clone":
            return np.asarray(PALETTE[clone_colours(moment.founders[cells], moment.frames)])
        numbered = self._numbered(moment, True)
        if numbered is not None:
            return numbered
        kinds = moment.kinds[cells].tolist()
        return np.array([moment.scene.kind(kind).colour for kind in kinds]).reshape(-1, 3)

    def of_membrane(self, moment: Moment) -> Floats | None:
        """Colours (m, 3) of the membrane particles of a moment, where they have their own."""
        return self._numbered(moment, False)

    def _numbered(self, moment: Moment, of_cells: bool) -> Floats | None:
        colours = self.colours(moment)
        if colours is None or COLOURINGS[self.colour_by].of_cells != of_cells:
            return None
        values = COLOURINGS[self.colour_by].values(moment)
        return np.asarray(colours.to_rgba(np.ma.masked_invalid(values)))[:, :3]
