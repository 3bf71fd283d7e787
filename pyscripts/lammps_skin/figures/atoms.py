"""Frames as text for other programs: extended XYZ for OVITO and ASE, and files for VMD."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from lammps_skin.arrays import Floats, Ints
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.frame import Frame

PROPERTIES = (
    "species:S:1:pos:R:3:id:I:1:radius:R:1:color:R:3:clone:I:1:divisions_left:I:1:parent:I:1"
)
NOWHERE = -1000.0  # z of places in a file for VMD that nothing takes in a frame
IN_THE_BOX = NOWHERE / 2


def radius_of(scene: Scene, kind: Kind) -> float:
    """R_d, R_m or R_c."""
    parts = {Kind.DERMAL: scene.dermis.radius, Kind.MEMBRANE: scene.membrane.radius}
    return float(parts.get(kind, scene.cells.radius))


def write_xyz(path: Path, scene: Scene, frames: Iterable[Frame], clones: Ints) -> None:
    """Write frames as extended XYZ.

    Parameters
    ----------
    path : Path
    scene : Scene
    frames : iterable of Frame
    clones : (s,) array of int
        Founder of the cell of each id, the first of which is 1; 0 of what is no cell.
    """
    kinds = {int(kind): kind for kind in scene.kinds}
    words = {
        number: (kind.label, radius_of(scene, kind), *kind.colour)
        for number, kind in kinds.items()
    }  # fmt: skip
    with path.open("w", encoding="ascii") as file:
        for frame in frames:
            wide, deep, high = frame.edges
            file.write(
                f'{len(frame.ids)}\nLattice="{wide:.17g} 0 0 0 {deep:.17g} 0 0 0 {high:.17g}" '
                f'pbc="T T F" Properties={PROPERTIES} Time={frame.time:.16g}\n'
            )
            state = frame.state
            rows = zip(
                frame.kinds.tolist(), frame.positions.tolist(), frame.ids.tolist(),
                clones[frame.ids - 1].tolist(), state["divisions_left"].tolist(),
                state["parent"].tolist(), strict=True,
            )  # fmt: skip
            for kind, (x, y, z), number, clone, left, parent in rows:
                label, radius, red, green, blue = words[kind]
                file.write(
                    f"{label} {x:.8g} {y:.8g} {z:.8g} {number} {radius:g} {red:g} {green:g} "
                    f"{blue:g} {clone} {left} {parent}\n"
                )


# ---- VMD, which knows trajectories of a fixed number of atoms with fixed names


class Places:
    """Places in a file that particles of one kind and one clone take, never two at a time.

    Parameters
    ----------
    frames : iterable of Frame
        All of them.
    clones : (s,) array of int
        As for `write_xyz`.

    Attributes
    ----------
    kinds, clones : (p,) arrays of int
        Of each place.
    """

    def __init__(self, frames: Iterable[Frame], clones: Ints) -> None:
        self._of_id = clones
        most: dict[tuple[int, int], int] = {}
        for frame in frames:
            groups, counts = np.unique(self._groups(frame), axis=0, return_counts=True)
            for group, count in zip(map(tuple, groups.tolist()), counts.tolist(), strict=True):
                most[group] = max(most.get(group, 0), count)
        ordered = sorted(most)
        self.kinds, self.clones = np.array(
            [group for group in ordered for _ in range(most[group])], np.int64
        ).reshape(-1, 2).T  # fmt: skip
        starts = np.cumsum([0, *(most[group] for group in ordered)])
        self._start = dict(zip(ordered, starts.tolist(), strict=False))

    def positions(self, frame: Frame) -> Floats:
        """Positions (p, 3) of what takes the places in a frame."""
        taken = np.full((len(self.kinds), 3), [0.0, 0.0, NOWHERE])
        groups = self._groups(frame)
        found, group, counts = np.unique(groups, axis=0, return_inverse=True, return_counts=True)
        starts = np.array([self._start[tuple(one)] for one in found.tolist()])
        order = np.argsort(group.ravel(), kind="stable")  # ids rise within a group
        place = np.repeat(starts - np.cumsum(counts) + counts, counts) + np.arange(len(order))
        taken[place] = frame.positions[order]
        return taken

    def _groups(self, frame: Frame) -> Ints:
        return np.column_stack([frame.kinds, self._of_id[frame.ids - 1]])


VMD_SCRIPT = """\
# Membrane, cells and dermis in VMD: vmd -e view.tcl
# A cell has a place in the file for each kind that it has been. Places that nothing takes are at
# z = {nowhere:g}; the selections leave them out, in every frame anew. The resid is the clone.
set folder [file dirname [file normalize [info script]]]
mol new [file join $folder skin.xyz] type xyz waitfor all
set file [open [file join $folder clones.dat]]
set atoms [atomselect top all]
$atoms set resid [split [string trim [read $file]]]
close $file
mol delrep 0 top
set number 0
foreach {{name radius red green blue material}} {{
{rows}
}} {{
  set atoms [atomselect top "name $name"]
  $atoms set radius $radius
  color change rgb $number $red $green $blue
  mol representation VDW 1.0 16
  mol color ColorID $number
  mol selection "name $name and z > {in_the_box:g}"
  mol material $material
  mol addrep top
  mol selupdate $number top on
  incr number
}}
# cells by clone: mol color ResID
"""


def write_vmd(folder: Path, scene: Scene, frames: Iterable[Frame], clones: Ints) -> list[Path]:
    """Write skin.xyz, the clones of its atoms, and the script that shows it.

    Parameters
    ----------
    folder : Path
    scene : Scene
    frames : sequence of Frame
        Gone through twice.
    clones : (s,) array of int
        As for `write_xyz`.
    """
    places = Places(frames, clones)
    kinds = {int(kind): kind for kind in scene.kinds}
    labels = [kinds[kind].label for kind in places.kinds.tolist()]
    paths = [folder / name for name in ("skin.xyz", "clones.dat", "view.tcl")]
    with paths[0].open("w", encoding="ascii") as file:
        for frame in frames:
            file.write(f"{len(labels)}\ntime {frame.time:.16g}\n")
            positions = places.positions(frame).tolist()
            for label, (x, y, z) in zip(labels, positions, strict=True):
                file.write(f"{label} {x:.8g} {y:.8g} {z:.8g}\n")
    paths[1].write_text("".join(f"{clone}\n" for clone in places.clones.tolist()), "ascii")
    rows = "\n".join(
        f"  {kind.label} {radius_of(scene, kind):g} {kind.colour[0]:g} {kind.colour[1]:g} "
        f"{kind.colour[2]:g} {'Transparent' if kind == Kind.DERMAL else 'Opaque'}"
        for kind in scene.kinds
        if kind in places.kinds
    )
    script = VMD_SCRIPT.format(rows=rows, nowhere=NOWHERE, in_the_box=IN_THE_BOX)
    paths[2].write_text(script, "ascii")
    return paths
