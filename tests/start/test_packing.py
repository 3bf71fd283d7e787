"""The dermis that a scene starts with: relaxed, whole, and as random as its seed."""

import numpy as np
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration

RELAXED = 0.02  # largest component of a force, docs/scene.md


def test_spheres_are_relaxed():
    """No component of a force on a sphere is above what the page states."""
    scene = Scene.load("one-stem").replace(**{"membrane.lattice": [16, 18], "cells.stem": 0})
    start = Configuration.from_scene(scene)
    with Simulation.begin(scene, configuration=start) as simulation:
        particles = simulation.forces()
    forces = particles.forces[particles.types == Kind.DERMAL]
    assert len(forces) > 50
    assert 0 < np.abs(forces).max() < 1.01 * RELAXED
