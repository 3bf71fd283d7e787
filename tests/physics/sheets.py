"""Membranes alone in LAMMPS, for tests of their bending."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from model_states import membrane, small_scene
from numpy_model import Floats, Ints, State, energies_and_forces, named, triangular_lattice

BIN = Path(sys.executable).parent
LATTICE = (14, 16)
K = 0.5
SKIN = ("skin/bend", f"{K}")
STOCK = ("multi/harmonic", f"{K / 2} {K} {K / 2} 0 0")

COMPUTES = """
compute energy all pe dihedral
compute atomic all pe/atom dihedral
compute stress all stress/atom NULL dihedral
compute pressure all pressure NULL dihedral
thermo_style custom step c_energy c_pressure[*]
thermo_modify norm no
dump all all custom 1 dump id fx fy fz c_atomic c_stress[*]
"""
SETTINGS = """
units lj
atom_style molecular
processors * * 1
boundary p p f
neighbor 0.3 bin
comm_modify cutoff 3.0
log none
"""


class Sheet(NamedTuple):
    """A membrane alone; the hinges are rows of `types` and of four particles."""

    box: tuple[float, float]
    positions: Floats
    hinges: Ints
    types: Ints

    def write(self, path: Path) -> None:
        """Write a data file."""
        n, types = len(self.positions), max(self.types)
        head = f"membrane\n\n{n} atoms\n{len(self.hinges)} dihedrals\n1 atom types\n"
        head += f"{types} dihedral types\n\n0 {self.box[0]:.17g} xlo xhi\n"
        head += f"0 {self.box[1]:.17g} ylo yhi\n0 40 zlo zhi\n\nMasses\n\n1 1\n\nAtoms\n\n"
        inside = self.positions.copy()
        inside[:, :2] %= self.box
        rows = [f"{i} 0 1 {x:.17g} {y:.17g} {z:.17g}" for i, (x, y, z) in enumerate(inside, 1)]
        lines = zip(self.types, self.hinges + 1, strict=True)
        rows += ["\nDihedrals\n"]
        rows += [f"{i} {t} {a} {b} {c} {d}" for i, (t, (a, b, c, d)) in enumerate(lines, 1)]
        path.write_text(head + "\n".join(rows) + "\n")


def make_sheet(shape: str) -> Sheet:
    """Return a crumpled or folded membrane."""
    scene = small_scene("bare-membrane")
    positions = membrane(scene, shape, np.random.default_rng(3))
    hinges = triangular_lattice(*LATTICE)[2]
    return Sheet(scene.box_sides[:2], positions, hinges, np.ones(len(hinges), int))


class Result(NamedTuple):
    """What LAMMPS computes: all per-atom values sorted by id."""

    energy: float
    pressure: Floats
    forces: Floats
    atomic: Floats
    stress: Floats


def evaluate(engine: Any, *style: str) -> Result:
    """Set a dihedral style and all its coefficients and evaluate it."""
    engine.command(f"dihedral_style {style[0]}")
    for number, coefficients in enumerate(style[1:], 1):
        engine.command(f"dihedral_coeff {number} {coefficients}")
    engine.command("run 0")
    return result(engine)


def result(engine: Any) -> Result:
    """Return what the last run has computed."""
    order = np.argsort(engine.numpy.extract_atom("id")[: engine.extract_global("nlocal")])
    get = engine.numpy.extract_compute
    return Result(
        float(get("energy", 0, 0)), np.array(get("pressure", 0, 1)),
        engine.numpy.extract_atom("f")[order], get("atomic", 1, 1)[order],
        get("stress", 1, 2)[order],
    )  # fmt: skip


def load(engine: Any, folder: Path, sheet: Sheet) -> None:
    """Read a membrane into LAMMPS and define the computes."""
    sheet.write(folder / "sheet.data")
    engine.command(f"read_data {folder}/sheet.data")
    engine.commands_string(COMPUTES.replace("custom 1 dump", f"custom 1 {folder}/dump"))


def assert_same(got: Result, want: Result, tolerance: float) -> None:
    """Compare all that two styles must agree in."""
    scale = np.abs(want.forces).max()
    assert got.energy == pytest.approx(want.energy, rel=tolerance, abs=0)
    np.testing.assert_allclose(got.forces, want.forces, rtol=0, atol=tolerance * scale)
    np.testing.assert_allclose(got.atomic, want.atomic, rtol=tolerance, atol=1e-15)
    scale = np.abs(want.pressure).max()
    np.testing.assert_allclose(got.pressure, want.pressure, rtol=0, atol=tolerance * scale)


def assert_same_as_numpy(got: Result, sheet: Sheet, tolerance: float, form: str = "cosine") -> None:
    """Compare energy and forces with those of the numpy model."""
    n = len(sheet.positions)
    state = State(
        np.full(n, "M"), sheet.positions, sheet.box, np.zeros(n, int), hinges=sheet.hinges
    )
    energies, forces = energies_and_forces(state, replace(named("papilla"), bending_form=form))
    assert got.energy == pytest.approx(energies["bend"], rel=tolerance, abs=0)
    scale = np.abs(forces["bend"]).max()
    np.testing.assert_allclose(got.forces, forces["bend"], rtol=0, atol=tolerance * scale)


def run_lmp(folder: Path, script: str, ranks: int = 1) -> subprocess.CompletedProcess[str]:
    """Run an input script in a folder."""
    (folder / "in").write_text(script)
    command = [BIN / "mpirun", "-np", str(ranks), BIN / "lmp", "-in", "in", "-nocite"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)
