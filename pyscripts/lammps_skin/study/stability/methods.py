"""The integrators of a map, and the parameters of a scene that are scaled in it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal, NamedTuple, get_args

from lammps_skin.errors import SceneError
from lammps_skin.model.accuracy import stability_limit
from lammps_skin.model.scene import Scene

Integrator = Literal["euler", "rkl1", "rkl2"]
INTEGRATORS: tuple[Integrator, ...] = get_args(Integrator)

# what is scaled, and the keys that this multiplies; `stiffness` is all of them
STIFFNESS = "stiffness"
ADHESION = "adhesion"
CROWDING = "crowding"
SCALED: dict[str, tuple[str, ...]] = {
    STIFFNESS: (),
    "stretch": ("membrane.stretch_stiffness",),
    "bending": ("membrane.bending_stiffness",),
    ADHESION: ("cells.adhesion_stiffness", "cells.binding_stiffness"),
    "spring": ("cells.division_stiffness",),
    "division": ("cells.division_rate",),
    CROWDING: ("cells.stem",),
}
OF_KINDS = {ADHESION: ("stiffness", "paired_stiffness"), CROWDING: ("count",)}


class Method(NamedTuple):
    """An integrator, force evaluations in its steps, and its limit of stiffness, 0 for none."""

    integrator: Integrator
    stages: int
    stiffness_limit: float

    @property
    def name(self) -> str:
        """Short, for tables."""
        return self.integrator + ("-limit" if self.stiffness_limit else "")

    @property
    def limit(self) -> float:
        """Timestep times largest eigenvalue up to which a step is stable."""
        return stability_limit(self.integrator, self.stages)

    def estimate(self, eigenvalue: float) -> float:
        """Longest stable timestep where this is the largest eigenvalue."""
        return self.limit / eigenvalue if eigenvalue > 0 else math.inf

    @property
    def variables(self) -> dict[str, Any]:
        """Of scene.in; no step is divided."""
        return {
            "integrator": self.integrator, "stages": self.stages,
            "stiffness_limit": self.stiffness_limit, "largest_move": 0.0,
        }  # fmt: skip


def methods(stages: int, stiffness_limit: float) -> list[Method]:
    """All integrators, each without and with a limit of stiffness."""
    return [
        Method(integrator, 1 if integrator == "euler" else stages, limit)
        for integrator in INTEGRATORS for limit in (0.0, stiffness_limit)
    ]  # fmt: skip


def scaled(scene: Scene, what: str, factor: float) -> Scene:
    """The scene with one of `SCALED` multiplied.

    Raises
    ------
    SceneError
        If the product is not allowed, or changes nothing.
    """
    if factor == 1:
        return scene
    keys = SCALED[what] or tuple(_stiffnesses(scene.model_dump(exclude_none=True)))
    keys += tuple(
        f"cells.kinds.{label}.{key}"
        for label, row in scene.cells.kinds.items()
        for key in OF_KINDS.get(what, ())
        if getattr(row, key)
    )
    values = {key: _value(scene, key) for key in keys}
    changes: dict[str, Any] = {key: factor * value for key, value in values.items()}
    if what == CROWDING:
        changes = {key: round(value) for key, value in changes.items()}
    if not any(values.values()) or changes == values:
        raise SceneError("is the same as x 1 in this scene")
    return scene.replace(**changes)


def _stiffnesses(content: Mapping[str, Any], prefix: str = "") -> Sequence[str]:
    """Keys of all stiffnesses of the model."""
    found: list[str] = []
    for key, value in content.items():
        if isinstance(value, Mapping):
            found += _stiffnesses(value, f"{prefix}{key}.")
        elif key == "stiffness" or key.endswith("_stiffness"):
            found.append(prefix + key)
    return found


def _value(scene: Scene, key: str) -> Any:
    value: Any = scene.model_dump()
    for part in key.split("."):
        value = value[part]
    return value
