"""The answer of a membrane to a push, in LAMMPS."""

from __future__ import annotations

import numpy as np
import pytest
from lammps_skin import Scene, SceneError
from lammps_skin.study.continuum.response import Response, measure


def test_a_free_membrane_moves_with_its_push() -> None:
    """Without a dermis nothing resists a small wave: bending and stretch are of higher order."""
    scene = Scene.load("one-stem").replace(**{"dermis.present": False})
    found = measure(scene, np.array([1, 2]), 0.001, end=20.0, every=10.0)
    np.testing.assert_allclose(found.wave_numbers, np.array([1, 2]) * 2 * np.pi / 12)
    mobility, rate = found.fitted()
    np.testing.assert_allclose(mobility, 1, atol=0.01)
    np.testing.assert_allclose(rate, 0, atol=2e-3)
    np.testing.assert_allclose(found.heights[2], 0.02, rtol=0.02)
    np.testing.assert_allclose(found.relaxed(), 0, atol=2e-3)


def test_drag_and_rate_are_found_in_courses() -> None:
    times = np.arange(0, 101, 5.0)
    rates, mobility = np.array([0.0, 0.004, 0.03]), np.array([1.0, 0.97, 0.9])
    pushed = np.minimum(times, 50)[:, None]
    with np.errstate(invalid="ignore"):
        grown = np.where(rates > 0, -np.expm1(-rates * pushed) / rates, pushed)
    left = np.exp(-rates * np.maximum(times - 50, 0)[:, None])
    found = Response(np.array([0.1, 0.5, 1.0]), times, 0.002 * mobility * grown * left, 0.002, 50.0)
    np.testing.assert_allclose(found.fitted(), [mobility, rates], atol=1e-6)
    np.testing.assert_allclose(found.relaxed(), rates, atol=1e-9)


def test_waves_that_do_not_fit_are_rejected() -> None:
    with pytest.raises(SceneError, match=r"modes = \[0, 1\]: must be whole numbers from 1 to 6"):
        measure(Scene.load("one-stem"), np.array([0, 1]), 0.001)
