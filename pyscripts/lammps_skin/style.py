"""How figures look: the same whatever a user's matplotlibrc says, on a screen or in print."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import ContextDecorator, contextmanager
from contextvars import ContextVar
from math import ceil
from textwrap import fill
from typing import TYPE_CHECKING, Any

from matplotlib import rcParams, style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TEXT = {"pdf.fonttype": 42, "svg.fonttype": "none"}  # letters stay letters in PDF and SVG
SHEETS: dict[str, dict[str, Any]] = {
    "screen": TEXT,
    "print": TEXT | {
        "font.size": 7, "axes.titlesize": 7, "axes.labelsize": 7, "legend.fontsize": 6,
        "xtick.labelsize": 6, "ytick.labelsize": 6, "axes.linewidth": 0.6, "lines.linewidth": 1.0,
        "xtick.major.width": 0.6, "ytick.major.width": 0.6, "xtick.major.size": 2.5,
        "ytick.major.size": 2.5, "axes.spines.top": False, "axes.spines.right": False,
        "font.family": "sans-serif", "font.sans-serif": ["Arial", "Helvetica", "DejaVu Sans"],
    },
}  # fmt: skip
PRINTED_WIDTH = 183 / 25.4  # two columns of a journal, inches
NARROW = 3.3  # in which letters still fit, inches
LETTER_WIDTH = 0.52  # of a letter over its height, in the mean
POINTS = 72  # in an inch
LETTERS = "abcdefghijklmnopqrstuvwxyz"

_sheet: ContextVar[str] = ContextVar("sheet", default="screen")


class Plain(ContextDecorator):
    """Within it, and in what it decorates, figures look as the chosen sheet says."""

    def __enter__(self) -> None:
        self._context = style.context(["default", SHEETS[_sheet.get()]])
        self._context.__enter__()

    def __exit__(self, *exception: Any) -> None:
        self._context.__exit__(*exception)

    def _recreate_cm(self) -> Plain:
        return Plain()


plain = Plain()


@contextmanager
def printed() -> Iterator[None]:
    """Within it, figures are drawn for print: small letters, the width of a page, panels named."""
    token = _sheet.set("print")
    try:
        yield
    finally:
        _sheet.reset(token)


def in_print() -> bool:
    """Whether figures are drawn for print."""
    return _sheet.get() == "print"


def size(width: float, height: float) -> tuple[float, float]:
    """Width and height of a figure, inches; in print at most as wide as a page."""
    factor = min(1.0, PRINTED_WIDTH / width) if in_print() else 1.0
    return width * factor, height * factor


def dots(pixels: int, wanted: int) -> int:
    """Pixels per inch of a picture of a width in pixels.

    They are those that are wanted, but fewer where letters would not fit, and more where in print
    the picture would be wider than a page.
    """
    fewest = ceil(pixels / PRINTED_WIDTH) if in_print() else 1
    return max(min(wanted, int(pixels / NARROW)), fewest)


def panels(
    number: int, across: int = 3, width: float = 4.6, height: float = 3.4
) -> tuple[Figure, list[Axes]]:
    """A figure with so many panels of a size in inches, some in a row."""
    from matplotlib.figure import Figure

    across = min(number, across)
    down = -(-number // across)
    figure = Figure(figsize=size(width * across, height * down), layout="constrained")
    found: list[Axes] = list(figure.subplots(down, across, squeeze=False).ravel())
    for axes in found[number:]:
        axes.remove()
    return figure, found[:number]


def with_indices(text: str) -> str:
    """Words whose symbols, such as χ_H and R_c, get their indices."""
    return re.sub(r"\b([χR])_(\w)\b", r"\1$_\\mathrm{\2}$", text)


def name_axes(axes: Axes, x: str, y: str = "") -> None:
    """Label axes, in as many lines as they need."""
    grid, figure = axes.get_gridspec(), axes.get_figure(root=True)
    assert grid is not None and figure is not None
    letter = LETTER_WIDTH * float(rcParams["font.size"]) / POINTS
    lengths = figure.get_size_inches() / [grid.ncols, grid.nrows]
    across, up = (
        with_indices(fill(text, max(int(0.85 * length / letter), 1)))
        for text, length in zip((x, y), lengths, strict=True)
    )
    axes.set(xlabel=across, ylabel=up)


def name_panels(panels: Sequence[Axes]) -> None:
    """Put a letter at the upper left of each panel in print."""
    if in_print() and len(panels) > 1:
        for letter, axes in zip(LETTERS, panels, strict=False):
            axes.set_title(letter, loc="left", fontweight="bold", fontsize=8)
