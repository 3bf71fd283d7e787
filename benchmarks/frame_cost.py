"""What a picture in three dimensions costs: seconds of CPU, the least of some rounds.

python benchmarks/frame_cost.py runs/quarter-ring --time 1000
"""

from __future__ import annotations

import argparse
from time import process_time

from lammps_skin.figures.look import Look
from lammps_skin.figures.moments import read_moments
from lammps_skin.figures.scenery import view


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run")
    parser.add_argument("--time", type=float)
    parser.add_argument("--size", type=int, default=750)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    (moment,) = read_moments(options.run, [options.time])
    look, kinds = Look(size=options.size), moment.scene.kinds_of_cells
    costs = []
    for _ in range(options.rounds):
        start = process_time()
        image = view(moment, kinds, look)
        costs.append(process_time() - start)
    high, wide = image.shape[:2]
    print(f"{wide} x {high} pixels, {len(moment.kinds):,} particles: {min(costs):.2f} s")


if __name__ == "__main__":
    main()
