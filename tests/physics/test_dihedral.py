"""`dihedral_style skin/bend` against `multi/harmonic`, finite differences and itself."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.engine.engine import lammps_message
from sheets import (
    COMPUTES,
    SETTINGS,
    SKIN,
    STOCK,
    Sheet,
    assert_same,
    assert_same_as_numpy,
    evaluate,
    load,
    make_sheet,
    result,
    run_lmp,
)

# ---- against stock LAMMPS ----


def test_same_as_multi_harmonic(lammps: Any, tmp_path: Path, sheet: Sheet) -> None:
    """Energy, forces, pressure tensor and energies by atom are those of K/2 (1 + cos)^2."""
    load(lammps, tmp_path, sheet)
    stock = evaluate(lammps, *STOCK)
    assert stock.energy > 1
    assert np.abs(stock.forces).max() > 1
    assert np.abs(stock.pressure).min() > 1e-6
    assert_same(evaluate(lammps, *SKIN), stock, 1e-10)


def test_same_as_numpy(lammps: Any, tmp_path: Path, sheet: Sheet) -> None:
    """Energy and forces are those of the numpy model."""
    load(lammps, tmp_path, sheet)
    assert_same_as_numpy(evaluate(lammps, *SKIN), sheet, 1e-12)


def test_per_atom_sums(lammps: Any, tmp_path: Path, sheet: Sheet) -> None:
    """Energies and stresses by atom add up to the energy and the pressure."""
    load(lammps, tmp_path, sheet)
    got = evaluate(lammps, *SKIN)
    assert got.atomic.sum() == pytest.approx(got.energy, rel=1e-12)
    volume = sheet.box[0] * sheet.box[1] * 40
    scale = np.abs(got.pressure).max()
    np.testing.assert_allclose(
        got.stress.sum(axis=0) / -volume, got.pressure, rtol=0, atol=1e-12 * scale
    )


def test_several_types(lammps: Any, tmp_path: Path, sheet: Sheet) -> None:
    """Each dihedral type has its own stiffness."""
    mixed = sheet._replace(types=np.random.default_rng(1).integers(1, 4, len(sheet.hinges)))
    load(lammps, tmp_path, mixed)
    stock = evaluate(lammps, STOCK[0], ".25 .5 .25 0 0", "0 0 0 0 0", "1.1 2.2 1.1 0 0")
    assert_same(evaluate(lammps, SKIN[0], "0.5", "0", "2.2"), stock, 1e-10)


def test_numdiff(lammps: Any, tmp_path: Path, sheet: Sheet) -> None:
    """Forces are the central differences that LAMMPS itself takes of the energy."""
    load(lammps, tmp_path, sheet)
    lammps.command("fix numdiff all numdiff 1 1.0e-5")
    # nothing moves: there is no integrator, and the fix works in the steps alone
    lammps.command("dihedral_style skin/bend")
    lammps.command("dihedral_coeff * 0.5")
    lammps.command("run 1")
    got = result(lammps).forces
    order = np.argsort(lammps.numpy.extract_atom("id")[: len(got)])
    differences = lammps.numpy.extract_fix("numdiff", 1, 2)[order]
    scale = np.abs(got).max()
    assert scale > 1
    np.testing.assert_allclose(differences, got, rtol=0, atol=1e-7 * scale)


# ---- independence of how the hinges are listed, and of the ranks ----


def listed_at_random(sheet: Sheet) -> Sheet:
    """Return the sheet with shuffled hinges, half of them and half of their links reversed."""
    rng = np.random.default_rng(5)
    hinges = sheet.hinges[rng.permutation(len(sheet.hinges))]
    turned, swapped = rng.random((2, len(hinges))) < 0.5
    hinges[turned] = hinges[turned][:, ::-1]
    hinges[swapped] = hinges[swapped][:, [0, 2, 1, 3]]
    return sheet._replace(hinges=hinges)


def test_any_order_and_orientation(lammps: Any, tmp_path: Path, sheet: Sheet) -> None:
    """A hinge may be listed from either end, with its link either way round."""
    load(lammps, tmp_path, sheet)
    want = evaluate(lammps, *SKIN)
    lammps.command("clear")
    lammps.commands_string(SETTINGS)
    load(lammps, tmp_path, listed_at_random(sheet))
    assert_same(evaluate(lammps, *SKIN), want, 1e-12)


def test_drift_through_the_edges(lammps: Any, tmp_path: Path, sheet: Sheet) -> None:
    """Forces go with a sheet that drifts around the box, through many neighbor builds."""
    load(lammps, tmp_path, sheet)
    want = evaluate(lammps, *SKIN)
    lammps.commands_string("""
        atom_modify sort 10 1.0
        neigh_modify every 1 delay 0 check yes
        timestep 0.05
        fix drift all move linear 1.0 0.7 0.0
        run 250
    """)
    assert_same(result(lammps), want, 1e-10)


@pytest.mark.parametrize(
    ("shape", "many"), [("crumpled", 2), pytest.param("folded", 4, marks=pytest.mark.slow)]
)
def test_ranks(tmp_path: Path, shape: str, many: int) -> None:
    """On several ranks energy, pressure and all per-atom values are those of one."""
    listed_at_random(make_sheet(shape)).write(tmp_path / "data")
    script = SETTINGS + "read_data data\ndihedral_style skin/bend\ndihedral_coeff 1 0.5\n"
    script += COMPUTES + "dump_modify all sort id format float %.17g\n"
    script += "thermo_modify format float %.17g\nrun 0\n"
    atoms, thermo = [], []
    for ranks in (1, many):
        run = run_lmp(tmp_path, script, ranks)
        assert run.returncode == 0, run.stdout
        lines = run.stdout.splitlines()
        assert any(f"{ranks} by 1 by 1 MPI" in line or "2 by 2 by 1 MPI" in line for line in lines)
        header = next(n for n, line in enumerate(lines) if line.split()[:1] == ["Step"])
        thermo.append(np.array(lines[header + 1].split(), float))
        atoms.append(np.loadtxt(tmp_path / "dump", skiprows=9))
    assert len(atoms[0]) == 224
    for other, numbers in zip(atoms[1:], thermo[1:], strict=True):
        np.testing.assert_array_equal(other[:, 0], atoms[0][:, 0])
        scale = np.abs(atoms[0][:, 1:4]).max()
        np.testing.assert_allclose(other[:, 1:], atoms[0][:, 1:], rtol=0, atol=1e-12 * scale)
        np.testing.assert_allclose(numbers, thermo[0], rtol=1e-10, atol=0)


# ---- errors ----


@pytest.mark.parametrize(
    ("commands", "message"),
    [
        (["dihedral_coeff 1 -0.5"], "skin/bend: K = -0.5 must be a number >= 0"),
        (["dihedral_coeff 1"], "needs K and may have a form, but got 0 coefficients"),
        (["dihedral_coeff 1 0.5 cosine 1"], "needs K and may have a form, but got 3 coefficients"),
        (["dihedral_coeff 1 0.5 0.5"], "form = 0.5 must be cosine or diverging"),
        (["dihedral_coeff 1 inf"], "K = inf|instead of 'inf'"),
        (["dihedral_coeff 1 nan"], "K = nan|instead of 'nan'"),
        (["dihedral_coeff 2 0.5"], "[Nn]umeric index 2 is out of bounds"),
        (["run 0"], "Dihedral coeffs are not set"),
    ],
)
def test_refused(lammps: Any, tmp_path: Path, commands: list[str], message: str) -> None:
    """A wrong coefficient is refused by an error that names it."""
    load(lammps, tmp_path, make_sheet("crumpled"))
    lammps.command("dihedral_style skin/bend")
    with pytest.raises(Exception, match=message):
        for command in commands:
            lammps.command(command)


def test_hinge_given_twice_is_refused(lammps: Any, tmp_path: Path) -> None:
    """A link of two triangles is one hinge, listed once."""
    sheet = make_sheet("crumpled")
    hinges = np.vstack([sheet.hinges, sheet.hinges[7]])
    load(lammps, tmp_path, sheet._replace(hinges=hinges, types=np.append(sheet.types, 1)))
    with pytest.raises(Exception, match="two dihedrals for one link of the triangle of atoms"):
        evaluate(lammps, *SKIN)


def test_free_edges(lammps: Any, tmp_path: Path, sheet: Sheet) -> None:
    """Links without a hinge, as at an edge of the membrane, do not bend."""
    kept = np.random.default_rng(2).random(len(sheet.hinges)) < 0.7
    torn = sheet._replace(hinges=sheet.hinges[kept], types=sheet.types[kept])
    load(lammps, tmp_path, torn)
    got = evaluate(lammps, *SKIN)
    assert_same_as_numpy(got, torn, 1e-12)
    assert_same(got, evaluate(lammps, *STOCK), 1e-10)


def test_newton_off_is_refused(lammps: Any, tmp_path: Path) -> None:
    """Each hinge must be computed by one rank."""
    lammps.command("newton on off")
    load(lammps, tmp_path, make_sheet("crumpled"))
    with pytest.raises(Exception, match="skin/bend needs newton on for bonds"):
        evaluate(lammps, *SKIN)


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_degenerate_triangle(tmp_path: Path, ranks: int) -> None:
    """Three particles on a line have no normal: the error names them and the step."""
    sheet = make_sheet("crumpled")
    corners = flatten(sheet, 0.0)
    sheet.write(tmp_path / "data")
    script = SETTINGS.replace("log none", "log log") + "read_data data\n"
    script += "dihedral_style skin/bend\ndihedral_coeff 1 0.5\nrun 0\n"
    run = run_lmp(tmp_path, script, ranks)
    assert run.returncode != 0
    log = (tmp_path / "log").read_text().splitlines()
    error = lammps_message(next(line for line in log if "ERROR" in line))
    assert error.startswith("Dihedral skin/bend: the triangle of atoms ")
    assert {int(word) - 1 for word in error.split()[6:9]} == corners
    assert error.endswith(
        "has no normal on step 0: its area is below 5e-11; the state that this run began with is "
        "like that"
    )


def flatten(sheet: Sheet, height: float) -> set[int]:
    """Put a corner of a triangle at a height above the middle of its link; return the corners."""
    corner, i, j, _ = sheet.hinges[100]
    sheet.positions[corner] = (sheet.positions[i] + sheet.positions[j]) / 2 + (0, 0, height)
    return {int(corner), int(i), int(j)}


@pytest.mark.parametrize("height", [1e-2, 1e-4, 1e-7])
def test_sliver(lammps: Any, tmp_path: Path, height: float) -> None:
    """Of a triangle that is not quite degenerate the forces are exact, however large.

    A normal is known to the rounding of its triangle's edges over the triangle's height.
    """
    sheet = make_sheet("crumpled")
    flatten(sheet, height)
    load(lammps, tmp_path, sheet)
    got = evaluate(lammps, *SKIN)
    assert np.abs(got.forces).max() > 1 / height
    assert_same_as_numpy(got, sheet, max(1e-12, np.finfo(float).eps / height))


# ---- files ----


def test_coefficients_survive_files(lammps: Any, tmp_path: Path) -> None:
    """Data and restart files keep the coefficients of all types to the last digit."""
    sheet = make_sheet("folded")
    types = np.random.default_rng(1).integers(1, 3, len(sheet.hinges))
    load(lammps, tmp_path, sheet._replace(types=types))
    third, tenth = 1 / 3, 0.1
    want = evaluate(lammps, SKIN[0], f"{third:.17g}", f"{tenth:.17g} diverging")
    lammps.command(f"write_data {tmp_path}/written.data")
    lammps.command(f"write_restart {tmp_path}/written.restart")
    text = (tmp_path / "written.data").read_text().splitlines()
    start = text.index("Dihedral Coeffs # skin/bend")
    written = [line.split() for line in text[start + 2 : start + 4]]
    assert [(int(number), float(k), form) for number, k, form in written] == [
        (1, third, "cosine"), (2, tenth, "diverging"),
    ]  # fmt: skip

    for read in (
        f"read_restart {tmp_path}/written.restart",
        f"dihedral_style skin/bend\nread_data {tmp_path}/written.data",
    ):
        lammps.command("clear")
        lammps.commands_string(SETTINGS + read)
        lammps.commands_string(COMPUTES.replace("custom 1 dump", f"custom 1 {tmp_path}/dump"))
        lammps.command("run 0")
        assert_same(result(lammps), want, 1e-12)
