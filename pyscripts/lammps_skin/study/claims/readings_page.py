"""The page that compares readings: the rule of the default, the claims, the basal layer."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from lammps_skin.analysis.basal_layer import LAYER
from lammps_skin.model.scene import Scene
from lammps_skin.model.scenes import ARRANGEMENTS
from lammps_skin.study.claims.catalogue import CLAIMS
from lammps_skin.study.claims.readings import (
    Reading,
    choose,
    generations,
    named,
    stiffness_series,
)
from lammps_skin.study.claims.readings_levels import levels, long_runs, stiffness
from lammps_skin.study.claims.report import interval, level, weakest
from lammps_skin.study.claims.rules import FEWEST_SEEDS, Verdict, Word
from lammps_skin.study.claims.tables import WINDOWS
from lammps_skin.study.tradeoff.report import Text, markdown_table

TESTED = [claim for claim in CLAIMS if claim.test]
DEFAULT = Scene.from_dict({})
WORDS: tuple[Word, ...] = ("holds", "partly", "does not", "too few seeds", "not tested")
FIGURE = "figures/readings.png"

HEAD = f"""\
# Readings of the model

Some numbers of the paper contradict its results, so the package has several
[parameter sets](scene.md#parameter-sets). A *reading* is one of these sets together with M, the
number of times that the descendants of a stem cell divide. This page asks which reading makes skin:
one layer of cells, on rounded papillae, with the stem cells on their tips. This command makes the
page and its figure from tables of ensembles, one folder for each reading:

```
skin claims docs/data docs/data/readings/* -o docs/readings.md -o docs/{FIGURE}
```

The first line of each section states what the table below it shows. All runs are of the quarter
size. A value is a mean over seeds, with an interval at 95 %. The claims and the words of the
verdicts are those of the page on [claims](claims.md).

* none below: fraction of the cells with no other cell straight below; in one layer it is at least
  {LAYER:g}.
* chi_H: how much more convex the membrane is under stem cells than under all cells.
* zeta: how much higher stem cells are than all cells, in cell radii; zeta_nd is that of ND cells.
* sigma: how clustered cells are, from 0 (spread out) to 1.4 (all at one place).
* departures: keys of the scene that differ from what the paper prints.
"""


def markdown(readings: Sequence[Reading]) -> str:
    """The page; of readings that are a parameter set and a number of generations at least one."""
    main, series = named(readings), stiffness_series(readings)
    long = [one for one in readings if one.is_long]
    parts = [HEAD, "## Which reading is the default", *_rule(main)]
    parts += ["## The claims", *_claims(main), "## The basal layer", *_layers(main)]
    parts += ["## Papillae, stem cells and ND cells", *levels(main)]
    if len(series) > 1:
        parts += ["## Bending stiffness", *stiffness(series, FIGURE)]
    if long:
        parts += ["## Long runs", *long_runs(long)]
    return "\n\n".join(part.rstrip("\n") for part in parts if part) + "\n"


# ---- words


def _and(words: Iterable[object]) -> str:
    """``a, b and c``."""
    *first, last = map(str, words)
    return f"{', '.join(first)} and {last}" if first else last


def _names(readings: Iterable[Reading]) -> str:
    return _and(one.name for one in readings)


def _bullets(lines: Iterable[str]) -> str:
    return "\n".join(f"* {line}" for line in lines)


# ---- the rule


RULE = f"""\
The rule has three steps. Keep the readings that make a basal layer: in all seven scenes, in each of
the windows t = {", ".join(map(str, WINDOWS))}, and while the membrane is covered, at least
{LAYER:g} of the cells have none below, as a mean over at least {FEWEST_SEEDS} seeds. Of these, take
the reading with which most claims hold. Of equals, take the one with fewest departures."""


def _rule(readings: Sequence[Reading]) -> Iterator[str]:
    yield f"**{outcome(readings)}**"
    yield RULE
    yield markdown_table(*rule_table(readings))
    against = list(_against(readings))
    if against:
        yield "### What argues against it"
        yield _bullets(against)


def outcome(readings: Sequence[Reading]) -> str:
    """What the rule takes, and why, in sentences."""
    return " ".join(_outcome(readings))


def _outcome(readings: Sequence[Reading]) -> Iterator[str]:
    candidates, best = choose(readings)
    if not best:
        yield "The rule takes no reading: none is known to make a basal layer in all seven scenes."
    elif len(best) > 1:
        yield f"The rule does not tell these apart: {_names(best)}."
    else:
        yield f"The rule takes {best[0].name}: {_reason(candidates)}."
    if unknown := [one for one in readings if one.is_layer == "not known"]:
        yield f"Not known enough: {_names(unknown)}."
    yield f"The default of the package is {DEFAULT.parameters} ({generations(DEFAULT)})."


def _reason(candidates: Sequence[Reading]) -> str:
    first, *others = candidates
    holds = len(first.claims("holds"))
    if not others:
        return "it alone is known to make a basal layer in all seven scenes"
    if holds > len(others[0].claims("holds")):
        return (
            f"of the {len(candidates)} readings that make a basal layer in all seven scenes, "
            f"{holds} claims hold with it, {len(others[0].claims('holds'))} with the next"
        )
    return (
        f"as many claims hold with it as with {others[0].name}, {holds}, and it has fewer "
        f"departures from print, {len(first.departures)} against {len(others[0].departures)}"
    )


def rule_table(readings: Iterable[Reading]) -> Text:
    """What the rule looks at."""
    heads = [
        "reading", "runs", "lacks", "least none below", "basal layer", "hold", "partly",
        "departures",
    ]  # fmt: skip
    rows = []
    for one in readings:
        least = one.least
        where = f"{interval(least.value)} ({least.scene}, {least.window})" if least else "-"
        numbers = [", ".join(map(str, one.claims(word))) or "-" for word in WORDS[:2]]
        rows.append([
            one.name, one.seeds, ", ".join(one.missing) or "-", where, one.is_layer, *numbers,
            str(len(one.departures)),
        ])  # fmt: skip
    return heads, rows


def _against(readings: Sequence[Reading]) -> Iterator[str]:
    """What speaks against the first of the readings that the rule takes."""
    candidates, best = choose(readings)
    if not best:
        return
    first = best[0]
    for one in first.verdicts:
        if one.word in ("partly", "does not"):
            verb = "holds in part" if one.word == "partly" else "does not hold"
            why = f" Weakest: {weakest(one.weakest)}."
            yield f"Claim {one.claim.number} {verb}: {one.claim.sentence}{why}"
    for layer in first.layers:
        if not layer.value.low >= LAYER:
            yield (
                f"The interval of none below reaches under {LAYER:g} in {layer.scene}, "
                f"t = {layer.window}: {interval(layer.value)}."
            )
    holds = len(first.claims("holds"))
    for other in readings:
        if other not in candidates and len(other.claims("holds")) >= holds:
            reason = "makes no basal layer" if other.is_layer == "no" else "is not known enough"
            numbers = ", ".join(map(str, other.claims("holds")))
            yield f"As many claims or more hold with {other.name} ({numbers}), which {reason}."
    for other in candidates:
        yield from _better(first, other)
    fewer = [one for one in candidates if len(one.departures) < len(first.departures)]
    if fewer:
        yield f"Nearer to print, and a basal layer, too: {_names(fewer)}."
    yield f"It departs from print in {_and(f'`{key}`' for key in first.departures)}."


def _better(first: Reading, other: Reading) -> Iterator[str]:
    """In what another candidate is nearer to what is wanted than the first."""
    if first.least and other.least and other.least.value.low > first.least.value.high:
        yield (
            f"Fewer cells lie over others with {other.name}: in the worst window none below is "
            f"{interval(other.least.value)}, not {interval(first.least.value)}."
        )
    pairs = [
        (theirs.claim.number, _as_claimed(theirs), _as_claimed(ours))
        for ours, theirs in zip(first.verdicts, other.verdicts, strict=True)
    ]
    more = [
        f"{number} ({theirs} instead of {ours})" for number, theirs, ours in pairs if theirs > ours
    ]
    if more:
        yield f"More findings are as claimed with {other.name}: those of claim {_and(more)}."


def _as_claimed(one: Verdict) -> int:
    return sum(finding.outcome() == "yes" for finding in one.findings)


# ---- the claims


def _claims(readings: Sequence[Reading]) -> Iterator[str]:
    most = max(readings, key=lambda one: len(one.claims("holds")))
    yield (
        f"Of the {len(TESTED)} claims that tables can test, {len(most.claims('holds'))} hold with "
        f"{most.name}, and no more with any other reading."
    )
    yield _matrix(readings)
    common = [name for name in ARRANGEMENTS if all(name in one.ensembles for one in readings)]
    if common and any(len(one.ensembles) > len(common) for one in readings):
        alone = [one.alone(common) for one in readings]
        yield (
            f"Those readings were not run in the same scenes, and more scenes test a claim in more "
            f"ways. The same from {_and(common)} alone:"
        )
        yield _matrix(alone)
    for number, claim in enumerate(CLAIMS):
        if not claim.test:
            continue
        yield f"### Claim {claim.number}"
        yield f"{_who(readings, claim.number)} {claim.sentence} Claimed: {claim.threshold}."
        yield markdown_table(
            ["reading", "verdict", "as claimed", "weakest"],
            [
                [
                    one.name, found.word, "; ".join(filter(None, (found.parts, found.notes))),
                    weakest(found.weakest) if found.parts else "",
                ]
                for one in readings for found in [one.verdicts[number]]
            ],
        )  # fmt: skip


def _matrix(readings: Iterable[Reading]) -> str:
    """Verdicts: a row for each reading, a column for each claim."""
    heads = ["reading", "runs", *(f"{claim.number}" for claim in TESTED)]
    rows = [
        [one.name, one.seeds, *(verdict.word for verdict in one.verdicts if verdict.claim.test)]
        for one in readings
    ]
    return markdown_table(heads, rows)


SAYING = {
    "holds": "holds with", "partly": "holds in part with", "does not": "does not hold with",
    "too few seeds": "has too few seeds of", "not tested": "is not tested with",
}  # fmt: skip


def _who(readings: Sequence[Reading], number: int) -> str:
    """With which readings a claim holds, as a sentence."""
    said = []
    for word in WORDS:
        those = [one for one in readings if number in one.claims(word)]
        if those:
            what = _names(those) if len(those) < len(readings) else "all readings"
            said.append(f"{SAYING[word]} {what}")
    return f"**It {'; it '.join(said)}.**"


# ---- the basal layer


def _layers(readings: Sequence[Reading]) -> Iterator[str]:
    heaps = [one for one in readings if one.is_layer == "no"]
    flat = [one for one in readings if one not in heaps and one.layers]
    said = []
    if flat:
        said.append(f"One layer of cells in all scenes that were run: {_names(flat)}.")
    if heaps:
        said.append(f"A heap of cells in at least one scene and window: {_names(heaps)}.")
    yield " ".join(said) or "Nothing is known of the layer: the tables lack the column none_below."
    rows = []
    for one in readings:
        for scene, ensemble in one.ensembles.items():
            found = ensemble.none_below()
            if found:
                most = level(ensemble, "most_on_particle", ensemble.late)
                rows.append([
                    one.name, scene, str(ensemble.seeds),
                    *(interval(found[window]) for window in WINDOWS), interval(most),
                ])  # fmt: skip
    heads = ["reading", "scene", "seeds", *(f"none below, {window}" for window in WINDOWS)]
    yield markdown_table([*heads, "most cells on one membrane particle"], rows) if rows else ""
