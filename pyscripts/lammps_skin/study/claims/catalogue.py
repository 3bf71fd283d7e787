"""The eleven claims, in our words, with their tests."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import combinations, pairwise, product
from typing import NamedTuple

import numpy as np

from lammps_skin.analysis.basal_layer import COVERED
from lammps_skin.analysis.statistics import pseudo_values
from lammps_skin.arrays import Floats, Ints
from lammps_skin.study.claims.rules import (
    HALF,
    NEGATIVE,
    POSITIVE,
    Claim,
    Ensembles,
    Finding,
    Range,
    Verdict,
    around_zero,
    judge,
)
from lammps_skin.study.claims.tables import WINDOWS, Ensemble
from lammps_skin.study.ranges import Window

STEM = ("ring", "cluster", "random")
ND = ("nd-a", "nd-b", "nd-c", "nd-d")
MIXED, APART = ("nd-a", "nd-c"), ("nd-b", "nd-d")  # ND cells among the stem cells, or not

ORDERS = ("chi_H", "chi_G", "zeta")
CURVATURES = ("chi_H", "chi_G")
START = Window(0, 0)
BARE = Window(50, 100)  # the membrane has come to rest, and a fifth of it is covered at most
BEFORE = Window(100, 200)  # half of the membrane is covered at most
IN_TIME = Range(200, 400)  # for coverage
COVERAGE = Window(300, 400)  # the paper has full coverage at t = 300
RISING = Window(200, 600)
STEP = 50.0  # times of it over which courses are smoothed
ND_EARLY, ND_LATE = Window(300, 500), Window(900, 1000)
PAPILLAE = 0.5  # for each stem cell, from which on they are many
A_LITTLE = 0.5  # in R_c


def covers(ensembles: Ensembles) -> Iterator[Finding]:
    for name, one in ensembles.items():
        for window in one.windows:
            yield Finding(
                "covered", "coverage", name, window, Range(low=COVERED),
                (one.mean("coverage", window),), fraction=True,
            )  # fmt: skip
        yield Finding(
            "near t = 300", f"time at which {COVERED:g} are covered", name, "all", IN_TIME,
            (one.first_time("coverage", COVERED),), condition=True,
        )  # fmt: skip
        first = WINDOWS[0]
        ratio = _ratio(one.mean("height_std", BARE), one.mean("height_std", first))
        yield Finding(
            "flat while bare", "ratio of height_std", name, f"{BARE} to {first}",
            Range(high=HALF), (ratio,),
        )  # fmt: skip


def _ratio(values: Floats, others: Floats) -> Floats:
    """Ratios (n,); NaN where the others are 0."""
    return np.divide(values, others, out=np.full(len(values), np.nan), where=others != 0)


def protrudes(ensembles: Ensembles) -> Iterator[Finding]:
    for name, one in ensembles.items():
        for window in one.windows:
            number = _ratio(one.mean("papillae", window), one.mean("stem", window))
            skewness = one.mean("skewness", window)
            yield Finding("outward", "skewness", name, window, POSITIVE, (skewness,))
            yield Finding(
                "many", "papillae / stem", name, window, Range(low=PAPILLAE), (number,)
            )  # fmt: skip


def stem_on_tips(ensembles: Ensembles) -> Iterator[Finding]:
    for name, one in ensembles.items():
        yield from _above(one, "on tips", "stem_on_tips", "stem_tips_expected")
        for column in ORDERS:
            yield from _above(one, f"{column} positive", column)
            level = around_zero(one.mean(column, one.late))
            yield Finding(
                "from 0", column, name, BEFORE, level, (one.mean(column, BEFORE),), condition=True
            )
            for former, latter in pairwise(one.windows):
                change = one.mean(column, latter) - one.mean(column, former)
                yield Finding(
                    "stationary", f"change of {column}", name, f"{former} to {latter}", level,
                    (change,), condition=True,
                )  # fmt: skip


def curvature_first(ensembles: Ensembles) -> Iterator[Finding]:
    for name, one in ensembles.items():
        for column in CURVATURES:
            yield Finding(
                "later", f"rise of zeta after {column}", name, RISING, POSITIVE, (lag(one, column),)
            )
        for column in ORDERS:
            values = one.mean(column, one.late)
            yield Finding("risen", column, name, one.late, POSITIVE, (values,), condition=True)


def lag(one: Ensemble, column: str) -> Floats:
    """Rise time of zeta less that of a column, as pseudo-values (s,) of the seeds."""
    first, second = Rise.of(one, "zeta"), Rise.of(one, column)
    return pseudo_values(lambda seeds: first.time(seeds) - second.time(seeds), one.seeds)


class Rise(NamedTuple):
    """How a column rises to its late level: its course (w, s) in short windows, the level (s,)."""

    course: Floats
    level: Floats

    @staticmethod
    def of(one: Ensemble, column: str) -> Rise:
        starts = np.arange(RISING.start, RISING.end, STEP)
        course = [one.mean(column, Window(start, start + STEP)) for start in starts]
        return Rise(np.array(course), one.mean(column, one.late))

    def time(self, seeds: Ints) -> float:
        """Mean time after the begin of `RISING` of the rise of the mean over some seeds.

        That of a step is its time; what is above the level counts as risen.
        """
        course, level = self.course[:, seeds].mean(axis=1), self.level[seeds].mean()
        with np.errstate(divide="ignore", invalid="ignore"):
            missing = 1 - np.minimum(course / level, 1.0)
        return float(missing.mean() * (RISING.end - RISING.start))


def no_memory(ensembles: Ensembles) -> Iterator[Finding]:
    for column in ORDERS:
        late = {name: one.mean(column, one.late) for name, one in ensembles.items()}
        level = around_zero(np.concatenate(list(late.values())))
        for first, second in combinations(late, 2):
            yield Finding(
                f"{column} alike", f"difference of {column}", f"{first} - {second}",
                ensembles[first].late, level, (late[first], late[second]),
            )  # fmt: skip


def remembers(ensembles: Ensembles) -> Iterator[Finding]:
    cluster = ensembles["cluster"]
    fall = cluster.mean("sigma", COVERAGE) - cluster.mean("sigma", START)
    yield Finding(
        "falls", "change of sigma", "cluster", f"{START} to {COVERAGE}", NEGATIVE, (fall,)
    )
    for name, one in ensembles.items():
        reached = one.mean("sigma", COVERAGE)
        for window in one.windows:
            yield Finding(
                "settled", "change of sigma", name, f"{COVERAGE} to {window}",
                around_zero(reached), (one.mean("sigma", window) - reached,), condition=True,
            )  # fmt: skip
    for other in ("ring", "random"):
        for window in cluster.windows:
            if window in ensembles[other].windows:
                yield Finding(
                    "remembers", "difference of sigma", f"cluster - {other}", window, POSITIVE,
                    (cluster.mean("sigma", window), ensembles[other].mean("sigma", window)),
                )  # fmt: skip


def nd_on_tips(ensembles: Ensembles) -> Iterator[Finding]:
    for name, one in ensembles.items():
        yield from _above(one, "on tips", "nd_on_tips", "nd_tips_expected")
        for column in CURVATURES:
            yield from _above(one, f"{column} positive", f"{column}_nd")
            stem = one.mean(column, one.late)
            apart = one.mean(f"{column}_nd", one.late) - stem
            yield Finding(
                "as stem cells", f"{column}_nd - {column}", name, one.late, around_zero(stem),
                (apart,), condition=True,
            )  # fmt: skip


def nd_cluster(ensembles: Ensembles) -> Iterator[Finding]:
    for one in ensembles.values():
        yield from _above(one, "more clustered", "sigma_nd", "sigma")
    for apart, mixed in product(APART, MIXED):
        if apart in ensembles and mixed in ensembles:
            pair = ensembles[apart], ensembles[mixed]
            first, second = (
                one.mean("sigma_nd", one.late) - one.mean("sigma", one.late) for one in pair
            )
            yield Finding(
                "most where apart", "difference of sigma_nd - sigma", f"{apart} - {mixed}",
                pair[0].late, POSITIVE, (first, second),
            )  # fmt: skip


def nd_rise(ensembles: Ensembles) -> Iterator[Finding]:
    claimed = Range(-A_LITTLE, 0.0)
    for name, one in ensembles.items():
        early = _apart(one, ND_EARLY, "zeta_nd", "zeta")
        yield Finding("a little below", "zeta_nd - zeta", name, ND_EARLY, claimed, (early,))
        late = (ND_LATE, *one.later)
        yield from _above(one, "late above", "zeta_nd", "zeta", windows=late)


def _apart(one: Ensemble, window: Window, column: str, other: str = "") -> Floats:
    return one.mean(column, window) - (one.mean(other, window) if other else 0.0)


def _above(
    one: Ensemble, part: str, column: str, other: str = "", windows: Iterable[Window] = ()
) -> Iterator[Finding]:
    """A column is above 0, or above another one, in each window."""
    statistic = f"{column} - {other}" if other else column
    for window in windows or one.windows:
        values = _apart(one, window, column, other)
        yield Finding(part, statistic, one.scene, window, POSITIVE, (values,))


CLAIMS = (
    Claim(
        1,
        "TA cells cover the membrane, and it deforms where they are.",
        "coverage, and when it is reached; roughness of the membrane before, over that after it",
        f"coverage above {COVERED:g}, between t = {IN_TIME.low:g} and {IN_TIME.high:g}; "
        f"the ratio below {HALF:g}",
        (STEM,), covers,
        "where in the plane the membrane deforms first",
    ),
    Claim(
        2,
        "Many protuberances form, and they point outward.",
        "skewness of the heights; papillae for each stem cell",
        f"skewness above 0; more than {PAPILLAE:g} papillae",
        (STEM,), protrudes,
    ),
    Claim(
        3,
        "Stem cells sit on the tips: chi_H, chi_G and zeta rise from 0 near full coverage to "
        "stationary values well above 0.",
        "stem cells on tips less TA cells on tips; chi_H, chi_G, zeta; their changes",
        "all above 0; before coverage, and from window to window, changes below half of the mean",
        (STEM,), stem_on_tips,
    ),
    Claim(
        4,
        "The curvatures chi_H and chi_G settle before the height zeta.",
        "time at which zeta rises to its late level, less that of chi_H and of chi_G",
        "above 0; all three have a level above 0",
        (STEM,), curvature_first,
    ),
    Claim(
        5,
        "These values do not depend on the arrangement at the start.",
        "differences of chi_H, chi_G, zeta between arrangements",
        "below half of the mean, either way",
        tuple((name,) for name in STEM), no_memory,
    ),
    Claim(
        6,
        "sigma falls and settles at full coverage, with a residue that remembers the arrangement: "
        "large from a cluster, small from random places.",
        "fall of sigma from a cluster; later changes; sigma from a cluster less that from others",
        "it falls; later changes below half of what is left; the differences above 0",
        tuple((name,) for name in STEM), remembers,
    ),
    Claim(
        7,
        "ND cells sit on tips, too, and where the membrane is as convex as under stem cells.",
        "ND cells on tips less TA cells on tips; chi_H, chi_G of ND cells, and less those of stem "
        "cells",
        "above 0; the differences below half of the value of stem cells",
        (ND,), nd_on_tips,
    ),
    Claim(
        8,
        "ND cells share papillae and cluster: sigma of ND cells is above that of stem cells, most "
        "of all where the two began apart.",
        "sigma of ND cells less that of stem cells; in nd-b and nd-d less in nd-a and nd-c",
        "above 0",
        (ND,), nd_cluster,
        "how many ND cells share a papilla",
    ),
    Claim(
        9,
        "ND cells are a little lower than stem cells early, and higher late.",
        "zeta of ND cells less that of stem cells",
        f"early between -{A_LITTLE:g} and 0, late above 0",
        (ND,), nd_rise,
    ),
    Claim(
        10,
        "In the continuum a term of the size of a cell breaks the symmetry of up and down.",
        lacking="a solution of the continuum equation: docs/studies/continuum.md",
    ),
    Claim(
        11,
        "A stiffer or less elastic membrane or dermis is flatter.",
        lacking="ensembles with several stiffnesses: docs/studies/photoaging.md",
    ),
)  # fmt: skip
"""All claims, in the order of the paper."""


def judge_all(ensembles: Ensembles) -> list[Verdict]:
    """A verdict on every claim, from ensembles of one size; see `rules.judge`."""
    return [judge(claim, ensembles) for claim in CLAIMS]
