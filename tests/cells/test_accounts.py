"""Energies, virials and times: what fix skin/cells adds to those of LAMMPS."""

from pathlib import Path

import numpy as np
import pytest
from lammps_skin.kinds import Kind
from lammps_skin.start.build import build

from tests.cells.conftest import CONTACT, HEIGHT, place
from tests.cells.scripts import busy, error_of, kind_rows, run, run_script, snapshots, told

# the membrane is held flat and tension-free, so that a cell's neighbor is known
HELD = ["group membrane type membrane", "fix hold membrane setforce 0 0 0"]
SUMS = [
    "fix_modify cells energy yes virial yes", "compute each all pe/atom",
    "compute pes all reduce sum c_each", "compute stress all stress/atom NULL virial",
    "compute total all reduce sum c_stress[1] c_stress[2] c_stress[3] c_stress[4] c_stress[5] "
    "c_stress[6]", "compute pressure all pressure NULL virial",
]  # fmt: skip


@pytest.mark.parametrize("ranks", [1, 2])
def test_sums_over_atoms_are_those_of_all(ranks: int, tmp_path: Path) -> None:
    """`compute pe/atom` and `stress/atom` in a colony with pairs, bound and adhering cells."""
    lines = [
        "run 24 post no", *SUMS, "thermo_style custom step pe c_pes press", "thermo_modify norm no",
        "variable d equal c_total[1]+vol*c_pressure[1]",
        "variable e equal c_total[6]+vol*c_pressure[6]", "run 0 post no",
        'print "OUT $(pe:%.15g) $(c_pes:%.15g) $(f_cells:%.15g) ${d} ${e} $(vol*press)"',
        "compute own all pe/atom fix", "compute owns all reduce sum c_own",
        "thermo_style custom step c_owns", "thermo_modify norm no", "run 0 post no",
        'print "OUT $(c_owns:%.15g)"',
    ]  # fmt: skip
    process = run_script(tmp_path, *lines, scene=busy(), ranks=ranks)
    (pe, each, mine, x, yz, whole), (fixed,) = told(process)
    assert each == pytest.approx(pe, rel=1e-12)
    assert fixed == pytest.approx(mine, rel=1e-12)
    assert mine > 0.01
    assert [x, yz] == pytest.approx([0.0, 0.0], abs=1e-12 * abs(whole))


def test_membrane_sums_are_those_over_atoms(tmp_path: Path) -> None:
    """Energies and virials of links and folds, alone and where atoms are asked for theirs, too."""
    sums = "c_stretch c_bend c_l[1] c_l[2] c_l[3] c_l[4] c_l[5] c_l[6] c_f[1] c_f[2] c_f[3] c_f[4]"
    printed = 'print "OUT ' + " ".join(f"$({word}:%.17g)" for word in sums.split()) + '"'
    lines = [
        "group sheet type membrane", "displace_atoms sheet random 0.05 0.05 0.05 7",
        "compute l all pressure NULL bond",
        "compute f all pressure NULL dihedral",
        f"thermo_style custom step {sums}", "thermo_modify norm no", "run 0 post no", printed,
        "compute s all stress/atom NULL virial", "compute e all pe/atom",
        "compute each all reduce sum c_s[1] c_e",
        f"thermo_style custom step {sums} c_each[1] c_each[2]", "thermo_modify norm no",
        "run 0 post no", printed,
    ]  # fmt: skip
    alone, beside = np.array(told(run_script(tmp_path, *lines, scene=busy(), ranks=2)))
    assert np.abs(alone).min() > 1e-9
    for term in (slice(0, 1), slice(1, 2), slice(2, 8), slice(8, 12)):
        scale = np.abs(beside[term]).max()
        assert alone[term] == pytest.approx(beside[term], rel=0, abs=1e-12 * scale)


VIRIAL = " ".join(f"$(c_p[{n}]*vol:%.15g)" for n in range(1, 7))


def six_products(x: np.ndarray) -> np.ndarray:
    """Products xx, yy, zz, xy, xz, yz of coordinates."""
    return np.outer(x, x)[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def test_virial_of_the_division_spring(tmp_path: Path) -> None:
    """-dU/d(strain) of a pair, once: the spring's force times its length, in its direction."""
    scene = busy(**{"cells.stem": 2, "cells.nd": 0})
    z = HEIGHT + CONTACT
    apart, tilted = 1.5, np.array([0.64, 0.48, 0.6])
    spots = [np.array([4.0, 6.0, z]), np.array([4.0, 6.0, z]) + apart * tilted]
    start = place(scene, [(Kind.STEM, spot, 0) for spot in spots])
    rows = kind_rows(("stem", "ta", "exhausted"), adhesion="0 1.2", binding="0")
    lines = [
        *HELD, "set atom 673 i_pair 674", "set atom 674 i_pair 673",
        "set group cells d_next_division 99", "unfix cells",
        f"fix cells cells skin/cells 1 membrane membrane {rows} contact 2.4 "
        "spring 5 0.014 1.4 2.8 offset 0.007",
        "fix_modify cells energy yes virial yes", "compute p all pressure NULL fix",
        "compute s cells stress/atom NULL fix", "compute e cells pe/atom fix",
        "thermo_style custom step c_p[1]", "dump d cells custom 1 x.dump id c_s[*] c_e",
        "dump_modify d format float %.15g", "run 0 post no",
        f'print "OUT $(f_cells:%.15g) {VIRIAL}"',
    ]  # fmt: skip
    ((energy, *virial),) = told(run_script(tmp_path, *lines, scene=scene, start=start))
    force = -5.0 * (apart - 0.014)
    assert energy == pytest.approx(2.5 * (apart - 0.014) ** 2)
    expected = force * apart * six_products(tilted)
    assert virial == pytest.approx(expected)
    (frame,) = snapshots(tmp_path / "x.dump")
    # LAMMPS: stress/atom is minus the atom's share of the virial
    for n, component in enumerate(expected, 1):
        assert frame[f"c_s[{n}]"] == pytest.approx([-component / 2] * 2)
    assert frame["c_e"] == pytest.approx([energy / 2] * 2)


@pytest.mark.parametrize(("kind", "term"), [("ta", "adhesion 5 1.4"), ("stem", "binding 5")])
def test_virial_of_attachment(kind: str, term: str, tmp_path: Path) -> None:
    """A cell above a membrane particle and a little aside: it is pulled back."""
    scene = busy(**{"cells.stem": 1, "cells.nd": 0})
    r = 1.15 * CONTACT
    above = np.array([0.12, 0.16, (r**2 - 0.2**2) ** 0.5])
    kinds = {"ta": Kind.TA, "stem": Kind.STEM}
    start = place(scene, [(kinds[kind], np.add([6.0, 7 * 3**0.5 / 2, HEIGHT], above), 1)])
    terms = {"adhesion": "0 1.4", "binding": "0", term.split()[0]: term.split(" ", 1)[1]}
    rows = kind_rows(("stem", "ta", "exhausted"), **terms)
    lines = [
        *HELD, "set group cells d_next_division 99", "unfix cells",
        f"fix cells cells skin/cells 1 membrane membrane {rows} contact 2.4 "
        "spring 5 0.014 1.4 2.8 offset 0.007",
        "comm_modify cutoff 5.5", "fix_modify cells virial yes energy yes",
        "compute p all pressure NULL fix", "compute s all stress/atom NULL fix",
        "compute e all pe/atom fix", "thermo_style custom step c_p[1]",
        "dump d all custom 1 x.dump id c_s[*] c_e", "dump_modify d format float %.15g",
        "run 0 post no",
        f'print "OUT $(f_cells[1]) $(f_cells[2]) $(f_cells) {VIRIAL}"',
    ]  # fmt: skip
    process = run_script(tmp_path, *lines, scene=scene, start=start)
    ((adhesion, binding, energy, *virial),) = told(process)
    s = 0.15
    slope = 5 * s * (1 - s**2 / 0.4**2) if kind == "ta" else 5 * s
    expected = 5 * s**2 / 2 * (1 - s**2 / (2 * 0.4**2)) if kind == "ta" else 5 * s**2 / 2
    assert energy == pytest.approx(expected, rel=1e-5)
    assert (adhesion, binding) == ((energy, 0.0) if kind == "ta" else (0.0, energy))
    assert virial == pytest.approx(-slope / CONTACT / r * six_products(above))
    (frame,) = snapshots(tmp_path / "x.dump")
    assert frame["c_e"][672] == pytest.approx(energy, rel=1e-5)
    sums = [frame[f"c_s[{n}]"].sum() for n in range(1, 7)]
    assert sums == pytest.approx([-component for component in virial])


# ---- minimisation


def test_forces_are_part_of_a_minimisation(tmp_path: Path) -> None:
    """A stem cell out of contact is pulled back to where exclusion begins."""
    scene = busy(**{"cells.stem": 1, "cells.nd": 0})
    spot = (6.0, 7 * 3**0.5 / 2)
    start = place(scene, [(Kind.STEM, (*spot, HEIGHT + 2.8), 1)])
    lines = [
        *HELD, "fix_modify cells energy yes", "minimize 0 1e-8 200 2000",
        'print "OUT $(f_cells[2])"', "write_dump cells custom x.dump id f_cells[7]",
    ]  # fmt: skip
    ((binding,),) = told(run_script(tmp_path, *lines, scene=scene, start=start))
    (frame,) = snapshots(tmp_path / "x.dump")
    assert frame["f_cells[7]"] == pytest.approx([CONTACT], abs=1e-3)
    assert binding < 1e-6


@pytest.mark.parametrize("checkpoints", [(), ("restart 7 min.1.restart min.2.restart",)])
def test_minimisation_takes_no_time(checkpoints: tuple[str, ...], tmp_path: Path) -> None:
    """With restart files or without: no events, no growth of pairs, and times go on after it."""
    report = 'print "OUT $(f_cells[9]) $(f_cells[8]) $(time)"'
    lines = ["run 20 post no", report, *checkpoints, "minimize 0 0 40 400", "restart 0",
             "run 0 post no", report, "run 4 post no", report]  # fmt: skip
    before, at, after = told(run_script(tmp_path, *lines, scene=busy()))
    assert before[1] > 0
    assert before == at
    assert after[2] == before[2] + 1.0
    if checkpoints:
        # a run from a restart file of the minimisation starts at the same time
        script = ["run 0 post no", report]
        process = run_script(
            tmp_path, *script, arguments=("-var", "restart", "min.1.restart")
        )  # fmt: skip
        assert told(process) == [before]


def test_nothing_is_detached_by_a_minimisation(tmp_path: Path) -> None:
    """A TA cell that its way through a minimisation takes out of reach, and back, stays."""
    scene = busy()
    build(scene, tmp_path)
    lines = ["run 20 post no", "displace_atoms cells move 0 0 0.6", "minimize 0 0 1 1",
             "displace_atoms cells move 0 0 -0.6", "run 4 post no",
             'print "OUT $(f_cells[10])"']  # fmt: skip
    assert told(run_script(tmp_path, *lines)) == [[0.0]]


# ---- boxes


def test_triclinic_box_is_the_same_box(tmp_path: Path) -> None:
    """Without tilt, and with a tilt of one period: the same images, the same run."""
    report = [
        'print "OUT $(f_cells[1]:%.12g) $(f_cells[2]:%.12g) $(f_cells[3]:%.12g) $(f_cells[9])"'
    ]
    results = []
    large = ["box tilt large", "change_box all xy final 12.0"]
    for box in ([], ["change_box all triclinic"], ["change_box all triclinic", *large]):
        lines = [*box, "run 16 post no", *report]
        results += told(run_script(tmp_path, *lines, scene=busy(**{"numerics.rounding": 0.0})))
    for result in results[1:]:
        assert result == pytest.approx(results[0], rel=1e-8)
    assert results[0][3] >= 2


def test_run_style_respa_is_refused(tmp_path: Path) -> None:
    message = error_of(run_script(tmp_path, "run_style respa 2 2", "run 2", scene=busy()))
    assert "Fix skin/cells does not work with run_style respa: use run_style verlet" in message


# ---- special neighbors


def test_special_neighbors_of_the_user_stay(tmp_path: Path) -> None:
    """A stem cell that is anchored by a bond divides, and its pair ends.

    What it does not see, and its daughter, is then what LAMMPS finds anew from bonds.
    """
    build(busy(**{"cells.stem": 1, "cells.nd": 0}), tmp_path)
    state = (tmp_path / "state.in").read_text()
    extra = "extra/bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4"
    state = state.replace("fix state NULL state", f"fix state NULL state {extra}")
    (tmp_path / "state.in").write_text(state)
    report = 'print "OUT $(evdwl:%.15g) $(f_cells[8]) $(f_cells[9])"'
    lines = [
        "bond_style hybrid skin/stretch harmonic",
        "bond_coeff 1 skin/stretch 0.04 2.0 1.25 0.25 1.0", "bond_coeff 2 harmonic 0.0 2.4",
        "compute near cells reduce max f_cells[1]", "displace_atoms cells move 0 0 -0.2",
        "thermo_style custom step evdwl", "thermo_modify norm no", "run 0 post no", report,
        "create_bonds single/bond 2 673 $(c_near:%.0f) special yes", "run 0 post no", report,
        "run 24 post no", report,
        "delete_bonds all stats special", "run 0 post no", report,
    ]  # fmt: skip
    seen, bonded, later, anew = told(run_script(tmp_path, *lines))
    assert bonded[0] < seen[0] - 1e-4
    assert later[2] > later[1]
    assert later == anew


NARROW = """
units lj
atom_style molecular
newton on
boundary p p f
region box block 0 4 0 12 0 20
create_box 4 box extra/special/per/atom 4
mass * 1
fix state all property/atom i_divisions_left i_divisions_done i_parent i_pair &
  d_next_division d_birth_time d_pair_start d_detached_time
create_atoms 1 single 1 3 5
create_atoms 2 single 1 3 7.4
create_atoms 2 single 2.5 3 7.4
set atom 2 i_pair 3
set atom 3 i_pair 2
set atom 2*3 d_next_division 99 d_detached_time -1
group cells type 2
special_bonds lj/coul 0.0 1.0 1.0
pair_style hybrid/overlay {style}
pair_modify shift yes
pair_coeff * * none
pair_coeff 2 2 {coefficients}
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
comm_modify cutoff 5
fix cells cells skin/cells 1 membrane 1 {rows} contact 2.4 &
  spring 5 0.014 0.14 2.8 offset 0.007
thermo_style custom step evdwl
thermo_modify norm no
run 0 post no
print "OUT $(evdwl:%.15g)"
"""


@pytest.mark.parametrize(
    ("style", "coefficients"),
    [
        ("skin/lj", "skin/lj 0.04 2.8 1.0"),
        ("lj/cut 2.8", f"lj/cut {0.04 / 12} {2.8 / 2 ** (1 / 6)} 2.8"),
    ],
)
def test_a_pair_in_a_narrow_box_sees_its_images(
    style: str, coefficients: str, tmp_path: Path
) -> None:
    """The two of a pair do not see each other, but do see each other's far images."""
    rows = kind_rows((2, 3, 4), adhesion="0 1.2", binding="0", cycle="36 0.083 48")
    script = NARROW.format(style=style, coefficients=coefficients, rows=rows)
    ((energy,),) = told(run(tmp_path, script.splitlines()))
    x = 2.5 / 2.8
    assert energy == pytest.approx(0.04 * (x**-12 / 12 - x**-6 / 6 + 1 / 12), rel=1e-9)
