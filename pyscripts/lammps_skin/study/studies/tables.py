"""The tables of a study in Parquet: means over windows, and time courses.

Rows are in the order of the points of the design, then by seed, then by window or time. The same
runs give the same bytes, in whatever order they have ended.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from lammps_skin.analysis.observables import Table, columns, read_table
from lammps_skin.errors import SkinError
from lammps_skin.files import atomic_write
from lammps_skin.study.ensemble import Member, window_means, with_seed
from lammps_skin.study.studies.runs import Runs, Study, StudyRun
from lammps_skin.study.studies.samples import Sample

MEANS, COURSES = "table.parquet", "courses.parquet"
SAMPLE = "sample"  # of what is stored with the names of columns
NEEDS = "tables of studies need pyarrow: pip install 'lammps-skin[study]'"


def write_tables(study: Study, failures: Mapping[Member, str] | None = None) -> list[Path]:
    """Write both tables of all that is there.

    Parameters
    ----------
    study : Study
    failures : mapping, optional
        Errors of runs that could not note them.
    """
    failures = failures or {}
    observed = observables_of(study)
    means, courses = study.folder / MEANS, study.folder / COURSES
    schema = _schema(study, ("window", "start", "end", "status", "error"), observed)
    rows = [
        row
        for point in study.points
        for run in point.runs
        for row in _mean_rows(study, point, run, observed, failures.get(run, ""))
    ]
    _write(means, schema, [rows])
    of_points = (
        [row for run in point.runs if run.done for row in _course_rows(point, run, observed)]
        for point in study.points
    )
    _write(courses, _schema(study, (), ["time", *observed]), of_points)
    return [means, courses]


def observables_of(study: Study) -> list[str]:
    """Columns of the observables of all points, in the order in which they first occur."""
    found: dict[str, None] = {}
    for point in study.design.points:
        found |= dict.fromkeys(columns(point.scene.kinds_of_cells)[1:])
    return list(found)


def read_means(folder: Path) -> dict[str, Any]:
    """Columns of the table of means; those of numbers have NaN where nothing is defined."""
    return _columns(folder / MEANS)


def read_sample(folder: Path) -> Sample | None:
    """The sample of which a study consists; None if there is none, or it is not told."""
    try:
        about = _arrow().parquet.read_schema(folder / MEANS).metadata or {}
    except FileNotFoundError:
        return None
    given = json.loads(about.get(SAMPLE.encode(), b"{}"))
    return Sample.of(given) if given else None


def read_courses(folder: Path) -> dict[str, Table]:
    """Time courses of each point, by its label, as a table of an ensemble: seed, time, observables.

    Points without a run that is done are left out.
    """
    found = _columns(folder / COURSES)
    names = list(found)
    observed = names[names.index("time") :]
    labels = np.array(found["point"], object)
    kinds = [(name, float) for name in ("seed", *observed)]
    tables = {}
    for label in dict.fromkeys(found["point"]):
        mine = np.flatnonzero(labels == label)
        table = np.empty(len(mine), kinds)
        for name, _ in kinds:
            table[name] = np.asarray(found[name], float)[mine]
        tables[label] = table
    return tables


def _columns(path: Path) -> dict[str, Any]:
    arrow = _arrow()
    try:
        table = arrow.parquet.read_table(path)
    except FileNotFoundError:
        raise SkinError(f"table {path}: no such file") from None
    except (OSError, arrow.ArrowException) as error:
        raise SkinError(f"table {path}: is no table of a study: {error}") from None
    found = {}
    for name, kind in zip(table.column_names, table.schema.types, strict=True):
        column = table.column(name)
        is_float = arrow.types.is_floating(kind)
        found[name] = column.to_numpy() if is_float else column.to_pylist()
    return found


def _arrow() -> Any:
    """The package pyarrow, which takes a moment to import."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise SkinError(NEEDS) from None
    return pyarrow


def _schema(study: Study, words: Sequence[str], numbers: Sequence[str]) -> Any:
    """Names and types of columns, and what the study is."""
    arrow = _arrow()
    text, number = arrow.string(), arrow.float64()
    fields = [("point", text), ("condition", text)]
    fields += [(key, _type_of(study, key)) for key in study.design.keys]
    fields += [("seed", arrow.int64()), ("run", text)]
    fields += [(name, number if name in ("start", "end") else text) for name in words]
    fields += [(name, number) for name in numbers]
    about = {
        "study": study.design.name,
        SAMPLE: json.dumps(asdict(study.design.sample) if study.design.sample else {}),
        "scene": json.dumps(study.design.scene.given(), sort_keys=True),
        "made by": ", ".join(" ".join(pair) for pair in study.runs[0].made_by),
    }
    return arrow.schema(fields, metadata=about)


def _type_of(study: Study, key: str) -> Any:
    """Numbers and truth as such, what else or mixed a key can be as text."""
    arrow = _arrow()
    values = [point.values[key] for point in study.design.points]
    kinds = {type(value) for value in values if value is not None}
    if kinds and kinds <= {int, float}:
        return arrow.float64()
    return arrow.bool_() if kinds == {bool} else arrow.string()


def _write(path: Path, schema: Any, groups: Any) -> None:
    """Write groups of rows, as they come."""
    arrow = _arrow()
    words = [field.name for field in schema if field.type == arrow.string()]
    try:
        with (
            atomic_write(path) as part,
            arrow.parquet.ParquetWriter(part, schema, compression="zstd") as writer,
        ):
            for rows in groups:
                if rows:
                    texts = [{name: _text(row.get(name)) for name in words} for row in rows]
                    told = [row | text for row, text in zip(rows, texts, strict=True)]
                    writer.write_table(arrow.Table.from_pylist(told, schema))
    except OSError as error:
        raise SkinError(f"table {path}: {error.strerror or error}") from None


def _named(point: Runs, run: StudyRun) -> dict[str, Any]:
    """The columns that say of which run a row is."""
    return {
        "point": point.point.label, "condition": point.point.condition,
        **point.point.values, "seed": run.seed, "run": run.directory.name,
    }  # fmt: skip


def _mean_rows(
    study: Study, point: Runs, run: StudyRun, observed: Sequence[str], error: str
) -> Iterator[dict[str, Any]]:
    """A row for each window."""
    named = _named(point, run)
    error = error or run.error
    status = "done" if run.done else "failed" if error else "missing"
    table: Any = with_seed(read_table(run.table), run.seed) if run.done else None
    for window in study.design.windows:
        row = {**named, "window": str(window), "start": window.start, "end": window.end,
               "status": status, "error": error if status == "failed" else None}  # fmt: skip
        for name in observed if table is not None else ():
            if name in table.dtype.names:
                row[name] = _defined(float(window_means(table, name, *window)[0]))
        yield row


def _course_rows(
    point: Runs, run: StudyRun, observed: Sequence[str]
) -> Iterator[dict[str, Any]]:
    """A row for each frame."""
    named, table = _named(point, run), read_table(run.table)
    names = [name for name in ("time", *observed) if name in (table.dtype.names or ())]
    for frame in table[names].tolist():
        yield {**named, **{name: _defined(x) for name, x in zip(names, frame, strict=True)}}


def _text(value: Any) -> str | None:
    """Text as it is; arrays and tables, and numbers among texts, as JSON."""
    return value if value is None or isinstance(value, str) else json.dumps(value)


def _defined(value: float) -> float | None:
    return None if np.isnan(value) else value
