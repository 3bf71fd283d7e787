"""The tree of descendants of a stem cell, and the sizes of all clones.

python docs/examples/lineage.py runs/demo
"""

import sys
from collections import defaultdict

import numpy as np
from lammps_skin import read_events
from lammps_skin.analysis.lineage import clone_sizes, founder_of

DEPTH = 2  # generations that are printed

events = read_events(f"{sys.argv[1]}/events.csv")
births = events.of("birth")
left = dict(zip(*(getattr(events.of("death"), key) for key in ("id", "time")), strict=True))
daughters = defaultdict(list)
for mother, cell, time in zip(births.parent, births.id, births.time, strict=True):
    daughters[mother].append((cell, time))


def show(cell: int, time: float, depth: int = 0) -> None:
    """Print a cell and its descendants."""
    end = f", left at {left[cell]:.1f}" if cell in left else ""
    print(f"{'    ' * depth}{cell}, born at {time:.1f}{end}")
    if depth < DEPTH:
        for daughter, born in daughters[cell]:
            show(daughter, born, depth + 1)


founders = np.unique(founder_of(births.parent, events))
show(founders[0], 0.0)
times = [events.time[-1] / 2, events.time[-1]]
print(f"\nfounder  cells at {times[0]:.0f}, {times[1]:.0f}")
for founder, sizes in zip(founders, clone_sizes(events, founders, times).T, strict=True):
    print(f"{founder:7}  {', '.join(map(str, sizes))}")
