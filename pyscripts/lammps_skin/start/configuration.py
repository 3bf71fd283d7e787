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
from lammps_skin.start.data_file import write_data_file
from lammps_skin.start.memory import check_memory
from lammps_skin.start.origin import Origin, frame_of
from lammps_skin.start.packing import dermal_count, pack_dermis
from lammps_skin.start.sheet import membrane_at_start, places_above

NEVER = -1.0  # no time of next division: none is due, or the run draws it
ROUGHNESS_STREAM = 102
MOST_DERMAL = 10_000_000
MOST_STEPS = 10**12
INTEGER = 2**31 - 1

PER_PARTICLE = ("divisions_left", "divisions_done", "parent", "pair",
                "next_division", "birth_time", "pair_start", "detached_time")  # fmt: skip
WHOLE = {"kinds", "ids", "links", "hinges", "divisions_left", "divisions_done", "parent", "pair"}
LIMITS = {
    "kinds": (int(Kind.DERMAL), INTEGER),
    "ids": (1, INTEGER),
    **dict.fromkeys(("divisions_left", "divisions_done", "parent", "pair"), (0, INTEGER)),
}


@dataclass
class Configuration:
    """State of all particles at one time.

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
    next_division, birth_time, pair_start, detached_time : (n,) arrays
        Times; `NEVER` as next division lets the run draw a first phase from its seed, and as
        detached time is that of a cell that is not detached.
    time : float
    ids : (n,) array of int
        Rising; n + 1 of particle n if not given.
    next_id : int
        The next newborn gets this ID, or the first after those of the particles if that is more.
    origin : Origin, optional
        The run that the state is of.
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
    detached_time: Floats = field(default_factory=lambda: np.empty(0))
    time: float = 0.0
    ids: Ints = field(default_factory=lambda: np.empty(0, int))
    next_id: int = 1
    origin: Origin | None = None

    def __post_init__(self) -> None:
        n = np.size(self.kinds)
        if not np.size(self.ids):
            self.ids = np.arange(1, n + 1)
        for name in PER_PARTICLE:
            if not np.size(getattr(self, name)):
                default = NEVER if name in ("next_division", "detached_time") else 0
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
    def from_scene(cls, scene: Scene, heights: Floats | None = None) -> Self:
        """The state with which a scene begins.

        Membrane, relaxed dermis and first cells, or the state of the run in `start.from`.

        Parameters
        ----------
        scene : Scene
        heights : (rows, columns) array, optional
            Of the membrane, instead of those in the file `membrane.heights`; see
            `sheet.membrane_at_start`.
        """
        if scene.start.run is not None:
            if heights is not None:
                raise SceneError("heights: are those of the run in start.from, and not to be given")
            return cls._continued(scene)
        check_sizes(scene, scene.box_sides)
        check_memory(scene)
        sheet = membrane_at_start(scene, heights)
        roughness = np.random.default_rng([scene.seed, ROUGHNESS_STREAM])
        first = place_cells(scene)
        dermis = pack_dermis(scene, sheet) if scene.dermis.present else np.empty((0, 3))
        places = np.concatenate([np.empty((0, 2)), *first.values()])
        cells = places_above(scene, sheet, places)
        sheet[:, 2] += scene.membrane.noise * roughness.standard_normal(len(sheet))
        top = scene.box_sides[2]
        outside = sheet[(sheet[:, 2] < 0) | (sheet[:, 2] >= top)]
        if len(outside):
            raise SceneError(
                f"membrane.noise = {scene.membrane.noise:g}: puts a particle at z = "
                f"{outside[0, 2]:g}, which must be in [0, {top:g})"
            )

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
            positions=np.concatenate([sheet, dermis, cells]),
            links=links,
            hinges=hinges,
            divisions_left=left,
        )
        configuration.check(scene)
        return configuration

    @classmethod
    def from_run(
        cls, run: str | Path, time: float | None = None, scene: Scene | None = None
    ) -> Self:
        """The state of a run at the time of a frame, the last one if none is given.

        Parameters
        ----------
        run : path
            Run directory, or the trajectory in it.
        time : float, optional
        scene : Scene, optional
            Whose numbers the kinds get, by their labels; those of the run's scene if not given.

        Raises
        ------
        ConfigurationError
            If the scene lacks a kind.
        SceneError
            If there is no such run or frame.
        SkinError
            If its trajectory cannot be read.
        """
        frame, links, hinges, origin = frame_of(run, time)
        cells = is_cell(frame.kinds)
        kinds = frame.kinds if scene is None else origin.numbered_in(scene, frame.kinds)
        never = {"next_division": NEVER, "detached_time": NEVER}
        return cls(
            box=frame.edges,
            kinds=kinds,
            positions=frame.positions,
            links=links,
            hinges=hinges,
            time=frame.time,
            ids=frame.ids,
            next_id=frame.next_id,
            origin=origin,
            **{
                name: np.where(cells, frame.state[name], never.get(name, 0))
                for name in PER_PARTICLE
            },
        )

    @classmethod
    def _continued(cls, scene: Scene) -> Self:
        """The state of the run from which a scene begins."""
        assert scene.start.run is not None
        found = cls.from_run(scene.start.run, scene.start.time, scene)
        assert found.origin
        if scene.start.content not in (None, found.origin.content):
            raise SceneError(
                f"start.content = {scene.start.content!r}: the state of {found.origin} is another, "
                f"{found.origin.content!r}; leave start.content out to begin with that"
            )
        if scene.end_time <= found.time:
            raise SceneError(
                f"end_time = {scene.end_time:g}: must be after {found.time:.10g}, the time of the "
                f"state of {found.origin.run} from which the scene begins"
            )
        found.check(scene)
        return found

    def described(self, scene: Scene) -> Scene:
        """The scene, with keys that tell of the run that this state is of, if it is of one."""
        if self.origin is None:
            return scene
        keys = {
            "start.from": str(self.origin.run),
            "start.time": self.time,
            "start.content": self.origin.content,
            "start.versions": self.origin.versions,
        }
        return scene.replace(**keys)

    def check(self, scene: Scene) -> None:
        """Raise `ConfigurationError` if this is no possible state of the scene."""
        self.time = float(_array("time", self.time, (), None))
        if not 0 <= self.time <= MOST_STEPS * scene.numerics.timestep:
            raise ConfigurationError(
                f"time: is {self.time:g}, must be 0 to {MOST_STEPS * scene.numerics.timestep:g}"
            )
        self._check_arrays()
        if self.origin:
            self.origin.check_fit(scene, self.present_kinds)
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
        shapes = {"box": (3,), "kinds": (n,), "ids": (n,), "positions": (n, 3), "links": (-1, 2),
                  "hinges": (-1, 4), **dict.fromkeys(PER_PARTICLE, (n,))}  # fmt: skip
        limits = {**LIMITS, "links": (0, n - 1), "hinges": (0, n - 1)}
        for name, shape in shapes.items():
            array = _array(name, getattr(self, name), shape, limits.get(name))
            setattr(self, name, array)
        falling = np.flatnonzero(np.diff(self.ids) < 1)
        if len(falling):
            raise ConfigurationError(
                f"ids: {self.ids[falling[0] + 1]} comes after {self.ids[falling[0]]}, must rise"
            )
        if not 1 <= self.next_id <= INTEGER:
            raise ConfigurationError(f"next_id: is {self.next_id}, must be 1 to {INTEGER}")

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
        longest = Terms.of(scene).longest_link
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
            if not self.pair[n]:
                continue
            other = min(int(np.searchsorted(self.ids, self.pair[n])), len(self.ids) - 1)
            if not (
                self.ids[other] == self.pair[n]
                and other != n
                and is_cell(self.kinds[other])
                and self.pair[other] == self.ids[n]
            ):
                raise ConfigurationError(
                    f"pair: particle {n} and id {self.pair[n]} are not each other's"
                )
            if self.pair_start[n] != self.pair_start[other]:
                raise ConfigurationError(
                    f"pair_start: {self.pair_start[n]:g} and {self.pair_start[other]:g} of the "
                    f"particles {n} and {other}, who are a pair, must be equal"
                )
        if len(cells) > 1:
            x = self.wrapped()[cells]
            tree = cKDTree(x, boxsize=[*self.box[:2], 2 * self.box[2]])
            for i, j in tree.query_pairs(1e-3 * scene.cells.radius):
                if self.pair[cells[i]] != self.ids[cells[j]]:
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
        """LAMMPS data file with the cell state in the section ``state`` of fix property/atom.

        Its rows are in the order of the properties that state.in defines, zeros for what is no
        cell.
        """
        lammps_type = {int(kind): number for number, kind in enumerate(kinds, 1)}
        types = np.array([lammps_type[kind] for kind in self.kinds])
        state = np.column_stack([getattr(self, name) for name in PER_PARTICLE])
        write_data_file(
            path, [kind.label for kind in kinds], self.box, self.ids, types, self.wrapped(),
            self.ids[self.links], self.ids[self.hinges],
            np.where(self.is_cell[:, None], state, 0.0) if any(map(is_cell, kinds)) else None,
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
    ranges = Terms.of(scene).cutoffs
    term = max(ranges, key=lambda name: ranges[name])
    skin = scene.numerics.neighbor_skin
    if ranges[term] + 2 * skin > min(box):
        raise SceneError(
            f"box of {box[0]:.4g} x {box[1]:.4g} x {box[2]:.4g}: too small for the range "
            f"{ranges[term]:g} of {term} and two of numerics.neighbor_skin = {skin:g}"
        )
    if scene.dermis.present and not 1 <= dermal_count(scene) <= MOST_DERMAL:
        dermis = scene.dermis
        how = f"volume_fraction {dermis.volume_fraction:g}"
        how = "cubic packing" if dermis.packing == "cubic" else how
        raise SceneError(
            f"dermis: radius {dermis.radius:g} and {how} give {dermal_count(scene):,} particles; "
            f"must be 1 to {MOST_DERMAL:,}"
        )
