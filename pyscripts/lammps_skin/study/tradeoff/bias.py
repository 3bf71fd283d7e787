"""What a choice of numerics changes in the statistics of ensembles."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lammps_skin.analysis.derived import COUNTS, statistic
from lammps_skin.analysis.observables import Table, read_table
from lammps_skin.analysis.statistics import mean, seeds_needed
from lammps_skin.arrays import Floats
from lammps_skin.errors import SceneError
from lammps_skin.study.ensemble import Member
from lammps_skin.study.ranges import Window
from lammps_skin.study.tradeoff.grid import Variant

MEANS = (
    "chi_H", "chi_G", "zeta", "sigma", "coverage", "ta", "exhausted", "papillae",
    "papilla_height", "skewness", "chi_H_nd", "chi_G_nd", "zeta_nd", "sigma_nd",
)  # fmt: skip
EFFECT = 0.5  # difference to be seen, in standard deviations over seeds


class Bias(NamedTuple):
    """A statistic of a variant, and its difference from the reference.

    Attributes
    ----------
    name : str
        Column of the table of observables.
    window : (2,) tuple
        Times over which it is the mean, or during which it is counted.
    reference, deviation : float
        Mean over the seeds of the reference; standard deviation over seeds, of both together.
    difference, error : float
        Of the means over all seeds of the variant and of the reference, and its standard error.
    seeds, reference_seeds : int
        That there are.
    percent, percent_error : float
        Mean over the seeds that both have of their differences relative to the reference, and
        its standard error.
    needed : float
        Seeds of both with which a difference of `EFFECT` standard deviations would be seen.
    """

    name: str
    window: Window
    reference: float
    deviation: float
    difference: float
    error: float
    seeds: int
    reference_seeds: int
    percent: float
    percent_error: float
    needed: float

    @property
    def in_errors(self) -> float:
        """The difference in units of its standard error; NaN of what never varies."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return float(np.divide(self.difference, self.error))


def member(one: Variant, seed: int, folder: Path) -> Member:
    """The run of a variant with a seed, as `skin ensemble` would name it."""
    return Member(one.scene.replace(seed=seed), folder)


def check_ensemble(one: Variant, seeds: Sequence[int]) -> None:
    """Raise `SceneError` for a scene of which there can be no ensemble."""
    if one.scene.cells.seed is not None and len(seeds) > 1:
        raise SceneError(
            f"cells.seed = {one.scene.cells.seed}: must not be given where there are seeds"
        )
    if not one.scene.output.dump_interval:
        raise SceneError("output.dump_interval = 0: an ensemble needs trajectories")


def tables(one: Variant, seeds: Sequence[int], folder: Path) -> dict[int, Table]:
    """Tables of observables that are there, by seed."""
    members = {seed: member(one, seed, folder) for seed in seeds}
    return {seed: read_table(member.table) for seed, member in members.items() if member.done}


def biases(
    variant: Mapping[int, Table], reference: Mapping[int, Table], windows: Sequence[Window]
) -> list[Bias]:
    """Every statistic in every window, from tables by seed; without those that neither has."""
    found = [
        _bias(name, window, *(
            {seed: statistic(table, name, window) for seed, table in tables.items()}
            for tables in (variant, reference)
        ))
        for window in windows for name in (*MEANS, *COUNTS)
    ]  # fmt: skip
    return [bias for bias in found if bias.seeds or bias.reference_seeds]


def _bias(
    name: str, window: Window, ours: Mapping[int, float], theirs: Mapping[int, float]
) -> Bias:
    """From the values of a statistic by seed."""
    values, others = _defined(ours.values()), _defined(theirs.values())
    freedom = len(values) + len(others) - 2
    deviation = error = np.nan
    if freedom > 0 and len(values) and len(others):
        squares = sum(((x - x.mean()) ** 2).sum() for x in (values, others))
        deviation = float(np.sqrt(squares / freedom))
        error = deviation * math.sqrt(1 / len(values) + 1 / len(others))
    pairs = _defined([(ours[seed], theirs[seed]) for seed in sorted(ours.keys() & theirs.keys())])
    pairs = pairs.reshape(-1, 2)
    differences = pairs[:, 0] - pairs[:, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        percent = mean(np.where(pairs[:, 1] != 0, 100 * differences / abs(pairs[:, 1]), np.nan))
    noise = float(differences.std(ddof=1)) if len(pairs) > 1 else np.nan
    return Bias(
        name, window, mean(others).value, deviation, mean(values).value - mean(others).value, error,
        len(values), len(others), percent.value, percent.error,
        seeds_needed(noise, EFFECT * deviation),
    )  # fmt: skip


def _defined(values: Iterable[float | tuple[float, ...]]) -> Floats:
    """Rows without NaN."""
    array = np.array(list(values), float)
    return array[~np.isnan(array.reshape(len(array), -1)).any(axis=1)]


def root_mean_square(found: Sequence[Bias]) -> float:
    """Of the differences in standard errors: 1 or so where there is nothing but chance."""
    values = np.array([bias.in_errors for bias in found if np.isfinite(bias.in_errors)])
    return float(np.sqrt((values**2).mean())) if len(values) else np.nan
