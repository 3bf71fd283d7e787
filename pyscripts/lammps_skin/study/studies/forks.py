"""A fork: runs that are the same up to a time, and go on in as many ways as a study has points."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from lammps_skin.errors import SceneError
from lammps_skin.model.interventions import place
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import shown
from lammps_skin.study.ranges import Window, windows_of

OF_THE_BEGIN = (
    "membrane.lattice", "membrane.radius", "membrane.spacing_ratio", "membrane.height",
    "membrane.heights", "membrane.heights_scale", "membrane.noise", "box", "box_height",
    "dermis.present", "dermis.radius", "dermis.packing", "dermis.volume_fraction", "dermis.seed",
    "cells.stem", "cells.nd", "cells.arrangement", "cells.ring_radius", "cells.radius",
    "cells.first_phase",
)  # fmt: skip
OF_THE_BEGIN_OF_KINDS = ("count", "first_phase")
"""Keys that decide how a run begins, or that cannot change in its course."""


def check_varied(keys: Iterable[str]) -> None:
    """Raise `SceneError` for a key in which runs cannot differ from a fork on."""
    for key in keys:
        of_kinds = key.startswith("cells.kinds.") and key.endswith(OF_THE_BEGIN_OF_KINDS)
        if key in OF_THE_BEGIN or of_kinds:
            raise SceneError(f"{key}: cannot differ from the fork on; it says how a run begins")


def fork_time(value: Any, scene: Scene, points: Mapping[str, Scene]) -> float:
    """Time of a fork, checked.

    Parameters
    ----------
    value : what the study says
    scene : Scene
        Up to the fork.
    points : mapping
        Scenes of the points by their labels.

    Raises
    ------
    SceneError
        For a time without a frame or after an end, and for what cannot differ from it on.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 < value < np.inf:
        raise SceneError(f"fork = {shown(value)}: must be a time greater than 0")
    time, interval = float(value), scene.output.dump_interval
    if scene.start.run is not None:
        raise SceneError(f"fork = {time:g}: the scene begins with another run itself, start.from")
    if not interval or abs(time / interval - round(time / interval)) > 1e-9:
        raise SceneError(
            f"fork = {time:g}: must be a multiple of output.dump_interval = {interval:g}, the time "
            "between states that are kept"
        )
    for label, after in points.items():
        if after.end_time <= time:
            raise SceneError(
                f"fork = {time:g}: must be before end_time = {after.end_time:g}, of {label}"
            )
        for one in after.interventions:
            once = one.every is None
            if once and one.first <= time and one not in scene.interventions:
                raise SceneError(
                    f"{label}: {place(one)}.at = {one.first:g}: must be after the fork, at {time:g}"
                )
    return time


def before(scene: Scene, time: float) -> Scene:
    """The scene up to a fork, with the steps that it has if it goes on."""
    numerics = scene.numerics.model_dump(exclude_none=True)
    return scene.replace(
        end_time=time, **{f"numerics.{key}": value for key, value in numerics.items()}
    )


def windows_after(text: Any, time: float, end: float) -> list[Window]:
    """Windows from a fork on, by default those of a run that begins there."""
    if text is None:
        return [
            Window(time + window.start, time + window.end)
            for window in windows_of(None, end - time)
        ]
    found = windows_of(text, end, "windows = ")
    for window in found:
        if window.start < time:
            raise SceneError(
                f"windows = {shown(text)}: {window} must not begin before the fork, at {time:g}"
            )
    return found
