"""What `skin run` tells of the tissue that it has come to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lammps_skin import Configuration, Scene, Simulation
from lammps_skin.cli.monitor import RunMonitor
from lammps_skin.start.configuration import PER_PARTICLE


def scene_of(cells: int) -> Scene:
    """ND cells side by side all over a small membrane."""
    return Scene.from_dict(
        {
            "end_time": 0.25,
            "dermis": {"present": False},
            "membrane": {"lattice": [26, 30]},
            "cells": {
                "nd": cells, "arrangement": "cluster", "adhesion_range": 1.8,
                "binding_stiffness": 0.0,
            },
        }
    )  # fmt: skip


def stacked(one: Configuration, rise: float) -> Configuration:
    """The same with another cell above each cell."""
    rows = np.append(np.arange(len(one.kinds)), np.flatnonzero(one.is_cell))
    arrays = {name: getattr(one, name)[rows] for name in ("kinds", "positions", *PER_PARTICLE)}
    arrays["positions"][len(one.kinds) :, 2] += rise
    return replace(one, ids=np.arange(1, len(rows) + 1), **arrays)


@pytest.mark.parametrize(("layers", "said"), [(1, False), (2, True)])
def test_a_covered_heap_of_cells_is_told_of(tmp_path, layers, said):
    scene = scene_of(12)
    start = Configuration.from_scene(scene)
    if layers == 2:
        start = stacked(start, 2.0)
    with Simulation.begin(scene, tmp_path, configuration=start) as simulation:
        monitor = RunMonitor(simulation, None)
        monitor.go()
    lines = list(monitor.lines(tmp_path / "events.csv"))
    assert f"{12 * layers} ND; 0 births, 0 removals" in lines
    assert any(line.endswith("% of the membrane within reach of a cell") for line in lines)
    heap = "not a basal layer at t = 0.25: 50% of the cells have another cell straight below them"
    assert any(line.startswith(heap) for line in lines) == said, lines
