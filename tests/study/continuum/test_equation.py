"""The continuum equation against what is known of its solutions."""

from __future__ import annotations

import numpy as np
import pytest
from lammps_skin.study.continuum.comparison import Fields, coefficients, growth
from lammps_skin.study.continuum.equation import Continuum
from lammps_skin.study.ranges import Window

SIDE = 20.0
DRAG, LEVER = 5.0, 1.4


def restoring(k: np.ndarray) -> np.ndarray:
    return 0.02 * k + 0.05 * k**4


CONTINUUM = Continuum(DRAG, LEVER, restoring)
SYMMETRIC = Continuum(DRAG, 0.0, restoring)


def line(points: int) -> np.ndarray:
    return np.arange(points) * SIDE / points


def test_waves_grow_as_they_should_under_a_constant_pull() -> None:
    """At (K k^2 - R(k))/tau; the fastest of R = c k^4 has k^2 = K/(2 c)."""
    x, times = line(32), np.linspace(0, 40, 5)
    for n in (1, 3, 6):
        k = 2 * np.pi * n / SIDE
        found = CONTINUUM.solve(0.1 * np.cos(k * x), np.full(32, 0.12), [SIDE], times)
        rate = (0.12 * k**2 - restoring(k)) / DRAG
        assert CONTINUUM.growth(np.array([k]), 0.12)[0] == pytest.approx(rate)
        expected = 0.1 * np.exp(rate * times)[:, None] * np.cos(k * x)
        np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-6)
    waves = np.linspace(0.01, 3, 3000)
    quartic = Continuum(DRAG, LEVER, lambda k: 0.05 * k**4)
    fastest = waves[quartic.growth(waves, 0.12).argmax()]
    assert fastest == pytest.approx(np.sqrt(0.12 / (2 * 0.05)), abs=2e-3)


def test_up_and_down_differ_by_the_lever_alone() -> None:
    """Without R_c, -h solves the equation if h does; with it a flat membrane rises where K is."""
    x, times = line(48), np.array([0.0, 10.0])
    pull = 0.1 + 0.05 * np.exp(-((x - 10) ** 2) / 8)
    height = 0.2 * np.sin(2 * np.pi * x / SIDE) + 0.1 * np.cos(6 * np.pi * x / SIDE)
    up, down = (SYMMETRIC.solve(sign * height, pull, [SIDE], times)[-1] for sign in (1, -1))
    np.testing.assert_allclose(up, -down, atol=1e-6)
    assert not SYMMETRIC.solve(0 * x, pull, [SIDE], times).any()
    raised = CONTINUUM.solve(0 * x, pull, [SIDE], times)[-1]
    assert raised.argmax() == np.argmax(pull) and raised.mean() == pytest.approx(0, abs=1e-12)
    up, down = (CONTINUUM.solve(sign * height, pull, [SIDE], times)[-1] for sign in (1, -1))
    np.testing.assert_allclose(up + down, 2 * raised, atol=1e-6)  # the part that has no mirror


def test_the_solution_does_not_depend_on_the_grid() -> None:
    """Nor on the direction: a field of x alone in the plane is that of the line."""
    times = np.array([0.0, 15.0])
    found = {}
    for points in (16, 32, 64):
        x = line(points)
        pull = 0.1 + 0.05 * np.cos(2 * np.pi * x / SIDE)
        height = 0.2 * np.sin(4 * np.pi * x / SIDE)
        found[points] = CONTINUUM.solve(height, pull, [SIDE], times)[-1][:: points // 16]
    np.testing.assert_allclose(found[16], found[64], atol=1e-4)
    np.testing.assert_allclose(found[32], found[64], atol=1e-6)
    x = line(16)
    pull = np.tile(0.1 + 0.05 * np.cos(2 * np.pi * x / SIDE), (6, 1))
    height = np.tile(0.2 * np.sin(4 * np.pi * x / SIDE), (6, 1))
    plane = CONTINUUM.solve(height, pull, [4.0, SIDE], times)[-1]
    np.testing.assert_allclose(plane, np.tile(found[16], (6, 1)), atol=1e-5)


def test_terms_are_those_of_finite_differences() -> None:
    """In the plane, with a pull that varies."""
    x = line(128)
    a = 2 * np.pi / SIDE
    height = np.sin(a * x)[:, None] * np.cos(2 * a * x)
    pull = 1 + 0.5 * np.cos(a * x)[:, None] * np.sin(a * x)

    def slope(field: np.ndarray, axis: int) -> np.ndarray:
        return (np.roll(field, -1, axis) - np.roll(field, 1, axis)) / (2 * SIDE / 128)

    growing, lifting, resisting = CONTINUUM.terms(height, pull, [SIDE, SIDE])
    flow = [slope(pull * slope(height, axis), axis) for axis in (0, 1)]
    np.testing.assert_allclose(growing, -sum(flow), atol=0.01)
    np.testing.assert_allclose(lifting, -sum(slope(slope(pull, n), n) for n in (0, 1)), atol=0.01)
    np.testing.assert_allclose(resisting, restoring(np.sqrt(5) * a) * height, atol=1e-10)


@pytest.fixture(scope="module")
def solved() -> Fields:
    """Heights that the equation gives, under a pull that wanders."""
    x = line(24)
    a = 2 * np.pi / SIDE
    wave = np.cos(2 * a * x)[:, None] * np.sin(a * x) + np.sin(a * x)[:, None]
    times = np.arange(0, 41.0, 1.0)

    def pull(time: float) -> np.ndarray:
        return np.asarray(0.12 + 0.02 * np.cos(0.1 * time) * wave)

    heights = CONTINUUM.solve(0.01 * wave.T, pull, [SIDE, SIDE], times)
    return Fields(times, heights, np.array([pull(time) for time in times]), [SIDE, SIDE])


def test_the_terms_of_a_solution_are_found_in_it(solved: Fields) -> None:
    found = coefficients(solved, CONTINUUM, 1.0, (0.0, 2.0))
    assert found.first == pytest.approx(1, abs=0.02)
    assert found.second == pytest.approx(LEVER, abs=0.02)
    assert found.explained > 0.99


def test_noise_of_the_pull_makes_least_squares_too_small_but_not_instruments(
    solved: Fields,
) -> None:
    """Each frame has noise of its own, more than twice what varies of the pull."""
    random = np.random.default_rng(1)
    found = []
    for _ in range(12):
        pull = solved.pull + random.normal(scale=0.05, size=solved.pull.shape)
        noisy = solved._replace(pull=pull)
        found.append(
            [coefficients(noisy, CONTINUUM, 1.0, (0.0, 0.8), earlier).second for earlier in (0, 2)]
        )
    least, instruments = np.mean(found, axis=0)
    assert least < 0.75 * LEVER
    assert instruments == pytest.approx(LEVER, abs=3 * 0.06 / np.sqrt(len(found)))


def test_growth_of_a_wave_is_found(solved: Fields) -> None:
    """Above what was there before."""
    x, times = line(24), solved.time
    wave = np.cos(6 * np.pi * x / SIDE)[:, None] * np.ones(24)
    grown = np.where(times < 20, 0, 0.01 * np.exp(0.03 * times))
    bumps = 0.005 * np.sin(6 * np.pi * x / SIDE)[:, None]
    fields = solved._replace(height=grown[:, None, None] * wave + bumps)
    k = 6 * np.pi / SIDE
    bands = [(k - 0.05, k + 0.05)]
    found = growth(fields, Window(0, 10), Window(20, 40), bands)
    assert found[0] == pytest.approx(0.03, rel=1e-3)


def test_a_coarse_grid_keeps_long_waves(solved: Fields) -> None:
    coarse = solved.coarse(SIDE / 12)
    assert coarse.height.shape[1:] == (12, 12)
    np.testing.assert_allclose(coarse.height[0], solved.height[0, ::2, ::2], atol=1e-12)
    between = coarse.pull[3:5].mean(axis=0)
    np.testing.assert_allclose(coarse.pull_at(3.5), between, atol=1e-12)
