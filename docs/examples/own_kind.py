"""A kind of cells of one's own: a mutant stem cell that divides twice as often.

python docs/examples/own_kind.py runs/fast
"""

import sys

from lammps_skin import Scene, Simulation, open_trajectory

scene = Scene.from_dict({
    "name": "fast",
    "end_time": 120.0,
    "dermis": {"present": False},
    "membrane": {"lattice": [24, 28]},
    "cells": {
        "stem": 1,
        "arrangement": "cluster",
        "kinds": {
            "mutant": {
                "like": "stem",
                "count": 1,
                "daughter": "mutantta",
                "cycle_delay": 18.0,
                "cycle_rate": 0.166,
            },
            "mutantta": {"like": "ta"},
        },
    },
})  # fmt: skip
with Simulation.begin(scene, directory=sys.argv[1], replace=True) as simulation:
    simulation.run()

universe = open_trajectory(sys.argv[1])
mutant, normal = (
    universe.select_atoms(f"type {kinds}", updating=True)
    for kinds in ("mutant mutantta", "stem ta")
)
for moment in universe.trajectory[::3]:
    print(f"t = {moment.time:g}: {len(mutant)} of the mutant's clone, {len(normal)} of the other")
