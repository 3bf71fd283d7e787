"""Single points: energies and forces of a configuration in a text file, by running LAMMPS.

The text format is one line ``lattice NX NY Lx Ly time``, then a line ``kind x y z [m]`` for
each particle (kinds M membrane, row by row, D dermal, S stem, T TA, N ND, and those that the
scene adds by their names; m divisions left) and ``pair i j L`` for each dividing pair, with
0-based indices and the natural length L.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.engine.engine import Forces
from lammps_skin.errors import ConfigurationError
from lammps_skin.kinds import KINDS, Kind
from lammps_skin.model import potentials
from lammps_skin.model.parameters import DEFAULT
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import Terms
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import lattice
from lammps_skin.start.configuration import Configuration

LETTERS = {"D": Kind.DERMAL, "M": Kind.MEMBRANE, "S": Kind.STEM, "T": Kind.TA, "N": Kind.ND}
LETTER_OF = {kind.label: letter for letter, kind in LETTERS.items()} | {"exhausted": "T"}
# names of the terms in the output
SHORT = {
    "dm": "dermis_membrane", "dd": "dermis_dermis", "wall": "wall", "str": "stretch",
    "bend": "bend", "mm_ex": "membrane_exclusion", "bind": "binding", "ad": "adhesion",
    "cm_ex": "cell_membrane_exclusion", "cc_ex": "cell_cell_exclusion", "div": "division",
}  # fmt: skip
FINE = {"timestep": 0.01, "table_style": "linear", "table_points": 100_000}


@dataclass
class Text:
    """What a text file says; of kinds their labels."""

    sheet: tuple[int, int]
    sides: tuple[float, float]
    time: float
    kinds: list[str]
    positions: Floats
    divisions_left: list[int]
    pairs: list[tuple[int, int, float]]


def read_text(path: Path, names: Sequence[str] = ()) -> Text:
    """Read a text file; raises `ConfigurationError` naming the line that is wrong.

    `names` are the labels of further kinds of cells.
    """
    known = {letter: kind.label for letter, kind in LETTERS.items()}
    known |= {name: name for name in names}
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not text in UTF-8"
        raise ConfigurationError(f"configuration {path}: {reason}") from None
    header: tuple[tuple[int, int], tuple[float, float], float] | None = None
    kinds, positions, divisions_left, pairs = [], [], [], []
    stated: dict[str, int] = {}  # what must be stated once, and its line

    def state(what: str, number: int) -> None:
        if what in stated:
            raise ConfigurationError(
                f"configuration {path}, line {number}: states {what}, which line {stated[what]} "
                "does, too"
            )
        stated[what] = number

    for number, line in enumerate(lines, 1):
        words = line.split()
        try:
            if not words or words[0].startswith("#"):
                continue
            if words[0] == "lattice":
                nx, ny, lx, ly, time = words[1:]
                header = (int(nx), int(ny)), (float(lx), float(ly)), float(time)
                state("the lattice", number)
            elif words[0] == "pair":
                i, j, length = words[1:]
                pairs.append((int(i), int(j), float(length)))
                for cell in {int(i), int(j)}:
                    state(f"a pair of cell {cell}", number)
            else:
                kind = known[words[0]]
                m = int(words[4]) if len(words) == 5 else 0
                place = [float(word) for word in words[1:4]]
                if len(words) not in (4, 5) or not 0 <= m <= 1000 or not np.isfinite(place).all():
                    raise ValueError
                positions.append(place)
                kinds.append("exhausted" if kind == "ta" and m == 0 else kind)
                divisions_left.append(m)
        except (ValueError, KeyError):
            raise ConfigurationError(
                f"configuration {path}, line {number}: {line.strip()[:60]!r} is none of "
                f"'lattice NX NY Lx Ly time', '{'|'.join(['M|D|S|T|N', *names])} x y z [m]', "
                "'pair i j L'"
            ) from None
    if header is None:
        raise ConfigurationError(f"configuration {path}: has no line 'lattice NX NY Lx Ly time'")
    places = np.array(positions).reshape(-1, 3)
    text = Text(*header, kinds, places, divisions_left, pairs)
    _check(text, path)
    return text


def _check(text: Text, path: Path) -> None:
    membrane = text.kinds.count("membrane")
    nx, ny = text.sheet
    if membrane != nx * ny:
        raise ConfigurationError(
            f"configuration {path}: lattice {nx} x {ny} needs {nx * ny} membrane particles, "
            f"the file has {membrane}"
        )
    for i, j, _ in text.pairs:
        inside = all(0 <= n < len(text.kinds) for n in (i, j))
        if i == j or not inside or {"membrane", "dermal"} & {text.kinds[i], text.kinds[j]}:
            raise ConfigurationError(f"configuration {path}: pair {i} {j}: must be two cells")


def _further(changes: dict[str, Any]) -> list[str]:
    """Labels of the kinds of cells that changes of a scene add."""
    told = {key: value for key, value in changes.items() if key.startswith("cells.kinds")}
    return [kind.label for kind in Scene().replace(**told).kinds_of_cells if kind not in KINDS]


def scene_of(text: Text, name: str, changes: dict[str, Any]) -> Scene:
    """The smallest scene that has the kinds of the file."""
    stem_line = sum(text.kinds.count(label) for label in ("stem", "ta", "exhausted"))
    further = sorted(set(text.kinds) - {kind.label for kind in KINDS})
    counts = {f"cells.kinds.{label}.count": text.kinds.count(label) for label in further}
    scene = Scene.from_dict(
        {
            "name": "evaluate",
            "parameters": name,
            "dermis": {"present": "dermal" in text.kinds},
            "membrane": {"lattice": list(text.sheet)},
            "cells": {
                "stem": stem_line,
                "nd": text.kinds.count("nd"),
                "arrangement": "random",
            },
            "numerics": dict(FINE),
            "output": {"dump_interval": 0.0, "checkpoint_interval": 0.0},
        }
    ).replace(**counts, **changes)
    top = float(text.positions[:, 2].max(initial=0.0)) + 4 * scene.contact
    if top > scene.box_height:
        scene = scene.replace(box_height=top)
    return scene.replace(box=list(text.sides)) if "box" not in changes else scene


def configuration_of(text: Text, scene: Scene) -> Configuration:
    """The state that a file describes."""
    links, hinges = lattice.links_and_hinges(text.sheet)
    numbers = {kind.label: int(kind) for kind in scene.all_kinds}
    kinds = np.array([numbers[label] for label in text.kinds], int)
    membrane = np.flatnonzero(kinds == Kind.MEMBRANE)
    configuration = Configuration(
        box=np.array([*text.sides, scene.box_height]),
        kinds=kinds,
        positions=text.positions,
        links=membrane[links],
        hinges=membrane[hinges],
        divisions_left=np.array(text.divisions_left, int),
        time=text.time,
    )
    _, start, rate, end = Terms.of(scene).division
    for i, j, length in text.pairs:
        if not 0 <= length <= end:
            raise ConfigurationError(
                f"pair {i} {j} {length:g}: a dividing pair's natural length must be in [0, {end:g}]"
            )
        configuration.pair[[i, j]] = [j + 1, i + 1]
        configuration.pair_start[[i, j]] = text.time - (length - start) / rate
    return configuration


@dataclass
class Evaluation:
    """Energies by term, and forces on the particles in the order of the file."""

    scene: Scene
    energies: dict[str, float]
    adhesion_plateau: float
    forces: Forces
    partner: dict[int, tuple[int, float]]

    def lines(self) -> list[str]:
        """The output format: energies, then ``index kind fx fy fz [nearest distance]``."""
        shifted = self.energies["cell_cell_adhesion"]
        energies = {short: self.energies[name] for short, name in SHORT.items()}
        known = {*SHORT.values(), "cell_cell_adhesion"}
        energies |= {name: value for name, value in self.energies.items() if name not in known}
        energies["cc_ad"] = shifted + self.adhesion_plateau
        energies["cc_ad_shifted"] = shifted
        total = sum(value for name, value in energies.items() if name != "cc_ad_shifted")
        lines = [f"# E {name} {value:.15g}" for name, value in energies.items()]
        lines += [f"# E total {total:.15g}", "# index type fx fy fz [nearest dnear]"]
        for n, (kind, force) in enumerate(zip(self.forces.types, self.forces.forces, strict=True)):
            nearest = "{} {:.15g}".format(*self.partner[n]) if n in self.partner else ""
            fx, fy, fz = force
            label = self.scene.kind(kind).label
            lines.append(
                f"{n} {LETTER_OF.get(label, label)} {fx:.15g} {fy:.15g} {fz:.15g} {nearest}".strip()
            )
        return lines


def evaluate(
    path: Path, parameters: str = DEFAULT, changes: dict[str, Any] | None = None
) -> Evaluation:
    """Energies and forces of the configuration in a text file, with the scene's own styles."""
    changes = changes or {}
    text = read_text(path, _further(changes))
    scene = scene_of(text, parameters, changes)
    try:
        configuration = configuration_of(text, scene)
        configuration.check(scene)
    except ConfigurationError as error:
        raise ConfigurationError(f"configuration {path}: {error}") from None
    with Simulation.begin(scene, configuration=configuration) as simulation:
        energies, forces, cells = simulation.energies(), simulation.forces(), simulation.cells()
    endless = forces.ids[~np.isfinite(forces.forces).all(axis=1)] - 1
    if len(endless) or not np.isfinite([*energies.values()]).all():
        named = ", ".join(map(str, endless[:4])) or "some"
        raise ConfigurationError(
            f"configuration {path}: forces on the particles {named} are not finite; no two may be "
            "in one place"
        )
    partner = {
        int(id_) - 1: (int(near) - 1, float(distance))
        for id_, near, distance in zip(cells.ids, cells.partner, cells.distance, strict=True)
    }
    plateau = _adhesion_plateau(scene, configuration)
    return Evaluation(scene, energies, plateau, forces, partner)


def _adhesion_plateau(scene: Scene, configuration: Configuration) -> float:
    """The plateau of u_ad that the pairs within its range have in the unshifted convention."""
    adhesion = Terms.of(scene).pair_potentials.get("cell_cell_adhesion")
    if adhesion is None:
        return 0.0
    pairs = _pairs_within(configuration, adhesion.range * adhesion.contact)
    depth = float(-potentials.shifted_adhesion(0.0, scene.cells.adhesion_range))
    return adhesion.stiffness * depth * pairs


def _pairs_within(configuration: Configuration, cutoff: float) -> int:
    """Number of pairs of cells, all periodic images counted, but for dividing pairs."""
    cells = np.flatnonzero(configuration.is_cell)
    x = configuration.wrapped()[cells]
    lx, ly = configuration.box[:2]
    reach_x, reach_y = int(np.ceil(cutoff / lx)), int(np.ceil(cutoff / ly))
    pairs = 0
    for shift_x in range(-reach_x, reach_x + 1):
        for shift_y in range(-reach_y, reach_y + 1):
            image = x + np.array([shift_x * lx, shift_y * ly, 0.0])
            near = np.linalg.norm(x[:, None] - image[None], axis=2) < cutoff
            near[configuration.pair[cells][:, None] == cells[None] + 1] = False
            if shift_x == shift_y == 0:
                np.fill_diagonal(near, False)
            pairs += int(near.sum())
    return pairs // 2
