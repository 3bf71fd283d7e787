"""The renderer: what is where, what hides what, what is lit."""

from __future__ import annotations

import numpy as np
import pytest
from lammps_skin.figures.camera import Camera, axes_of
from lammps_skin.figures.raster import Canvas, Spheres, Surface
from lammps_skin.figures.render import hollow, picture

GREEN, RED = (0.2, 0.9, 0.2), (0.9, 0.2, 0.2)
CUBE = np.stack(np.meshgrid([-2.0, 2.0], [-2.0, 2.0], [-2.0, 2.0]), axis=-1).reshape(-1, 3)
VIEWS = [(0.0, 90.0), (-60.0, 40.0), (130.0, 10.0), (20.0, -50.0)]


def spheres(*rows):
    """Spheres of (x, y, z, radius, colour)."""
    return Spheres(
        np.array([row[:3] for row in rows], float),
        np.array([row[3] for row in rows], float),
        np.array([row[4] for row in rows], float),
    )


def sheet(height, size=40):
    """Surface z = height(x, y) over the square from -2 to 2, of size x size cells."""
    x, y = np.meshgrid(*[np.linspace(-2, 2, size + 1)] * 2, indexing="ij")
    points = np.stack([x, y, height(x, y)], axis=-1)
    a, b, c, d = (points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:])
    corners = np.concatenate(
        [np.stack(t, axis=-2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))]
    )
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    colours = np.broadcast_to([0.9, 0.8, 0.7], corners.shape)
    return Surface(corners, np.repeat(normal[:, None], 3, axis=1), colours)


def drawn(things, azimuth, elevation, width, sides=None):
    """Picture of the cube and what is in it."""
    camera = Camera.looking(axes_of(azimuth, elevation), CUBE, width)
    return picture(things, camera, 1.0, sides)


def is_green(image):
    return (image[..., 1] > image[..., 0] + 0.1) & (image[..., 1] > image[..., 2] + 0.1)


def is_red(image):
    return (image[..., 0] > image[..., 1] + 0.1) & (image[..., 0] > image[..., 2] + 0.1)


@pytest.mark.parametrize("view", VIEWS)
def test_what_is_drawn_of_a_sphere_lies_on_it(view):
    camera = Camera.looking(axes_of(*view), CUBE, 300)
    canvas = Canvas(camera, [spheres((0.5, -0.3, 0.2, 1.1, GREEN))])
    places = canvas.places() - [0.5, -0.3, 0.2]
    assert np.linalg.norm(places, axis=1) == pytest.approx(1.1, abs=1e-9)
    assert (places @ camera.axes[2] >= 0).all()
    assert len(places) == pytest.approx(np.pi * (1.1 * camera.scale) ** 2, rel=0.01)


@pytest.mark.parametrize("view", VIEWS)
def test_what_is_drawn_of_a_plane_lies_in_it(view):
    camera = Camera.looking(axes_of(*view), CUBE, 300)
    canvas = Canvas(camera, [sheet(lambda x, y: 0.3 * x)])
    places = canvas.places()
    assert places[:, 2] == pytest.approx(0.3 * places[:, 0], abs=1e-9)
    normal = np.array([-0.3, 0.0, 1.0]) / np.hypot(0.3, 1.0)
    seen = 16 * np.hypot(0.3, 1.0) * abs(normal @ camera.axes[2]) * camera.scale**2
    assert len(places) == pytest.approx(seen, rel=0.02)


@pytest.mark.parametrize("order", [1, -1])
def test_the_nearer_sphere_hides_the_farther(order):
    both = [spheres((0, 0, -1, 1, RED)), spheres((0, 0, 1, 0.5, GREEN))][::order]
    image = drawn(both, 0.0, 90.0, 200)
    middle = np.array(image.shape[:2]) // 2
    assert is_green(image)[tuple(middle)]
    assert is_red(image).sum() > is_green(image).sum()
    from_below = drawn(both, 0.0, -90.0, 200)
    assert is_red(from_below).any() and not is_green(from_below).any()


def test_empty_pixels_are_white():
    image = drawn([spheres((0, 0, 0, 1, RED))], 30.0, 40.0, 200)
    assert (image[[0, 0, -1, -1], [0, -1, 0, -1]] == 1).all()
    assert image.min() >= 0 and image.max() <= 1


def test_a_hill_is_brighter_on_the_lit_side():
    hill = sheet(lambda x, y: 1.5 * np.exp(-(x**2) - y**2), 80)
    image = drawn([hill], -90.0, 90.0, 240).mean(axis=2)
    middle = np.array(image.shape) // 2
    off = image.shape[1] // 8  # half a length, where the hill is steepest
    assert image[middle[0], middle[1] - off] > 1.2 * image[middle[0], middle[1] + off]
    assert image[middle[0] - off, middle[1]] > image[middle[0] + off, middle[1]]


def test_a_sphere_throws_a_shadow_away_from_the_light():
    flat = sheet(lambda x, y: 0 * x)
    ball = spheres((0, 0, 1.2, 0.5, RED))
    bare, both = (drawn(things, -90.0, 90.0, 240) for things in ([flat], [flat, ball]))
    darker = (bare - both).mean(axis=2) > 0.1
    row, column = np.argwhere(darker & ~is_red(both)).mean(axis=0)
    assert column > 1.1 * bare.shape[1] / 2
    assert row > 1.1 * bare.shape[0] / 2


def test_hollows_are_darker_than_the_plane():
    pit = sheet(lambda x, y: -1.5 * np.exp(-4 * (x**2 + y**2)), 80)
    camera = Camera.looking(axes_of(0.0, 90.0), CUBE, 200)
    behind = hollow(Canvas(camera, [pit]).depth, 0.5 * camera.scale)
    middle = np.array(camera.shape) // 2
    assert behind[tuple(middle)] > 0.5
    assert behind[middle[0], middle[1] // 2] < 0.1


# ---- cut by the sides of a box


@pytest.mark.parametrize("view", VIEWS)
def test_a_surface_ends_at_the_sides(view):
    camera = Camera.looking(axes_of(*view), CUBE, 300)
    things = [sheet(lambda x, y: 0.3 * x)]
    places = Canvas(camera, things, (1.0, 1.5)).places()
    assert (places[:, :2] > -1e-9).all() and (places[:, :2] < np.array([1.0, 1.5]) + 1e-9).all()
    inside = Canvas(camera, things).places()
    inside = inside[((inside[:, :2] > 0) & (inside[:, :2] < [1.0, 1.5])).all(axis=1)]
    assert len(places) >= len(inside) > 0


def test_a_sphere_at_a_side_is_whole():
    camera = Camera.looking(axes_of(0.0, 0.0), CUBE, 300)
    places = Canvas(camera, [spheres((0.8, 1.0, 0.0, 0.7, RED))], (1.0, 2.0)).places()
    assert places[:, 0].max() == pytest.approx(1.5, abs=1e-3)
    assert len(places) == pytest.approx(np.pi * 0.7**2 * camera.scale**2, rel=0.02)


def test_zoom_keeps_the_middle():
    views = [Camera.looking(axes_of(30.0, 40.0), CUBE, 200, zoom) for zoom in (1.0, 2.0)]
    assert views[0].shape == views[1].shape
    middles = [camera.project(np.zeros(3))[:2] for camera in views]
    assert middles[0] == pytest.approx(middles[1])
    ends = [camera.project(np.array([0.0, 0.0, 1.0]))[:2] for camera in views]
    assert ends[1] - middles[1] == pytest.approx(2 * (ends[0] - middles[0]))


def test_pixels_of_a_finer_camera_are_parts_of_those_of_the_camera():
    camera = Camera.looking(axes_of(30.0, 40.0), CUBE, 200)
    points = np.array([[0.3, 0.2, 0.1], [-1.0, 0.5, 0.7]])
    inside = (camera.finer(3).project(points)[:, :2] - 1) / 3
    assert inside == pytest.approx(camera.project(points)[:, :2])
