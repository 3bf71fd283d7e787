"""Readings of the model, compared by their ensembles, and the rule that takes one as the default.

A reading is a named parameter set with a number of generations M. Its ensembles are those of the
scenes of the quarter size in one folder.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, NamedTuple

from lammps_skin.analysis.basal_layer import LAYER
from lammps_skin.analysis.statistics import Mean
from lammps_skin.errors import SceneError, SkinError
from lammps_skin.model.cell_kinds import ROWS
from lammps_skin.model.scene import Scene
from lammps_skin.model.scenes import ARRANGEMENTS
from lammps_skin.study.claims.catalogue import judge_all
from lammps_skin.study.claims.rules import FEWEST_SEEDS, Ensembles, Verdict, Word
from lammps_skin.study.claims.tables import END, LATER, flat, load, set_keys
from lammps_skin.study.ranges import Window
from lammps_skin.study.result_keys import physics

SIZE = "quarter"
NAMING = ("parameters", "cells.generations")  # the keys by which readings are named
ASIDE = ("description", "seed", "end_time", "numerics.", "output.")  # not what is simulated
STIFFNESS = "membrane.bending_stiffness"
# with all keys of the four kinds of cells, also those that only other sets give
PRINTED = Scene.from_dict({"parameters": "printed", "cells": {"kinds": {row: {} for row in ROWS}}})


class Layer(NamedTuple):
    """Fraction of the cells with none below, of a scene in a window after coverage."""

    scene: str
    window: Window
    value: Mean


@dataclass(frozen=True)
class Reading:
    """Ensembles of scenes that differ in their arrangement alone.

    Attributes
    ----------
    folder : Path
        Where the tables are.
    given : dict
        What was given beside the built-in scenes, by dotted keys.
    ensembles : mapping of str to Ensemble
        By scene.
    """

    folder: Path
    given: dict[str, Any]
    ensembles: Ensembles

    @cached_property
    def scene(self) -> Scene:
        """A scene with its keys, of no arrangement in particular."""
        try:
            return Scene.from_dict({}).replace(**self.given)
        except SceneError as error:
            raise SkinError(f"folder {self.folder}: {error}") from None

    @property
    def changes(self) -> dict[str, Any]:
        """Keys that were given beside the parameter set and the number of generations."""
        left_out = (*NAMING, *ASIDE)
        return {key: value for key, value in self.given.items() if not key.startswith(left_out)}

    @property
    def name(self) -> str:
        words = [f"{key} = {value}" for key, value in sorted(self.changes.items())]
        return f"{self.scene.parameters} ({', '.join([generations(self.scene), *words])})"

    @property
    def is_long(self) -> bool:
        """Whether the runs end long after those of the paper."""
        return any(one.end >= END + LATER for one in self.ensembles.values())

    @property
    def seeds(self) -> str:
        """Numbers of seeds and scenes: ``8 seeds of 3 scenes``."""
        numbers = [one.seeds for one in self.ensembles.values()]
        return "; ".join(
            f"{seeds} seed{'s' * (seeds > 1)} of {numbers.count(seeds)} "
            f"scene{'s' * (numbers.count(seeds) > 1)}"
            for seeds in sorted(set(numbers), reverse=True)
        )

    @property
    def missing(self) -> list[str]:
        """Scenes of the paper that lack seeds for a verdict."""
        return [
            scene for scene in ARRANGEMENTS
            if scene not in self.ensembles or self.ensembles[scene].seeds < FEWEST_SEEDS
        ]  # fmt: skip

    def alone(self, scenes: Iterable[str]) -> Reading:
        """The same with these of its scenes alone."""
        kept = {scene: self.ensembles[scene] for scene in scenes}
        return Reading(self.folder, self.given, kept)

    @property
    def departures(self) -> list[str]:
        """Keys whose values differ from those printed in the paper."""
        printed = dict(flat(physics(PRINTED)))
        return [key for key, value in flat(physics(self.scene)) if value != printed.get(key)]

    # ---- what the ensembles show

    @cached_property
    def verdicts(self) -> list[Verdict]:
        return judge_all(self.ensembles)

    def claims(self, word: Word) -> list[int]:
        """Numbers of the claims with a verdict."""
        return [one.claim.number for one in self.verdicts if one.word == word]

    @cached_property
    def layers(self) -> list[Layer]:
        """Of each scene and window in which it is known."""
        return [
            Layer(scene, window, value)
            for scene, one in self.ensembles.items()
            for window, value in one.none_below().items()
            if not math.isnan(value.value)
        ]

    @property
    def least(self) -> Layer | None:
        """The window in which most cells have another one below."""
        return min(self.layers, default=None, key=lambda one: one.value.value)

    @property
    def is_layer(self) -> Literal["yes", "no", "not known"]:
        """Whether it makes a basal layer in all scenes of the paper, in each window."""
        if self.least and self.least.value.value < LAYER:
            return "no"
        windows = sum(len(one.windows) for one in self.ensembles.values())
        return "not known" if self.missing or len(self.layers) < windows else "yes"


def generations(scene: Scene) -> str:
    """How often the descendants of a stem cell divide, in words."""
    number = scene.cells.generations
    return "M without end" if number == "endless" else f"M = {number}"


def read(folders: Iterable[Path]) -> list[Reading]:
    """The readings in folders, one in each.

    Raises
    ------
    SkinError
        If a folder has no tables of the quarter size, if it is not known what was given, if its
        scenes differ in more than their arrangement, or if two folders have the same reading.
    """
    found: dict[tuple[str, bool], Reading] = {}
    for folder in folders:
        ensembles = load(folder).get(SIZE)
        if not ensembles:
            raise SkinError(f"folder {folder}: has no table of the {SIZE} size")
        all_given = [set_keys(SIZE, one) for one in ensembles.values()]
        if not all(all_given):
            raise SkinError(f"folder {folder}: a table does not say what was run")
        if any(given != all_given[0] for given in all_given):
            raise SkinError(f"folder {folder}: the scenes differ in more than their arrangement")
        one = Reading(folder, all_given[0], ensembles)
        same = found.setdefault((one.name, one.is_long), one)
        if same is not one:
            raise SkinError(f"folders {same.folder} and {folder}: both are of {one.name}")
    return list(found.values())


def named(readings: Iterable[Reading]) -> list[Reading]:
    """Those that are a parameter set with a number of generations, and that are not long."""
    return [one for one in readings if not (one.changes or one.is_long)]


def stiffness_series(readings: Iterable[Reading]) -> list[Reading]:
    """The largest group of readings that differ in their bending stiffness alone, ascending."""
    groups: dict[str, list[Reading]] = {}
    for one in readings:
        keys = dict(flat(physics(one.scene)))
        del keys[STIFFNESS]
        if not one.is_long:
            groups.setdefault(repr(sorted(keys.items())), []).append(one)
    largest = max(groups.values(), default=[], key=len)
    return sorted(largest, key=lambda one: one.scene.membrane.bending_stiffness)


# ---- the rule


class Choice(NamedTuple):
    """What the rule says.

    Attributes
    ----------
    candidates : list of Reading
        Those that make a basal layer, best first.
    best : list of Reading
        The first; several if the rule does not tell them apart, none without a candidate.
    """

    candidates: list[Reading]
    best: list[Reading]


def choose(readings: Sequence[Reading]) -> Choice:
    """Apply the rule: of readings that make a basal layer, most claims, then fewest departures."""

    def rank(one: Reading) -> tuple[int, int]:
        return -len(one.claims("holds")), len(one.departures)

    candidates = sorted((one for one in readings if one.is_layer == "yes"), key=rank)
    return Choice(candidates, [one for one in candidates if rank(one) == rank(candidates[0])])
