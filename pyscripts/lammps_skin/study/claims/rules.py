"""From values of seeds to findings, and from findings to verdicts.

A finding says of one statistic in one window whether its interval over seeds lies where a claim
says. A verdict sums up the findings of a claim.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from lammps_skin.analysis.statistics import Mean, difference, mean
from lammps_skin.arrays import Floats
from lammps_skin.study.claims.tables import END, Ensemble
from lammps_skin.study.ranges import Window

FEWEST_SEEDS = 4  # of a scene, for a verdict
CONFIDENCE = 0.95  # of intervals
HALF = 0.5  # of a level: changes and differences below it count as none

Outcome = Literal["yes", "no", "undecided"]
Word = Literal["holds", "partly", "does not", "too few seeds", "not tested"]
Ensembles = Mapping[str, Ensemble]


class Range(NamedTuple):
    """Where a claim says that a value lies, ends not included."""

    low: float = -math.inf
    high: float = math.inf

    def __str__(self) -> str:
        if math.isinf(self.high):
            return f"> {self.low:.3g}"
        if math.isinf(self.low):
            return f"< {self.high:.3g}"
        return f"{self.low:.3g} to {self.high:.3g}"


POSITIVE, NEGATIVE = Range(low=0.0), Range(high=0.0)


def around_zero(level: Floats) -> Range:
    """Less than half of a level, the mean of values (n,)."""
    reach = HALF * abs(mean(level).value)
    return Range(-reach, reach)


@dataclass(frozen=True)
class Finding:
    """A statistic in a window, and where a claim says that it lies.

    Attributes
    ----------
    part : str
        Of the sentence of the claim.
    statistic : str
    scenes : str
    when : str
        Window, or windows.
    claimed : Range
    samples : tuple of (n,) arrays
        Values of the seeds; those of two scenes if the statistic is the difference of their means.
    condition : bool
        It must be so if the claim holds, but being so does not speak for the claim.
    fraction : bool
        The values are from 0 to 1.
    """

    part: str
    statistic: str
    scenes: str
    when: Window | str
    claimed: Range
    samples: tuple[Floats, ...]
    condition: bool = False
    fraction: bool = False

    def interval(self, confidence: float) -> Mean:
        """Mean over seeds, and its interval, after Student's t or Welch."""
        first, *other = self.samples
        if other:
            return difference(first, other[0], confidence)
        return mean(first, confidence, self.fraction)

    @cached_property
    def value(self) -> Mean:
        """With the interval that is shown."""
        return self.interval(CONFIDENCE)

    def outcome(self, confidence: float = CONFIDENCE) -> Outcome:
        """Whether the interval lies in the range that is claimed, outside of it, or neither."""
        _, _, low, high, _ = self.interval(confidence)
        if low > self.claimed.low and high < self.claimed.high:
            return "yes"
        return "no" if high <= self.claimed.low or low >= self.claimed.high else "undecided"

    @property
    def margin(self) -> float:
        """How far the interval lies within the claimed range, in standard errors."""
        room = min(self.value.low - self.claimed.low, self.claimed.high - self.value.high)
        with np.errstate(divide="ignore", invalid="ignore"):
            return float(np.divide(room, self.value.error))


Test = Callable[[Ensembles], Iterator[Finding]]


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper, and how it is tested.

    Attributes
    ----------
    number : int
    sentence : str
    statistic, threshold : str
        What is measured, and where the claim says that it lies.
    scenes : tuple of tuple of str
        Of each of these groups of scenes at least one is needed; all that are there are used.
    test : callable, optional
        From ensembles to findings.
    lacking : str
        What the tables do not say about the claim.
    """

    number: int
    sentence: str
    statistic: str = ""
    threshold: str = ""
    scenes: tuple[tuple[str, ...], ...] = ()
    test: Test | None = None
    lacking: str = ""


@dataclass(frozen=True)
class Verdict:
    """What ensembles say of a claim.

    Attributes
    ----------
    claim : Claim
    word : str
    findings : sequence of Finding
    seeds : mapping of str to int
        Of each scene that was used.
    notes : str
        What is missing.
    """

    claim: Claim
    word: Word
    findings: Sequence[Finding] = ()
    seeds: Mapping[str, int] | None = None
    notes: str = ""

    @property
    def parts(self) -> str:
        """How many findings of each part are as claimed."""
        if self.word == "too few seeds":
            return ""
        outcomes: dict[str, list[Outcome]] = {}
        for finding in self.findings:
            part = f"({finding.part})" if finding.condition else finding.part
            outcomes.setdefault(part, []).append(finding.outcome())
        return "; ".join(
            f"{part} {found.count('yes')} of {len(found)}" for part, found in outcomes.items()
        )

    @property
    def weakest(self) -> Finding | None:
        """The finding that speaks least for the claim."""
        order = {"no": 0, "undecided": 1, "yes": 2}
        return min(
            self.findings, default=None,
            key=lambda finding: (order[finding.outcome()], np.nan_to_num(finding.margin)),
        )  # fmt: skip


def judge(claim: Claim, ensembles: Ensembles) -> Verdict:
    """The verdict on a claim; raises `SkinError` if a table lacks a column."""
    if claim.test is None:
        return Verdict(claim, "not tested", notes=f"needs {claim.lacking}")
    for group in claim.scenes:
        if not any(scene in ensembles for scene in group):
            return Verdict(claim, "not tested", notes=f"needs {' or '.join(group)}")
    wanted = {scene for group in claim.scenes for scene in group}
    used = {scene: one for scene, one in ensembles.items() if scene in wanted}
    for scene, one in used.items():
        frames = np.unique(one.table["time"])
        if one.end + np.diff(frames, prepend=0.0)[-1] <= END:  # the last frame may come before
            notes = f"needs runs to t = {END:g}: {scene} ends at t = {one.end:g}"
            return Verdict(claim, "not tested", notes=notes)
    findings = list(claim.test(used))
    seeds = {scene: one.seeds for scene, one in used.items()}
    few = [f"{number} ({scene})" for scene, number in seeds.items() if number < FEWEST_SEEDS]
    if few:
        notes = f"needs {FEWEST_SEEDS} seeds, not {', '.join(few)}"
        return Verdict(claim, "too few seeds", findings, seeds, notes)
    notes = f"not in the tables: {claim.lacking}" if claim.lacking else ""
    return Verdict(claim, word(findings), findings, seeds, notes)


def word(findings: Iterable[Finding]) -> Word:
    """The verdict that follows from findings.

    "holds" if all are as claimed. "partly" if one that is no condition is so beyond chance: also
    with an interval so wide that all of those miss the truth together in at most 5 % of cases.
    """
    findings = list(findings)
    if all(finding.outcome() == "yes" for finding in findings):
        return "holds"
    speaking = [finding for finding in findings if not finding.condition]
    strict = 1 - (1 - CONFIDENCE) / len(speaking)
    some = any(finding.outcome(strict) == "yes" for finding in speaking)
    return "partly" if some else "does not"
