"""How the membrane on its dermis answers a push: drag and relaxation of waves, without cells."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import SceneError
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation

SETTLING = 20.0  # time before the push


class Response(NamedTuple):
    """What w waves along x do under a constant push, and after it.

    Attributes
    ----------
    wave_numbers : (w,) array
        1/length.
    times : (t,) array
        From the beginning of the push on.
    heights : (t, w) array
        Amplitudes of the waves in their direction of push, less those of a run without it.
    push : float
        Amplitude of the force on a particle of the membrane.
    end : float
        Of the push, time.
    """

    wave_numbers: Floats
    times: Floats
    heights: Floats
    push: float
    end: float

    def fitted(self) -> tuple[Floats, Floats]:
        """Mobility and relaxation rate (w,) of da/dt = mobility x push - rate a, of the push.

        The mobility is that of a free particle, 1, less what the dermis holds back.
        """
        pushed = self.times <= self.end
        found = [_fit(self.times[pushed], wave / self.push) for wave in self.heights[pushed].T]
        mobility, rate = np.array(found).T
        return mobility, rate

    def relaxed(self) -> Floats:
        """Mean relaxation rate (w,) after the push: of what is left at the end."""
        first = self.heights[np.searchsorted(self.times, self.end)]
        left = np.maximum(self.heights[-1] / first, 1e-12)
        return np.asarray(-np.log(left) / (self.times[-1] - self.end), float)


def _fit(times: Floats, heights: Floats) -> tuple[float, float]:
    """Mobility and rate of heights that a unit of push makes."""

    def misfit(guess: Floats) -> Floats:
        mobility, rate = guess
        grown = times if rate == 0 else -np.expm1(-rate * times) / rate
        return np.asarray(mobility * grown - heights, float)

    mobility, rate = least_squares(misfit, (1.0, 1e-3)).x
    return float(mobility), float(rate)


def measure(
    scene: Scene, modes: Ints, push: float, end: float = 100.0, every: float = 5.0
) -> Response:
    """Push waves of a membrane, all at once, then let them relax for as long.

    Parameters
    ----------
    scene : Scene
        Its cells are left out.
    modes : (w,) array of int
        Wave lengths that fit into L_x.
    push : float
        Amplitude of the force on a particle, so small that the answer is linear.
    end, every : float
        Time of the push, and between measurements.
    """
    modes = np.asarray(modes)
    most = scene.membrane.lattice[0] // 4
    if not (len(modes) and modes.min() >= 1 and modes.max() <= most):
        raise SceneError(f"modes = {modes.tolist()}: must be whole numbers from 1 to {most}")
    kinds = {"cells.stem": 0, "cells.nd": 0, "end_time": SETTLING + 2 * end}
    bare = scene.replace(**kinds)
    k = np.asarray(2 * np.pi * modes / bare.box_sides[0], float)
    times = np.asarray(np.arange(round(2 * end / every) + 1) * every, float)
    # crests of the waves at places of their own, so that they do not add up
    phases = 2 * np.pi * np.arange(len(k)) * (np.sqrt(5) - 1) / 2
    words = [f"{push!r}*cos({wave!r}*x-{phase!r})"
             for wave, phase in zip(k.tolist(), phases.tolist(), strict=True)]  # fmt: skip
    still = _course(bare, [], times, end)
    moved = _course(bare, [f"variable push atom {'+'.join(words)}"], times, end)
    waves = np.cos(still[0, :, :1] * k - phases)
    heights = 2 * np.einsum("tn,nw->tw", (moved - still)[:, :, 2], waves) / len(waves)
    return Response(k, times, heights, push, end)


def _course(scene: Scene, push: list[str], times: Floats, end: float) -> Floats:
    """Positions (t, n, 3) of the membrane."""
    found = []
    with Simulation.begin(scene) as simulation:
        for time in times.tolist():
            simulation.run(until=SETTLING + time)
            if push and time == 0.0:
                for line in (*push, f"group pushed type {Kind.MEMBRANE.label}",
                             "fix push pushed addforce 0 0 v_push"):  # fmt: skip
                    simulation.command(line)
            if push and time == end:
                simulation.command("unfix push")
            particles = simulation.forces()
            found.append(particles.positions[particles.types == Kind.MEMBRANE])
    return np.array(found)
