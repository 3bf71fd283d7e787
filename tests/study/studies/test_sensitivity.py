"""Sensitivities of observables, from a table of means that is made up."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from lammps_skin.study.studies.runs import Study
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
    design = morris.design
    assert has_indices(design)
    radius = np.array([point.values["cells.radius"] for point in design.points])
    zeta = np.where([point.condition == "a" for point in design.points], 2 * radius, -radius)
    labels = [point.label for point in design.points]
    means = {"point": labels, "window": [str(design.windows[-1])] * len(labels), "zeta": zeta}
    means["sigma"] = np.where(np.arange(len(labels)) == len(labels) - 1, np.nan, radius)
    found = sensitivities(design, means, ["zeta", "sigma"])
    assert [one.what for one in found] == ["a, zeta", "a, sigma", "b, zeta", "b, sigma"]
    heads = found[0].heads
    of_radius = [found[n].values[0, heads.index("mu")] for n in (0, 2)]
    np.testing.assert_allclose(of_radius, [2, -1], rtol=1e-6)
    np.testing.assert_allclose(found[0].values[1], 0, atol=1e-6)
    assert len(found[1].values) and not len(found[3].values)
    table = effects(design, [found[0], found[2]])
    assert table[0] == "| key | a, zeta | b, zeta |"
    assert table[2].startswith("| `cells.radius` | **2")
    figure = draw(design, found)
    assert [axes.get_title() for axes in figure.axes] == [one.what for one in found]
