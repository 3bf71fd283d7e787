"""Time courses of synthetic ensembles whose means and intervals are known."""

from __future__ import annotations

import numpy as np
import pytest
from lammps_skin.analysis.labels import label
from lammps_skin.analysis.observables import ORDERS
from lammps_skin.errors import FigureError
from lammps_skin.figures.time_courses import draw_course, draw_courses, draw_stem_and_nd
from lammps_skin.style import printed
from matplotlib.figure import Figure
from scipy.stats import t as student


def table(values, columns=("zeta",)):
    """Rows of seeds 1 to s at times 0, 10, ... from values (s, t), the same in all columns."""
    seeds, times = np.indices(np.shape(values))
    rows = np.zeros(seeds.size, [(name, float) for name in ("seed", "time", *columns)])
    rows["seed"], rows["time"] = seeds.ravel() + 1, 10.0 * times.ravel()
    for name in columns:
        rows[name] = np.ravel(values)
    return rows


def drawn(values):
    """Points of the line (t, 2), and lower and upper edge of the band by time."""
    axes = Figure().add_subplot()
    draw_course(axes, table(values), "zeta")
    (band,) = axes.collections
    edges: dict[float, list[float]] = {}
    for path in band.get_paths():
        for x, y in path.vertices:
            edges.setdefault(x, []).append(y)
    return axes.lines[0].get_xydata(), {x: (min(y), max(y)) for x, y in edges.items()}


def test_mean_and_interval_over_seeds():
    values = np.array([[0.0, 1.0, 5.0], [2.0, 1.0, 6.0], [4.0, 4.0, 10.0]])
    line, band = drawn(values)
    assert line == pytest.approx(np.array([[0, 2], [10, 2], [20, 7]]))
    half = student.ppf(0.975, 2) * values.std(axis=0, ddof=1) / np.sqrt(3)
    for time, mean, width in zip((0, 10, 20), (2, 2, 7), half, strict=True):
        assert band[time] == pytest.approx((mean - width, mean + width))


def test_one_seed_has_no_band():
    line, band = drawn([[1.0, 2.0]])
    assert line[:, 1] == pytest.approx([1, 2])
    assert not band


def test_what_is_not_defined_is_left_out():
    nan = np.nan
    line, _ = drawn([[nan, 1.0, nan], [nan, 3.0, 4.0]])
    assert line[:, 1] == pytest.approx([nan, 2, 4], nan_ok=True)


def test_a_column_that_is_missing_is_named():
    with pytest.raises(FigureError, match=r"no column 'chi_H'; it has seed, time, zeta"):
        draw_course(Figure().add_subplot(), table([[1.0]]), "chi_H")


def test_a_panel_for_each_column_and_a_line_for_each_table():
    tables = {name: table(np.full((2, 3), n), ORDERS) for n, name in enumerate(("ring", "random"))}
    figure = draw_courses(tables, ORDERS, across=2)
    labels = [axes.get_ylabel().replace("\n", " ") for axes in figure.axes]
    assert labels[0] == r"χ$_\mathrm{H}$: stem cells on convex places"
    assert labels[2:] == [label(name).text.replace("R_c", r"R$_\mathrm{c}$") for name in ORDERS[2:]]
    for axes in figure.axes:
        assert [line.get_ydata()[0] for line in axes.lines[:2]] == [0, 1]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["ring (2 seeds)", "random (2 seeds)"]


def test_stem_and_nd_have_a_line_each():
    columns = ("zeta", "zeta_nd")
    rows = table(np.ones((1, 2)), columns)
    rows["zeta_nd"] = 3
    figure = draw_stem_and_nd({"nd-a": rows, "nd-b": rows}, ("zeta",))
    assert len(figure.axes) == 2
    for axes in figure.axes:
        assert {line.get_label(): line.get_ydata()[0] for line in axes.lines[:2]} == {
            "stem": 1, "ND": 3,
        }  # fmt: skip
    assert figure.axes[0].get_title() == "nd-a (1 seed)"


def test_time_is_in_cycles_in_print():
    """And panels have letters, within the width of a page."""
    tables = {"ring": table([[1.0, 2.0]], ORDERS)}
    on_screen = draw_courses(tables, ORDERS, across=2, cycle=10.0)
    with printed():
        figure = draw_courses(tables, ORDERS, across=2, cycle=10.0)
    times, cycles = (one.axes[0].lines[0].get_xdata() for one in (on_screen, figure))
    assert cycles == pytest.approx(np.array(times) / 10.0)
    assert [axes.get_xlabel() for axes in (on_screen.axes[0], figure.axes[0])] == [
        "time (time units)", "time (cycles)",
    ]  # fmt: skip
    assert [axes.get_title("left") for axes in figure.axes] == ["a", "b", "c", "d"]
    assert figure.get_size_inches()[0] == pytest.approx(183 / 25.4)
    assert on_screen.axes[0].get_title("left") == ""
