"""What a choice of numerics changes in the statistics of ensembles, seed by seed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.stats import norm

from lammps_skin.analysis.geometry import Floats
from lammps_skin.analysis.statistics import mean
from lammps_skin.ensemble import Member
from lammps_skin.errors import SceneError
from lammps_skin.observables import Table, load
from lammps_skin.tradeoff.grid import Variant

MEANS = (
    "chi_H", "chi_G", "zeta", "sigma", "coverage", "ta", "exhausted", "papillae",
    "papilla_height", "skewness",
)  # fmt: skip
COUNTS = ("births", "deaths")  # since the start: what counts is how many more in a window
EFFECT = 0.5  # difference to be seen, in standard deviations over seeds
CONFIDENCE, POWER = 0.95, 0.8  # with which it is seen

Window = tuple[float, float]


class Bias(NamedTuple):
    """A statistic of a variant, and its difference from the reference with the same seeds.

    Attributes
    ----------
    name : str
        Column of the table of observables.
    window : (2,) tuple
        Times over which it is the mean, or during which it is counted.
    reference, deviation : float
        Mean and standard deviation over seeds, of the reference.
    difference, error : float
        Mean over seeds of the differences, and its standard error.
    percent, percent_error : float
        Of the differences relative to the reference, likewise.
    seeds : int
        That both have.
    needed : float
        Seeds with which a difference of `EFFECT` standard deviations would be seen.
    """

    name: str
    window: Window
    reference: float
    deviation: float
    difference: float
    error: float
    percent: float
    percent_error: float
    seeds: int
    needed: float

    @property
    def in_errors(self) -> float:
        """The difference in units of its standard error; 0 where all seeds are the same."""
        return 0.0 if self.difference == self.error == 0 else float(
            np.divide(self.difference, self.error)
        )  # fmt: skip


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
    return {seed: load(member.table) for seed, member in members.items() if member.done}


def windows_of(text: str | None, end: float) -> list[Window]:
    """Windows of a list of ranges; without one, before and long after crowding at t = 300."""
    if text is None:
        return [(0.3 * end, 0.6 * end), (0.8 * end, end)]
    found = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        try:
            window = float(first), float(last)
        except ValueError:
            window = (0.0, -1.0)
        if not 0 <= window[0] < window[1] <= end:
            raise SceneError(
                f"--windows {text}: {part} must be two times such as 300-600, ascending, up to "
                f"the end time, {end:g}"
            )
        found.append(window)
    return found


def biases(
    variant: Mapping[int, Table], reference: Mapping[int, Table], windows: Sequence[Window]
) -> list[Bias]:
    """Every statistic in every window, over the seeds that both have."""
    seeds = sorted(variant.keys() & reference.keys())
    found = []
    for window in windows:
        for name in (*MEANS, *COUNTS):
            pairs = [
                (_statistic(variant[seed], name, window), _statistic(reference[seed], name, window))
                for seed in seeds
            ]
            found.append(_bias(name, window, np.array(pairs, float).reshape(-1, 2)))
    return found


def _statistic(table: Table, name: str, window: Window) -> float:
    """Mean over a window of what is defined, or the count during it."""
    inside = table[(table["time"] >= window[0]) & (table["time"] <= window[1])][name]
    inside = inside[~np.isnan(inside)]
    if not len(inside):
        return np.nan
    return float(inside[-1] - inside[0] if name in COUNTS else inside.mean())


def _bias(name: str, window: Window, pairs: Floats) -> Bias:
    pairs = pairs[~np.isnan(pairs).any(axis=1)]
    ours, theirs = pairs.T
    differences = ours - theirs
    difference = mean(differences)
    with np.errstate(divide="ignore", invalid="ignore"):
        percent = mean(np.where(theirs != 0, 100 * differences / np.abs(theirs), np.nan))
    many = len(pairs) > 1
    deviation = float(theirs.std(ddof=1)) if many else np.nan
    noise = float(differences.std(ddof=1)) if many else np.nan
    return Bias(
        name, window, mean(theirs).value, deviation, difference.value, difference.error,
        percent.value, percent.error, len(pairs), seeds_needed(noise, deviation),
    )  # fmt: skip


def seeds_needed(noise: float, deviation: float) -> float:
    """Seeds with which a difference of `EFFECT` standard deviations is seen.

    Parameters
    ----------
    noise : float
        Standard deviation over seeds of the difference of two choices.
    deviation : float
        Standard deviation over seeds of the statistic itself.

    Returns
    -------
    float
        With `CONFIDENCE` and `POWER`, for normal differences; NaN of what does not vary.
    """
    if not deviation > 0 or np.isnan(noise):
        return np.nan
    quantiles = norm.ppf((1 + CONFIDENCE) / 2) + norm.ppf(POWER)
    return max(2.0, math.ceil((quantiles * noise / (EFFECT * deviation)) ** 2))


def root_mean_square(found: Sequence[Bias]) -> float:
    """Of the differences in standard errors: 1 or so where there is nothing but chance."""
    values = np.array([bias.in_errors for bias in found if np.isfinite(bias.in_errors)])
    return float(np.sqrt((values**2).mean())) if len(values) else np.nan
