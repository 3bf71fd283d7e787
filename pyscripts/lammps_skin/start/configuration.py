"""The initial state as arrays: built from a scene, read from a text file, or edited by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from lammps_skin.arrays import Bools, Floats, Ints
from lammps_skin.errors import ConfigurationError, SceneError
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.cell_kinds import divisions_left
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import Terms
from lammps_skin.start import lattice
from lammps_skin.start.arrangements import place_cells
from lammps_skin.start.memory import check_memory
from lammps_skin.start.packing import dermal_count, pack_dermis

NEVER = -1.0  # no time of next division: none is due, or the run draws it
ROUGHNESS_STREAM = 102
MOST_DERMAL = 10_000_000
MOST_STEPS = 10**12
INTEGER = 2**31 - 1

PER_PARTICLE = ("divisions_left", "divisions_done", "parent", "pair",
                "next_division", "birth_time", "pair_start")  # fmt: skip
WHOLE = {"kinds", "links", "hinges", "divisions_left", "divisions_done", "parent", "pair"}
LIMITS = {
    "kinds": (int(Kind.DERMAL), INTEGER),
    **dict.fromkeys(("divisions_left", "divisions_done", "parent", "pair"), (0, INTEGER)),
}


@dataclass
class Configuration:
    """State of all particles at one time; particle n has id n + 1.

    Attributes
    ----------
    box : (3,) array
        L_x, L_y, L_z; the box starts at the origin, x and y are periodic.
    kinds : (n,) array of int
        `Kind` of each particle, the type numbers of the model.
    positions : (n, 3) array
    links : (l, 2) array of int
        Membrane links, 0-based.
    hinges : (h, 4) array of int
        Dihedrals of the membrane, see `lattice.links_and_hinges`.
    divisions_left, divisions_done, parent, pair : (n,) arrays of int
        State of the cells; parent and pair are ids, 0 for none.
    next_division, birth_time, pair_start : (n,) arrays
        Times; `NEVER` as next division lets the run draw a first phase from its seed.
    time : float
    """

    box: Floats
    kinds: Ints
    positions: Floats
    links: Ints
    hinges: Ints
    divisions_left: Ints = field(default_factory=lambda: np.empty(0, int))
    divisions_done: Ints = field(default_factory=lambda: np.empty(0, int))
    parent: Ints = field(default_factory=lambda: np.empty(0, int))
    pair: Ints = field(default_factory=lambda: np.empty(0, int))
    next_division: Floats = field(default_factory=lambda: np.empty(0))
    birth_time: Floats = field(default_factory=lambda: np.empty(0))
    pair_start: Floats = field(default_factory=lambda: np.empty(0))
    time: float = 0.0

    def __post_init__(self) -> None:
        n = np.size(self.kinds)
        for name in PER_PARTICLE:
            if not np.size(getattr(self, name)):
                default = NEVER if name == "next_division" else 0
                setattr(self, name, np.full(n, default, int if name in WHOLE else float))

    @property
    def is_cell(self) -> Bools:
        """Mask (n,) of the cells."""
        mask: NDArray[np.bool_] = is_cell(self.kinds)
        return mask

    @property
    def present_kinds(self) -> set[int]:
        """Numbers of the kinds that there are."""
        return set(np.unique(self.kinds).tolist())

    @classmethod
    def from_scene(cls, scene: Scene) -> Self:
        """Membrane, relaxed dermis and first cells of a scene."""
        check_sizes(scene, scene.box_sides)
        check_memory(scene)
        sheet = lattice.positions(scene.membrane.lattice, scene.spacing, scene.membrane_height)
        roughness = np.random.default_rng([scene.seed, ROUGHNESS_STREAM])
        first = place_cells(scene)
        dermis = pack_dermis(scene, sheet) if scene.dermis.present else np.empty((0, 3))
        sheet[:, 2] += scene.membrane.noise * roughness.standard_normal(len(sheet))

        places = np.concatenate([np.empty((0, 2)), *first.values()])
        above = np.full((len(places), 1), scene.membrane_height + scene.contact)
        links, hinges = lattice.links_and_hinges(scene.membrane.lattice)
        kinds = np.repeat(
            [Kind.MEMBRANE, Kind.DERMAL, *first],
            [len(sheet), len(dermis), *map(len, first.values())],
        ).astype(int)
        left = np.zeros(len(kinds), int)
        for row in scene.cell_kinds:
            left[kinds == row.kind] = divisions_left(row, scene.cell_table)
        configuration = cls(
            box=np.array(scene.box_sides),
            kinds=kinds,
            positions=np.concatenate([sheet, dermis, np.hstack([places, above])]),
            links=links,
            hinges=hinges,
            divisions_left=left,
        )
        configuration.check(scene)
        return configuration

    def check(self, scene: Scene) -> None:
        """Raise `ConfigurationError` if this is no possible state of the scene."""
        self.time = float(_array("time", self.time, (), None))
        if not 0 <= self.time <= MOST_STEPS * scene.numerics.timestep:
            raise ConfigurationError(
                f"time: is {self.time:g}, must be 0 to {MOST_STEPS * scene.numerics.timestep:g}"
            )
        self._check_arrays()
        check_sizes(scene, self.box)
        if np.abs(self.box - scene.box_sides).max() > 1e-3:
            raise ConfigurationError(
                f"box: is {np.round(self.box, 6).tolist()}, must be that of the scene, "
                f"{np.round(scene.box_sides, 6).tolist()}"
            )
        absent = self.present_kinds - set(scene.kinds)
        if absent:
            labels = {int(kind): kind.label for kind in scene.all_kinds}
            names = ", ".join(labels.get(number, str(number)) for number in sorted(absent))
            raise ConfigurationError(f"kinds: the scene has no particles of kind {names}")
        if Kind.MEMBRANE not in self.present_kinds:
            raise ConfigurationError("kinds: there is no membrane particle (2)")
        self._check_places()
        self._check_links(scene)
        self._check_cells(scene)

    def _check_arrays(self) -> None:
        """Shapes and numbers; what came as a list becomes an array."""
        n = np.size(self.kinds)
        shapes = {"box": (3,), "kinds": (n,), "positions": (n, 3), "links": (-1, 2),
                  "hinges": (-1, 4), **dict.fromkeys(PER_PARTICLE, (n,))}  # fmt: skip
        limits = {**LIMITS, "links": (0, n - 1), "hinges": (0, n - 1)}
        for name, shape in shapes.items():
            array = _array(name, getattr(self, name), shape, limits.get(name))
            setattr(self, name, array)

    def _check_places(self) -> None:
        z = self.positions[:, 2]
        outside = np.flatnonzero((z < 0) | (z >= self.box[2]))
        if len(outside):
            first = outside[0]
            raise ConfigurationError(
                f"positions: z = {z[first]:g} of particle {first} must be in [0, {self.box[2]:g})"
            )

    def _check_links(self, scene: Scene) -> None:
        """Links and hinges join membrane particles, and the length of a link is one it can have."""
        for name in ("links", "hinges"):
            if not (self.kinds[getattr(self, name)] == Kind.MEMBRANE).all():
                raise ConfigurationError(f"{name}: must join membrane particles")
            link = getattr(self, name)[:, slice(1, 3) if name == "hinges" else slice(2)]
            ends, count = np.unique(np.sort(link, axis=1), axis=0, return_counts=True)
            if (count > 1).any():
                i, j = ends[count > 1][0]
                raise ConfigurationError(f"{name}: the particles {i} and {j} have more than one")
        delta = self.positions[self.links[:, 0]] - self.positions[self.links[:, 1]]
        delta[:, :2] -= self.box[:2] * np.round(delta[:, :2] / self.box[:2])
        lengths = np.linalg.norm(delta, axis=1)
        longest = Terms(scene).longest_link
        bad = np.flatnonzero((lengths == 0) | (lengths >= longest))
        if len(bad):
            i, j = self.links[bad[0]]
            raise ConfigurationError(
                f"positions: the link of the particles {i} and {j} is {lengths[bad[0]]:g} long, "
                f"must be between 0 and {longest:g}"
            )

    def _check_cells(self, scene: Scene) -> None:
        from scipy.spatial import cKDTree

        cells = np.flatnonzero(self.is_cell)
        limited = [row.kind for row in scene.cell_kinds if row.generations is not None]
        last = {row.after_last for row in scene.cell_kinds}
        ended = [row.kind for row in scene.cell_kinds if row.label in last and not row.daughter]
        for n in cells:
            kind, m = self.kinds[n], self.divisions_left[n]
            if (kind in limited and m == 0) or (kind in ended and m > 0):
                raise ConfigurationError(
                    f"divisions_left: {m} for particle {n}, a {scene.kind(kind).label} cell"
                )
            other = self.pair[n]
            if other and not (
                other <= len(self.kinds)
                and other != n + 1
                and is_cell(self.kinds[other - 1])
                and self.pair[other - 1] == n + 1
            ):
                raise ConfigurationError(f"pair: particle {n} and id {other} are not each other's")
            if other and self.pair_start[n] != self.pair_start[other - 1]:
                raise ConfigurationError(
                    f"pair_start: {self.pair_start[n]:g} and {self.pair_start[other - 1]:g} of the "
                    f"particles {n} and {other - 1}, who are a pair, must be equal"
                )
        if len(cells) > 1:
            x = self.wrapped()[cells]
            tree = cKDTree(x, boxsize=[*self.box[:2], 2 * self.box[2]])
            for i, j in tree.query_pairs(1e-3 * scene.cells.radius):
                if self.pair[cells[i]] != cells[j] + 1:
                    apart = np.linalg.norm(x[i] - x[j])
                    raise ConfigurationError(
                        f"positions: the cells {cells[i]} and {cells[j]} overlap, {apart:g} apart"
                    )

    def wrapped(self) -> Floats:
        """Positions (n, 3) with x and y inside the box."""
        x = self.positions.copy()
        x[:, :2] %= self.box[:2]
        x[:, :2][x[:, :2] >= self.box[:2]] = 0.0
        return x

    def nearest_membrane(self) -> tuple[Ints, Floats]:
        """Index of and distance to the nearest membrane particle, each (n,), of all particles."""
        from scipy.spatial import cKDTree

        membrane = np.flatnonzero(self.kinds == Kind.MEMBRANE)
        x = self.wrapped()
        # no image in z: a period longer than twice the box keeps it open
        tree = cKDTree(x[membrane], boxsize=[*self.box[:2], 4 * self.box[2]])
        distance, index = tree.query(x)
        return membrane[index], np.asarray(distance)

    def write_data(self, path: Path, kinds: tuple[Kind, ...]) -> None:
        """LAMMPS data file with the cell state in the section ``state`` of fix property/atom."""
        n = len(self.kinds)
        ids = np.arange(1, n + 1)
        lammps_type: dict[int, int] = {kind: number for number, kind in enumerate(kinds, 1)}
        types = np.array([lammps_type[kind] for kind in self.kinds])

        with path.open("w", encoding="utf-8") as file:
            file.write("LAMMPS data file, written by lammps-skin\n\n")
            file.write(f"{n} atoms\n{len(self.links)} bonds\n{len(self.hinges)} dihedrals\n")
            file.write(f"{len(kinds)} atom types\n1 bond types\n1 dihedral types\n\n")
            for side, axis in zip(self.box, "xyz", strict=True):
                file.write(f"0 {side:.17g} {axis}lo {axis}hi\n")
            file.write("\nAtom Type Labels\n\n")
            file.writelines(f"{number} {kind.label}\n" for number, kind in enumerate(kinds, 1))
            file.write("\nMasses\n\n")
            file.writelines(f"{number} 1\n" for number in lammps_type.values())
            file.write("\nAtoms # molecular\n\n")
            atoms = np.column_stack([ids, np.zeros(n), types, self.wrapped()])
            np.savetxt(file, atoms, fmt="%d %d %d %.17g %.17g %.17g")
            if len(self.links):
                file.write("\nBonds\n\n")
                _write_topology(file, self.links)
            if len(self.hinges):
                file.write("\nDihedrals\n\n")
                _write_topology(file, self.hinges)
            if self.is_cell.any():
                file.write("\nstate\n\n")
                np.savetxt(file, self._state_rows(ids), fmt=["%d"] * 5 + ["%.17g"] * 4)

    def _state_rows(self, ids: Ints) -> Floats:
        """Rows in the order of the properties that cells.in defines."""
        never_detached = np.where(self.is_cell, NEVER, 0.0)
        return np.column_stack(
            [ids, self.divisions_left, self.divisions_done, self.parent, self.pair,
             np.where(self.is_cell, self.next_division, 0.0), self.birth_time, self.pair_start,
             never_detached]
        )  # fmt: skip


def _array(
    name: str, values: Any, shape: tuple[int, ...], limits: tuple[int, int] | None
) -> NDArray[Any]:
    """The values as an array of this shape (-1: any length), finite and within the limits."""
    whole = name in WHOLE
    try:
        array = np.asarray(values)
    except ValueError:
        array = np.empty(0, object)
    if array.dtype.kind not in ("iu" if whole else "iuf"):
        raise ConfigurationError(f"{name}: must be an array of {'whole ' if whole else ''}numbers")
    got = array.shape
    if len(got) != len(shape) or any(0 <= s != g for s, g in zip(shape, got, strict=True)):
        raise ConfigurationError(f"{name}: has shape {got}, must be {shape}".replace("-1", "n"))
    low, high = limits or (-np.inf, np.inf)
    bad = np.argwhere(~np.isfinite(array) | (array < low) | (array > high))
    if len(bad):
        index = tuple(bad[0].tolist())
        entry = f"entry {', '.join(map(str, index))} " if index else ""
        allowed = f"{low} to {high}" if limits else "finite"
        raise ConfigurationError(f"{name}: {entry}is {array[index]}, must be {allowed}")
    return array


def check_sizes(scene: Scene, box: Sequence[float] | Floats) -> None:
    """Raise `SceneError` if the box is too small for the scene's ranges, or the dermis too big."""
    ranges = Terms(scene).cutoffs
    term = max(ranges, key=lambda name: ranges[name])
    skin = scene.numerics.neighbor_skin
    if ranges[term] + 2 * skin > min(box):
        raise SceneError(
            f"box of {box[0]:.4g} x {box[1]:.4g} x {box[2]:.4g}: too small for the range "
            f"{ranges[term]:g} of {term} and two of numerics.neighbor_skin = {skin:g}"
        )
    if scene.dermis.present and not 1 <= dermal_count(scene) <= MOST_DERMAL:
        raise SceneError(
            f"dermis: radius {scene.dermis.radius:g} and volume_fraction "
            f"{scene.dermis.volume_fraction:g} give {dermal_count(scene):,} particles; "
            f"must be 1 to {MOST_DERMAL:,}"
        )


def _write_topology(file, members: Ints) -> None:  # type: ignore[no-untyped-def]
    numbers = np.arange(1, len(members) + 1)
    np.savetxt(file, np.column_stack([numbers, np.ones_like(numbers), members + 1]), fmt="%d")
