"""What `skin check` expects of whole runs, beside what they cost.

Seconds are CPU time of the thread that runs LAMMPS, output and checkpoints included.

    python benchmarks/run_cost.py demo one-stem no-dermis bare-membrane [--until T] [--csv FILE]
"""

from __future__ import annotations

import argparse
import csv
import tempfile
import time
from pathlib import Path

from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.study.cost import estimate

PIECES = 40


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--until", type=float)
    parser.add_argument("--accuracy")
    parser.add_argument("--csv", type=Path, help="seconds and cells over time")
    arguments = parser.parse_args()
    rows = []
    print("| scene | until | cells | evaluations per step | expected s | measured s | ratio |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name in arguments.scenes:
        scene = Scene.load(name)
        if arguments.until:
            scene = scene.replace(end_time=arguments.until)
        if arguments.accuracy:
            scene = scene.replace(**{"numerics.accuracy": arguments.accuracy})
        with tempfile.TemporaryDirectory() as folder, Simulation.begin(scene, folder) as simulation:
            began = last = time.thread_time()
            for n in range(1, PIECES + 1):
                simulation.run(until=scene.end_time * n / PIECES)
                now, motion = time.thread_time(), simulation.motion()
                cells = len(simulation.cells().ids) if scene.has_cells else 0
                rows.append(
                    (name, simulation.time, cells, now - last, motion.steps, motion.evaluations)
                )
                last = now
        cost, measured = estimate(scene), last - began
        expected = cost.seconds - cost.start
        print(
            f"| {name} | {scene.end_time:g} | {cells} | {motion.evaluations / motion.steps:.2f} | "
            f"{expected:.1f} | {measured:.1f} | {measured / expected:.2f} |",
            flush=True,
        )
    if arguments.csv:
        with arguments.csv.open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["scene", "time", "cells", "seconds", "steps", "evaluations"])
            writer.writerows(rows)


if __name__ == "__main__":
    main()
