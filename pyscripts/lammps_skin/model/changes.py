"""What LAMMPS is told when an intervention sets keys of a scene in the course of its run."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from lammps_skin.model.scene import Scene
from lammps_skin.model.tables import Table
from lammps_skin.model.terms import Terms

WITHOUT = {"detach": "never", "generations": "endless"}
"""Values of kinds of cells that stand for none."""


@dataclass(frozen=True)
class Change:
    """Commands for LAMMPS at a time.

    Attributes
    ----------
    name : str
        That of the intervention.
    time : float
    commands : tuple of str
        For a scene that is built and whose input has been read.
    tables : dict of str to Table
        Tables that they read, by the names of their files.
    """

    name: str
    time: float
    commands: tuple[str, ...]
    tables: dict[str, Table]

    def first_step(self, step: int, time: float, timestep: float) -> int:
        """The first step that is not before its time, seen from a step and its time."""
        return step + math.ceil((self.time - time) / timestep - 1e-6)


def scene_at(scene: Scene, time: float) -> Scene:
    """What is in force at a time: the scene after the interventions that have set keys by then."""
    done = sum(one.first <= time for one in scene.interventions if one.set)
    return scene.stages[done]


def changes(scene: Scene) -> tuple[Change, ...]:
    """The changes of a scene's coefficients in the order of their times."""
    found, former = [], Terms(scene)
    setting = [one for one in scene.interventions if one.set]
    for number, (one, stage) in enumerate(zip(setting, scene.later_stages, strict=True), 1):
        terms = Terms(stage, f".{number}")
        tables = {
            term.file: term.table
            for term, old in zip(
                (*terms.pairs, terms.stretch), (*former.pairs, former.stretch), strict=True
            )
            if term.table and not term.same_as(old)
        }
        labels = [row.label for row in scene.cell_kinds]
        found.append(Change(one.name, one.first, tuple(_commands(former, terms, labels)), tables))
        former = terms
    return tuple(found)


def _commands(former: Terms, terms: Terms, labels: list[str]) -> Iterator[str]:
    """Commands by which one scene becomes another.

    Parameters
    ----------
    former, terms : Terms
    labels : list of str
        Of the kinds of cells that can occur.
    """
    for old, term in zip(former.pairs, terms.pairs, strict=True):
        if not term.same_as(old):
            between = terms.pair_potentials[term.name].between
            types = between.replace("_", " ").replace("cell", "${cell_types}")
            yield f"pair_coeff {types} ${{{term.name}_style}} {term.argument}"
    if not terms.stretch.same_as(former.stretch):
        yield f"bond_coeff 1 {terms.stretch.argument}"
    bending = [one.scene.membrane.bending_stiffness for one in (former, terms)]
    if bending[0] != bending[1]:
        yield f"dihedral_coeff 1 {bending[1]} ${{bending_form}}"
    if terms.scene.dermis.present and terms.wall != former.wall:
        yield f"fix wall dermis wall/lj126 zlo 0.0 {terms.wall}"
    for label in labels:
        was, now = (
            WITHOUT | one.kind(one.scene.cell_table[label], labels) for one in (former, terms)
        )
        new = [f"{key} {value}" for key, value in now.items() if was.get(key) != value]
        if new:
            yield f"fix_modify cells kind {label} {' '.join(new)}"
