"""The event log of a crowded membrane is what it was, whatever has changed in the plugin."""

import csv
from pathlib import Path

import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation

from tests.cells.conftest import FOUR_STEPS, QUIET

KEPT = Path(__file__).parent / "data" / "crowded.csv"
CROWDED = {
    "parameters": "weak5", "membrane.lattice": [24, 28], "cells.stem": 4, "cells.nd": 2,
    "cells.arrangement": "random", "cells.generations": 2, "cells.cycle_delay": 2.0,
    "cells.cycle_rate": 0.5, "cells.first_phase": 2.0, "cells.division_rate": 1.4,
    "cells.seed": 3, "end_time": 20.0, "numerics": FOUR_STEPS, "output": QUIET,
}  # fmt: skip
PLACE = 1e-3  # processors round otherwise


def split(path: Path) -> tuple[list[list[str]], list[float]]:
    """Rows without places, and the places."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    places = [float(row.pop(axis)) for row in rows for axis in "xyz"]
    return [list(row.values()) for row in rows], places


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_the_event_log_is_what_it_was(ranks: int, tmp_path: Path) -> None:
    """Births of both kinds, ends of both kinds of pairs, deaths of both kinds."""
    scene = Scene.load("no-dermis").replace(**CROWDED)
    with Simulation.begin(scene, tmp_path, ranks=ranks) as simulation:
        simulation.run()
    (found, places), (kept, old_places) = split(tmp_path / "events.csv"), split(KEPT)
    assert found == kept
    assert places == pytest.approx(old_places, abs=PLACE)
    assert {(row[1], row[4], row[6]) for row in kept} == {
        ("birth", "4", "division"), ("birth", "5", "division"),
        ("division_end", "4", "grown"), ("division_end", "5", "grown"),
        ("division_end", "4", "partner_removed"), ("division_end", "5", "partner_removed"),
        ("death", "4", "detached"), ("death", "5", "detached"),
    }  # fmt: skip
