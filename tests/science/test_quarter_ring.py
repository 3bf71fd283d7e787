"""The default set makes a basal layer on outward papillae, and without a fault."""

import re
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.analysis.basal_layer import LAYER
from lammps_skin.analysis.observables import observables
from lammps_skin.arrays import Floats
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation

# a periodic sheet closes on itself, and the dermal force jumps to 0 at its cutoff
EXPECTED_WARNINGS = (
    "Inconsistent image flags",
    "force values in table DERMIS_DERMIS are inconsistent with -dE/dr.",
    "Should only be flagged at inflection points",
)


def at(table: Floats, name: str, times: list[float]) -> Floats:
    """Values of a column at times of frames."""
    return table[name][np.searchsorted(table["time"], times)]


def test_a_small_patch(tmp_path: Path) -> None:
    scene = Scene.load("demo").replace(end_time=400.0)
    with Simulation.begin(scene, tmp_path) as simulation:
        simulation.run()
    table = observables(tmp_path)
    assert at(table, "coverage", [250.0, 400.0]).min() > 0.95
    assert at(table, "none_below", [250.0, 400.0]).min() >= LAYER
    assert table["most_on_particle"].max() <= 7  # as many as eight runs of `reference` have


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_quarter_ring(seed: int, tmp_path: Path) -> None:
    """Means over t = 400 to 1000 of one seed; the numbers of several are in the documents."""
    scene = Scene.load("quarter-ring").replace(seed=seed)
    with Simulation.begin(scene, tmp_path) as simulation:
        simulation.run()
        cells = simulation.cells()

    table = observables(tmp_path)
    assert table["time"][-1] == pytest.approx(1000)
    assert at(table, "none_below", [400.0, 700.0, 1000.0]).min() >= LAYER
    late = {name: table[name][table["time"] >= 400].mean() for name in table.dtype.names}
    assert late["coverage"] > 0.95
    assert late["papillae"] > 10
    assert late["papilla_height"] > 1.0
    assert late["skewness"] > 0.5
    assert late["chi_H"] > 0.1
    assert late["zeta"] > 0.1
    assert late["stem_on_tips"] > late["stem_tips_expected"]
    assert (cells.types == 3).sum() == scene.cells.stem

    kinds = re.findall(r"^[^,\n]+,(birth|death),", (tmp_path / "events.csv").read_text(), re.M)
    assert scene.cells.stem + kinds.count("birth") - kinds.count("death") == len(cells.ids)
    warnings = re.findall(r"WARNING: *(.*)", (tmp_path / "log.lammps").read_text())
    assert not [line for line in warnings if not any(text in line for text in EXPECTED_WARNINGS)]
