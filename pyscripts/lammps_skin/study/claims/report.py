"""Verdicts as tables: for the terminal, as Markdown, CSV and JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lammps_skin.analysis.derived import average
from lammps_skin.analysis.statistics import Mean, mean
from lammps_skin.errors import SkinError
from lammps_skin.files import atomic_write
from lammps_skin.study.claims.catalogue import ND, judge_all
from lammps_skin.study.claims.rules import CONFIDENCE, FEWEST_SEEDS, Finding, Verdict
from lammps_skin.study.claims.tables import Ensemble, layer_remarks, load, settings
from lammps_skin.study.ranges import Window
from lammps_skin.study.tradeoff.report import Text, csv_text, markdown_table

LEVELS = ("chi_H", "chi_G", "zeta", "sigma")
FOLDS = ("coverage", "skewness", "papillae", "papilla_height")

HEAD = f"""\
# Ensembles

`skin claims FOLDER -o FILE.md` makes this page from the tables of `skin ensemble` in FOLDER, here
`{{folder}}`. Values are means over seeds of the mean over a window of time, with intervals over
seeds at {100 * CONFIDENCE:g} %; one seed has no interval. Columns are those of the table of
observables; "on tips" is the fraction of the cells that are on tips less that of TA cells.

* holds: every interval lies in the range that is claimed.
* partly: some do, and more than by chance.
* does not: none does, or no more than by chance.
* too few seeds: fewer than {FEWEST_SEEDS} of a scene.

Parts in parentheses are conditions: they must be so for a claim to hold, but do not speak for it.
A finding is undecided if its interval holds an end of the range."""


@dataclass(frozen=True)
class Report:
    """The verdicts on all claims from the ensembles of one size.

    Attributes
    ----------
    size : str
    ensembles : mapping of str to Ensemble
        By scene.
    verdicts : list of Verdict
    """

    size: str
    ensembles: Mapping[str, Ensemble]
    verdicts: list[Verdict]

    @property
    def title(self) -> str:
        return f"scenes of the {self.size} size"

    @property
    def remarks(self) -> list[str]:
        """What was run, and what to know of it."""
        ran = settings(self.size, self.ensembles)
        mixed = ["the scenes differ in more than their arrangement"] if len(ran) > 1 else []
        lines = []
        for words, scenes in ran.items():
            seeds = {self.ensembles[scene].seeds for scene in scenes}
            lines += [
                f"{words}; seeds: {number}, of "
                + ", ".join(one for one in scenes if self.ensembles[one].seeds == number)
                for number in sorted(seeds)
            ]
        return [*lines, *mixed, *layer_remarks(self.ensembles)]


def reports(folder: Path) -> list[Report]:
    """One for each size of which there are tables in a folder; raises `SkinError` if none."""
    return [Report(size, found, judge_all(found)) for size, found in load(folder).items()]


# ---- tables as text


def verdicts_table(report: Report) -> Text:
    """All claims: the sentence, the verdict, how it came about."""
    heads = ["", "claim", "verdict", "as claimed", "weakest"]
    rows = [
        [
            str(one.claim.number), one.claim.sentence, one.word,
            "; ".join(filter(None, (one.parts, one.notes))), weakest(one.weakest),
        ]
        for one in report.verdicts
    ]  # fmt: skip
    return heads, rows


def findings_table(findings: Iterable[Finding]) -> Text:
    """Every interval with the range that is claimed."""
    heads = ["part", "statistic", "scene", "t", "mean", "claimed", "as claimed"]
    rows = [
        [
            f"({one.part})" if one.condition else one.part, one.statistic, one.scenes,
            str(one.when), interval(one.value), str(one.claimed), _said(one),
        ]
        for one in findings
    ]  # fmt: skip
    return heads, rows


def levels_table(report: Report) -> Text:
    """Means over the late window: of stem cells and the membrane, of ND cells, their differences.

    On tips: fraction of the cells less that of TA cells.
    """
    windows = {one.late for one in report.ensembles.values()}
    heads = [f"t = {', '.join(sorted(map(str, windows)))}", *LEVELS, "on tips", *FOLDS]
    rows = [
        [f"{name}, stem cells", *_levels(one, "", "stem"), *(_level(one, fold) for fold in FOLDS)]
        for name, one in report.ensembles.items()
    ]
    blank = [""] * len(FOLDS)
    for name, one in report.ensembles.items():
        if name in ND:
            rows.append([f"{name}, ND cells", *_levels(one, "_nd", "nd"), *blank])
            apart = (_level(one, f"{column}_nd", column) for column in LEVELS)
            tips = _level(one, "nd_on_tips", "stem_on_tips")
            rows.append([f"{name}, ND less stem cells", *apart, tips, *blank])
    return heads, rows


def _levels(one: Ensemble, suffix: str, kind: str) -> Iterator[str]:
    yield from (_level(one, f"{column}{suffix}") for column in LEVELS)
    yield _level(one, f"{kind}_on_tips", f"{kind}_tips_expected")


def _level(one: Ensemble, column: str, other: str = "") -> str:
    return interval(level(one, column, one.late, other))


def level(one: Ensemble, column: str, window: Window, other: str = "") -> Mean:
    """Mean of a column over a window, or less that of another one, with its interval over seeds."""
    values = one.mean(column, window)
    if other:
        return mean(values - one.mean(other, window))
    return average(values, column)


def interval(value: Mean) -> str:
    """Mean and interval; the mean alone of one seed."""
    digits = 2 if abs(value.value) < 10 else 0 if abs(value.value) >= 100 else 1
    middle, low, high = (f"{number:.{digits}f}" for number in (value.value, value.low, value.high))
    if math.isnan(value.value):
        return "-"
    return middle if math.isnan(value.low) else f"{middle} [{low}, {high}]"


def _said(finding: Finding) -> str:
    return "-" if math.isnan(finding.value.low) else finding.outcome()


def weakest(one: Finding | None) -> str:
    """A finding in words: what was measured, and whether it is as claimed."""
    if one is None or math.isnan(one.value.low):
        return ""
    is_not = "" if one.outcome() == "yes" else "not "
    place = f"{one.statistic}, {one.scenes}, t = {one.when}"
    return f"{place}: {interval(one.value)}, {is_not}{one.claimed}"


# ---- files


def markdown(found: Iterable[Report], folder: Path) -> str:
    """The page: for each size the verdicts, then the intervals of each claim, and levels."""
    parts = [HEAD.format(folder=folder)]
    for report in found:
        parts += [
            f"## {report.title.capitalize()}",
            "\n".join(f"* {remark}" for remark in report.remarks),
            markdown_table(*verdicts_table(report)),
            "### Levels", markdown_table(*levels_table(report)),
        ]  # fmt: skip
        for one in report.verdicts:
            if one.word in ("holds", "partly", "does not"):
                claim = one.claim
                parts += [
                    f"### Claim {claim.number}: {one.word}",
                    f"{claim.sentence} Measured: {claim.statistic}. Claimed: {claim.threshold}.",
                    markdown_table(*findings_table(one.findings)),
                ]
    return "\n\n".join(parts) + "\n"


RECORD = (
    "part", "statistic", "scene", "t", "seeds", "mean", "low", "high", "claimed_low",
    "claimed_high", "condition", "as_claimed",
)  # fmt: skip


def _records(found: Iterable[Report]) -> Iterator[dict[str, Any]]:
    """A record for each finding; one for each claim without any."""
    for report in found:
        for one in report.verdicts:
            claim = {
                "size": report.size, "claim": one.claim.number, "sentence": one.claim.sentence,
                "verdict": one.word, "notes": one.notes,
            }  # fmt: skip
            for finding in one.findings:
                yield claim | _record(finding)
            if not one.findings:
                yield claim | dict.fromkeys(RECORD, "")


def _record(finding: Finding) -> dict[str, Any]:
    value, claimed = finding.value, finding.claimed
    return dict(zip(RECORD, (
        finding.part, finding.statistic, finding.scenes, str(finding.when), value.n, value.value,
        value.low, value.high, claimed.low, claimed.high, finding.condition, _said(finding),
    ), strict=True))  # fmt: skip


def _csv(found: list[Report], _: Path) -> str:
    return csv_text(_records(found))


def _json(found: list[Report], _: Path) -> str:
    """Sizes, their claims, the findings of these; what is not finite is null."""
    data = [
        {
            "size": report.size,
            "settings": settings(report.size, report.ensembles),
            "remarks": report.remarks,
            "claims": [
                {
                    "number": one.claim.number, "sentence": one.claim.sentence,
                    "statistic": one.claim.statistic, "threshold": one.claim.threshold,
                    "verdict": one.word, "notes": one.notes, "seeds": one.seeds or {},
                    "findings": [
                        {key: _finite(value) for key, value in _record(finding).items()}
                        for finding in one.findings
                    ],
                }
                for one in report.verdicts
            ],
        }
        for report in found
    ]  # fmt: skip
    return json.dumps(data, indent=1, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


FORMATS = {".md": markdown, ".csv": _csv, ".json": _json}


def check_names(paths: Iterable[Path], suffixes: Iterable[str] = FORMATS) -> None:
    """Raise `SkinError` for a name that ends in none of the suffixes."""
    for path in paths:
        if path.suffix not in suffixes:
            raise SkinError(f"output {path}: its name must end in one of {', '.join(suffixes)}")


def write(found: list[Report], folder: Path, path: Path) -> None:
    """Write verdicts in the format that the suffix of a name says; see `check_names`."""
    write_text(path, FORMATS[path.suffix](found, folder))


def write_text(path: Path, text: str) -> None:
    """Write a file when it is complete; raises `SkinError` if it cannot be written."""
    try:
        with atomic_write(path) as place:
            place.write_text(text, "utf-8")
    except OSError as error:
        raise SkinError(f"output {path}: {error.strerror}") from None
