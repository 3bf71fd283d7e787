"""How many particles there are when a run begins."""

from __future__ import annotations

from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.start.configuration import Configuration
from lammps_skin.start.memory import particle_counts


def first_counts(scene: Scene) -> dict[Kind, int]:
    """Numbers of particles by kind; of a scene that begins with the state of a run, those of it."""
    if scene.start.run is not None:
        kinds = Configuration.from_scene(scene).kinds
        return {kind: int((kinds == kind).sum()) for kind in scene.all_kinds}
    membrane, dermal, _ = particle_counts(scene)
    cells = {row.kind: row.count for row in scene.cell_table.values()}
    return {Kind.DERMAL: dermal, Kind.MEMBRANE: membrane, **cells}
