"""Snapshots of a real run: what their pixels show, and what is refused."""

from __future__ import annotations

import re
from contextlib import nullcontext

import matplotlib.image
import numpy as np
import pytest
from lammps_skin.errors import FigureError, SkinError
from lammps_skin.figures.look import COLOUR_BY, Look
from lammps_skin.figures.moments import last_time, read_moments
from lammps_skin.figures.raster import Canvas
from lammps_skin.figures.scenery import camera_of, cell_spheres, membrane_surface, view
from lammps_skin.figures.snapshot import VIEWS, figure_of, shown_of, snapshot
from lammps_skin.kinds import KINDS, Kind, is_cell
from lammps_skin.style import printed
from lammps_skin.trajectory.universe import open_trajectory

CELLS = tuple(kind for kind in KINDS if is_cell(kind))


def green(image):
    return (image[..., 1] > image[..., 0] + 0.1) & (image[..., 1] > image[..., 2] + 0.1)


def purple(image):
    return (image[..., 2] > image[..., 1] + 0.1) & (image[..., 0] < 0.6)


# ---- moments


def test_all_sources_give_the_same_moment(run):
    universe = open_trajectory(run / "skin.h5")
    universe.trajectory[1]
    found = [
        read_moments(source, [time])[0]
        for source, time in (
            (run, 5.0), (run / "skin.dump", 5.2), (run / "skin.h5", 4.9), (universe, None),
        )
    ]  # fmt: skip
    for moment in found:
        assert moment.time == pytest.approx(5)
        assert np.array_equal(moment.kinds, found[0].kinds)
        assert np.array_equal(moment.positions, found[0].positions)
    assert len(found[0].membrane) == 24 * 28
    assert len(found[0].of(Kind.STEM)) == 1


def test_the_last_frame(run):
    assert last_time(run) == pytest.approx(10)
    assert read_moments(run, [None, 0.0])[0].time == pytest.approx(10)


@pytest.mark.parametrize("time", [13.0, -3.0, float("nan")])
def test_a_time_without_a_frame_is_refused(run, time):
    with pytest.raises(FigureError, match=r"time = .*nearest frame of .*skin\.(h5|dump)"):
        read_moments(run, [time])


def test_what_is_no_run_is_refused(tmp_path):
    with pytest.raises(SkinError, match=r"nowhere: No such file or directory"):
        read_moments(tmp_path / "nowhere", [None])
    with pytest.raises(SkinError, match=r"holds no trajectory"):
        read_moments(tmp_path, [None])
    (tmp_path / "skin.h5").write_text("no")
    with pytest.raises(SkinError, match=r"skin\.h5: is no trajectory"):
        read_moments(tmp_path, [None])


# ---- three dimensions


def test_the_surface_fills_the_box(landscape):
    moment = landscape(lambda x, y: 10 + np.sin(x) * np.cos(y))
    camera = camera_of(moment, Look(size=300, elevation=90.0))
    canvas = Canvas(camera, [membrane_surface(moment, Look())], moment.box)
    assert (canvas.depth > -np.inf).sum() == pytest.approx(
        np.prod(moment.box) * camera.scale**2, rel=0.01
    )


def test_normals_of_the_surface(landscape):
    moment = landscape(lambda x, y: 10 + 0 * x)
    assert np.allclose(membrane_surface(moment, Look()).normals, [0, 0, 1])


def test_a_stem_cell_is_green_where_it_projects(run):
    (moment,) = read_moments(run, [10.0])
    look = Look(size=300)
    image, camera = view(moment, (Kind.STEM,), look), camera_of(moment, look)
    places = cell_spheres(moment, (Kind.STEM,), look).centers
    column, row, _ = camera.project(places)[
        ((places[:, :2] > 0) & (places[:, :2] < moment.box)).all(axis=1)
    ][0]
    found = np.argwhere(green(image))
    assert found.mean(axis=0) == pytest.approx([image.shape[0] - 1 - row, column], abs=1)
    assert len(found) == pytest.approx(np.pi * (1.4 * camera.scale) ** 2, rel=0.1)


@pytest.mark.parametrize("place", [0.3, -0.3, 30.2])
def test_a_cell_at_a_side_is_drawn_once_and_whole(landscape, place):
    """Within the picture, wherever in the plane its image is that LAMMPS holds."""
    moment = landscape(lambda x, y: 0 * x, (Kind.STEM, place, 0.1, 2.4))
    look = Look(size=200, elevation=90.0)
    image = green(view(moment, CELLS, look))
    assert image.sum() == pytest.approx(np.pi * (1.4 * camera_of(moment, look).scale) ** 2, rel=0.1)
    for edge in (image[0], image[-1], image[:, 0], image[:, -1]):
        assert not edge.any()


def test_a_shift_moves_all_across_the_sides(landscape):
    there = landscape(lambda x, y: np.sin(2 * np.pi * x / 30.0), (Kind.STEM, 3.0, 5.0, 2.4))
    lx, ly = there.box
    image = view(there, CELLS, Look(size=150))
    assert np.abs(view(there, CELLS, Look(size=150, shift=(lx, -ly))) - image).max() < 1e-3
    moved = view(there, CELLS, Look(size=150, shift=(lx / 2, 0.0)))
    assert np.abs(moved - image).max() > 0.3


@pytest.mark.parametrize("colour_by", COLOUR_BY)
def test_colours(run, colour_by):
    """Numbers of the membrane colour it and leave the cells alone, and the other way round."""
    moment = read_moments(run, [10.0])[0]
    look, plain = Look(colour_by=colour_by), Look()
    spheres = [cell_spheres(moment, CELLS, one).colours for one in (look, plain)]
    surface = [membrane_surface(moment, one).colours for one in (look, plain)]
    assert np.array_equal(*spheres) == (colour_by in ("kind", "height", "curvature"))
    assert np.array_equal(*surface) == (colour_by not in ("height", "curvature"))
    for colours in (look.of_cells(moment), surface[0]):
        assert colours.min() >= 0 and colours.max() <= 1


def test_only_what_is_asked_for_is_drawn(landscape):
    moment = landscape(
        lambda x, _: 10 + 0 * x, (Kind.STEM, 8.0, 15.0, 12.4), (Kind.TA, 22.0, 15.0, 12.4)
    )
    both, stem, ta = (
        view(moment, kinds, Look(size=200)) for kinds in (CELLS, (Kind.STEM,), (Kind.TA,))
    )
    assert green(both).any() and purple(both).any()
    assert green(stem).any() and not purple(stem).any()
    assert purple(ta).any() and not green(ta).any()


def test_seen_from_below_the_membrane_hides_the_cells(landscape):
    moment = landscape(lambda x, _: 10 + 0 * x, (Kind.STEM, 15.0, 15.0, 12.4))
    assert green(view(moment, CELLS, Look(size=200))).any()
    assert not green(view(moment, CELLS, Look(size=200), below=True)).any()


# ---- files


def test_text_is_text_in_a_vector_format(run, tmp_path):
    path = snapshot(run, 10.0, tmp_path / "section.svg", "section")
    texts = re.findall(r"<text[^>]*>(.*?)</text>", path.read_text(), re.DOTALL)
    assert any("section at y" in text for text in texts)
    assert any("stem" in text for text in texts)


def test_a_picture_has_the_pixels_that_are_asked_for(run, tmp_path):
    """And shows what was rendered pixel by pixel."""
    look = Look(size=240, dpi=50, scale_bar=False)
    image = matplotlib.image.imread(snapshot(run, 10.0, tmp_path / "a.png", look=look))[..., :3]
    assert image.shape[1] == 240
    rendered = view(read_moments(run, [10.0])[0], CELLS, look)
    start = round(0.34 * 50)
    assert np.abs(image[start : start + len(rendered)] - rendered).max() < 0.01


@pytest.mark.parametrize("name", ["3d", "section"])
@pytest.mark.parametrize("sheet", [nullcontext, printed])
def test_letters_fit_and_a_page_is_not_too_wide(run, name, sheet):
    """Whatever the pixels per inch; the pixels are those that are asked for."""
    (moment,) = read_moments(run, [10.0])
    for size, dpi in ((200, 600), (900, 50)):
        look = Look(size=size, dpi=dpi)
        with sheet():
            figure = figure_of(moment, name, shown_of(moment, None, None, look))
        wide = figure.get_size_inches()[0]
        assert wide * figure.dpi == pytest.approx(size)
        assert wide >= 3.3
        assert sheet is nullcontext or wide <= 183 / 25.4


@pytest.mark.parametrize("name", [*VIEWS, "all"])
def test_every_view_makes_a_picture(run, tmp_path, name):
    path = snapshot(run, None, tmp_path / "new" / f"{name}.png", name)
    image = matplotlib.image.imread(path)[..., :3]
    assert image.std() > 0.05
    assert name in ("below", "clones") or green(image).any()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (
            {"view": "side"},
            r"view = 'side': must be one of 3d, below, height, section, clones, lineage, all",
        ),
        ({"show": ["stem", "fat"]}, r"show = 'stem,fat': must be some of stem, ta, exhausted, nd"),
        ({"show": ["stm"]}, r"show = 'stm': .*; did you mean stem\?"),
        ({"show": []}, r"show = '': must be some of"),
        ({"view": "section", "y": 99.0}, r"y = 99: must be from 0 to L_y = 12\.\d+"),
        ({"view": "section", "look": {"zoom": 0.0}}, r"zoom = 0: must be from 0.1 to 100"),
        ({"look": {"size": 20}}, r"size = 20: must be from 100 to 8000"),
        ({"look": {"elevation": 91.0}}, r"elevation = 91: must be from -90 to 90"),
        (
            {"look": {"colour_by": "clones"}},
            r"color-by = 'clones': must be one of kind, clone, .*; did you mean clone\?",
        ),
        ({"path": "picture.jpeg2"}, r"picture\.jpeg2: its suffix must be one of .*png"),
    ],
)
def test_what_cannot_be_drawn_is_refused(run, tmp_path, options, text):
    path = tmp_path / options.pop("path", "picture.png")
    with pytest.raises(FigureError, match=text):
        snapshot(run, None, path, **options | {"look": Look(**options.get("look", {}))})
    assert not path.exists()
