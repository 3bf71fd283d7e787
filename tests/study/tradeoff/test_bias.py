"""Differences of ensembles, and the plot of error against time."""

import numpy as np
import pytest
from lammps_skin.analysis.observables import COLUMNS
from lammps_skin.analysis.statistics import seeds_needed
from lammps_skin.errors import SceneError
from lammps_skin.study.ranges import windows_of
from lammps_skin.study.tradeoff.bias import EFFECT, biases, root_mean_square
from lammps_skin.study.tradeoff.plot import front
from scipy.stats import ttest_ind

TIMES = np.arange(0.0, 101.0, 10.0)


def table(**columns):
    """Table of observables that are 1, but for some columns."""
    made = np.ones(len(TIMES), [(name, float) for name in COLUMNS])
    made["time"] = TIMES
    for name, values in columns.items():
        made[name] = values
    return made


def test_differences():
    late = TIMES > 45
    reference = {seed: table(zeta=seed * late, deaths=10 * seed * TIMES) for seed in (1, 2, 3, 9)}
    shifts = {1: 0.1, 2: 0.2, 3: 0.6, 4: 7.0}
    ours = {
        seed: table(zeta=(seed + shift) * late, deaths=9 * seed * TIMES)
        for seed, shift in shifts.items()
    }
    found = {
        (bias.name, bias.window): bias for bias in biases(ours, reference, [(0, 40), (50, 100)])
    }
    zeta = found["zeta", (50, 100)]
    values, others = np.array([1.1, 2.2, 3.6, 11.0]), np.array([1.0, 2, 3, 9])
    assert (zeta.seeds, zeta.reference_seeds) == (4, 4)
    assert zeta.reference == pytest.approx(others.mean())
    assert zeta.difference == pytest.approx(values.mean() - others.mean())
    assert zeta.in_errors == pytest.approx(ttest_ind(values, others).statistic)
    assert zeta.percent == pytest.approx(np.mean([10, 10, 20]))  # of the seeds that both have
    assert zeta.percent_error == pytest.approx(np.std([10, 10, 20], ddof=1) / np.sqrt(3))
    assert zeta.needed == seeds_needed(np.std([0.1, 0.2, 0.6], ddof=1), EFFECT * zeta.deviation)
    deaths = found["deaths", (50, 100)]
    assert deaths.reference == pytest.approx(10 * others.mean() * 50)
    assert deaths.percent == pytest.approx(-10) and deaths.percent_error == pytest.approx(0)
    early = found["zeta", (0, 40)]
    assert early.difference == 0 and np.isnan(early.in_errors) and np.isnan(early.percent)


def test_one_seed_has_a_difference_without_an_error():
    found = biases({1: table(zeta=2.0)}, {1: table(zeta=1.0)}, [(0, 100)])
    (zeta,) = [bias for bias in found if bias.name == "zeta"]
    assert zeta.difference == 1 and zeta.percent == 100
    assert np.isnan([zeta.error, zeta.percent_error, zeta.needed]).all()
    assert np.isnan(root_mean_square(found))


def test_the_same_has_no_bias():
    rng = np.random.default_rng(5)
    same = {seed: table(chi_H=rng.normal(size=len(TIMES))) for seed in range(1, 5)}
    found = biases(same, same, [(0, 100)])
    assert root_mean_square(found) == 0


def test_what_a_scene_does_not_have_is_left_out():
    """Order parameters of ND cells, without ND cells."""
    tables = {1: table(zeta_nd=np.nan), 2: table(zeta_nd=np.nan)}
    names = {bias.name for bias in biases(tables, tables, [(0, 100)])}
    assert "zeta" in names and "sigma_nd" in names and "zeta_nd" not in names


def test_windows():
    assert windows_of(None, 1000) == [(300, 600), (800, 1000)]
    assert windows_of("0-5,6.5-10", 10) == [(0, 5), (6.5, 10)]
    for text in ("5", "5-", "a-b", "5-3", "0-11", "-1-3", "nan-3", ""):
        with pytest.raises(SceneError, match="--windows"):
            windows_of(text, 10)


def test_front():
    points = np.array([(1, 1), (0.5, 2), (0.7, 3), (2, 1), (3, 0.5), (0.5, 4)])
    assert front(points) == [1, 0, 4]
