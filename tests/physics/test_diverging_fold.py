"""The form `diverging` of dihedral_style skin/bend: K (1/(1 + c) - 1/2) beyond a right angle."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.model import potentials
from numpy_model import State, energies_and_forces, named
from sheets import (
    COMPUTES,
    SETTINGS,
    Sheet,
    assert_same,
    assert_same_as_numpy,
    evaluate,
    load,
    make_sheet,
    result,
    run_lmp,
)

DIVERGING = ("skin/bend", "0.5 diverging")


@pytest.fixture
def folded() -> Sheet:
    """A membrane with folds on both sides of a right angle."""
    sheet = make_sheet("crumpled")
    positions = sheet.positions.copy()
    positions[:, 2] = 10 + 6 * (positions[:, 2] - positions[:, 2].mean())
    return sheet._replace(positions=positions)


def test_same_as_numpy(lammps: Any, tmp_path: Path, folded: Sheet) -> None:
    load(lammps, tmp_path, folded)
    cosine = evaluate(lammps, "skin/bend", "0.5 cosine")
    got = evaluate(lammps, *DIVERGING)
    assert got.energy > 1.05 * cosine.energy
    assert_same_as_numpy(got, folded, 1e-12, "diverging")
    assert got.atomic.sum() == pytest.approx(got.energy, rel=1e-12)


def test_forces_are_minus_the_gradient(lammps: Any, tmp_path: Path, folded: Sheet) -> None:
    """As LAMMPS differentiates the energy, in boxes of other sizes too: the virial."""
    load(lammps, tmp_path, folded)
    lammps.commands_string("dihedral_style skin/bend\ndihedral_coeff 1 0.5 diverging")
    lammps.commands_string("fix numdiff all numdiff 1 1.0e-5\nrun 1")
    got = result(lammps)
    order = np.argsort(lammps.numpy.extract_atom("id")[: len(got.forces)])
    differences = lammps.numpy.extract_fix("numdiff", 1, 2)[order]
    scale = np.abs(got.forces).max()
    np.testing.assert_allclose(differences, got.forces, rtol=0, atol=1e-6 * scale)
    lammps.command("unfix numdiff")
    energies = []
    for factor in (1 + 1e-6, (1 - 1e-6) / (1 + 1e-6)):
        lammps.commands_string(f"change_box all x scale {factor:.17g} remap\nrun 0")
        energies.append(result(lammps).energy)
    pressure = (energies[1] - energies[0]) / 2e-6 / (folded.box[0] * folded.box[1] * 40)
    assert pressure == pytest.approx(got.pressure[0], rel=1e-4)


def hinge(degrees: float) -> Sheet:
    """Two triangles that are folded against each other."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    positions = np.array([(1.0, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, -0.5, 0.0), (-c, 0.0, s)])
    positions += np.array((4.0, 4.0, 10.0))
    return Sheet((9.0, 9.0), positions, np.array([(0, 1, 2, 3)]), np.array([1]))


def test_a_closed_fold_has_no_end_of_energy(lammps: Any, tmp_path: Path) -> None:
    """Two triangles and nothing else: K/(1 + cos) - K/2 of the angle, and K/2 (1 - cos)^2."""
    for degrees in (60.0, 89.999, 90.001, 120.0, 175.0):
        c = np.cos(np.radians(degrees))
        load(lammps, tmp_path, hinge(degrees))
        want = 0.5 * ((1 - c) ** 2 / 2 if c > 0 else 1 / (1 + c) - 0.5)
        assert evaluate(lammps, *DIVERGING).energy == pytest.approx(want, rel=1e-9)
        assert 0.5 * potentials.bending(c, "diverging") == pytest.approx(want, rel=1e-12)
        lammps.command("clear")
        lammps.commands_string(SETTINGS)


@pytest.mark.parametrize("form", ["cosine", "diverging"])
@pytest.mark.parametrize("degrees", [20.0, 85.0, 95.0, 130.0, 170.0])
def test_mobilities_know_the_stiffness(
    degrees: float, form: str, lammps: Any, tmp_path: Path
) -> None:
    """The bound of fix skin/motion is above the largest second derivative, and not far above."""
    sheet, limit, h = hinge(degrees), 1e-4, 1e-5
    load(lammps, tmp_path, sheet)
    lammps.commands_string("mass 1 1.0\ndihedral_style skin/bend\ntimestep 1e-9")
    lammps.commands_string(f"dihedral_coeff 1 0.5 {form}\nneigh_modify every 1 delay 0 check yes")
    lammps.commands_string(f"fix motion all skin/motion euler stiffness {limit}\nrun 1")
    bound = limit / lammps.extract_fix("motion", 0, 1, 4, 0)

    parameters = replace(named("papilla"), bending_form=form)
    rows = []
    for shift in h * np.eye(12).reshape(12, 4, 3):
        forces = [
            energies_and_forces(
                State(np.full(4, "M"), sheet.positions + sign * shift, sheet.box,
                      np.zeros(4, int), hinges=sheet.hinges), parameters
            )[1]["bend"].ravel()
            for sign in (1, -1)
        ]  # fmt: skip
        rows.append(-(forces[0] - forces[1]) / (2 * h))
    largest = np.abs(np.linalg.eigvalsh((np.array(rows) + np.array(rows).T) / 2)).max()
    assert largest < bound < 8 * largest


def test_each_type_has_its_form(lammps: Any, tmp_path: Path, folded: Sheet) -> None:
    """With K = 0 for one of two types at a time energies add up to those of both."""
    types = np.random.default_rng(1).integers(1, 3, len(folded.hinges))
    load(lammps, tmp_path, folded._replace(types=types))
    both = evaluate(lammps, "skin/bend", "0.5", "0.5 diverging")
    one = evaluate(lammps, "skin/bend", "0.5", "0")
    other = evaluate(lammps, "skin/bend", "0 diverging", "0.5 diverging")
    np.testing.assert_allclose(one.forces + other.forces, both.forces, atol=1e-10)
    assert one.energy + other.energy == pytest.approx(both.energy, rel=1e-12)


def test_free_edges_and_adapted_stiffness(lammps: Any, tmp_path: Path, folded: Sheet) -> None:
    kept = np.random.default_rng(2).random(len(folded.hinges)) < 0.7
    torn = folded._replace(hinges=folded.hinges[kept], types=folded.types[kept])
    load(lammps, tmp_path, torn)
    got = evaluate(lammps, *DIVERGING)
    assert_same_as_numpy(got, torn, 1e-12, "diverging")
    lammps.commands_string("variable k equal 1.5\nfix a all adapt 1 dihedral skin/bend K 1 v_k")
    lammps.command("run 0")
    assert result(lammps).energy == pytest.approx(3 * got.energy, rel=1e-12)


def test_ranks(lammps: Any, tmp_path: Path, folded: Sheet) -> None:
    load(lammps, tmp_path, folded)
    want = evaluate(lammps, *DIVERGING)
    script = SETTINGS + "read_data sheet.data\ndihedral_style skin/bend\n" + COMPUTES
    script += "dihedral_coeff 1 0.5 diverging\ndump_modify all sort id format float %.17g\nrun 0\n"
    run = run_lmp(tmp_path, script, 2)
    assert run.returncode == 0, run.stdout
    forces = np.loadtxt(tmp_path / "dump", skiprows=9)[:, 1:4]
    np.testing.assert_allclose(forces, want.forces, atol=1e-11 * np.abs(want.forces).max())
    assert_same(want, want._replace(forces=forces), 1e-11)
