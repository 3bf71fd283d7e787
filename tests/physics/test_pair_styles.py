"""The pair styles of the plugin: against the numpy model, stock styles, and their own energies."""

import re
import struct
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.engine.engine import open_lammps
from lammps_skin.run.simulation import Simulation
from model_states import SCENES, TERMS, alone, assert_forces, expected, prepared
from numpy_model import Floats
from test_forces import ANALYTIC, CASES, FULL, SHAPES, difference_quotients

from tests.reliability.conftest import run_script, try_script

SKIN = {"numerics.pair_form": "skin"}
PAIRS = (
    "dermis_dermis", "dermis_membrane", "membrane_exclusion", "cell_membrane_exclusion",
    "cell_cell_exclusion", "cell_cell_adhesion",
)  # fmt: skip


# ---- the terms of the model


@pytest.mark.parametrize(
    ("name", "shape", "ranks"),
    [
        *product(SCENES, SHAPES, (1,)),
        (FULL, "crumpled", 2),
        pytest.param(FULL, "folded", 4, marks=pytest.mark.slow),
    ],
)
def test_scene(name: str, shape: str, ranks: int) -> None:
    """Energies by term and forces on every particle of every kind of scene."""
    case = prepared(name, "papilla", shape)
    want = expected(case.scene, case.state)
    scene = case.scene.replace(**SKIN)
    with Simulation.begin(scene, configuration=case.configuration, ranks=ranks) as simulation:
        energies, forces = simulation.energies(), simulation.forces()
    for term in TERMS:
        if term != "stretch":
            assert energies[term] == pytest.approx(want.energies[term], rel=ANALYTIC, abs=0), term
    total = np.sum(list(want.forces.values()), axis=0)
    gross = np.sum(list(want.gross.values()), axis=0)
    assert_forces(forces.forces, total, ANALYTIC * gross)


@pytest.mark.parametrize(("shape", "parameters"), CASES)
@pytest.mark.parametrize("term", PAIRS)
def test_term_alone(term: str, shape: str, parameters: str) -> None:
    """Energy and forces are the numpy model's, and the forces are minus the energy's gradient."""
    case = prepared(FULL, parameters, shape)
    want = expected(case.scene, case.state)
    scene = alone(case.scene, term).replace(**SKIN)
    with Simulation.begin(scene, configuration=case.configuration) as simulation:
        energy, forces = simulation.energies()[term], simulation.forces().forces
        slopes = np.array(list(difference_quotients(simulation, term)))
    assert energy == pytest.approx(want.energies[term], rel=ANALYTIC, abs=0)
    assert_forces(forces, want.forces[term], ANALYTIC * want.gross[term])
    assert np.abs(forces.sum(axis=0)).max() < 1e-10 < np.abs(forces).max()
    force, quotient, size = slopes.T
    np.testing.assert_array_less(np.abs(quotient - force), 1e-5 * size)


# ---- any types against lj/cut

TYPES, SIDE, SKIN_DISTANCE = 4, 7.0, 0.3
# pairs of types with K, contact length and range: of one type, of two, of sets that overlap
SETS: dict[str, dict[tuple[int, int], tuple[float, float, float]]] = {
    "like": {(3, 3): (0.7, 1.1, 1.6)},
    "unlike": {(2, 4): (0.7, 1.1, 1.6)},
    "one with many": {(1, 2): (0.7, 1.1, 1.6), (1, 3): (0.2, 0.9, 1.0), (1, 4): (0.7, 1.1, 1.6)},
    "overlapping": {(1, 2): (0.7, 1.1, 1.6), (2, 2): (0.4, 0.8, 2.0), (2, 3): (0.7, 1.0, 1.0)},
    "all": {(i, j): (0.5, 1.0, 1.5) for i in range(1, 5) for j in range(i, 5)},
}


@cache
def gas() -> tuple[Floats, Floats]:
    """Types and places of particles, no two of them closer than 0.7."""
    draw = np.random.default_rng(3)
    places = np.empty((0, 3))
    for place in draw.random((20_000, 3)) * SIDE:
        apart = places - place
        apart -= SIDE * np.round(apart / SIDE)
        if len(places) < 300 and (np.linalg.norm(apart, axis=1) > 0.7).all():
            places = np.vstack([places, place])
    assert len(places) == 300
    return draw.integers(1, TYPES + 1, len(places)), places


def script(folder: Path, style: str, pairs: dict[tuple[int, int], Any], more: str = "") -> str:
    """Pairs of types with one style alone."""
    lines = [f"pair_coeff {i} {j} {style} {stated(style, *c)}" for (i, j), c in pairs.items()]
    setting = "lj/cut 1.0" if style == "lj/cut" else style
    begin = f"pair_style hybrid/overlay {setting}\npair_coeff * * none\n"
    return gas_script(folder, begin + "\n".join(lines), more)


def stated(style: str, k: float, contact: float, reach: float) -> str:
    """Coefficients of a pair of types as a style has them."""
    if style == "lj/cut":
        return f"{k / 12!r} {contact / 2 ** (1 / 6)!r} {contact * reach!r}"
    return f"{k!r} {contact!r} {reach!r}"


def gas_script(folder: Path, pair_commands: str, more: str = "") -> str:
    """Forces at the start and after the particles have moved, with bonds between some of them."""
    types, places = gas()
    atoms = "\n".join(
        f"{n} {n % 7 + 1} {kind} {x:.17g} {y:.17g} {z:.17g}"
        for n, (kind, (x, y, z)) in enumerate(zip(types, places, strict=True), 1)
    )
    bonds = "\n".join(f"{n} 1 {n} {n + 1}" for n in range(1, len(types)))
    (folder / "gas.data").write_text(
        f"gas\n\n{len(types)} atoms\n{len(types) - 1} bonds\n{TYPES} atom types\n1 bond types\n"
        f"0 {SIDE} xlo xhi\n0 {SIDE} ylo yhi\n0 {SIDE} zlo zhi\n\nMasses\n\n"
        + "".join(f"{n} 1\n" for n in range(1, TYPES + 1))
        + f"\nAtoms\n\n{atoms}\n\nBonds\n\n{bonds}\n"
    )
    return f"""
        units lj
        atom_style molecular
        newton on
        special_bonds lj/coul 0.0 1.0 1.0
        bond_style zero nocoeff
        read_data {folder}/gas.data extra/special/per/atom 4
        bond_coeff 1
        {pair_commands}
        pair_modify shift yes
        neighbor {SKIN_DISTANCE} bin
        neigh_modify every 1 delay 0 check yes
        comm_modify cutoff 2.6
        {more}
        compute each all pe/atom pair
        compute stress all stress/atom NULL pair
        compute sum all reduce sum c_each
        thermo_style custom step pe c_sum pxx pyy pzz pxy pxz pyz
        thermo_modify format float %.16g
        velocity all create 1.0 7 loop geom
        fix drift all nve/noforce
        timestep 0.005
        thermo 10
        dump forces all custom 10 {folder}/dump id fx fy fz c_each c_stress[1] c_stress[4]
        dump_modify forces sort id format float %.16g
        run 40
    """


def numbers(folder: Path) -> tuple[Floats, Floats]:
    """Thermo output, and what the dump says of each particle in all frames."""
    rows = re.findall(r"^ +(\d+(?: +\S+){8}) *$", (folder / "log.lammps").read_text(), re.MULTILINE)
    lines = (folder / "dump").read_text().splitlines()
    particles = [line.split() for line in lines if len(line.split()) == 7 and "ITEM" not in line]
    return np.array([row.split() for row in rows], float), np.array(particles, float)


@pytest.mark.parametrize(
    ("name", "ranks"),
    [
        *product(SETS, (1,)), ("all", 2),
        *(pytest.param(*case, marks=pytest.mark.slow)
          for case in (("one with many", 2), *product(SETS, (4,)))),
    ],
)  # fmt: skip
def test_same_as_stock(name: str, ranks: int, tmp_path: Path) -> None:
    """Energies, forces, pressures and stresses of lj/cut, while particles move through a box."""
    assert_same_as_stock(name, ranks, tmp_path)


def test_lists_with_less_room(tmp_path: Path) -> None:
    """Particles leave margins soon; lists are then built anew, and no pair is missed."""
    margins = "fix lists nobody skin/motion euler margins 0.1 0.4 1 0.7"
    assert_same_as_stock("overlapping", 1, tmp_path, f"group nobody empty\n{margins}")


def assert_same_as_stock(name: str, ranks: int, tmp_path: Path, more: str = "") -> None:
    found = []
    for style, where in (("lj/cut", "stock"), ("skin/lj", "ours")):
        folder = tmp_path / where
        folder.mkdir()
        commands = script(folder, style, SETS[name], more if where == "ours" else "")
        run_script(folder, commands, ranks=ranks if where == "ours" else 1)
        found.append(numbers(folder))
    (thermo, particles), (our_thermo, our_particles) = found
    assert len(thermo) == 5
    assert np.abs(thermo[:, 1]).min() > 0.1
    scale = np.abs(thermo).max(axis=0)
    np.testing.assert_allclose(our_thermo / scale, thermo / scale, rtol=0, atol=1e-12)
    scale = np.abs(particles).max(axis=0)
    np.testing.assert_allclose(our_particles / scale, particles / scale, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    "exclusion",
    [
        "neigh_modify exclude type 2 2",
        "group some id 1:150\ngroup others id 100:300\nneigh_modify exclude group some others",
        "neigh_modify exclude molecule/intra all",
        "neigh_modify exclude molecule/inter all",
    ],
)
def test_excluded_pairs(exclusion: str, tmp_path: Path) -> None:
    """What neigh_modify excludes is left out, as by lj/cut."""
    scripts = [script(tmp_path, "lj/cut", SETS["all"], more) for more in ("", exclusion)]
    scripts += [script(tmp_path, "skin/lj", SETS["all"], more) for more in ("", exclusion)]
    run_script(tmp_path, "\nclear\n".join(scripts))
    stock_all, stock, ours_all, ours = np.split(numbers(tmp_path)[0][:, 1], 4)
    assert np.abs(stock - stock_all).min() > 1e-3
    np.testing.assert_allclose(ours_all, stock_all, rtol=1e-11)
    np.testing.assert_allclose(ours, stock, rtol=1e-11)


# ---- what is refused, and what survives

BOX = """
    units lj
    atom_style molecular
    region box block 0 8 0 8 0 8
    create_box 2 box extra/special/per/atom 4
    create_atoms 1 single 3 4 4
    create_atoms 2 single 4.1 4 4
    mass * 1
    special_bonds lj/coul 0.0 1.0 1.0
"""


@pytest.mark.parametrize(
    ("commands", "message"),
    [
        ("pair_style skin/lj 2.5", "Pair style skin/lj needs no arguments, but got 1"),
        ("pair_style skin/lj\npair_coeff * * 1 1", "skin/lj needs 3 coefficients .* got 2"),
        ("pair_style skin/lj\npair_coeff * * -1 1 1", "skin/lj: K = -1 must be a number >= 0"),
        ("pair_style skin/lj\npair_coeff * * 1 0 1", "contact length = 0 must be a number > 0"),
        ("pair_style skin/lj\npair_coeff * * 1 1 0.9", "range = 0.9 must be a number >= 1"),
        ("pair_style skin/dermis\npair_coeff * * 1 1 0.1 1.0 1.4", "d1 = 1.0 must be .* < 1"),
        ("pair_style skin/dermis\npair_coeff * * 1 1 0.1 0.8 0.5", "range = 0.5 must be"),
        ("pair_style skin/adhesion\npair_coeff 1 1 1 1 1.2\nrun 0", "All pair coeffs are not set"),
        ("newton off\npair_style skin/lj\npair_coeff * * 1 1 1\nrun 0", "newton"),
        (
            "special_bonds lj/coul 0 0 1\npair_style skin/lj\npair_coeff * * 1 1 1\nrun 0",
            "needs special_bonds lj 0.0 1.0 1.0; it got 0 0 1",
        ),
    ],
)
def test_refused(commands: str, message: str, tmp_path: Path) -> None:
    before, after = (commands, BOX) if commands.startswith("newton") else (BOX, commands)
    if commands.startswith("newton"):
        before, after = "newton off", BOX + commands.removeprefix("newton off")
    output = try_script(tmp_path, f"{before}\n{after}").stdout
    assert re.search(f"ERROR.*{message}", output), output


STYLES = {
    "skin/lj": "0.7 1.1 1.6", "skin/dermis": "0.7 1.3 0.4 0.9 1.5", "skin/adhesion": "0.7 1.0 1.3",
}  # fmt: skip


@pytest.mark.parametrize("style", STYLES)
def test_coefficients_survive_files(style: str, tmp_path: Path) -> None:
    """Restart files hold style and coefficients, data files the coefficients, of pairs or types."""
    energies = []
    begin = (
        f"{BOX}\npair_style {style}\npair_coeff * * {STYLES[style]}\npair_coeff 1 2 0.3"
        + (STYLES[style][3:])
    )
    settings = "units lj\natom_style molecular\nspecial_bonds lj/coul 0.0 1.0 1.0\n"
    for commands in (
        f"{begin}\nrun 0\nwrite_restart state\nwrite_data state.data pair ij"
        "\nwrite_data state.types",
        "read_restart state\nrun 0",
        f"{settings}pair_style {style}\nread_data state.data\nrun 0",
    ):
        engine = open_lammps(["-log", "none"])
        for command in commands.replace(" state", f" {tmp_path}/state").splitlines():
            engine.command(command)
        energies.append(engine.get_thermo("pe"))
        engine.close()
    assert abs(energies[0]) > 1e-3
    assert energies[1] == energies[0]
    assert energies[2] == pytest.approx(energies[0], rel=1e-12)
    section = (tmp_path / "state.types").read_text().split("Pair Coeffs")[1].split("\n\n")[1]
    given = [float(word) for word in STYLES[style].split()]
    assert np.loadtxt(section.splitlines()).tolist() == [[1, *given], [2, *given]]


def test_links_in_restart_files(tmp_path: Path) -> None:
    """Coefficients of one type after those of another, as in all restart files so far."""
    engine = open_lammps(["-log", "none"])
    engine.commands_string(
        f"""
        units lj
        atom_style molecular
        region box block 0 8 0 8 0 8
        create_box 1 box bond/types 2
        mass 1 1
        create_atoms 1 single 4 4 4
        bond_style skin/stretch
        bond_coeff 1 0.1 2.0 1.5 0.25 1.0
        bond_coeff 2 0.2 2.5 1.25 0.5 0.75
        special_bonds lj/coul 0.0 1.0 1.0
        write_restart {tmp_path}/state
        clear
        read_restart {tmp_path}/state
        write_data {tmp_path}/data
    """
    )
    engine.close()
    stored = struct.pack("<10d", 0.1, 2.0, 1.5, 0.25, 1.0, 0.2, 2.5, 1.25, 0.5, 0.75)
    assert stored in (tmp_path / "state").read_bytes()
    rows = re.findall(r"^([12]) (.*)$", (tmp_path / "data").read_text().split("Bond Coeffs")[1],
                      re.MULTILINE)  # fmt: skip
    found = [[float(word) for word in values.split()] for _, values in rows[:2]]
    assert found == [[0.1, 2.0, 1.5, 0.25, 1.0], [0.2, 2.5, 1.25, 0.5, 0.75]]


def test_two_particles_far_and_near(tmp_path: Path) -> None:
    """One pair through the whole range of the dermis: energy by hand, force its slope."""
    a1, d1, reach, k, contact = 0.125, 0.8, 1.4, 0.04, 2.8
    engine = open_lammps(["-log", "none"])
    engine.commands_string(f"""
        units lj
        boundary f f f
        atom_modify map array
        region box block 0 20 0 20 0 20
        create_box 1 box
        create_atoms 1 single 5 5 5
        create_atoms 1 single 6 5 5
        mass 1 1
        pair_style skin/dermis
        pair_coeff 1 1 {k} {contact} {a1} {d1} {reach}
    """)

    def phi(x: float) -> float:
        return x**-12 / 12 - x**-6 / 6

    def by_hand(x: float) -> float:
        if x >= reach:
            return 0.0
        if x >= 1:
            return k * (phi(x) - phi(reach))
        well = phi(x + 1 - d1) if x < d1 else phi(1.0)
        return k * (a1 / 2 * (x - 1) ** 2 + well - phi(reach))

    for x in (0.3, 0.5, 0.79, 0.81, 0.95, 1.05, 1.2, 1.39, 1.41):
        engine.command(f"set atom 2 x {5 + x * contact:.17g}")
        engine.command("run 0 post no")
        assert engine.get_thermo("pe") * 2 == pytest.approx(by_hand(x), rel=1e-12, abs=1e-15)
        slope = (by_hand(x + 1e-6) - by_hand(x - 1e-6)) / 2e-6 / contact
        force = engine.numpy.extract_atom("f")[1, 0]
        assert force == pytest.approx(-slope, rel=1e-6, abs=1e-9)
    engine.close()
