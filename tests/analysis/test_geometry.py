"""Periodic distances against all images by brute force."""

from itertools import product

import numpy as np
import pytest
from lammps_skin.analysis.geometry import images, minimum_image, nearest, wrapped

BOX = (5.0, 3.0)
IMAGES = np.array([(5.0 * i, 3.0 * j, 0.0) for i, j in product(range(-4, 5), repeat=2)])


def test_minimum_image_is_the_shortest():
    vectors = np.random.default_rng(1).uniform(-8, 8, (200, 3))
    shortest = np.linalg.norm(vectors[:, None] + IMAGES, axis=-1).min(axis=1)
    found = minimum_image(vectors, BOX)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), shortest, rtol=1e-13)
    boxes = (found - vectors)[:, :2] / BOX
    np.testing.assert_allclose(boxes, np.round(boxes), atol=1e-13)
    np.testing.assert_array_equal(minimum_image(vectors[:, :2], BOX), found[:, :2])
    assert minimum_image(vectors, None) is vectors


def test_wrapped_is_inside_and_leaves_z():
    positions = np.array([[-1e-18, 3.0, -7.0], [5.0, -0.5, 70.0], [12.5, 2.0, 1.0]])
    before = positions.copy()
    np.testing.assert_allclose(wrapped(positions, BOX), [[0, 0, -7], [0, 2.5, 70], [2.5, 2, 1]])
    np.testing.assert_array_equal(positions, before)


def test_nearest_is_the_true_nearest_through_the_edges():
    random = np.random.default_rng(2)
    points, targets = random.uniform(-6, 9, (100, 3)), random.uniform(-6, 9, (40, 3))
    every = np.linalg.norm(points[:, None, None] - targets[:, None] - IMAGES, axis=-1).min(axis=-1)
    index, distance = nearest(points, targets, BOX)
    np.testing.assert_array_equal(index, every.argmin(axis=1))
    np.testing.assert_allclose(distance, every.min(axis=1), rtol=1e-12)


def test_z_is_open():
    _, distance = nearest(np.array([[0, 0, 0.1]]), np.array([[0, 0, 99.9]]), (5.0, 3.0, 100.0))
    np.testing.assert_allclose(distance, 99.8)


def test_images_are_those_that_reach_into_the_box():
    box, points = (4.0, 6.0), np.array([[0.5, 3.0, 1.0], [2.0, 2.0, 2.0], [3.9, 5.8, 3.0]])
    places, index = images(points, box, np.array([1.0, 1.0, 0.3]))
    found = sorted(zip(index.tolist(), places.tolist(), strict=True))
    assert found == [
        (0, [0.5, 3.0, 1.0]), (0, [4.5, 3.0, 1.0]), (1, [2.0, 2.0, 2.0]),
        (2, pytest.approx([-0.1, -0.2, 3.0])), (2, pytest.approx([-0.1, 5.8, 3.0])),
        (2, pytest.approx([3.9, -0.2, 3.0])), (2, [3.9, 5.8, 3.0]),
    ]  # fmt: skip
    assert len(images(points[:0], box, 1.0)[1]) == 0
