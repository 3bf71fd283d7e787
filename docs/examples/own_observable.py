"""An observable of one's own: how far TA cells have come from the nearest stem cell.

python docs/examples/own_observable.py runs/demo
"""

import sys
from typing import Any

import numpy as np
from lammps_skin import open_trajectory
from lammps_skin.analysis.geometry import periodic_tree
from lammps_skin.analysis.state import State, StateAnalysis
from lammps_skin.kinds import Kind


class DistanceFromStem(StateAnalysis):
    """``results.distance`` (f,): mean distance in the plane from TA cells to a stem cell."""

    columns = ("distance",)

    def _measure(self, state: State) -> tuple[Any, ...]:
        stem, ta = (state.cells[state.kinds == kind][:, :2] for kind in (Kind.STEM, Kind.TA))
        if not len(ta):
            return (np.nan,)
        distances, _ = periodic_tree(stem, state.box).query(ta)
        return (distances.mean(),)


found = DistanceFromStem(open_trajectory(sys.argv[1])).run(step=2).results
for time, distance in zip(found.time, found.distance, strict=True):
    print(f"t = {time:g}: {distance:.2f}")
