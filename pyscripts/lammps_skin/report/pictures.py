"""What is drawn of each frame: membrane, heights, cells, and what they are coloured by."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lammps_skin.analysis.basal_layer import number_below
from lammps_skin.analysis.curvature import curvature
from lammps_skin.analysis.geometry import minimum_image, wrapped
from lammps_skin.analysis.lineage import founder_of
from lammps_skin.analysis.observables import Run
from lammps_skin.analysis.state import State, StateAnalysis
from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import MembraneError
from lammps_skin.kinds import Kind
from lammps_skin.report.packing import quantised
from lammps_skin.trajectory.clones import clones

STEADY = ("membrane", "curvature", "height", "dermis")
CELL = ("id", "kind", "clone", "age", "left", "below", "curvature")
OUTLYING = 0.02  # fraction of curvatures beyond the ends of the colour scale


class Picture(NamedTuple):
    """One frame.

    Attributes
    ----------
    membrane : (n, 3) array
        Positions, each in the image nearest to its first one.
    curvature : (n,) array
        Mean curvature, 1/length.
    height : (g_x, g_y) array
        Upper side of the membrane; NaN where it is no sheet over the box.
    cells : (c, 3) array
        Positions, each in the image nearest to the membrane below.
    of_cells : dict of (c,) arrays
        The names in `CELL`: id, number of the kind, founder of the clone, age (NaN of those that
        were there at the start of all), generations left (-1: endless or none), number of cells
        straight below, and mean curvature below.
    dermis : (d, 3) array
        Positions, each in the image nearest to its first one; (0, 3) if not wanted.
    """

    membrane: Floats
    curvature: Floats
    height: Floats
    cells: Floats
    of_cells: dict[str, NDArray[Any]]
    dermis: Floats


class Pictures(StateAnalysis):
    """``pictures``: a `Picture` of each frame; ``first`` (n, 3): where the membrane begins."""

    def __init__(self, run: Run, dermis: bool = False, **options: Any) -> None:
        super().__init__(run.universe, **options)
        self._founders = _founders(run)
        dermal = run.universe.atoms.types == Kind.DERMAL.label
        self._dermal = np.flatnonzero(dermal if dermis else np.zeros_like(dermal))
        moment = run.universe.trajectory[0]
        self._begin, first = moment.time, self._state(moment)
        self.first, self.triangles = wrapped(first.membrane, first.box), first.triangles
        self._dermis = wrapped(moment.data["position"][self._dermal], first.box)

    def _measure(self, state: State) -> tuple[Any, ...]:
        bent = curvature(state.membrane, state.triangles, state.box).mean
        membrane = _near(state.membrane, self.first, state.box)
        dermis = _near(self._ts.data["position"][self._dermal], self._dermis, state.box)
        above = minimum_image(state.cells - state.membrane[state.below], state.box)
        held, of_cells = self._ts.data, state.ids - 1
        born = (held["parent"][of_cells] > 0) | (held["birth_time"][of_cells] > self._begin)
        radius = state.scene.cells.radius
        return (Picture(membrane, bent, _height(state), membrane[state.below] + above, {
            "id": state.ids,
            "kind": state.kinds,
            "clone": self._founders(state.ids),
            "age": np.where(born, state.time - held["birth_time"][of_cells], np.nan),
            "left": held["divisions_left"][of_cells],
            "below": number_below(state.cells, state.box, radius),
            "curvature": bent[state.below],
        }, dermis),)  # fmt: skip

    def _conclude(self) -> None:
        self.pictures: list[Picture] = [picture for _, picture in self._rows]


def _founders(run: Run) -> Callable[[Ints], Ints]:
    """Founder of each of some cells; without an event log as far as the frames tell."""
    events = run.events
    if events is not None:
        return lambda ids: founder_of(ids, events)
    known = clones(run.universe.trajectory.frames)
    return lambda ids: known[ids - 1]


def _near(places: Floats, first: Floats, box: Floats) -> Floats:
    """Positions (n, 3) in the images nearest to the first ones."""
    found: Floats = first + minimum_image(places - first, box)
    return found


def _height(state: State) -> Floats:
    try:
        return state.height
    except MembraneError:
        shape = np.maximum(np.round(state.box / state.scene.spacing), 1).astype(int)
        return np.full(shape, np.nan)


def surface(first: Floats, triangles: Ints, box: Floats) -> tuple[Ints, Ints]:
    """A membrane that is periodic, as triangles in the plane that reach over the sides of the box.

    Parameters
    ----------
    first : (n, 3) array
        Positions in the box.
    triangles : (t, 3) array of int
    box : (2,) array

    Returns
    -------
    copies : (g, 3) array of int
        Beside the n points there are g copies: the point, and by how many boxes it is displaced.
    corners : (s, 3) array of int
        Of the triangles, numbers below n + g. A triangle through a side is there on both sides.
    """
    a = first[triangles][:, :1, :2]
    boxes = -np.rint((first[triangles][..., :2] - a) / box).astype(np.int64)
    images = np.concatenate([boxes - boxes[:, n : n + 1] for n in range(3)])
    named = np.concatenate([np.tile(triangles, (3, 1))[..., None], images], axis=-1)
    named = np.unique(named.reshape(-1, 9), axis=0).reshape(-1, 3)
    copied = named[:, 1:].any(axis=1)
    copies, places = np.unique(named[copied], axis=0, return_inverse=True)
    corners = named[:, 0].copy()
    corners[copied] = len(first) + places.ravel()
    return copies, corners.reshape(-1, 3)


def arrays(pictures: Sequence[Picture]) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """What is packed of pictures, and the ranges that bring whole numbers back to lengths."""
    membrane = np.array([picture.membrane for picture in pictures])
    bent = np.array([picture.curvature for picture in pictures])
    height = np.array([picture.height for picture in pictures])
    cells = np.concatenate([picture.cells for picture in pictures])
    dermis = np.array([picture.dermis for picture in pictures])
    around = np.concatenate([membrane.reshape(-1, 3), cells, dermis.reshape(-1, 3)])
    low, high = around.min(axis=0), around.max(axis=0)
    steepest = _most(bent)
    bottom, top = np.nanmin(membrane[..., 2]), np.nanmax(membrane[..., 2])
    packed: dict[str, NDArray[Any]] = {
        "membrane": quantised(membrane, low, high, "u2"),
        "curvature": quantised(np.nan_to_num(bent), -steepest, steepest, "u1"),
        "height": quantised(np.nan_to_num(height, nan=bottom), bottom, top, "u1"),
        "number": np.array([len(picture.cells) for picture in pictures], np.int32),
        "cells": quantised(cells, low, high, "u2"),
    }
    if dermis.size:
        packed["dermis"] = quantised(dermis, low, high, "u2")
    types = dict(zip(CELL, ("i4", "u1", "i4", "f4", "i2", "u1", "f4"), strict=True))
    for name, kind in types.items():
        values = np.concatenate([picture.of_cells[name] for picture in pictures])
        if kind == "u1":
            values = np.minimum(values, 255)
        packed[f"cell_{name}"] = values.astype(kind)
    ends = [OUTLYING, 1 - OUTLYING]
    ranges = {
        "low": low.tolist(), "high": high.tolist(), "curvature": steepest,
        "height": [float(bottom), float(top)],
        "cells": {
            "height": np.quantile(cells[:, 2], ends).tolist() if len(cells) else [0.0, 1.0],
            "curvature": _most(packed["cell_curvature"]), "age": _most(packed["cell_age"]),
        },
    }  # fmt: skip
    return packed, ranges


def _most(values: NDArray[Any]) -> float:
    """Below which nearly all numbers are, whatever their sign; 1 if there is none but 0."""
    sizes = np.abs(values[~np.isnan(values)])
    return (float(np.quantile(sizes, 1 - OUTLYING)) if len(sizes) else 0.0) or 1.0
