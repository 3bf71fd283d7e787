"""The potentials of the numpy model against closed forms."""

from dataclasses import replace
from math import cos, pi

import numpy as np
import pytest
from numpy_model import (
    Parameters,
    State,
    energies_and_forces,
    named,
    phi,
    u_adhesion,
    u_binding,
    u_dermis_dermis,
    u_dermis_membrane,
    u_exclusion,
    u_stretch,
)
from plain_potentials import plain_phi, table_dermis_dermis


@pytest.mark.parametrize("angle", [0.01, 0.7, pi / 2, 3.0, -1.0])
def test_bending_of_one_hinge(angle: float) -> None:
    """Two triangles at an angle cost K/2 (1 - cos)^2."""
    corners = [[-0.4, 0.1, 0.0], [0, 0, 0], [0, 0.5, 0], [0.3 * cos(angle), 0.2, 0]]
    positions = np.array(corners) + np.array([10, 10, 5])
    positions[3, 2] += 0.3 * np.sin(angle)
    hinge = np.array([[0, 1, 2, 3]])
    state = State(np.full(4, "M"), positions, (20.0, 20.0), np.zeros(4, int), hinges=hinge)
    energies, _ = energies_and_forces(state, Parameters())
    assert energies["bend"] == pytest.approx(0.25 * (1 - cos(angle)) ** 2, rel=1e-9)


@pytest.mark.parametrize("x", [0.3, 0.79, 0.85, 0.99, 1.0, 1.2, 1.39, 1.5])
def test_dermal_potential(x: float) -> None:
    """The dermal potential is the table's on all its branches."""
    value, _ = u_dermis_dermis(np.array(x), Parameters())
    assert value == pytest.approx(table_dermis_dermis(x), rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("scale", [1.0, 2.0])
@pytest.mark.parametrize("x", [0.2, 0.24, 0.3, 0.9, 1.0, 1.05, 1.2])
def test_stretch_potential(x: float, scale: float) -> None:
    """The link potential is the table's on all its branches, the springs scaled."""
    if x < 0.25:
        expected = plain_phi(4 * x)
    elif x <= 1:
        expected = scale * 0.625 * (4 * x - 1) ** 2 - 1 / 12
    else:
        expected = plain_phi((1.25 - x) / 0.25) + scale * (-9.375 + 15 * x)
    value, _ = u_stretch(np.array(x), Parameters(), scale)
    assert value == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("scale", [1.0, 2.0])
@pytest.mark.parametrize("x", [0.25, 1.0])
def test_stretch_is_smooth(x: float, scale: float) -> None:
    """Value and slope of the link potential are continuous where its branches meet."""
    ends = np.array([x - 1e-9, x + 1e-9])
    value, slope = u_stretch(ends, Parameters(), scale)
    assert value[0] == pytest.approx(value[1], abs=1e-6)
    assert slope[0] == pytest.approx(slope[1], abs=1e-5)
    assert slope[1] == pytest.approx(0 if x < 1 else 15 * scale, abs=1e-5)


def test_minima_and_plateaus() -> None:
    """The potentials have the values one can do in one's head."""
    p = named("papilla")
    value, slope = phi(np.array([1.0, 0.5]))
    np.testing.assert_allclose(value, [-1 / 12, 4096 / 12 - 64 / 6], rtol=1e-14)
    np.testing.assert_allclose(slope, [0, 128 - 8192], atol=1e-11)
    value, slope = u_exclusion(np.array([0.5, 1.0, 1.2]))
    np.testing.assert_allclose(value, [4096 / 12 - 64 / 6 + 1 / 12, 0, 0], atol=1e-15)
    np.testing.assert_allclose(slope, [128 - 8192, 0, 0], atol=1e-11)
    value, slope = u_dermis_membrane(np.array([1.0, 1.4, 2.0]), p)
    np.testing.assert_allclose(value, [-1 / 12 - plain_phi(1.4), 0, 0], atol=1e-15)
    np.testing.assert_allclose(slope, [0, 0, 0], atol=1e-15)
    value, slope = u_adhesion(np.array([0.5, 1.0, 1.1, 1.2, 2.0]), p)
    np.testing.assert_allclose(value, [0, 0, 0.005 - 1e-4 / 0.16, 0.01, 0.01], atol=1e-15)
    np.testing.assert_allclose(slope, [0, 0, 0.1 - 1e-3 / 0.04, 0, 0], atol=1e-15)
    value, slope = u_binding(np.array([0.5, 1.0, 1.5]))
    np.testing.assert_allclose([value, slope], [[0, 0, 0.125], [0, 0, 0.5]], atol=1e-15)


def test_link_at_its_singularity_is_refused() -> None:
    """A link of length 2.5 has no energy."""
    state = State(
        np.full(2, "M"),
        np.array([[5.0, 5.0, 5.0], [5.0, 5.0, 7.5]]),
        (20.0, 20.0),
        np.zeros(2, int),
        links=np.array([[0, 1]]),
    )
    with pytest.raises(ValueError, match=r"x = 1\.25"):
        energies_and_forces(state, Parameters())


def test_parameter_sets() -> None:
    """The named sets differ from print in what the description lists; others do not exist."""
    assert named("printed") == Parameters()
    assert named("papilla") == Parameters(division_spring="length", lam=1.2)
    assert named("weak5") == Parameters(division_spring="length", Kad=5)
    assert named("direct5") == replace(named("weak5"), force_scale="direct")
    with pytest.raises(ValueError, match="'strong'"):
        named("strong")
    with pytest.raises(ValueError, match="'indirect'"):
        Parameters(force_scale="indirect")
    with pytest.raises(ValueError, match="length"):
        Parameters(force_scale="direct", division_spring="reduced")
