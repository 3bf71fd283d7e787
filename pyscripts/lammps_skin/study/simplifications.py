"""What a scene could do without: how much of a step that saves here, and what it risks."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import PER_PARTICLE, Configuration

QUIET = {"output.dump_interval": 0.0, "output.checkpoint_interval": 0.0}
ROUNDS = 5


class Simplification(NamedTuple):
    """Something to leave out: the changes of the scene, and what they risk.

    `time` is the time of a step over that of the scene as it is, NaN if not measured.
    """

    name: str
    changes: dict[str, Any]
    risk: str
    time: float = float("nan")


def candidates(scene: Scene) -> Iterator[Simplification]:
    """What is on in a scene and not needed to run it."""
    dermis, membrane, cells = scene.dermis, scene.membrane, scene.cells
    if dermis.present and not dermis.frozen_below:
        half = scene.membrane_height / 2
        yield Simplification(
            "the lower half of the dermis moves", {"dermis.frozen_below": half},
            "deep spheres no longer give way under folds",
        )  # fmt: skip
    if dermis.present:
        yield Simplification(
            "dermis", {"dermis.present": False}, "nothing holds the membrane up: other folds"
        )
    if membrane.exclusion_stiffness:
        yield Simplification(
            "exclusion of membrane particles that are not linked",
            {"membrane.exclusion_stiffness": 0.0}, "folds may pass through each other",
        )  # fmt: skip
    if scene.has_cells and cells.cell_adhesion_stiffness:
        yield Simplification(
            "cell-cell adhesion", {"cells.cell_adhesion_stiffness": 0.0},
            "cells that touch no longer hold together",
        )  # fmt: skip


def measured(scene: Scene, steps: int = 10) -> list[Simplification]:
    """Candidates with their times, from runs at the start of the scene that take turns.

    Times are medians over rounds of ratios within a round, in CPU seconds of this thread.
    """
    choices = list(candidates(scene))
    start = Configuration.from_scene(scene)
    with ExitStack() as stack:
        turns = [
            stack.enter_context(_started(scene.replace(**QUIET, **changes), start))
            for changes in ({}, *(choice.changes for choice in choices))
        ]
        seconds = np.array([[_seconds(turn, steps) for turn in turns] for _ in range(ROUNDS + 1)])
    ratios = np.median(seconds[1:, 1:] / seconds[1:, :1], axis=0)
    return [
        choice._replace(time=float(ratio)) for choice, ratio in zip(choices, ratios, strict=True)
    ]


def _started(scene: Scene, start: Configuration) -> Simulation:
    """A simulation of a scene from the same state, as far as it has the particles."""
    if scene.dermis.present:
        return Simulation.begin(scene, configuration=start)
    return Simulation.begin(scene, configuration=_without_dermis(start))


def _without_dermis(start: Configuration) -> Configuration:
    kept = start.kinds != Kind.DERMAL
    place = np.cumsum(kept) - 1  # of each particle among those that are kept
    names = ("kinds", "ids", "positions", *PER_PARTICLE)
    arrays = {name: getattr(start, name)[kept] for name in names}
    return replace(start, links=place[start.links], hinges=place[start.hinges], **arrays)


def _seconds(simulation: Simulation, steps: int) -> float:
    began = time.thread_time()
    simulation.run(until=simulation.time + steps * simulation.scene.numerics.timestep)
    return time.thread_time() - began
