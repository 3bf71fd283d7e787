"""``skin stats``: the observables of a run, over time and averaged."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from lammps_skin.cli.output import console, counted, print_table
from lammps_skin.errors import SkinError

MOMENTS = 7  # of a run that are shown
SHOWN = (
    "births", "deaths", "coverage", "none_below", "most_on_particle", "membrane_area",
    "height_std", "skewness", "papillae", "papilla_height", "papilla_width_cells",
)  # fmt: skip
ORDERS = ("chi_H", "zeta", "sigma")  # that are shown of kinds of cells
SPREADS = ("_low", "_high", "_sd", "_p")  # of what stands in a column of its own
CLONES = 8


def stats(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Run directory, or a trajectory.")],
    window: Annotated[
        str | None,
        typer.Option(
            metavar="A-B",
            help="Times to show and to average over [default: all, the last two fifths].",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print everything as JSON.")] = False,
) -> None:
    """Show the observables of a run: over time, averaged, with events and energies."""
    from lammps_skin.analysis.summary import (  # MDAnalysis takes a second to import
        summary,
        without_nan,
    )

    times = None if window is None else _times(window)
    if as_json:
        print(json.dumps(without_nan(summary(run, times)), allow_nan=False))
        return
    with console.status("analysing"):
        found = summary(run, times)
    told = found["run"]
    further = f" of {told['end_time']:g}" if told["to"] < told["end_time"] else ""
    console.print(
        f"{told['scene']}, {told['parameters']}, {_seeds(told)}: "
        f"{counted(told['frames'], 'frame')}, t = {told['from']:g} to {told['to']:g}{further}"
    )
    means = found["window"]
    window = f"t = {means['start']:g} to {means['end']:g}"
    places = _places(found["observables"]["time"], times)
    moments = [_number(found["observables"]["time"][place]) for place in places]
    tables = [
        (["", *moments], _over_time(found, places)),
        ([window, "mean", "95 % interval", "frames", "trend"], _averages(found)),
    ]
    if found["events"]:
        tables.append((["events", ""], _happened(found["events"], window)))
        heads = ["clone of", "kind", "births", "removals", "cells"]
        tables.append((heads, _clones(found["events"])))
    if found["energies"]:
        tables.append((["energy", "first", "mean", "last"], _energies(found["energies"])))
    for heads, rows in tables:
        print_table(heads, rows, right=True)
    for line in _remarks(found, window):
        console.print(f"\n{line}")


def _remarks(found: dict[str, Any], window: str) -> Iterator[str]:
    """What the tables do not tell by themselves."""
    from lammps_skin.analysis.basal_layer import last_remark

    if line := last_remark(found["observables"]):
        yield line
    trends = {mean["trend"] for mean in found["window"]["means"].values()}
    if trends & {"rises", "falls"}:
        yield f"not stationary in {window}: what rises or falls has a mean of this window alone"
    if "unclear" in trends:
        yield (
            f"{window} has too few frames to tell whether what has an unclear trend is stationary"
        )


def _seeds(told: dict[str, Any]) -> str:
    """The seeds that were used: one, or those of the cells and of the dermis."""
    cells, dermis = told["cell_seed"], told["dermis_seed"]
    return f"seed {cells}" if cells == dermis else f"seeds {cells} of cells, {dermis} of dermis"


def _times(window: str) -> tuple[float, float]:
    try:
        start, end = (float(word) for word in window.split("-"))
        if start < end:
            return start, end
    except ValueError:
        pass
    raise SkinError(f"--window {window}: must be two ascending times, such as 600-1000")


def _places(times: list[float], within: tuple[float, float] | None) -> list[int]:
    """Frames to show, evenly spread over the run or over those of a window."""
    start, end = within or (times[0], times[-1])
    inside = [place for place, time in enumerate(times) if start <= time <= end]
    last = len(inside) - 1
    return [inside[n] for n in sorted({round(last * n / (MOMENTS - 1)) for n in range(MOMENTS)})]


def _over_time(found: dict[str, Any], places: list[int]) -> Iterator[tuple[str, ...]]:
    columns = list(found["observables"])
    kinds = columns[1 : columns.index("births")]
    placed = [kind for kind in kinds if f"{kind}_on_tips" in columns]
    tips = [f"{kind}_on_tips" for kind in placed]
    orders = [*ORDERS, *(f"{name}_{kind}" for kind in placed[1:] for name in ORDERS)]
    for name in (*kinds, *SHOWN, *tips, *orders):
        values = [found["observables"][name][place] for place in places]
        kind = next((word for word in name.split("_") if word in placed), "stem")
        if any(value == value and value for value in values) or (
            all(value != value for value in values) and any(found["observables"][kind])
        ):
            yield name, *map(_number, values)


def _averages(found: dict[str, Any]) -> Iterator[tuple[str, ...]]:
    columns = list(found["observables"])
    kinds = columns[1 : columns.index("births")]
    absent = [kind for kind in kinds if not any(found["observables"][kind])]
    for name, mean in found["window"]["means"].items():
        if mean["n"] and not name.endswith(SPREADS) and not set(name.split("_")) & set(absent):
            defined = mean["low"] == mean["low"]
            interval = f"{_number(mean['low'])} to {_number(mean['high'])}" if defined else "-"
            trend = "" if mean["trend"] == "none" else mean["trend"]
            yield name, _number(mean["value"]), interval, str(mean["n"]), trend


def _happened(events: dict[str, Any], window: str) -> Iterator[tuple[str, ...]]:
    causes = (f"{number:,} {cause}" for cause, number in events["removals_by_cause"].items())
    yield "births", f"{events['births']:,}"
    yield "removals", ", ".join(causes) or "0"
    yield from events["interventions"].items()
    yield (
        f"births, removals per time unit, {window}",
        (f"{_number(events['births_per_time'])}, {_number(events['removals_per_time'])}"),
    )
    yield "mixing of clones at the end", _number(events["mixing"])


def _clones(events: dict[str, Any]) -> Iterator[tuple[str, ...]]:
    """The largest, and how many there are."""
    clones = events["clones"]
    for clone in clones[:CLONES]:
        yield (
            str(clone["founder"]), clone["kind"], str(clone["births"]), str(clone["removals"]),
            str(clone["size"]),
        )  # fmt: skip
    rest = clones[CLONES:]
    if rest:
        sums = (str(sum(clone[key] for clone in rest)) for key in ("births", "removals", "size"))
        yield counted(len(rest), "other"), "", *sums


def _energies(energies: dict[str, Any]) -> Iterator[tuple[str, ...]]:
    for name, values in energies.items():
        yield name, *(_number(values[key]) for key in ("first", "mean", "last"))


def _number(value: float) -> str:
    """Three digits, whole numbers in full, nothing for what is not defined."""
    if value != value:
        return "-"
    return f"{value:.0f}" if value == round(value) or abs(value) >= 1000 else f"{value:.3g}"
