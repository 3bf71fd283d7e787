"""What is done to a scene in the course of its run: its keys, and what is wrong with them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, pairwise
from typing import Annotated, Any, NamedTuple

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

from lammps_skin.model.cell_kinds import CellKind
from lammps_skin.model.parts import LARGEST, Numerics, Part, Positive
from lammps_skin.model.scene_keys import merged, near, shown

ACTIONS = ("remove", "convert", "add", "set")

NEEDS: dict[str, tuple[str, ...]] = {
    "to": ("convert",), "places": ("add",), "until": ("every",),
    "fraction": ("remove", "convert"), "within": ("remove", "convert"),
    "every": ("remove", "convert", "add"),
}  # fmt: skip
"""Keys that go with one of others."""

ALL = "all"  # kinds of cells
MOST = 1000  # interventions of a scene, and places of one
NAME = re.compile("[A-Za-z0-9][A-Za-z0-9_-]{0,31}")
RESERVED = ("division", "grown", "partner_removed", "detached")
"""Causes of what happens without an intervention."""

SETTABLE = (
    "dermis.stiffness", "dermis.membrane_stiffness", "dermis.wall_stiffness",
    "membrane.stretch_stiffness", "membrane.elasticity", "membrane.bending_stiffness",
    "membrane.exclusion_stiffness",
    "cells.exclusion_stiffness", "cells.membrane_exclusion_stiffness",
    "cells.cell_adhesion_stiffness", "cells.adhesion_stiffness", "cells.adhesion_range",
    "cells.binding_stiffness", "cells.cycle_delay", "cells.cycle_rate", "cells.generations",
)  # fmt: skip
"""Keys of a scene that `set` may change."""

OF_KINDS = "cells.kinds."
SETTABLE_OF_KINDS = (
    "adhesion", "stiffness", "range", "detaches", "cycle_delay", "cycle_rate", "generations",
    "paired_stiffness",
)  # fmt: skip
"""Keys of a kind of cells that it may change."""

KEPT_APART = (
    "dermis.stiffness", "dermis.membrane_stiffness",
    "membrane.exclusion_stiffness",
    "cells.exclusion_stiffness", "cells.membrane_exclusion_stiffness",
)  # fmt: skip
"""Those of forces that keep particles apart: they neither begin nor end in a run."""


def _numbers(value: Any, least: int, most: int) -> bool:
    return (
        isinstance(value, tuple)
        and least <= len(value) <= most
        and all(type(one) in (int, float) and abs(one) <= LARGEST for one in value)
    )


def _cylinder(value: Any) -> Any:
    if _numbers(value, 3, 3) and value[2] > 0:
        return value
    raise PydanticCustomError("cylinder", "must be [x, y, radius], the radius greater than 0")


def _half_space(value: Any) -> Any:
    if _numbers(value, 4, 4) and any(value[:3]):
        return value
    raise PydanticCustomError("half_space", "must be [n_x, n_y, n_z, offset], n not 0")


def _places(value: Any) -> Any:
    if isinstance(value, tuple) and value and all(_numbers(one, 2, 3) for one in value):
        return value
    raise PydanticCustomError("places", "must be an array of places, [x, y] or [x, y, z]")


def _kinds(value: Any) -> Any:
    words = value if isinstance(value, tuple) else (value,)
    if words and all(isinstance(word, str) for word in words):
        return words
    raise PydanticCustomError("kinds", "must be a kind of cells, an array of kinds, or 'all'")


def _changes(value: Any) -> Any:
    if isinstance(value, Mapping) and value:
        return dict(_flat(value))
    raise PydanticCustomError("changes", "must be a table of keys of the scene and their values")


def _flat(keys: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Nested keys with dots between them, and their values."""
    for key, value in keys.items():
        if isinstance(value, Mapping) and value:
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


Numbers = tuple[float, ...]
Kinds = Annotated[tuple[str, ...], BeforeValidator(_kinds)]


class Region(Part):
    """Where cells are chosen."""

    cylinder: Annotated[Numbers, BeforeValidator(_cylinder)] | None = Field(
        None, description="x, y, radius"
    )
    half_space: Annotated[Numbers, BeforeValidator(_half_space)] | None = Field(
        None, description="n_x, n_y, n_z, offset: where n.x is above the offset"
    )


class Intervention(Part):
    """Something that is done in a run, once or several times."""

    name: str
    at: Positive | None = Field(None, description="time; of the first with `every`")
    every: Positive | None = Field(None, description="time between repetitions")
    until: Positive | None = Field(None, description="time of the last repetition at most")
    remove: Kinds | None = Field(None, description="kinds of cells that leave")
    convert: Kinds | None = Field(None, description="kinds of cells that become another")
    to: str | None = Field(None, description="that kind")
    add: str | None = Field(None, description="kind of new cells")
    places: Annotated[tuple[Numbers, ...], BeforeValidator(_places)] | None = Field(
        None, description="of these"
    )
    set: Annotated[dict[str, Any], BeforeValidator(_changes)] | None = Field(
        None, description="keys of the scene with new values"
    )
    fraction: Annotated[float, Field(gt=0, le=1)] = Field(1.0, description="of the cells chosen")
    within: Region | None = Field(None, description="where cells are chosen")

    def __hash__(self) -> int:
        return hash(self.model_dump_json())  # a table of keys has no hash of its own

    @property
    def first(self) -> float:
        """Time at which it is done first."""
        return self.at or self.every or 0.0

    @property
    def enters(self) -> str | None:
        """Kind of the cells that it makes."""
        return self.to or self.add


def nested(changes: Mapping[str, Any]) -> dict[str, Any]:
    """Keys with dots between them as nested keys, one value over the other in their order."""
    found: dict[str, Any] = {}
    for key, value in changes.items():
        for part in reversed(key.split(".")):
            value = {part: value}
        found = merged(found, value)
    return found


def with_nested_changes(given: Mapping[str, Any]) -> dict[str, Any]:
    """Keys of a scene, those that its interventions set nested: each can then be replaced."""
    return {
        key: [_with_nested(entry) for entry in value]
        if key == "interventions" and isinstance(value, (list, tuple))
        else value
        for key, value in given.items()
    }


def _with_nested(entry: Any) -> Any:
    if not isinstance(entry, Mapping):
        return entry
    keys = dict(entry)
    if isinstance(keys.get("set"), Mapping):
        keys["set"] = nested(dict(_flat(keys["set"])))
    return keys


def stated(given: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """Keys of a scene, and what they are after each of the sets, before all that is validated."""
    yield given
    entries = given.get("interventions")
    for entry in entries if isinstance(entries, (list, tuple)) else ():
        if isinstance(entry, Mapping) and isinstance(entry.get("set"), Mapping):
            given = merged(given, nested(dict(_flat(entry["set"]))))
            yield given


def last_event_step(numerics: Numerics, time: float) -> float:
    """Time of the last step, up to a time, on which cells can be removed, converted and added."""
    every = max(math.ceil(numerics.event_interval / numerics.timestep - 1e-6), 1)
    return time - round(time / numerics.timestep) % every * numerics.timestep


# ---- what the single keys cannot know


class Limits(NamedTuple):
    """What a scene allows.

    Attributes
    ----------
    box : (L_x, L_y, L_z)
    closest : float
        Distance of cells that are added together.
    timestep : float
    """

    box: tuple[float, float, float]
    closest: float
    timestep: float


def contradictions(
    interventions: Sequence[Intervention], table: Mapping[str, CellKind], limits: Limits
) -> Iterator[str]:
    """Faults, each as `key = value: what is allowed`.

    Parameters
    ----------
    interventions : sequence of Intervention
    table : mapping
        All kinds of cells by their labels.
    limits : Limits
    """
    names: list[str] = []
    if len(interventions) > MOST:
        yield f"interventions: there are {len(interventions):,}, must be {MOST:,} at most"
    for one in interventions:
        yield from _of_name(one.name, names)
        names.append(one.name)
        yield from _of_keys(one)
        yield from _of_kinds(one, table)
        yield from _of_places(one, limits.box, limits.closest)
        yield from _of_changes(one, table)
        if one.every and one.every < limits.timestep:
            least = f"at least the timestep, {limits.timestep:g}"
            yield f"{place(one)}.every = {one.every:g}: must be {least}"
    for former, one in pairwise(interventions):
        if one.first < former.first:
            key = "at" if one.at else "every"
            yield (
                f"{place(one)}.{key} = {one.first:g}: must be in the order of times, not before "
                f"{former.name}, which stands above it, at {former.first:g}"
            )


def place(one: Intervention) -> str:
    """What errors call it."""
    return f"interventions.{one.name}"


def _of_name(name: str, others: Sequence[str]) -> Iterator[str]:
    if not NAME.fullmatch(name):
        yield (
            f"interventions.name = {shown(name)}: must be up to 32 letters, digits, '-' and '_', a "
            "letter or digit first"
        )
    if name in RESERVED:
        yield (
            f"interventions.name = {shown(name)}: is the cause of other events; reserved are "
            f"{', '.join(RESERVED)}"
        )
    if name in others:
        yield f"interventions.name = {shown(name)}: is the name of two, each needs its own"


def _of_keys(one: Intervention) -> Iterator[str]:
    """Which keys are given together."""
    actions = [key for key in ACTIONS if getattr(one, key) is not None]
    if len(actions) != 1:
        found = f"has {' and '.join(actions)}" if actions else "does nothing"
        yield f"{place(one)}: {found}, must have one of {', '.join(ACTIONS)}"
    for key, others in NEEDS.items():
        is_given = getattr(one, key) != Intervention.model_fields[key].default
        if is_given and all(getattr(one, other) is None for other in others):
            yield (
                f"{place(one)}.{key} = {shown(_plain(getattr(one, key)))}: goes with "
                f"{' or '.join(others)}"
            )
    if one.at is None and one.every is None:
        yield f"{place(one)}: needs the key `at`, a time, or `every`"
    if one.until is not None and one.until < one.first:
        yield f"{place(one)}.until = {one.until:g}: must be {one.first:g}, the first time, or later"
    for key, other, what in (
        ("convert", "to", "the kind that the cells become"),
        ("add", "places", "where the new cells are"),
    ):
        if getattr(one, key) is not None and getattr(one, other) is None:
            given = f"{place(one)}.{key} = {shown(_plain(getattr(one, key)))}"
            yield f"{given}: needs the key `{other}`, {what}"
    if one.within and not any(one.within.model_dump().values()):
        yield f"{place(one)}.within: must have cylinder or half_space, or both"


def _plain(value: Any) -> Any:
    return value.model_dump(exclude_none=True) if isinstance(value, Region) else value


def _of_kinds(one: Intervention, table: Mapping[str, CellKind]) -> Iterator[str]:
    for key in ("remove", "convert", "to", "add"):
        given = getattr(one, key)
        labels = given if isinstance(given, tuple) else () if given is None else (given,)
        allowed = (*table, ALL) if key in ("remove", "convert") else tuple(table)
        for label in labels:
            if label not in allowed:
                yield (
                    f"{place(one)}.{key} = {shown(label)}: must be a kind of cells, one of "
                    f"{', '.join(allowed)}{near(label, allowed)}"
                )
    if one.to is not None and one.convert and one.to in one.convert:
        yield f"{place(one)}.to = {shown(one.to)}: is what they are"


def _of_places(one: Intervention, box: tuple[float, float, float], closest: float) -> Iterator[str]:
    points = list(one.places or ())
    if one.within and one.within.cylinder:
        points.append(one.within.cylinder[:2])
    if one.within and one.within.half_space:
        *normal, offset = one.within.half_space
        highest = sum(max(n * side, 0.0) for n, side in zip(normal, box, strict=True))
        if highest <= offset:
            yield (
                f"{place(one)}.within.half_space = {shown(one.within.half_space)}: no place in the "
                f"box is in it; the offset must be below {highest:g}"
            )
    for point in points:
        if not all(0 <= x < side for x, side in zip(point, box, strict=False)):
            sides = " x ".join(f"{side:.6g}" for side in box)
            key = "places" if one.places else "within.cylinder"
            yield f"{place(one)}.{key} = {shown(point)}: must be inside the box, {sides}"
    if len(one.places or ()) > MOST:
        yield f"{place(one)}.places: there are {len(points):,}, must be {MOST:,} at most"
    for a, b in combinations(one.places or (), 2):
        distance = _distance(a, b, box)
        if distance < closest:
            yield (
                f"{place(one)}.places: {shown(a)} and {shown(b)} are {distance:.3g} apart, must be "
                f"at least {closest:g}"
            )


def _distance(a: Numbers, b: Numbers, box: tuple[float, float, float]) -> float:
    """Of two places, through the periodic edges; in the plane if one of them has no height."""
    apart = [x - y for x, y in zip(a, b, strict=False)]
    for axis in (0, 1):
        apart[axis] -= box[axis] * round(apart[axis] / box[axis])
    return math.hypot(*apart)


def _of_changes(one: Intervention, table: Mapping[str, CellKind]) -> Iterator[str]:
    for key, value in (one.set or {}).items():
        said = f"{place(one)}.set.{key} = {shown(value)}"
        if not key.startswith(OF_KINDS):
            if key not in SETTABLE:
                words = {each.rpartition(".")[2]: each for each in reversed(SETTABLE)}
                guess = near(key, SETTABLE) or near(key.rpartition(".")[2], words, words)
                yield (
                    f"{said}: cannot change in a run; can: {', '.join(SETTABLE)}, and keys of "
                    f"{OF_KINDS}NAME{guess}"
                )
            continue
        kind, _, last = key.removeprefix(OF_KINDS).rpartition(".")
        if kind not in table:
            yield (
                f"{said}: {shown(kind or last)} is no kind of cells; there are {', '.join(table)}"
                f"{near(kind or last, table)}"
            )
        if last not in SETTABLE_OF_KINDS:
            allowed = ", ".join(SETTABLE_OF_KINDS)
            yield f"{said}: cannot change in a run; can: {allowed}{near(last, SETTABLE_OF_KINDS)}"
