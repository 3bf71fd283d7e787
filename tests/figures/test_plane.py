"""Map of heights and vertical section."""

from __future__ import annotations

import numpy as np
import pytest
from lammps_skin.figures.look import Look
from lammps_skin.figures.plane import (
    draw_cells_from_above,
    draw_heights,
    draw_section,
    highest_stem,
    section_circles,
    section_lines,
)
from lammps_skin.kinds import Kind
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

GROUND = tuple(1 - 0.5 * (1 - np.array(Kind.DERMAL.colour)))


def colour_at(axes, figure, x, z):
    """Red, green and blue in the picture at a point of the data."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    column, row = axes.transData.transform((x, z))
    pixels = np.asarray(canvas.buffer_rgba())
    return pixels[pixels.shape[0] - 1 - int(row), int(column), :3] / 255


@pytest.mark.parametrize("y", [0.0, 7.3, 15.0])
def test_the_section_of_a_wavy_membrane(landscape, y):
    lx = 30.0
    moment = landscape(lambda x, _: 10 + np.sin(2 * np.pi * x / lx))
    lines = section_lines(moment, y)
    x, z = lines.reshape(-1, 2).T
    assert z == pytest.approx(10 + np.sin(2 * np.pi * x / lx), abs=5e-3)
    assert np.abs(np.diff(lines[..., 0])).sum() == pytest.approx(lx)


def test_the_section_of_a_slope_in_y(landscape):
    moment = landscape(lambda _, y: 10 + np.abs(y - 15))
    lines = section_lines(moment, 9.0)
    assert lines[..., 1] == pytest.approx(16.0)


def test_circles_of_a_section(landscape):
    ly = 70 * 0.5 * np.sqrt(3) / 2
    moment = landscape(
        lambda x, _: 10 + 0 * x,
        (Kind.STEM, 4.0, 5.0, 13.0), (Kind.STEM, 9.0, 7.0, 13.0), (Kind.ND, 2.0, ly - 0.2, 14.0),
    )  # fmt: skip
    centers, radii = section_circles(moment, 5.5, Kind.STEM)
    assert centers == pytest.approx(np.array([[4.0, 13.0]]))
    assert radii == pytest.approx([np.sqrt(1.4**2 - 0.5**2)])
    centers, radii = section_circles(moment, 0.3, Kind.ND)  # through the periodic edge
    assert centers == pytest.approx(np.array([[2.0, 14.0]]))
    assert radii == pytest.approx([np.sqrt(1.4**2 - 0.5**2)])


def test_the_picture_of_a_section(landscape):
    moment = landscape(
        lambda x, _: 10 + 0 * x,
        (Kind.STEM, 4.0, 5.0, 12.4), (Kind.ND, 20.0, 5.0, 12.4), (Kind.DERMAL, 12.0, 5.0, 5.0),
    )  # fmt: skip
    figure = Figure()
    axes = figure.add_subplot()
    draw_section(axes, moment, 5.0, (Kind.STEM, Kind.TA, Kind.ND), Look())
    for x, z, colour in [
        (4.0, 12.4, Kind.STEM.colour), (20.0, 12.4, Kind.ND.colour),
        (12.0, 5.0, Kind.DERMAL.colour), (15.0, 7.0, GROUND), (9.0, 10.0, Kind.MEMBRANE.colour),
        (9.0, 10.9, Kind.MEMBRANE.colour), (9.0, 11.4, (1, 1, 1)),
    ]:  # fmt: skip
        assert colour_at(axes, figure, x, z) == pytest.approx(colour, abs=0.01)


def test_the_stem_cell_of_a_section_is_in_front(landscape):
    """Also of a cell that is nearer to the plane; what lies behind the plane is pale."""
    moment = landscape(
        lambda x, _: 10 + 0 * x,
        (Kind.TA, 4.0, 5.0, 12.4), (Kind.STEM, 4.3, 5.2, 12.4), (Kind.TA, 20.0, 7.0, 12.4),
        (Kind.TA, 25.0, 3.0, 12.4),
    )  # fmt: skip
    figure = Figure()
    axes = figure.add_subplot()
    draw_section(axes, moment, 5.0, (Kind.STEM, Kind.TA), Look())
    assert colour_at(axes, figure, 4.0, 12.4) == pytest.approx(Kind.STEM.colour, abs=0.01)
    pale = 1 - 0.4 * (1 - np.array(Kind.TA.colour))
    assert colour_at(axes, figure, 20.0, 12.4) == pytest.approx(pale, abs=0.01)
    assert colour_at(axes, figure, 25.0, 12.4) == pytest.approx([1, 1, 1])


def test_a_stem_cell_of_a_section_is_joined_with_its_partner(landscape):
    moment = landscape(lambda x, _: 10 + 0 * x, (Kind.STEM, 4.0, 5.0, 12.4))
    partner = int(np.hypot(moment.membrane[:, 0] - 6, moment.membrane[:, 1] - 5).argmin())
    moment.state["partner"][-1] = partner + 1
    axes = Figure().add_subplot()
    draw_section(axes, moment, 5.0, (Kind.STEM,), Look())
    x, z = axes.lines[0].get_data()
    assert x == pytest.approx([4.0, moment.membrane[partner, 0]])
    assert z == pytest.approx([12.4, 10.0])


def test_the_map_of_heights(landscape):
    moment = landscape(
        lambda x, y: 10 + 3 * np.exp(-((x - 20) ** 2 + (y - 8) ** 2) / 8),
        (Kind.STEM, 5.0, 25.0, 13.0),
    )
    figure = Figure()
    axes = figure.add_subplot()
    image = draw_heights(axes, moment, [Kind.STEM])
    height = np.asarray(image.get_array())
    row, column = np.unravel_index(height.argmax(), height.shape)
    sides = np.array(moment.box)
    assert np.array([column, row]) / height.shape[::-1] * sides == pytest.approx([20, 8], abs=0.3)
    assert height.max() == pytest.approx(13, abs=0.05)
    assert image.get_clim() == moment.relief
    assert colour_at(axes, figure, 5.0, 25.0) == pytest.approx(Kind.STEM.colour, abs=0.01)


def test_edges_of_stem_cells_are_seen_below_others(landscape):
    moment = landscape(
        lambda x, _: 10 + 0 * x, (Kind.STEM, 10.0, 10.0, 12.0), (Kind.TA, 11.4, 10.0, 14.0)
    )
    figure = Figure(dpi=200)
    axes = figure.add_subplot()
    draw_cells_from_above(axes, moment, (Kind.STEM, Kind.TA), Look())
    radius = moment.scene.cells.radius
    assert colour_at(axes, figure, 10.7, 10.0) == pytest.approx(Kind.TA.colour, abs=0.01)
    assert colour_at(axes, figure, 10.0 + radius, 10.0) == pytest.approx([0, 0, 0], abs=0.01)


def test_the_highest_stem_cell(landscape):
    flat = lambda x, _: 10 + 0 * x  # noqa: E731
    stem = (Kind.STEM, 4.0, 5.0, 12.4), (Kind.STEM, 4.0, 9.0, 12.6)
    assert highest_stem(landscape(flat, *stem)) == 9.0
    assert highest_stem(landscape(flat)) == pytest.approx(70 * 0.5 * np.sqrt(3) / 4)
