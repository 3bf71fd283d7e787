"""The potentials: the energy of every term of the model, as the package computes it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lammps_skin.arrays import Floats
from lammps_skin.model import potentials
from lammps_skin.model.parameters import DEFAULT
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import TERMS, Terms
from lammps_skin.style import name_axes, plain

AGE = 5.0  # of the dividing pair whose spring is shown, time
POINTS = 601
RATIO = "distance / contact length"
ACROSS = 4  # panels in a row
SETS = ("printed", DEFAULT)


class Curve(NamedTuple):
    """Energy (p,) of a term against x (p,), what x is, and where the energy is singular."""

    label: str
    x: Floats
    energy: Floats
    singular: float | None = None


def curves(scene: Scene) -> dict[str, Curve]:
    """The curve of every term, by the names in `TERMS`.

    x is the distance over the contact length, the angle between the normals of two triangles
    (bend), or the distance of a dividing pair of age `AGE` (division).
    """
    membrane, cells, terms = scene.membrane, scene.cells, Terms.of(scene)
    x = np.linspace(0.85, 1.6, POINTS)
    found = {
        "adhesion": Curve(RATIO, x, terms.adhesion * potentials.adhesion(x, cells.adhesion_range)),
        "binding": Curve(RATIO, x, terms.binding * potentials.binding(x)),
    }
    for pair in terms.pair_potentials.values():
        x = np.linspace(0.85 if pair.lennard_jones else 0.6, 1.6, POINTS)
        energy = np.where(x < pair.range, pair.stiffness * pair.energy(x), 0.0)
        found[pair.name] = Curve(RATIO, x, energy)
    x = np.linspace(0.85, 1.6, POINTS)
    found["wall"] = Curve(RATIO, x, scene.dermis.wall_stiffness * potentials.exclusion(x))

    angle = np.linspace(0.0, np.pi, POINTS)
    bend = membrane.bending_stiffness * potentials.bending(np.cos(angle), membrane.bending_form)
    found["bend"] = Curve("angle between normals (radians)", angle, bend)
    found["stretch"] = _stretch(scene)
    stiffness, start, rate, end = terms.division
    distance = np.linspace(0.0, 2 * cells.radius, POINTS)
    length = min(start + rate * AGE, end)
    spring = stiffness * potentials.division_spring(distance, length)
    found["division"] = Curve(f"distance at age {AGE:g} (length units)", distance, spring)
    return {name: found[name] for name in TERMS}


def _stretch(scene: Scene) -> Curve:
    """Links, up to just below the length at which their energy is infinite."""
    membrane, d2 = scene.membrane, scene.membrane.spacing_ratio
    scale = 2 * membrane.radius if scene.force_scale == "direct" else 1.0
    x = np.linspace(0.85 * d2, 1 + d2 - 0.7 * d2, POINTS)
    energy = potentials.stretch(x, membrane.elasticity, d2, scale)
    return Curve(RATIO, x, membrane.stretch_stiffness * energy, 1 + d2)


@plain
def draw_potentials(sets: tuple[str, ...] = SETS) -> Figure:
    """Figure of all terms, with a parameter set's curve where it differs from the first's."""
    scene = Scene.load("quarter-nd-a")
    of_sets = {name: curves(scene.replace(parameters=name)) for name in sets}
    rows = -(-len(TERMS) // ACROSS)
    figure = Figure(figsize=(13, 3 * rows), layout="constrained")
    for n, term in enumerate(TERMS, 1):
        axes: Axes = figure.add_subplot(rows, ACROSS, n)
        first = of_sets[sets[0]][term]
        for name, style in zip(sets, ("-", "--", ":", "-."), strict=False):
            curve = of_sets[name][term]
            if name == sets[0] or not np.array_equal(curve.energy, first.energy):
                axes.plot(curve.x, curve.energy, style, label=name)
        if first.singular is not None:
            axes.axvline(first.singular, color="0.5", ls=":", label="singular")
        axes.set(title=term.replace("_", "-"))
        name_axes(axes, first.label, "energy (energy units)")
        if len(axes.lines) > 1:
            axes.legend(frameon=False)
    return figure
