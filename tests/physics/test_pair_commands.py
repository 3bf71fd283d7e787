"""Pair styles of the skin beside commands that change which pairs there are: as lj/cut."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.engine.engine import open_lammps
from numpy_model import Floats
from test_pair_styles import BOX, gas_script, numbers, stated

from tests.reliability.conftest import run_script, try_script

ALL, OTHER = (0.5, 1.0, 1.5), (0.3, 0.9, 1.4)  # K, contact length, range
FEW = "group few id 1:120\natom_modify first few\nneigh_modify include few"
TILT = "change_box all triclinic xy final 2.1 xz final -1.7 yz final 1.3 remap"
SHEAR = "fix shear all deform 1 xy erate 0.9 z erate -0.5 remap x"
SMALL = "neighbor 2.5 bin\npair_coeff 1 1 {s} {own}"  # particles in reach of their own images

# pair_style, and commands that follow `pair_coeff * * {s} {c}`: {s} a style, {c} other coefficients
COMMANDS = {
    "none": ("hybrid {s}", "pair_coeff 1 1 none\npair_coeff 2 3* none"),
    "none, later": ("hybrid {s}", "run 0\npair_coeff 1 1 none\npair_coeff 2 3* none"),
    "another one": ("hybrid {s} soft 1.0", "pair_coeff 2 2* soft 0.3"),
    "another one, later": (
        "hybrid {s} soft 1.0", "pair_coeff 1 1 soft 0.1\nrun 0\npair_coeff 2 2* soft 0.3"
    ),
    "taken back": ("hybrid {s} soft 1.0", "pair_coeff 2 2* soft 0.3\npair_coeff 2 2 {s} {c}"),
    "two": ("hybrid/overlay {s} soft 1.0", "pair_coeff 2 2* soft 0.3"),
    "scaled": ("hybrid/scaled 0.25 {s} 0.5 soft 1.0", "pair_coeff 2 2* soft 0.3"),
    "not computed": ("hybrid/overlay {s} soft 1.0",
                     "pair_coeff 2 2* soft 0.3\npair_modify pair {s} compute no"),
    "included group": ("hybrid {s}", FEW),
    "included group, excluded types": ("hybrid {s}", f"{FEW}\nneigh_modify exclude type 2 3"),
    "tilted box": ("hybrid {s}", TILT),
    "sheared box": ("hybrid {s}", f"{TILT}\n{SHEAR}"),
    "included group, tilted box": ("hybrid {s}", f"{TILT}\n{FEW}"),
    "tilted box that is given": ("{s}", TILT),
}  # fmt: skip


def gas_commands(folder: Path, style: str, name: str) -> str:
    """A run with one of the commands, or with none of them."""
    pair_style, more = COMMANDS.get(name, ("hybrid {s}", ""))
    setting = "lj/cut 1.0" if style == "lj/cut" else style
    folder.mkdir(parents=True)
    return "clear\n" + gas_script(
        folder,
        f"""
        pair_style {pair_style.format(s=setting)}
        pair_coeff * * {style if pair_style.startswith("hybrid") else ""} {stated(style, *ALL)}
        """,
        f"log {folder}/log.lammps\n{more.format(s=style, c=stated(style, *OTHER))}",
    )


Outcome = dict[str, tuple[Floats, Floats]]


@pytest.fixture(scope="module", params=[pytest.param(1, marks=pytest.mark.slow), 2])
def outcomes(request: pytest.FixtureRequest, tmp_path_factory: Any) -> tuple[Outcome, Outcome]:
    """Thermo output and forces with all commands, in stock LAMMPS and with our style on ranks."""
    both = []
    for style, ranks in (("lj/cut", 1), ("skin/lj", request.param)):
        top = tmp_path_factory.mktemp("gas")
        names = ["nothing", *COMMANDS]
        folders = {name: top / str(n) for n, name in enumerate(names)}
        run_script(top, "\n".join(gas_commands(folders[n], style, n) for n in names), ranks=ranks)
        both.append({name: numbers(folders[name]) for name in names})
    return both[0], both[1]


@pytest.mark.parametrize("name", COMMANDS)
def test_same_as_stock(name: str, outcomes: tuple[Outcome, Outcome]) -> None:
    """Energies, forces, pressures and stresses, while particles move."""
    stock, ours = outcomes
    for want, got in zip(stock[name], ours[name], strict=True):
        if "include" in COMMANDS[name][1] and len(want) > 100:
            # LAMMPS leaves the forces of the others as they are, whatever that is
            want, got = (rows[rows[:, 0] <= 120] for rows in (want, got))
        scale = np.abs(want).max(axis=0)
        np.testing.assert_allclose(got / scale, want / scale, rtol=0, atol=1e-11)
    assert np.abs(stock[name][0][-5:, 1] - stock["nothing"][0][:, 1]).max() > 1e-3


# ---- in reach of their own images


def small_box(style: str) -> str:
    """Bonded particles in a box smaller than the cutoff: all images but the nearest one count."""
    draw = np.random.default_rng(5)
    places = draw.random((8, 3)) * 0.9 + 1.1 * np.array(
        [[a, b, c] for a in (0, 1) for b in (0, 1) for c in (0, 1)]
    )
    setting = "lj/cut 1.0" if style == "lj/cut" else style
    atoms = "\n".join(
        f"create_atoms {n % 2 + 1} single {x} {y} {z}" for n, (x, y, z) in enumerate(places)
    )
    return f"""
        clear
        units lj
        atom_style molecular
        region box block 0 2.2 0 2.2 0 2.2
        create_box 2 box bond/types 1 extra/bond/per/atom 4 extra/special/per/atom 8
        {atoms}
        mass * 1
        bond_style zero nocoeff
        bond_coeff 1
        create_bonds single/bond 1 1 2
        create_bonds single/bond 1 3 7
        special_bonds lj/coul 0.0 1.0 1.0
        pair_style {setting}
        pair_modify shift yes
        pair_coeff * * {stated(style, 0.5, 1.0, 3.0)}
        pair_coeff 1 2 {stated(style, 0.2, 0.8, 4.0)}
        thermo_style custom step pe pxx pyy pzz pxy pxz pyz
        thermo_modify norm no format float %.15g
        dump forces all custom 10 {style.replace("/", "_")} id fx fy fz
        dump_modify forces sort id format float %.15g
        fix drift all move linear 0.3 0.2 -0.1
        timestep 0.05
        thermo 10
        run 30
    """


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_own_images(ranks: int, tmp_path: Path) -> None:
    output = run_script(tmp_path, small_box("lj/cut") + small_box("skin/lj"), ranks=ranks)
    rows = [line.split() for line in output.splitlines() if len(line.split()) == 8]
    thermo = np.array([row for row in rows if row[0] in ("0", "10", "20", "30")], float)
    assert thermo.shape == (8, 8)
    np.testing.assert_allclose(thermo[4:], thermo[:4], rtol=1e-11)
    forces = [
        np.array([line.split() for line in (tmp_path / name).read_text().splitlines()
                  if len(line.split()) == 4 and "ITEM" not in line], float)
        for name in ("lj_cut", "skin_lj")
    ]  # fmt: skip
    assert forces[0].shape == (32, 4)
    scale = np.abs(forces[0][:, 1:]).max()
    np.testing.assert_allclose(forces[1], forces[0], rtol=0, atol=1e-11 * scale)


# ---- commands that ask for single pairs, or change coefficients

LINE = (
    BOX + "create_atoms 2 single 4.6 4.9 4\ncreate_atoms 1 single 3.2 4.8 4.5\npair_style {style}\n"
)


def test_computes_of_pairs() -> None:
    """compute pair/local, group/group and pe/atom add up to the energy, and pair_write agrees."""
    engine = open_lammps(["-log", "none"])
    engine.commands_string(
        LINE.format(style="hybrid/overlay skin/lj skin/adhesion")
        + """
        pair_coeff * * skin/lj 0.5 1.1 1.6
        pair_coeff 1 2 skin/adhesion 0.3 1.0 1.5
        group one type 1
        group two type 2
        compute local all pair/local eng
        compute sum all reduce sum c_local inputs local
        compute each all pe/atom pair
        compute atoms all reduce sum c_each
        compute between one group/group two
        compute within1 one group/group one
        compute within2 two group/group two
        thermo_style custom step pe c_sum c_atoms c_between c_within1 c_within2
        thermo_modify norm no
        run 0 post no
    """
    )
    pe = engine.get_thermo("pe")
    parts = [engine.extract_compute(name, 0, 0) for name in ("sum", "atoms")]
    groups = sum(engine.extract_compute(n, 0, 0) for n in ("between", "within1", "within2"))
    engine.close()
    assert abs(pe) > 0.01
    assert [*parts, groups] == pytest.approx([pe] * 3, rel=1e-12)


@pytest.mark.parametrize("style", ["{s}", "hybrid/overlay {s} soft 1.0"])
def test_fix_adapt_as_of_stock(style: str) -> None:
    """K of a pair of types changes in the course of a run, epsilon of lj/cut does as K / 12."""
    found = []
    for name, setting, which, part in (
        ("lj/cut", "lj/cut 1.0", "epsilon", 1 / 12), ("skin/lj", "skin/lj", "K", 1.0)
    ):  # fmt: skip
        engine = open_lammps(["-log", "none"])
        sub = name if "hybrid" in style else ""
        engine.commands_string(
            LINE.format(style=style.format(s=setting))
            + f"""
            pair_modify shift yes
            pair_coeff * * {sub} {stated(name, 0.5, 1.1, 1.6)}
            {"pair_coeff 1 1 soft 0.0" if sub else ""}
            variable k equal {part}*(0.2+0.05*step)
            fix change all adapt 2 pair {name} {which} 1 2 v_k
            velocity all create 0.1 5
            fix move all nve/noforce
            thermo_style custom step pe
            thermo_modify norm no
        """
        )
        energies = []
        for _ in range(6):
            engine.command("run 1 post no")
            energies.append(engine.get_thermo("pe"))
        engine.command("unfix change")
        engine.command("run 0 post no")
        found.append([*energies, engine.get_thermo("pe")])
        engine.close()
    assert np.ptp(found[0]) > 0.01
    assert found[1] == pytest.approx(found[0], rel=1e-11)


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_fix_adapt_while_lists_change(ranks: int, tmp_path: Path) -> None:
    """Of one pair of types alone, on each step, while atoms are sorted and change their ranks."""
    found = []
    for style, which, part in (("lj/cut", "epsilon", 1 / 12), ("skin/lj", "K", 1.0)):
        folder = tmp_path / style.replace("/", "-")
        folder.mkdir()
        setting = "lj/cut 1.0" if style == "lj/cut" else style
        script = gas_script(
            folder,
            f"""
            pair_style hybrid/overlay {setting} soft 1.0
            pair_coeff * * soft 0.1
            pair_coeff 1 2 {style} {stated(style, *ALL)}
            pair_coeff 3 3 {style} {stated(style, *OTHER)}
            """,
            f"""
            log {folder}/log.lammps
            neigh_modify every 2 delay 0 check no
            atom_modify sort 1 1.0
            variable k equal {part!r}*(0.2+0.02*step)
            fix change all adapt 1 pair {style} {which} 1 2 v_k
            """,
        )
        run_script(folder, script, ranks=ranks)
        found.append(numbers(folder))
    for want, got in zip(*found, strict=True):
        scale = np.abs(want).max(axis=0)
        np.testing.assert_allclose(got / scale, want / scale, rtol=0, atol=1e-11)


COEFFICIENTS = {
    "skin/lj": {"K": 0.5, "contact": 1.1, "range": 1.6},
    "skin/dermis": {"K": 0.5, "contact": 1.2, "a1": 0.3, "d1": 0.97, "range": 1.5},
    "skin/adhesion": {"K": 0.5, "contact": 1.0, "range": 1.4},
}


@pytest.mark.parametrize(("style", "which"), [(s, w) for s, c in COEFFICIENTS.items() for w in c])
def test_all_coefficients_can_change(style: str, which: str) -> None:
    """As if they had been given: alone, for one pair of types among those that were alike."""
    values = COEFFICIENTS[style]
    changed = values | {which: values[which] * 0.95}

    def text(of: dict[str, float]) -> str:
        return " ".join(f"{v:.17g}" for v in of.values())

    engine = open_lammps(["-log", "none"])
    engine.commands_string(
        LINE.format(style=style)
        + f"""
        pair_coeff * * {text(values)}
        thermo_style custom step pe pxx pyy
        variable v equal {changed[which]:.17g}
        run 0 post no
    """
    )
    before = engine.get_thermo("pe")
    engine.commands_string(f"fix change all adapt 1 pair {style} {which} 1 2 v_v\nrun 2 post no")
    adapted = [engine.get_thermo(name) for name in ("pe", "pxx", "pyy")]
    engine.commands_string(f"unfix change\npair_coeff 1 2 {text(changed)}\nrun 0 post no")
    given = [engine.get_thermo(name) for name in ("pe", "pxx", "pyy")]
    engine.close()
    assert abs(adapted[0] - before) > 1e-6
    assert adapted == pytest.approx(given, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("K 1 2 v_minus", "skin/lj: K = -1 must be a number >= 0"),
        (
            "contact 1 2 v_two",
            "types 1 and 2 have the range 3.2 on step 0, but neighbor lists .* 1.76",
        ),
        ("sigma 1 2 v_two", "Fix adapt pair style skin/lj param sigma not supported"),
    ],
)
def test_what_they_cannot_become(change: str, message: str, tmp_path: Path) -> None:
    script = (
        LINE.format(style="skin/lj")
        + f"""
        pair_coeff * * 0.5 1.1 1.6
        variable minus equal -1.0
        variable two equal 2.0
        fix change all adapt 1 pair skin/lj {change}
        run 1
    """
    )
    output = try_script(tmp_path, script).stdout
    assert re.search(f"ERROR.*{message}", output), output
