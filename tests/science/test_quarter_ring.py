"""The quarter-ring scene to t = 1000: covered, with outward papillae, and without a fault."""

import re
from pathlib import Path

import pytest
from lammps_skin.analysis.observables import observables
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation

# a periodic sheet closes on itself, and the dermal force jumps to 0 at its cutoff
EXPECTED_WARNINGS = (
    "Inconsistent image flags",
    "force values in table DERMIS_DERMIS are inconsistent with -dE/dr.",
    "Should only be flagged at inflection points",
)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_quarter_ring(seed: int, tmp_path: Path) -> None:
    """Means over t = 400 to 1000 of one seed; the numbers of several are in the documents."""
    scene = Scene.load("quarter-ring").replace(seed=seed)
    with Simulation.begin(scene, tmp_path) as simulation:
        simulation.run()
        cells = simulation.cells()

    table = observables(tmp_path)
    late = {name: table[name][table["time"] >= 400].mean() for name in table.dtype.names}
    assert table["time"][-1] == pytest.approx(1000)
    assert late["coverage"] > 0.95
    assert late["papillae"] > 10
    assert late["papilla_height"] > scene.cells.radius
    assert late["skewness"] > 0.5
    assert late["chi_H"] > 0
    assert late["zeta"] > 0.5
    assert (cells.types == 3).sum() == scene.cells.stem

    kinds = re.findall(r"^[^,\n]+,(birth|death),", (tmp_path / "events.csv").read_text(), re.M)
    assert scene.cells.stem + kinds.count("birth") - kinds.count("death") == len(cells.ids)
    warnings = re.findall(r"WARNING: *(.*)", (tmp_path / "log.lammps").read_text())
    assert not [line for line in warnings if not any(text in line for text in EXPECTED_WARNINGS)]
