"""A run that Python watches, and takes in hand when there are enough cells.

python docs/examples/watched_run.py runs/watched 6
"""

import sys

from lammps_skin import Simulation
from lammps_skin.kinds import Kind

directory, enough = sys.argv[1], int(sys.argv[2])


def report(time: float, simulation: Simulation) -> None:
    """Called after every ten time units."""
    cells = simulation.cells()
    dividing = (cells.pair > 0).sum() // 2
    print(f"t = {time:g}: {len(cells.ids)} cells, {dividing} pairs divide")


with Simulation.begin("two-cells", directory=directory, replace=True) as simulation:
    while simulation.time < 200 and len(simulation.cells().ids) < enough:
        simulation.run(until=simulation.time + 20, progress=report, every=10.0)

    # any command of LAMMPS can follow, such as one that takes a cell out
    cells = simulation.cells()
    ta = cells.ids[cells.types == Kind.TA]
    simulation.command(f"group chosen id {ta[0]}")
    simulation.command("delete_atoms group chosen bond yes")
    simulation.run(until=simulation.time + 1)
    print(f"t = {simulation.time:g}: {len(simulation.cells().ids)} cells")
