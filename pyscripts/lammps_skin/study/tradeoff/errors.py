"""How far apart trajectories are, and the order in which that falls with the timestep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.study.tradeoff.grid import Variant
from lammps_skin.study.tradeoff.store import EndState


class Distance(NamedTuple):
    """Distances of the same particles in two trajectories.

    Root of the mean square, median and largest. In a crowded scene, a few particles where the
    membrane has collapsed make up most of the first; the second is that of a usual particle.
    """

    rms: float
    median: float
    largest: float


class Order(NamedTuple):
    """Order of convergence of variants that differ in their timestep.

    `distances` (n,) are those at the `timesteps` (n,), ascending; `of_rms` and `of_median` are
    slopes of the lines of least squares through their logarithms.
    """

    names: tuple[str, ...]
    timesteps: tuple[float, ...]
    distances: tuple[Distance, ...]
    of_rms: float
    of_median: float


def distance(one: EndState, truth: EndState, box: Sequence[float] | Floats) -> Distance:
    """Distances of particles, matched by id, across the periodic sides x and y.

    Parameters
    ----------
    one, truth : EndState
    box : (2,) or (3,)
        Sides of the box.
    """
    if one.problem or truth.problem:
        return Distance(np.nan, np.nan, np.nan)
    apart = np.asarray(one.positions - truth.positions)
    sides = np.asarray(box, float)[:2]
    apart[:, :2] -= sides * np.round(apart[:, :2] / sides)
    squares = (apart**2).sum(axis=1)
    numbers = np.sqrt([squares.mean(), np.median(squares), squares.max()])
    return Distance(*map(float, numbers))


def orders(found: Sequence[Variant], distances: Mapping[str, Distance]) -> list[Order]:
    """The order of every family of variants with at least two timesteps."""
    families: dict[tuple[object, ...], dict[float, Variant]] = {}
    for one in found:
        if min(distances[one.name]) > 0:
            families.setdefault(one.family, {}).setdefault(one.scene.numerics.timestep, one)
    measured = []
    for family in families.values():
        if len(family) < 2:
            continue
        timesteps = sorted(family)
        names = tuple(family[timestep].name for timestep in timesteps)
        apart = tuple(distances[name] for name in names)
        slopes = np.polyfit(np.log(timesteps), np.log(apart), 1)[0]
        measured.append(Order(names, tuple(timesteps), apart, float(slopes[0]), float(slopes[1])))
    return measured
