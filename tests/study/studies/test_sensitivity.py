"""Sensitivities of observables, from a table of means that is made up."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from lammps_skin.study.studies.runs import Study
from lammps_skin.study.studies.samples import Sample
from lammps_skin.study.studies.sensitivity import draw, effects, has_indices, sensitivities


@pytest.fixture
def morris(study: Callable[..., Study]) -> Study:
    return study(end="""
        [conditions.a]
        [conditions.b]
        cells.generations = 3
        [sample]
        method = "morris"
        n = 4
        [sample.ranges]
        cells.radius = [1.0, 2.0]
        box_height = [100.0, 101.0]
        """)


def test_effects_of_each_condition(morris: Study) -> None:
    """zeta = 2 R_c in one condition, and -R_c in the other, of which a column lacks a value."""
    design, sample = morris.design, morris.design.sample
    assert sample
    assert has_indices(sample)
    radius = np.array([point.values["cells.radius"] for point in design.points])
    zeta = np.where([point.condition == "a" for point in design.points], 2 * radius, -radius)
    labels = [point.label for point in design.points]
    sigma = np.where(np.arange(len(labels)) == len(labels) - 1, np.nan, radius)
    kinds = [(name, float) for name in ("seed", "time", "zeta", "sigma")]
    courses = {
        label: np.array([(1.0, window.end, *values) for window in design.windows], kinds)
        for label, *values in zip(labels, zeta, sigma, strict=True)
    }
    found = sensitivities(sample, labels, courses, ["zeta", "sigma"], design.windows[-1])
    assert [one.what for one in found] == ["a, zeta", "a, sigma", "b, zeta", "b, sigma"]
    heads = found[0].heads
    of_radius = [found[n].values[0, heads.index("mu")] for n in (0, 2)]
    np.testing.assert_allclose(of_radius, [2, -1], rtol=1e-6)
    np.testing.assert_allclose(found[0].values[1], 0, atol=1e-6)
    assert len(found[1].values) and not len(found[3].values)
    table = effects(sample, [found[0], found[2]])
    assert table[0] == "| key | a, zeta | b, zeta |"
    assert table[2].startswith("| `cells.radius` | **2")
    figure = draw(sample, found)
    for axes, one in zip(figure.axes, found, strict=True):
        assert axes.get_xlabel().split()[-1] == one.what.split(",")[0]  # the condition


def test_halves_that_are_alike_are_told() -> None:
    """Of five keys 16 points are too few: indices of a sum of three are then far from a third."""
    ranges = {name: (0.0, 1.0) for name in "abcde"}
    few, more = (Sample("sobol", n, 1, ranges) for n in (16, 32))
    assert few.remark.startswith("sample.n = 16: the two halves of so few points are alike")
    assert not more.remark and not Sample("morris", 4, 1, ranges).remark
    totals = []
    for sample in (few, more):
        results = sample._unit()[:, :3].sum(axis=1)
        heads, values = sample.sensitivity(results)
        totals.append(values[:3, heads.index("total")])
    assert abs(totals[0] - 1 / 3).max() > 0.2 > 0.1 > abs(totals[1] - 1 / 3).max()
