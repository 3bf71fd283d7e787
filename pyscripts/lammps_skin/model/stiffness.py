"""What is stiffest in a scene, and the longest timestep that is stable with it, beforehand."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from lammps_skin.model.accuracy import stability_limit
from lammps_skin.model.parameters import SETS
from lammps_skin.model.parts import Membrane
from lammps_skin.model.potentials import stretch_slope
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import Terms

FOLDS = {  # largest eigenvalues that folds come to in runs, by parameter set
    "printed": 200.0, "papilla": 200.0, "weak5": 25.0, "direct5": 40.0, "earlier": 25.0,
    "earlier-stiff": 65.0, "earlier-full": 25.0,
}  # fmt: skip
RESERVE = 1.5  # stages are chosen for eigenvalues so many times as large as the stiffest known one
FEWEST, MOST = 3, 99  # stages
STEP = 1e-4  # of a difference quotient, relative


class Stiffest(NamedTuple):
    """The stiffest motion: what it is, and the largest eigenvalue of the second derivatives."""

    name: str
    eigenvalue: float


def stiffest(scene: Scene) -> Stiffest:
    """The stiffest of what a scene is sure to come to, at its start or after an intervention.

    Two particles that are bound by a spring k alone have the eigenvalue 2 k, a triangular network
    of them 6 k. Folds of a membrane under cells are stiffer by far: what is known of them has been
    seen in runs. Crowds, where several springs pull at one particle, may be stiffer than this.
    Sizes of which there are no squares have nothing that is stiff.
    """
    try:
        with np.errstate(all="ignore"):
            motions = (one for stage in scene.stages for one in _motions(stage))
            return max(motions, key=lambda one: one.eigenvalue)
    except ArithmeticError:
        return Stiffest("nothing", 0.0)


def _motions(scene: Scene) -> Iterator[Stiffest]:
    terms = Terms.of(scene)
    limit = scene.numerics.stiffness_limit or math.inf
    yield Stiffest("links of the membrane", min(6 * _link(scene), limit))
    for kind in scene.cell_kinds:
        name = "binding" if kind.adhesion == "bound" else "adhesion"
        strongest = max(kind.stiffness, kind.paired_stiffness if kind.paired_with else 0.0)
        yield Stiffest(name, 2 * terms.attachment(strongest) / scene.contact**2)
    if scene.divides:
        yield Stiffest("division springs", 2 * terms.division.stiffness)
        name = f"folds as runs of {scene.parameters} have them"
        yield Stiffest(name, min(_folds(scene), limit))


def _link(scene: Scene) -> float:
    """Second derivative of stretch at rest, the mean of those on both sides."""
    membrane, contact = scene.membrane, 2 * scene.membrane.radius
    rest = membrane.spacing_ratio
    scale = contact if scene.force_scale == "direct" else 1.0
    around = rest * np.array([1 - STEP, 1 + STEP])
    slopes = stretch_slope(around, membrane.elasticity, rest, scale)
    return float(membrane.stretch_stiffness * np.ptp(slopes) / (2 * STEP * rest) / contact**2)


def _folds(scene: Scene) -> float:
    """Largest eigenvalue of folds, under the same forces as the cube root of the stiffness K.

    The energy of a fold by a small angle t is as K t^4, a force as K t^3, the eigenvalue as K t^2.
    """
    of_set = SETS[scene.parameters].get("membrane", {})
    usual = of_set.get("bending_stiffness", Membrane().bending_stiffness)
    return FOLDS[scene.parameters] * math.cbrt(scene.membrane.bending_stiffness / usual)


def evaluations(scene: Scene) -> int:
    """Force evaluations in a step that is not divided.

    Stages that are not given are as many as make a step stable for `RESERVE` times the largest
    eigenvalue of the scene, from `FEWEST` to `MOST`.
    """
    numerics = scene.numerics
    if numerics.integrator == "euler":
        return 1
    if numerics.stages:
        return numerics.stages
    needed = RESERVE * numerics.timestep * stiffest(scene).eigenvalue
    enough = (s for s in range(FEWEST, MOST) if stability_limit(numerics.integrator, s) >= needed)
    return next(enough, MOST)


def longest_timestep(scene: Scene) -> float:
    """The longest timestep that can be stable with as many stages, without dividing it."""
    eigenvalue = stiffest(scene).eigenvalue
    stable = stability_limit(scene.numerics.integrator, evaluations(scene))
    return stable / eigenvalue if eigenvalue else math.inf


def warning(scene: Scene) -> str:
    """What there is to say of the scene's timestep; nothing if it may be stable."""
    longest, timestep = longest_timestep(scene), scene.numerics.timestep
    if not timestep > longest:
        return ""
    numerics = scene.numerics
    method = str(numerics.integrator)
    if method != "euler":
        method += f" with {evaluations(scene)} stages"
    name, eigenvalue = stiffest(scene)
    outcome = (
        "steps will be divided" if numerics.largest_move else "the run is likely to end in an error"
    )
    return (
        f"numerics.timestep = {timestep:g}: {method} is stable up to {longest:.3g} with {name} "
        f"(stiffness {eigenvalue:.3g}); beyond, {outcome}"
    )
