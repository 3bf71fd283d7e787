"""The page: one file without links to anything else."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from lammps_skin.errors import SkinError
from lammps_skin.files import atomic_write
from lammps_skin.report.library import three
from lammps_skin.report.record import Record, record, scales
from lammps_skin.report.study import study_pages

SCRIPTS = ("unpack.js", "colours.js", "view.js", "maps.js", "charts.js", "panels.js", "study.js",
           "page.js")  # fmt: skip
MOST_RUNS = 4  # side by side


def report(
    runs: Sequence[Path], output: Path, frames: int | None = None, dermis: bool = False
) -> Path:
    """Write the page of a run, or of several side by side.

    Parameters
    ----------
    runs : sequence of Path
        Run directories, or trajectories.
    output : Path
        The file; its folder is made if need be.
    frames : int, optional
    dermis : bool
        See `record`.

    Raises
    ------
    SkinError
        If a run cannot be read, if there are too many, or if the file cannot be written.
    """
    if not 1 <= len(runs) <= MOST_RUNS:
        raise SkinError(f"runs: are {len(runs)}, must be 1 to {MOST_RUNS} on a page")
    return _written(page([record(path, frames, dermis, len(runs)) for path in runs]), output)


def report_study(
    folder: Path, output: Path, frames: int | None = None, dermis: bool = False
) -> Path:
    """Write the page of a study: its answer, its time courses, and a kept run of each point.

    Parameters
    ----------
    folder : Path
        Of the study.
    output : Path
        The file; its folder is made if need be.
    frames : int, optional
    dermis : bool
        See `record`.

    Raises
    ------
    SkinError
        If there are no tables, if no run is done, or if the file cannot be written.
    """
    told, records = study_pages(folder, MOST_RUNS, frames, dermis)
    return _written(page(records, study=told), output)


def _written(content: str, output: Path) -> Path:
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(output) as place:
            place.write_text(content, "utf-8")
    except OSError as error:
        raise SkinError(f"output {output}: {error.strerror}") from None
    return output


def page(records: Sequence[Record], live: int = 0, study: dict[str, Any] | None = None) -> str:
    """HTML of some runs.

    Parameters
    ----------
    records : sequence of Record
    live : int
        Not 0: the number of this version; the page asks where it came from for later ones.
    study : dict, optional
        What is told of the study to which they belong.
    """
    folder = files(__package__ or "lammps_skin.report")

    def of(name: str) -> str:
        return folder.joinpath(name).read_text("utf-8")

    names = [study["name"]] if study else dict.fromkeys(one.told["name"] for one in records)
    parts = {
        "title": escape(" and ".join(names)),
        "style": of("page.css"),
        "three": three(),
        "data": "\n".join(_data(n, one) for n, one in enumerate(records)),
        "settings": _json({"scales": scales(), "live": live}),
        "study": _json(study),
        "scripts": "\n".join(of(name) for name in SCRIPTS),
    }
    return re.sub(r"<!--(\w+)-->", lambda mark: parts[mark[1]], of("page.html"))


def _data(number: int, one: Record) -> str:
    packed = b64encode(one.packed).decode()
    return (
        f'<script type="application/json" id="told-{number}">{_json(one.told)}</script>\n'
        f'<script type="application/octet-stream" id="packed-{number}">{packed}</script>'
    )


def _json(value: Any) -> str:
    """JSON that cannot end the script in which it stands."""
    return json.dumps(value, allow_nan=False).replace("<", "\\u003c")
