"""What the neighbor skin changes in runs of one scene and seed.

For each skin: CPU seconds, and how many of a million particles were beyond the reach of the
neighbor lists, in the mean over the force evaluations of a run; then where its event log leaves
that of the first.

    python benchmarks/neighbor_skin.py balanced 0.5 0.25 [--scene quarter-ring] [--until 600]
    python benchmarks/neighbor_skin.py fast 0.5 1.0
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation


def events(scene: Scene, until: float, folder: Path) -> list[str]:
    """The event log of a run; prints its cost and its particles beyond the lists."""
    began = time.thread_time()
    with Simulation.begin(scene, folder) as simulation:
        simulation.run(until=until)
        motion, particles = simulation.motion(), len(simulation.forces().ids)
    share = motion.beyond_lists / (motion.evaluations * particles)
    spent = time.thread_time() - began
    print(f"skin {scene.numerics.neighbor_skin:g}: {spent:.0f} s, {1e6 * share:.3g} of a million")
    return (folder / "events.csv").read_text("utf-8").splitlines()[1:]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("level")
    parser.add_argument("skins", type=float, nargs="+")
    parser.add_argument("--scene", default="quarter-ring")
    parser.add_argument("--until", type=float, default=600.0)
    options = parser.parse_args()

    logs = []
    for skin in options.skins:
        scene = Scene.load(options.scene).replace(
            **{
                "numerics.accuracy": options.level, "numerics.neighbor_skin": skin,
                "output.dump_interval": 0.0, "output.checkpoint_interval": 0.0,
            }
        )  # fmt: skip
        with TemporaryDirectory() as folder:
            logs.append(events(scene, options.until, Path(folder)))
    first = logs[0]
    for skin, other in zip(options.skins[1:], logs[1:], strict=True):
        pairs = enumerate(zip(first, other, strict=False))
        same = next((n for n, pair in pairs if pair[0] != pair[1]), None)
        where = "the same events" if same is None else f"{same} events, to t = {first[same][:7]}"
        print(f"skin {skin:g} and {options.skins[0]:g} have in common: {where}")


if __name__ == "__main__":
    main()
