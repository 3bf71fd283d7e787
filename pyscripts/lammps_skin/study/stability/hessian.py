"""Largest eigenvalue of the second derivatives of the energy, from forces of LAMMPS."""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from lammps_skin.arrays import Floats
from lammps_skin.errors import SimulationError
from lammps_skin.run.simulation import Simulation

SHIFT = 1e-6  # length of the displacement, of all particles together, between two forces
PRECISION = 1e-2  # relative, of the eigenvalue
PRODUCTS = 100  # restarts of the iteration
PUSH = 1.0  # force with which mobilities are measured


def largest_eigenvalue(simulation: Simulation, mobility: Floats) -> float:
    """Largest eigenvalue of M H by Lanczos iteration; the simulation stays where it is.

    M is the diagonal matrix of mobilities and H are the second derivatives of the energy, so
    that M H and its symmetric form M^1/2 H M^1/2 have the same eigenvalues. Products with H are
    differences of forces. Explicit methods are stable below a multiple of its reciprocal.

    Parameters
    ----------
    simulation : Simulation
    mobility : (n,) array
        By id.

    Returns
    -------
    float
        0 where the energy is flat or has downward curvature alone.

    Raises
    ------
    SimulationError
        If the iteration does not converge.
    """
    particles = simulation.forces()
    ids, x = particles.ids, particles.positions
    root = np.sqrt(mobility)[:, None]

    def forces(displaced: Floats) -> Floats:
        simulation.move(ids, displaced)
        return np.asarray(simulation.forces().forces)

    def product(vector: Floats) -> Floats:
        shift = SHIFT / max(float(np.linalg.norm(vector)), 1e-300) * vector.reshape(-1, 3) * root
        change = forces(x - shift) - forces(x + shift)
        return np.asarray(np.linalg.norm(vector) / (2 * SHIFT) * root * change).ravel()

    size = x.size
    operator = LinearOperator((size, size), matvec=product, dtype=float)
    begin = np.random.default_rng(1).standard_normal(size)
    try:
        found = eigsh(
            operator, k=1, which="LA", v0=begin, tol=PRECISION, maxiter=PRODUCTS,
            return_eigenvectors=False,
        )  # fmt: skip
    except ArpackNoConvergence:
        raise SimulationError("the iteration for the largest eigenvalue does not end") from None
    finally:
        simulation.move(ids, x)
    return max(float(found[0]), 0.0)


def mobilities(simulation: Simulation) -> Floats:
    """Mobility (n,) of every particle by id, from one forward Euler step under a known force.

    The simulation has to be one of forward Euler, without events; it stays where it is.
    """
    before = simulation.forces()
    simulation.command(f"fix push all addforce {PUSH} {PUSH} {PUSH}")
    simulation.command("run 0 post no")
    force = simulation.forces().forces
    simulation.command("run 1 pre no post no")
    moved = simulation.forces().positions - before.positions
    sides = np.array(simulation.scene.box_sides[:2])
    moved[:, :2] -= sides * np.round(moved[:, :2] / sides)
    timestep = simulation.timestep
    simulation.command("unfix push")
    simulation.move(before.ids, before.positions)
    along = (moved * force).sum(axis=1) / (timestep * (force**2).sum(axis=1))
    return np.clip(along, 0.0, 1.0)
