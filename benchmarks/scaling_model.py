"""A model of the cost of a step on many ranks, from the tables that scaling.py has written.

Seconds of a step on P ranks are those of

- computing: a constant for each particle of the rank and one for each of its ghost particles;
- bytes: what it sends for its ghost particles, and the events of all ranks, over the bandwidth;
- waiting: messages x latency + collective calls x log2(P) x latency;
- events: every rank goes through the births, ends of divisions and removals of all.

The constants of computing and all counts are measured here; latency, bandwidth and the seconds of
an event are arguments.

    python benchmarks/scaling_model.py [--particles 6.5e6] [--latency 2e-6] [--bandwidth 1e10]

It prints the tables of docs/scaling.md and draws docs/figures/scaling.png.
"""

from __future__ import annotations

import argparse
import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

DOCS = Path(__file__).resolve().parent.parent / "docs"
REACH = 4.42  # of ghost particles, as the inputs of these scenes have it (ghost_cutoff)
SPACING = 0.5
LATTICE = (50, 58)  # of a tile

# bytes of a ghost particle, in one direction
PART = 8  # stiffness, once in a part of a step
EVENT = 88  # bytes of an event, gathered on all ranks
BORDER = 56  # position, id, type, mask and molecule, at a rebuild


@dataclass(frozen=True)
class Model:
    """Seconds of a step.

    Attributes
    ----------
    particle, ghost : float
        Seconds of a particle, and of a ghost particle, in a step.
    density : float
        Particles per unit area of the membrane.
    messages, collectives : float
        Of a rank with four neighbors, in a step.
    per_ghost : float
        Bytes that a ghost particle costs in a step.
    events : float
        Events in a step, for each particle.
    event : float
        Seconds of an event on every rank, given.
    latency, bandwidth : float
        Seconds of a message, and bytes in a second: of the network, given.
    """

    particle: float
    ghost: float
    density: float
    messages: float
    collectives: float
    per_ghost: float
    events: float
    event: float
    latency: float
    bandwidth: float

    def parts(self, particles: float, ranks: int) -> tuple[float, float, float, float]:
        """Seconds of computing, of bytes, of waiting for messages and of events."""
        side = math.sqrt(particles / ranks / self.density)
        around = ghosts(side, side, self.density)
        computing = self.particle * particles / ranks + self.ghost * around
        events = self.events * particles
        handling = self.event * events
        if ranks == 1:
            return computing, 0.0, 0.0, handling
        sent = self.per_ghost * around + EVENT * events
        waiting = self.latency * (self.messages + self.collectives * math.log2(ranks))
        return computing, sent / self.bandwidth, waiting, handling


def ghosts(along: float, up: float, density: float) -> float:
    """Ghost particles of a rank with a piece of these sides."""
    return density * ((along + 2 * REACH) * (up + 2 * REACH) - along * up)


def sent_ghosts(along: float, up: float, grid: tuple[int, int], density: float) -> float:
    """Those of them that come from other ranks: first along x, then along y with the former."""
    from_x = 2 * REACH * up if grid[0] > 1 else 0.0
    from_y = 2 * REACH * (along + 2 * REACH) if grid[1] > 1 else 0.0
    return density * (from_x + from_y)


def table(name: str) -> list[dict[str, str]]:
    with (DOCS / "data" / f"scaling-{name}.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def exponent(
    particles: NDArray[np.float64], seconds: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Exponent of least squares of the logarithms, and its interval of 95 %."""
    fit = stats.linregress(np.log(particles), np.log(seconds))
    half = float(stats.t.ppf(0.975, len(particles) - 2) * fit.stderr)
    return float(fit.slope), float(fit.slope) - half, float(fit.slope) + half


def sizes() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    rows = table("sizes")
    return (
        np.array([float(row["particles"]) for row in rows]),
        np.array([float(row["seconds_per_step"]) for row in rows]),
    )


def constants(
    particles: NDArray[np.float64], seconds: NDArray[np.float64], density: float
) -> tuple[float, float]:
    """Seconds of a particle and of a ghost particle, of least squares of relative errors."""
    sides = np.sqrt(particles / density)
    around = np.array([ghosts(side, side, density) for side in sides])
    (own, other), _ = optimize.nnls(np.column_stack([particles, around]) / seconds[:, None],
                                    np.ones(len(seconds)))  # fmt: skip
    return float(own), float(other)


def compare_counts(density: float, evaluations: int, rebuilds: float) -> float:
    """Print bytes counted beside those of the formula; returns bytes of a ghost in a step."""
    forwards = evaluations + 1  # one more to test where cells are, or before events
    per_ghost = 24 * forwards + 24 * evaluations + PART + BORDER * rebuilds
    print(f"\nbytes of a ghost particle in a step: {per_ghost:.0f}\n")
    print("| grid | ghosts, LAMMPS | ghosts, formula | bytes, counted | bytes, formula |")
    print("| --- | --- | --- | --- | --- |")
    for row in table("traffic"):
        grid = tuple(int(n) for n in row["grid"].split("x"))
        area = float(row["particles"]) / density
        ratio = LATTICE[1] * math.sqrt(3) / 2 / LATTICE[0]
        along = math.sqrt(area / ratio) / grid[0]
        up = math.sqrt(area * ratio) / grid[1]
        expected = per_ghost * sent_ghosts(along, up, (grid[0], grid[1]), density)
        print(
            f"| {row['grid']} | {row['ghosts']} | {ghosts(along, up, density):.0f} "
            f"| {float(row['bytes_per_step']):.3g} | {expected:.3g} |"
        )
    return per_ghost


def draw(particles: NDArray[np.float64], seconds: NDArray[np.float64], model: Model,
         whole: float, ranks: Sequence[int]) -> None:  # fmt: skip
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    slope = exponent(particles, seconds)[0]
    left.loglog(particles, seconds, "o", color="tab:blue")
    at = np.array([particles.min(), particles.max()])
    middle = np.exp(np.mean(np.log(seconds)) + slope * (np.log(at) - np.log(particles).mean()))
    left.loglog(at, middle, color="black", lw=1, label=f"exponent {slope:.3f}")
    left.set(xlabel="particles", ylabel="seconds of a step, one core")
    left.legend(frameon=False)

    parts = np.array([model.parts(whole, count) for count in ranks])
    names = ("computing", "bytes", "messages", "events")
    right.loglog(ranks, parts.sum(axis=1), "o-", color="black", label="step", base=2)
    for values, name in zip(parts.T, names, strict=True):
        right.loglog(ranks, np.where(values > 0, values, np.nan), "--", lw=1, label=name, base=2)
    right.set(xlabel="ranks", ylabel="seconds of a step, predicted", ylim=(1e-5, None))
    right.set_yscale("log", base=10)
    right.set_title(f"{whole:.3g} particles", fontsize="medium")
    right.legend(frameon=False)
    figure.savefig(DOCS / "figures" / "scaling.png", dpi=150)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--particles", type=float, default=6.5e6)
    parser.add_argument("--latency", type=float, default=2e-6, help="seconds of a message")
    parser.add_argument("--bandwidth", type=float, default=1e10, help="bytes in a second")
    parser.add_argument("--event", type=float, default=2e-6, help="seconds of an event on a rank")
    parser.add_argument("--events", type=float, default=0.0011, help="per step and particle")
    parser.add_argument("--evaluations", type=int, default=5, help="in a step of these scenes")
    parser.add_argument("--rebuilds", type=float, default=0.5, help="in a step of these scenes")
    options = parser.parse_args()

    particles, seconds = sizes()
    slope, low, high = exponent(particles, seconds)
    print(f"exponent {slope:.3f}, interval of 95 % {low:.3f} to {high:.3f}")
    for count in np.unique(particles):
        of_size = seconds[particles == count]
        print(f"| {count:.0f} | {np.median(of_size):.3g} | {of_size.min():.3g} to "
              f"{of_size.max():.3g} | {1e6 * np.median(of_size) / count:.2f} |")  # fmt: skip

    tile = SPACING**2 * math.sqrt(3) / 2 * LATTICE[0] * LATTICE[1]
    density = particles.min() / tile
    per_ghost = compare_counts(density, options.evaluations, options.rebuilds)
    counted = table("traffic")[-1]
    own, ghost = constants(particles, seconds, density)
    print(f"\nseconds of a particle {own:.3g}, of a ghost particle {ghost:.3g}")
    model = Model(
        particle=own, ghost=ghost, density=density,
        messages=float(counted["messages_per_step"]),
        collectives=float(counted["collectives_per_step"]), per_ghost=per_ghost,
        events=options.events, event=options.event, latency=options.latency,
        bandwidth=options.bandwidth,
    )  # fmt: skip
    print("\n| ranks | of a rank | computing | bytes | messages | events | step | efficiency |")
    print("| " + "--- | " * 8)
    ranks = [4**power for power in range(7)]
    alone = sum(model.parts(options.particles, 1))
    for count in ranks:
        parts = model.parts(options.particles, count)
        shown = " | ".join(f"{value:.3g}" for value in (*parts, sum(parts)))
        print(f"| {count} | {options.particles / count:.0f} | {shown} "
              f"| {100 * alone / count / sum(parts):.0f} % |")  # fmt: skip
    draw(particles, seconds, model, options.particles, ranks)


if __name__ == "__main__":
    main()
