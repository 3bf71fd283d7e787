"""The state of another run, from which a run begins: where it is, and what else belongs to it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lammps_skin.arrays import Ints
from lammps_skin.errors import ConfigurationError, SceneError
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import shown, value_of
from lammps_skin.start import lattice
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.frame import ABSENT, Frame
from lammps_skin.trajectory.frames import nearest_frame, open_frames
from lammps_skin.trajectory.store import Store

SAME_TIME = 1e-9  # differences of times that are rounding, of the time or in time units
HASHED = 16  # digits of the hash of a state
TOLD = ("lammps", "lammps-skin", "plugin", "commit")


@dataclass(frozen=True)
class Origin:
    """What a state came from.

    Attributes
    ----------
    run : Path
        Run directory or trajectory.
    time : float
    content : str
        Hash of the state.
    versions : str
        Of what made the run, as far as its trajectory names them.
    scene : Scene
        That of the run.
    """

    run: Path
    time: float
    content: str
    versions: str
    scene: Scene

    @property
    def directory(self) -> Path:
        """Directory of the run."""
        return self.run if self.run.is_dir() else self.run.parent

    def __str__(self) -> str:
        return f"{self.run} at t = {self.time:.10g}"

    def numbered_in(self, scene: Scene, kinds: Ints) -> Ints:
        """Kinds (n,) of the state by the numbers that another scene gives to their labels."""
        numbers = {kind.label: int(kind) for kind in scene.kinds}
        found = kinds.copy()
        for number in np.unique(kinds):
            label = self.scene.kind(int(number)).label
            if label not in numbers:
                own = {"stem": "cells.stem", "nd": "cells.nd", "dermal": "dermis.present"}
                key = own.get(label, f"cells.kinds.{label}.count")
                raise ConfigurationError(
                    f"kinds: the scene has no particles of kind {label}, which the state has; give "
                    f"it some with {key}"
                )
            found[kinds == number] = numbers[label]
        return found

    def check_fit(self, scene: Scene, kinds: set[int]) -> None:
        """Raise `SceneError` unless a state of these kinds has lattice and radii of a scene.

        Parameters
        ----------
        scene : Scene
        kinds : set of int
            Numbers of the kinds in the state.
        """
        keys = ["membrane.lattice", "membrane.radius", "membrane.spacing_ratio", "box_height"]
        if Kind.DERMAL in kinds:
            keys.append("dermis.radius")
        if any(map(is_cell, kinds)):
            keys.append("cells.radius")
        for key in keys:
            mine, theirs = value_of(scene, key), value_of(self.scene, key)
            if mine != theirs:
                raise SceneError(
                    f"{key} = {shown(mine)}: must be {shown(theirs)}, that of the run {self.run} "
                    "from which the scene begins"
                )


def frame_of(run: str | Path, time: float | None) -> tuple[Frame, Ints, Ints, Origin]:
    """A frame of a run, the links and hinges of its membrane, and where they came from.

    Parameters
    ----------
    run : path
        Run directory, or the trajectory in it.
    time : float or None
        Of a frame; None takes the last one.

    Returns
    -------
    frame : Frame
    links : (l, 2) array of int
        Indices of the particles of the frame, in the order in which a scene is built.
    hinges : (h, 4) array of int
    origin : Origin

    Raises
    ------
    SceneError
        If there is no such run or frame, or its membrane is not the lattice of its scene.
    SkinError
        If its trajectory cannot be read.
    """
    trajectory = _opened(Path(run))
    frame = trajectory[_place(trajectory, run, time)]
    if frame.next_id == ABSENT:
        raise SceneError(
            f"start.from = {str(run)!r}: its trajectory is of an older version, which did not keep "
            "all of the state of cells; run it again"
        )
    nx, ny = trajectory.scene.membrane.lattice
    members = np.flatnonzero(frame.kinds == Kind.MEMBRANE)
    links, hinges = lattice.links_and_hinges((nx, ny))
    if len(members) != nx * ny or not _same(frame.ids[members[links]], trajectory.links):
        raise SceneError(
            f"start.from = {str(run)!r}: its membrane is not the lattice [{nx}, {ny}] of its scene"
        )
    told = trajectory.versions if isinstance(trajectory, Store) else {}
    origin = Origin(
        run=Path(run).absolute(),
        time=frame.time,
        content=_hash(frame),
        versions=", ".join(f"{name} {told[name]}" for name in TOLD if name in told),
        scene=trajectory.scene,
    )
    return frame, members[links], members[hinges], origin


def _opened(run: Path) -> Store | Dump:
    if not (run.is_dir() or run.is_file()):  # nor a pipe, which may never end
        raise SceneError(f"start.from = {str(run)!r}: there is no such run directory or trajectory")
    return open_frames(run)


def _place(trajectory: Store | Dump, run: str | Path, time: float | None) -> int:
    """Number of the frame of a time."""
    n, times = nearest_frame(trajectory, time), np.asarray(trajectory.times, float)
    if time is None or np.isclose(times[n], time, rtol=SAME_TIME, atol=SAME_TIME):
        return n
    below, above = times[times < time], times[times > time]
    near = [f"{t:.10g}" for t in (*below[-1:], *above[:1])]
    raise SceneError(
        f"start.time = {time:.10g}: {run} has no frame of this time; the nearest "
        f"{'are' if near[1:] else 'is'} at {' and '.join(near)}"
    )


def _same(links: Ints, others: Ints) -> bool:
    """Whether they join the same particles, in whatever order."""
    ours, theirs = (np.unique(np.sort(pairs, axis=1), axis=0) for pairs in (links, others))
    return np.array_equal(ours, theirs)


def _hash(frame: Frame) -> str:
    """Hash of all that a run which begins with the frame depends on."""
    digest = hashlib.sha256(f"{frame.time!r} {frame.next_id}".encode())
    for values in (frame.edges, frame.ids, frame.kinds, frame.positions, *frame.state.values()):
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()[:HASHED]
