"""How far apart trajectories are, and the order in which that falls with the timestep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from lammps_skin.analysis.geometry import Floats
from lammps_skin.tradeoff.grid import Variant
from lammps_skin.tradeoff.store import Reached


class Distance(NamedTuple):
    """Distances of the same particles in two trajectories: root of the mean square, largest."""

    rms: float
    largest: float


class Order(NamedTuple):
    """Order of convergence of variants that differ in their timestep.

    `errors` (n,) are rms distances at the `timesteps` (n,), ascending; `order` is the slope of
    the line of least squares through their logarithms.
    """

    names: tuple[str, ...]
    timesteps: tuple[float, ...]
    errors: tuple[float, ...]
    order: float


def distance(one: Reached, truth: Reached, box: Sequence[float] | Floats) -> Distance:
    """Distances of particles, matched by id, across the periodic sides x and y.

    Parameters
    ----------
    one, truth : Reached
    box : (2,) or (3,)
        Sides of the box.
    """
    if one.problem or truth.problem:
        return Distance(np.nan, np.nan)
    apart = np.asarray(one.positions - truth.positions)
    sides = np.asarray(box, float)[:2]
    apart[:, :2] -= sides * np.round(apart[:, :2] / sides)
    squares = (apart**2).sum(axis=1)
    return Distance(float(np.sqrt(squares.mean())), float(np.sqrt(squares.max())))


def orders(found: Sequence[Variant], distances: Mapping[str, Distance]) -> list[Order]:
    """The order of every family of variants with at least two timesteps."""
    families: dict[tuple[object, ...], dict[float, Variant]] = {}
    for one in found:
        error = distances[one.name].rms
        if error > 0:
            families.setdefault(one.family, {}).setdefault(one.scene.numerics.timestep, one)
    measured = []
    for family in families.values():
        if len(family) < 2:
            continue
        timesteps = sorted(family)
        errors = [distances[family[timestep].name].rms for timestep in timesteps]
        slope = np.polyfit(np.log(timesteps), np.log(errors), 1)[0]
        names = tuple(family[timestep].name for timestep in timesteps)
        measured.append(Order(names, tuple(timesteps), tuple(errors), float(slope)))
    return measured
