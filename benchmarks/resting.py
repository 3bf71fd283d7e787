"""How much of the membrane and of the dermis moves slowly, from one frame of a run to the next.

The run is made first, with frames that lie close enough:

    skin run paper-ring --set output.dump_interval=10.0 -o runs/paper-ring
    python benchmarks/resting.py runs/paper-ring [--speed 0.001]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from lammps_skin.kinds import Kind
from lammps_skin.trajectory.frames import open_frames


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path, help="run directory with a trajectory")
    parser.add_argument("--speed", type=float, default=1e-3, help="per time unit")
    options = parser.parse_args()

    print("| t | membrane | dermis |\n| --- | --- | --- |")
    frames = iter(open_frames(options.run))
    former = next(frames)
    for frame in frames:
        # neither membrane nor dermis particles are born or removed: ids and order stay
        still = np.isin(frame.kinds, (Kind.MEMBRANE, Kind.DERMAL))
        way = frame.positions[still] - former.positions[np.isin(former.ids, frame.ids[still])]
        way[:, :2] -= frame.edges[:2] * np.round(way[:, :2] / frame.edges[:2])
        slow = np.linalg.norm(way, axis=1) < options.speed * (frame.time - former.time)
        kinds = frame.kinds[still]
        shares = [slow[kinds == kind].mean() for kind in (Kind.MEMBRANE, Kind.DERMAL)]
        print(f"| {frame.time:g} | {shares[0]:.3f} | {shares[1]:.3f} |")
        former = frame


if __name__ == "__main__":
    main()
