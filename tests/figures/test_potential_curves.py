"""The curves of the potentials: their known values, and which of them differ between sets."""

from __future__ import annotations

import numpy as np
import pytest
from lammps_skin.figures.potential_curves import curves, draw_potentials
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import TERMS


@pytest.fixture(params=["printed", "papilla", "direct5"])
def scene(request):
    return Scene.load("quarter-nd-a").replace(parameters=request.param)


def test_every_term_has_a_curve(scene):
    found = curves(scene)
    assert tuple(found) == TERMS
    for curve in found.values():
        assert np.isfinite(curve.energy).all()
        assert np.ptp(curve.energy) > 0


def test_known_values(scene):
    found = curves(scene)
    scale = scene.contact if scene.force_scale == "direct" else 1.0
    depth = scale * scene.cells.adhesion_stiffness * (scene.cells.adhesion_range - 1) ** 2 / 4
    assert found["adhesion"].energy[-1] == pytest.approx(depth)
    assert found["bend"].energy[-1] == pytest.approx(2 * scene.membrane.bending_stiffness)
    well = found["dermis_membrane"]
    assert well.x[well.energy.argmin()] == pytest.approx(1, abs=2e-3)
    stretch = found["stretch"]
    assert stretch.singular == 1.25
    assert stretch.x[stretch.energy.argmin()] == pytest.approx(0.25, abs=2e-3)
    assert stretch.x[-1] < stretch.singular
    for name in ("wall", "membrane_exclusion", "cell_membrane_exclusion", "cell_cell_exclusion"):
        assert not found[name].energy[found[name].x >= 1].any()


def test_panels_show_where_the_sets_differ():
    figure = draw_potentials(("printed", "papilla"))
    titles = [axes.get_title() for axes in figure.axes]
    assert titles == [term.replace("_", "-") for term in TERMS]
    both = {
        axes.get_title() for axes in figure.axes
        if "papilla" in [line.get_label() for line in axes.lines]
    }  # fmt: skip
    assert both == {"adhesion", "cell-cell-adhesion", "division"}
    stretch = figure.axes[TERMS.index("stretch")]
    assert [line.get_xdata()[0] for line in stretch.lines if line.get_label() == "singular"] == [
        1.25
    ]
