"""``skin check``: what a scene is, what is on and off, and what it will cost; nothing is run."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated

import typer

from lammps_skin.cli.options import (
    Accuracy,
    At,
    From,
    Parameters,
    Seed,
    Settings,
    scene_from,
    scenes_beginning,
)
from lammps_skin.cli.output import console, counted, duration, print_table
from lammps_skin.engine.machine import cores
from lammps_skin.engine.rank_count import efficiency, worthwhile
from lammps_skin.errors import SceneError, one_line
from lammps_skin.kinds import Kind
from lammps_skin.model.changes import scene_at
from lammps_skin.model.remarks import remarks
from lammps_skin.model.scene import Scene
from lammps_skin.model.stiffness import evaluations, longest_timestep, stiffest
from lammps_skin.model.terms import TERMS
from lammps_skin.start.arrangements import place_cells
from lammps_skin.start.configuration import Configuration, check_sizes
from lammps_skin.start.counts import first_counts
from lammps_skin.start.sheet import membrane_at_start
from lammps_skin.study import cost
from lammps_skin.study.rates import calibration_file, stored
from lammps_skin.study.simplifications import Simplification, candidates, measured


def check(
    scene: Annotated[
        str | None,
        typer.Argument(
            metavar="SCENE",
            help="Name of a built-in scene, or a .toml file.",
            autocompletion=scenes_beginning,
        ),
    ] = None,
    parameters: Parameters = None,
    accuracy: Accuracy = None,
    seed: Seed = None,
    settings: Settings = None,
    run: From = None,
    at: At = None,
    measure: Annotated[
        bool, typer.Option("--measure", help="Time a short run of the scene on this machine.")
    ] = False,
    calibrate: Annotated[
        bool,
        typer.Option("--calibrate", help="Measure how fast this machine is, for all estimates."),
    ] = False,
    savings: Annotated[
        bool, typer.Option("--savings", help="Measure what leaving parts out would save.")
    ] = False,
) -> None:
    """Show what a scene has and what it will cost, without running it."""
    if calibrate:
        _calibrate()
    if scene is None:
        if not calibrate:
            raise SceneError("SCENE: is missing; skin scenes lists the built-in ones")
        return
    described = scene_from(scene, parameters, settings, accuracy, seed, run, at)
    check_sizes(described, described.box_sides)
    if described.start.run is None:
        membrane_at_start(described)
        place_cells(described)
    else:
        described = Configuration.from_scene(described).described(described)
    console.print(one_line(f"{described.name}: {described.description}").rstrip(": "))
    if begins := _beginning(described):
        console.print(one_line(begins))
    in_force = scene_at(described, described.begins)
    for title, rows in {
        "part": _parts(described), "kind of cells": _kinds(in_force),
        "intervention": _interventions(described), "term": _terms(in_force),
        "size": _sizes(described), "numerics": _numerics(described),
    }.items():  # fmt: skip
        if lines := list(rows):
            print_table([title, "", ""], lines, whole=[0], fold=True)
    for remark in remarks(described):
        console.print(remark)
    with console.status("measuring"):
        seconds = cost.measure(described) if measure else None
    print_table(["cost on one core", ""], _costs(described, seconds), whole=[0], fold=True)
    with console.status("measuring"):
        found = measured(described) if savings else list(candidates(described))
    heads = ["could be left out", "risk", *(["step time"] if savings else [])]
    print_table(heads, _savings(found), whole=[0, 2], fold=True)


def _calibrate() -> None:
    with console.status("measuring"):
        running, starting = cost.calibrate()
    console.print(
        f"calibrated: runs take {running:.2f} times, starts {starting:.2f} times as long as on the "
        f"machine of docs/speed.md; stored in {calibration_file()}"
    )


def _beginning(scene: Scene) -> str:
    """What a scene begins with that is not made by itself."""
    run, membrane = scene.start.run, scene.membrane
    if run is not None:
        return f"begins with the state of {run} at t = {scene.begins:.10g}"
    if membrane.heights is not None:
        scale = "" if membrane.heights_scale == 1 else f", times {membrane.heights_scale:g}"
        return f"begins at t = 0 with a membrane of the heights in {membrane.heights}{scale}"
    return ""


def _parts(scene: Scene) -> Iterator[tuple[str, ...]]:
    cells = scene.cells
    parts = {
        "dermis": (scene.dermis.present, "dermis.present"),
        "membrane": (True, ""),
        "stem and TA cells, births, removals": (scene.divides, "cells.stem"),
        "non-dividing cells": (cells.nd > 0, "cells.nd"),
        "trajectory": (scene.output.dump_interval > 0, "output.dump_interval"),
        "restart files": (scene.output.checkpoint_interval > 0, "output.checkpoint_interval"),
    }
    for name, (on, key) in parts.items():
        yield name, "on" if on else "off", "" if on else f"by {key}"


def _terms(scene: Scene) -> Iterator[tuple[str, ...]]:
    dermis, membrane, cells = scene.dermis, scene.membrane, scene.cells
    without_dermis = "" if dermis.present else "no dermis"
    without_cells = "" if scene.has_cells else "no cells"
    without_division = "" if scene.divides else "no stem cells"
    attached = {
        adhesion: [row.stiffness for row in scene.cell_kinds if row.adhesion == adhesion]
        for adhesion in ("adhesive", "bound")
    }
    without_adhesion = "" if attached["adhesive"] else without_division or "no adhesive cells"
    without_binding = without_cells or ("" if attached["bound"] else "no bound cells")
    terms: dict[str, tuple[float | list[float], str]] = {
        "dermis_dermis": (dermis.stiffness, without_dermis),
        "dermis_membrane": (dermis.membrane_stiffness, without_dermis),
        "wall": (dermis.wall_stiffness, without_dermis),
        "stretch": (membrane.stretch_stiffness, ""),
        "bend": (membrane.bending_stiffness, ""),
        "membrane_exclusion": (membrane.exclusion_stiffness, ""),
        "cell_membrane_exclusion": (cells.membrane_exclusion_stiffness, without_cells),
        "adhesion": (attached["adhesive"], without_adhesion),
        "binding": (attached["bound"], without_binding),
        "cell_cell_exclusion": (cells.exclusion_stiffness, without_cells),
        "cell_cell_adhesion": (cells.cell_adhesion_stiffness, without_cells),
        "division": (cells.division_stiffness, without_division),
    }
    for name in TERMS:
        given, missing = terms[name]
        stiffnesses = sorted({*given} if isinstance(given, list) else {given})
        why = missing or ("" if any(stiffnesses) else "its K is 0")
        told = ", ".join(f"{stiffness:g}" for stiffness in stiffnesses)
        yield name, "off" if why else "on", why or f"K = {told}"


def _kinds(scene: Scene) -> Iterator[tuple[str, ...]]:
    """What the kinds of cells do, of a scene that says something of them."""
    for row in scene.cell_kinds if scene.cells.kinds else ():
        attached = {
            "bound": f"bound, K = {row.stiffness:g}",
            "adhesive": f"adhesive, K = {row.stiffness:g}, range {row.range:g}",
            "none": "no adhesion",
        }[row.adhesion]
        paired = f", K = {row.paired_stiffness:g} in a pair with {row.paired_with}"
        leaves = f", detaches beyond {row.range:g}" if row.detaches else ""
        if row.daughter is None:
            divides = "never divides"
        elif row.generations is None:
            divides = f"divides every {row.cycle:.4g} into itself and {row.daughter}"
        else:
            divides = (
                f"divides {counted(row.generations, 'time')}, every {row.cycle:.4g}, into itself "
                f"and {row.daughter}, then is {row.after_last}"
            )
        yield row.label, f"{attached}{paired if row.paired_with else ''}{leaves}", divides


def _interventions(scene: Scene) -> Iterator[tuple[str, ...]]:
    """What is done in the course of the run, and when."""
    for one in scene.interventions:
        times = f"at t = {one.first:g}"
        if one.every:
            times += f", every {one.every:g}"
        if one.until:
            times += f" until {one.until:g}"
        if one.set:
            done = "sets " + ", ".join(f"{key} = {value}" for key, value in one.set.items())
        elif one.add:
            done = f"adds {len(one.places or ())} {one.add}"
        else:
            share = f"{one.fraction:.3g} of " if one.fraction < 1 else ""
            where = one.within.model_dump(exclude_none=True) if one.within else {}
            named = " and ".join(f"{key} {list(values)}" for key, values in where.items())
            done = f"{'removes' if one.remove else 'converts'} {share}"
            done += ", ".join(one.remove or one.convert or ())
            done += f" to {one.to}" if one.to else ""
            done += f" within {named}" if named else ""
        yield one.name, times, done


def _sizes(scene: Scene) -> Iterator[tuple[str, ...]]:
    counts = first_counts(scene)
    for kind, count in counts.items():
        if count or kind not in (Kind.TA, Kind.EXHAUSTED):
            yield f"{kind.label} particles", f"{count:,}"
    yield "links", f"{3 * counts[Kind.MEMBRANE]:,}"
    yield "box", " x ".join(f"{side:.6g}" for side in scene.box_sides)


def _numerics(scene: Scene) -> Iterator[tuple[str, ...]]:
    numerics, output = scene.numerics, scene.output
    limit, move = numerics.stiffness_limit, numerics.largest_move
    yield "accuracy", numerics.accuracy
    yield "integrator", f"{numerics.integrator}, {evaluations(scene)} force evaluations a step"
    yield "stiffness limit", f"{limit:g}" if limit else "none"
    yield "largest move of a step", f"{move:g}" if move else "any"
    longest, name = longest_timestep(scene), stiffest(scene).name
    yield "timesteps that can be stable", f"up to {longest:.3g}, for {name}"
    yield "parameters, forces", f"{scene.parameters}, {scene.force_scale}"
    yield "seeds", f"cells {scene.cell_seed}, dermis {scene.dermis_seed}"
    yield "timestep, end time", f"{numerics.timestep:g}, {scene.end_time:g}"
    yield "events handled every", f"{numerics.event_interval:g}"
    yield "pair terms", numerics.pair_form
    yield "tables", f"{numerics.table_style}, {numerics.table_points:,} points"
    yield "neighbor skin", f"{numerics.neighbor_skin:g}"
    yield (
        "thermo, trajectory, restart every",
        f"{output.thermo_interval:g}, {output.dump_interval:g}, {output.checkpoint_interval:g}",
    )


def _costs(scene: Scene, measured: float | None) -> Iterator[tuple[str, ...]]:
    expected = cost.estimate(scene)
    factor = measured / expected.first_step if measured else 1.0
    yield "memory", f"{expected.memory / 1e6:,.0f} MB"
    yield "disk", f"about {expected.disk / 1e6:,.3g} MB"
    yield "cells at the end", f"about {expected.cells:,.0f}"
    rest = f", from t = {scene.begins:.10g} to {scene.end_time:g}" if scene.begins else ""
    yield "steps", f"{expected.steps:,}{rest}"
    yield "until the first step", f"about {duration(expected.start)}"
    yield "step at the start", f"{expected.first_step * 1e3:.3g} ms expected"
    if measured:
        yield "", f"{measured * 1e3:.3g} ms measured"
    seconds = expected.start + factor * (expected.seconds - expected.start)
    yield "the whole run", f"about {duration(seconds)}"
    particles = sum(first_counts(scene).values())
    if (ranks := worthwhile(particles, cores())) > 1:
        shared = (seconds - expected.start) / (ranks * efficiency(particles / ranks))
        yield f"on {ranks} cores", f"about {duration(expected.start + shared)}"
    if not stored():
        yield "", "of a machine like that of docs/speed.md; skin check --calibrate measures yours"


def _savings(found: list[Simplification]) -> Iterator[tuple[str, ...]]:
    for saving in found:
        keys = ", ".join(f"{key} = {str(value).lower()}" for key, value in saving.changes.items())
        measure = () if math.isnan(saving.time) else (f"x {saving.time:.2f}",)
        yield keys, f"{saving.name}: {saving.risk}", *measure
