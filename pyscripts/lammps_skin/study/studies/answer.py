"""What a study answers: means over seeds with their intervals, by point; and pictures of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lammps_skin.analysis import labels
from lammps_skin.analysis.derived import average, fault, statistic
from lammps_skin.analysis.observables import Table
from lammps_skin.analysis.statistics import Mean
from lammps_skin.arrays import Floats
from lammps_skin.errors import SceneError
from lammps_skin.model.scene_keys import near
from lammps_skin.study.ensemble import by_seed, over_time
from lammps_skin.study.ranges import Window
from lammps_skin.study.studies.design import Design
from lammps_skin.style import name_axes, panels, plain

SHOWN = (
    "stem_on_tips-stem_tips_expected", "chi_H", "zeta", "coverage", "papillae",
    "papilla_height", "skewness",
)  # fmt: skip
TIME = "time"


class Answer(NamedTuple):
    """A mean over the seeds of a point, in a window."""

    point: str
    window: Window
    column: str
    mean: Mean


def check_columns(wanted: Sequence[str], observed: Sequence[str]) -> None:
    """Raise `SceneError` for a column that there is not, nor can be made of those there are."""
    for column in wanted:
        if wrong := fault(column, observed):
            allowed = (
                "" if "; did you mean" in wrong else
                f"; allowed: {', '.join(observed)}, differences such as a-b, times such as a>0.5"
            )  # fmt: skip
            raise SceneError(f"--columns {column}: {wrong}{allowed}")


def mean_of(courses: Mapping[str, Table], label: str, column: str, window: Window) -> Mean:
    """Mean over the seeds of a point, from the time courses of all points, by their labels."""
    tables = by_seed(courses[label]).values() if label in courses else ()
    return average(np.array([statistic(table, column, window) for table in tables]), column)


def answers(
    design: Design, courses: Mapping[str, Table], wanted: Sequence[str]
) -> list[Answer]:
    """Of all points in all windows."""
    return [
        Answer(point.label, window, column, mean_of(courses, point.label, column, window))
        for window, point, column in product(design.windows, design.points, wanted)
    ]


def defined(
    design: Design, courses: Mapping[str, Table], wanted: Sequence[str]
) -> list[str]:
    """The columns that have a value at some point in some window; all of them if none has."""
    found = {one.column for one in answers(design, courses, wanted) if one.mean.n}
    return [column for column in wanted if column in found] or list(wanted)


def against_of(design: Design, against: str | None) -> str:
    """What pictures have on their horizontal axis: time, ``condition`` or a key that is varied.

    By default the key if there is one of numbers, else time.
    """
    numeric = [key for key in design.keys if _is_numeric(design, key)]
    if against is None:
        return numeric[0] if len(numeric) == 1 and not design.sample else TIME
    allowed = [TIME, *(["condition"] if design.points[0].condition else []), *design.keys]
    if against not in allowed:
        raise SceneError(
            f"--against {against}: must be one of {', '.join(allowed)}{near(against, allowed)}"
        )
    return against


def _is_numeric(design: Design, key: str) -> bool:
    values = [point.values[key] for point in design.points]
    return all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values)


@plain
def draw_over_time(courses: Mapping[str, Table], wanted: Sequence[str]) -> Figure:
    """A panel for each column, a line with a band for each point."""
    figure, axes_of = panels(len(wanted))
    for axes, column in zip(axes_of, wanted, strict=True):
        for label, table in courses.items():
            _line(axes, *over_time(table, column), label)
        name_axes(axes, labels.TIME, labels.label(column).text)
    _legend(figure, axes_of)
    return figure


@plain
def draw_against(
    design: Design, courses: Mapping[str, Table], wanted: Sequence[str], against: str,
    window: Window,
) -> Figure:
    """A panel for each column: means in a window, with intervals, against a key or the condition.

    A line for each choice of what else is varied.
    """
    groups: dict[str, list[tuple[Any, str]]] = {}
    for point in design.points:
        values = {"condition": point.condition, **point.values}
        if against == "condition":  # what the conditions change belongs to them
            fixed = point.label.removeprefix(str(point.condition)).removeprefix(", ")
        else:
            fixed = ", ".join(
                word for word in point.label.split(", ") if not word.startswith(f"{against}=")
            )
        groups.setdefault(fixed, []).append((values[against], point.label))
    numeric = against != "condition" and _is_numeric(design, against)
    found = {(one.point, one.column): one.mean for one in answers(design, courses, wanted)
             if one.window == window}  # fmt: skip
    figure, axes_of = panels(len(wanted))
    for axes, column in zip(axes_of, wanted, strict=True):
        for n, (label, points) in enumerate(groups.items()):
            if numeric:
                points = sorted(points)
                places = np.array([float(value) for value, _ in points])
            else:
                places = np.arange(len(points)) + 0.1 * n
                axes.set_xticks(range(len(points)), [str(value) for value, _ in points])
            _bars(axes, places, [found[point, column] for _, point in points], label, numeric)
        name_axes(axes, against, labels.label(column).text)
    figure.suptitle(f"means over t = {window}", fontsize="medium")
    _legend(figure, axes_of)
    return figure


def _line(axes: Axes, places: Floats, means: Sequence[Mean], label: str) -> None:
    value, _, low, high, _ = np.array(means).T
    (line,) = axes.plot(places, value, label=label)
    axes.fill_between(places, low, high, color=line.get_color(), alpha=0.2, linewidth=0)


def _bars(
    axes: Axes, places: Floats, means: Sequence[Mean], label: str, joined: bool
) -> None:
    value, _, low, high, _ = np.array(means).T
    reach = np.nan_to_num([value - low, high - value])
    axes.errorbar(places, value, reach, fmt="o-" if joined else "o", capsize=3, label=label)


def _legend(figure: Figure, panels: Sequence[Axes]) -> None:
    handles, labels = panels[0].get_legend_handles_labels()
    if len(labels) > 1:
        figure.legend(handles, labels, frameon=False, loc="outside lower center", ncols=4)
