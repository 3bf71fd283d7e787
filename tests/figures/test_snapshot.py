"""Snapshots of a real run: what their pixels show, and what is refused."""

from __future__ import annotations

import matplotlib.image
import numpy as np
import pytest
from lammps_skin.errors import FigureError, SkinError
from lammps_skin.figures.moments import last_time, read_moments
from lammps_skin.figures.render import Camera, axes_of
from lammps_skin.figures.scenery import ABOVE, AZIMUTH, cell_spheres, membrane_surface, view
from lammps_skin.figures.snapshot import VIEWS, snapshot
from lammps_skin.kinds import KINDS, Kind, is_cell
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
    corners = membrane_surface(moment).corners
    a, b, c = corners[..., :2].transpose(1, 0, 2)
    area = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]).sum() / 2
    assert area == pytest.approx(np.prod(moment.box))
    assert corners[..., :2].min() >= 0
    assert (corners[..., :2].max(axis=(0, 1)) <= moment.box).all()


def test_normals_of_the_surface(landscape):
    moment = landscape(lambda x, y: 10 + 0 * x)
    assert np.allclose(membrane_surface(moment).normals, [0, 0, 1])


def test_a_stem_cell_is_green_where_it_projects(run):
    (moment,) = read_moments(run, [10.0])
    image = view(moment, (Kind.STEM,), width=300)
    heights = [moment.membrane[:, 2], moment.of(Kind.STEM)[:, 2]]
    z = np.concatenate(heights)
    corners = np.stack(
        np.meshgrid([0, moment.box[0]], [0, moment.box[1]], [z.min(), z.max()]), axis=-1
    ).reshape(-1, 3)
    camera = Camera.looking(axes_of(AZIMUTH, ABOVE), corners.astype(float), 300)
    column, row, _ = camera.project(cell_spheres(moment, (Kind.STEM,)).centers)[0]
    found = np.argwhere(green(image))
    assert found.mean(axis=0) == pytest.approx([image.shape[0] - row, column], abs=2)
    assert len(found) == pytest.approx(np.pi * (1.4 * camera.scale) ** 2, rel=0.1)


@pytest.mark.parametrize("below", [False, True])
def test_cells_at_the_edges_are_drawn_whole(landscape, below):
    """Also those that reach beyond the box: the frame of the picture stays white."""
    wide, deep = landscape(lambda x, y: 0 * x).box[:2]
    corners = [(Kind.STEM, x, y, 2.4) for x in (0.0, wide) for y in (0.0, deep)]
    image = view(landscape(lambda x, y: 0 * x, *corners), CELLS, 120, below)
    for edge in (image[0], image[-1], image[:, 0], image[:, -1]):
        assert (edge == 1.0).all()
    assert green(image).any() or below


def test_only_what_is_asked_for_is_drawn(landscape):
    moment = landscape(
        lambda x, _: 10 + 0 * x, (Kind.STEM, 8.0, 15.0, 12.4), (Kind.TA, 22.0, 15.0, 12.4)
    )
    both, stem, ta = (view(moment, kinds, width=200) for kinds in (CELLS, (Kind.STEM,), (Kind.TA,)))
    assert green(both).any() and purple(both).any()
    assert green(stem).any() and not purple(stem).any()
    assert purple(ta).any() and not green(ta).any()


def test_seen_from_below_the_membrane_hides_the_cells(landscape):
    moment = landscape(lambda x, _: 10 + 0 * x, (Kind.STEM, 15.0, 15.0, 12.4))
    assert green(view(moment, CELLS, width=200)).any()
    assert not green(view(moment, CELLS, below=True, width=200)).any()


# ---- files


@pytest.mark.parametrize("name", [*VIEWS, "all"])
def test_every_view_makes_a_picture(run, tmp_path, name):
    path = snapshot(run, None, tmp_path / "new" / f"{name}.png", name)
    image = matplotlib.image.imread(path)[..., :3]
    assert image.std() > 0.05
    assert name == "below" or green(image).any()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"view": "side"}, r"view = 'side': must be one of 3d, below, height, section, all"),
        ({"show": ["stem", "fat"]}, r"show = 'stem,fat': must be some of stem, ta, exhausted, nd"),
        ({"show": ["stm"]}, r"show = 'stm': .*; did you mean stem\?"),
        ({"show": []}, r"show = '': must be some of"),
        ({"view": "section", "y": 99.0}, r"y = 99: must be from 0 to L_y = 12\.\d+"),
        ({"path": "picture.jpeg2"}, r"picture\.jpeg2: its suffix must be one of .*png"),
    ],
)
def test_what_cannot_be_drawn_is_refused(run, tmp_path, options, text):
    path = tmp_path / options.pop("path", "picture.png")
    with pytest.raises(FigureError, match=text):
        snapshot(run, None, path, **options)
    assert not path.exists()
