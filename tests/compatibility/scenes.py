"""The small scenes beside which LAMMPS commands are tried, as input scripts of their own.

Each is a directory with one flat script, `setup.in`, and the state that it reads: `membrane`
alone, `cells` on a membrane, and `tissue`, cells and membrane over a dermis. Cells divide, end
their divisions and leave within the 40 steps of a try.
"""

import re
from pathlib import Path

import numpy as np
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.start import lattice
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import FOUR_STEPS

LATTICE = (24, 28)
HEIGHT = 22.4
AGE = 16.0  # of the state that a try starts from
CELLS = {
    "stem": 3, "nd": 2, "arrangement": "random", "generations": 3, "cycle_delay": 2.0,
    "cycle_rate": 0.5, "first_phase": 2.0, "division_rate": 0.7,
}  # fmt: skip
QUIET = {"thermo_interval": 2.5, "dump_interval": 0.0, "checkpoint_interval": 0.0}
SCENES = {
    "membrane": {"dermis": {"present": False}, "cells": {"stem": 0, "nd": 0}},
    "cells": {"dermis": {"present": False}, "cells": CELLS},
    "tissue": {"cells": CELLS},
}
STATE = (
    "i_divisions_left i_divisions_done i_parent i_pair "
    "d_next_division d_birth_time d_pair_start d_detached_time"
)


def scene_of(name: str) -> Scene:
    membrane = {"lattice": list(LATTICE), "height": HEIGHT}
    return Scene.from_dict(
        {"name": name, "parameters": "papilla", "end_time": 100.0, "membrane": membrane,
         "output": QUIET, "numerics": FOUR_STEPS, **SCENES[name]}
    )  # fmt: skip


def configuration_of(scene: Scene) -> Configuration:
    """A waving membrane, cells at fixed places, and a lattice as dermis, so nothing is packed."""
    sheet = lattice.positions(LATTICE, scene.spacing, HEIGHT)
    phase = 2 * np.pi * sheet[:, :2] / scene.box_sides[:2]
    sheet[:, 2] += 0.4 * np.cos(phase[:, 0]) * np.cos(phase[:, 1])
    sheet += np.random.default_rng(1).normal(0.0, [0.02, 0.02, 0.06], sheet.shape)
    kinds, places = [Kind.MEMBRANE] * len(sheet), [sheet]
    if scene.dermis.present:
        steps = np.indices((4, 4, 7)).reshape(3, -1).T + 0.5
        places.append(steps * [*(scene.box_sides[:2] / np.array([4, 4])), 2.8])
        kinds += [Kind.DERMAL] * len(steps)
    if scene.has_cells:
        mixture = [Kind.STEM, Kind.EXHAUSTED, Kind.ND, Kind.TA, Kind.STEM, Kind.TA, Kind.ND]
        mixture += [Kind.TA, Kind.STEM]
        steps = np.indices((3, 3)).reshape(2, -1).T + 0.5
        flat = steps * np.array(scene.box_sides[:2]) / 3
        cells = np.column_stack([flat, np.full(len(flat), HEIGHT + 2.5)])
        cells[-2] = cells[-4] + [0.1, 0.2, 0.0]
        places.append(cells)
        kinds += mixture
    kind_of = np.array(kinds, int)
    pair = np.zeros(len(kinds), int)
    pair[[-4, -2]] = len(kinds) - 1, len(kinds) - 3  # ids of a dividing pair
    links, hinges = lattice.links_and_hinges(LATTICE)
    left = np.select([kind_of == Kind.STEM, kind_of == Kind.TA], [3, 2])
    return Configuration(
        box=np.array(scene.box_sides), kinds=kind_of, positions=np.concatenate(places),
        links=links, hinges=hinges, divisions_left=left, pair=pair,
    )  # fmt: skip


def build_scene(name: str, directory: Path) -> None:
    """Write a scene with its `setup.in`; its state is that of time 0."""
    scene = scene_of(name)
    build(scene, directory, configuration_of(scene))
    (directory / "setup.in").write_text(flat_script(directory, "skin.in"))


def flat_script(directory: Path, name: str) -> str:
    """A script with all that it includes, one command in one line, without its last run."""
    text = re.sub(r"&\n\s*", "", (directory / name).read_text())
    lines = []
    for line in text.splitlines():
        words = line.split("#")[0].split()
        included = re.search(r"include \$\{dir\}/(\w+\.in)", " ".join(words))
        if included and (directory / included[1]).exists():
            lines.append(flat_script(directory, included[1]))
        elif words and not included and words[0] != "run":
            lines.append(" ".join(words))
    return "\n".join(lines) + "\n"
