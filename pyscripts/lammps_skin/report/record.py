"""All that the page tells of a run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex
from numpy.typing import NDArray

from lammps_skin.analysis.lineage import Events
from lammps_skin.analysis.observables import open_run
from lammps_skin.analysis.summary import summary, without_nan
from lammps_skin.errors import SkinError
from lammps_skin.figures.clone_colours import PALETTE, clone_colours
from lammps_skin.figures.look import COLOURINGS
from lammps_skin.figures.snapshot import on_map
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import merged, shown
from lammps_skin.report.packing import pack
from lammps_skin.report.pictures import STEADY, Pictures, arrays, surface
from lammps_skin.report.words import titles, warnings
from lammps_skin.trajectory.store import Store
from lammps_skin.versions import versions

MOST_FRAMES, MOST_POINTS = 101, 2_500_000  # drawn; points are those of the membrane in all frames
FEWEST = 5
SHADES = 32
# of runs and points, for eyes that see in any way
CURVES = "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#4D4D4D"


class Record(NamedTuple):
    """A run on the page: what JSON tells of it, and its packed arrays."""

    told: dict[str, Any]
    packed: bytes


def record(path: Path, frames: int | None = None, dermis: bool = False, beside: int = 1) -> Record:
    """Read all of a run.

    Parameters
    ----------
    path : Path
        Run directory, or a trajectory.
    frames : int, optional
        Most frames to draw; as many as keep the page small if not given.
    dermis : bool
        Whether its particles are drawn, too.
    beside : int
        How many runs are on the page.

    Raises
    ------
    SkinError
        If there is no trajectory, or if it or the event log cannot be read.
    """
    if frames is not None and frames < 2:
        raise SkinError(f"frames = {frames}: must be 2 or more")
    found = summary(path)
    table = found["observables"]
    with open_run(path) as run:
        made = Pictures(run, dermis)
        drawn = chosen(len(table["time"]), frames or fitting(beside * len(made.first)))
        pictures = made.run(frames=drawn).pictures
        frames_of = run.universe.trajectory.frames
        founders = np.unique(np.concatenate([picture.of_cells["clone"] for picture in pictures]))
        numbers = clone_colours(founders, frames_of)
        clones = dict(zip(founders.tolist(), numbers.tolist(), strict=True))
        made_with = frames_of.versions if isinstance(frames_of, Store) else {}
        scene, log = run.scene, run.events
    copies, corners = surface(made.first, made.triangles, np.array(scene.box_sides[:2]))
    pictured, ranges = arrays(pictures)
    events, event_names = _events(log)
    plane = {"copies": copies.astype(np.int32), "corners": corners.astype(np.int32)}
    told = {
        "name": path.resolve().name if path.is_dir() else path.resolve().parent.name,
        **_of_scene(scene),
        "from": found["run"]["from"],
        "to": found["run"]["to"],
        "grid": pictured["height"].shape[1:],
        "ranges": ranges,
        "frames": [table["time"][n] for n in drawn],
        "columns": titles(list(table)),
        "table": table,
        "means": found["window"],
        "events": found["events"],
        "event_names": event_names,
        "warnings": list(warnings(scene, found)),
        "thinned": (
            f"Pictures show {len(drawn)} of {len(table['time'])} frames; curves show all of them."
            if len(drawn) < len(table["time"]) else ""
        ),
        "clones": clones,
        "provenance": _provenance(path, found["run"], made_with),
    }  # fmt: skip
    return Record(without_nan(told), pack({**plane, **pictured, **events}, STEADY))


def _of_scene(scene: Scene) -> dict[str, Any]:
    return {
        "scene": scene.name,
        "description": scene.description,
        "parameters": scene.parameters,
        "box": scene.box_sides[:2],
        "radius": scene.cells.radius,
        "thickness": 2 * scene.membrane.radius,
        "membrane": to_hex(Kind.MEMBRANE.colour),
        "dermis": {"radius": scene.dermis.radius, "colour": to_hex(Kind.DERMAL.colour)},
        "kinds": [
            {
                "number": int(row.kind), "name": row.kind.name, "label": row.label,
                "colour": to_hex(row.kind.colour), "on_map": row.kind in on_map(scene),
                "endless": row.daughter is not None and row.generations is None,
            }
            for row in scene.cell_table.values()
        ],
        "keys": list(_keys(scene)),
    }  # fmt: skip


def chosen(there: int, most: int) -> list[int]:
    """Frames to draw, evenly spread, the first and the last among them."""
    if there <= most:
        return list(range(there))
    return sorted({round(n * (there - 1) / (most - 1)) for n in range(most)})


def fitting(points: int) -> int:
    """Number of frames of a membrane of so many points that keep a page small."""
    return max(min(MOST_FRAMES, MOST_POINTS // points), FEWEST)


def scales() -> dict[str, list[str]]:
    """Colours of the page, from low to high: those of snapshots; of clones, and of curves."""
    shown = {name: colouring.colours for name, colouring in COLOURINGS.items()}
    shades = {
        name: [to_hex(colormaps[scale](n / (SHADES - 1))) for n in range(SHADES)]
        for name, scale in {**shown, "below": shown["height"]}.items()
    }
    return {
        **shades,
        "clones": [to_hex(colour) for colour in PALETTE],
        "curves": list(CURVES),
    }


def _events(events: Events | None) -> tuple[dict[str, NDArray[Any]], dict[str, list[str]]]:
    """Columns of events.csv, and the words that numbers in two of them stand for."""
    if events is None:
        return {}, {}
    kinds, kind = np.unique(events.kind, return_inverse=True)
    causes, cause = np.unique(events.cause, return_inverse=True)
    columns: dict[str, NDArray[Any]] = {
        "event_time": events.time,
        "event_kind": kind.astype(np.uint8),
        "event_id": events.id.astype(np.int32),
        "event_parent": events.parent.astype(np.int32),
        "event_type": events.type.astype(np.uint8),
        "event_left": events.divisions_left.astype(np.int32),
        "event_cause": cause.astype(np.uint16),
    }
    return columns, {"kind": kinds.tolist(), "cause": causes.tolist()}


def _keys(scene: Scene) -> Iterator[tuple[str, str, bool]]:
    """Dotted key, value, and whether the scene gives it, of all keys that have a value."""
    given = dict(_dotted(scene.given()))
    for key, value in _dotted(merged({}, scene.model_dump())):
        if value is not None:
            yield key, shown(value), key in given


def _dotted(keys: Any, above: Sequence[str] = ()) -> Iterator[tuple[str, Any]]:
    for key, value in keys.items():
        if isinstance(value, dict):
            yield from _dotted(value, [*above, key])
        else:
            yield ".".join([*above, key]), value


def _provenance(path: Path, told: dict[str, Any], made_with: dict[str, str]) -> dict[str, str]:
    seeds = {f"seed of {what}": str(told[f"{key}_seed"])
             for what, key in (("cells", "cell"), ("the dermis", "dermis"))}  # fmt: skip
    return {
        "run": str(path),
        "frames": f"{told['frames']}, t = {told['from']:g} to {told['to']:g}",
        **seeds,
        **{f"{name}, which ran it": version for name, version in made_with.items()},
        "lammps-skin, which made this page": versions()["lammps-skin"],
    }
