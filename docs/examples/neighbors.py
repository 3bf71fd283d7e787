"""Which cells stand next to stem cells, and how cells lie around them.

python docs/examples/neighbors.py runs/demo
"""

import sys

import numpy as np
from lammps_skin import open_trajectory
from lammps_skin.analysis.radial import InPlaneRDF
from MDAnalysis.lib.distances import capped_distance

REACH = 2.8  # the diameter of a cell

universe = open_trajectory(sys.argv[1])
stem = universe.select_atoms("type stem", updating=True)
cells = universe.select_atoms("type stem ta exhausted", updating=True)

print("    time  neighbors of a stem cell  of which stem cells")
for moment in universe.trajectory:
    pairs = capped_distance(
        stem.positions, cells.positions, REACH, box=moment.dimensions, return_distances=False
    )
    around = cells[pairs[:, 1]]
    others = around[around.ids != stem[pairs[:, 0]].ids]  # a cell is no neighbor of its own
    of_stem = np.mean(others.types == "stem") if len(others) else 0.0
    print(f"{moment.time:8g}  {len(others) / len(stem):24.1f}  {of_stem:19.2f}")

found = InPlaneRDF(stem, cells, bins=10).run(start=len(universe.trajectory) // 2).results
print("\ndistance  density around stem cells over the mean")
for distance, density in zip(found.bins, found.rdf, strict=True):
    print(f"{distance:8.2f}  {density:.2f}")
