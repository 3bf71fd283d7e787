"""Kinds of cells: each law with each end of it, alone and in pairs, and the rules of pairs."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from tests.cells.conftest import read_events
from tests.cells.scripts import error_of, run, snapshots, told
from tests.physics.numpy_model import u_kind

PROPERTIES = (
    "i_divisions_left i_divisions_done i_parent i_pair "
    "d_next_division d_birth_time d_pair_start d_detached_time"
)
CONTACT, HEIGHT = 2.4, 5.0
NONE = np.inf
# law, K, lambda, detach, K in a pair with a cell of the same kind
LAWS = {
    "spring": ("bound", 7.0, NONE, NONE, None),
    "loose": ("bound", 7.0, NONE, 1.35, None),
    "sticky": ("adhesive", 9.0, 1.4, NONE, None),
    "leaving": ("adhesive", 9.0, 1.4, 1.25, None),
    "late": ("adhesive", 9.0, 1.4, 1.5, None),
    "free": ("none", 0.0, NONE, 1.3, None),
    "bound-pair": ("bound", 7.0, NONE, 1.5, 3.0),
    "sticky-pair": ("adhesive", 9.0, 1.4, 1.3, 0.5),
}
X = (0.9, 1.1, 1.2, 1.28, 1.33, 1.45, 1.55)  # distances from the membrane, in contact lengths


def row_of(name: str) -> str:
    """A kind as an argument of the fix."""
    law, stiffness, lam, detach, paired = LAWS[name]
    words = ["kind", name, "type", str(2 + list(LAWS).index(name)), "law", law]
    words += [str(v) for v in (stiffness, lam) if law != "none" and v != NONE]
    words += ["detach", str(detach)] if detach != NONE else []
    words += ["paired", name, str(paired)] if paired is not None else []
    return " ".join(words)


ROWS = " ".join(map(row_of, LAWS))
COUNTS = (4, 5, 6, 7, *range(12, 8 + len(LAWS)))  # of the kinds, in the vector of the fix
FIX = (
    f"fix cells cells skin/cells 1 membrane 1 {ROWS} contact {CONTACT} spring 0 0.1 1 2 offset 0.1"
)


def places() -> list[tuple[int, float, float, float]]:
    """Type and place of cells of each kind at each distance, two at each for pairs."""
    found = []
    for column, (*_, paired) in enumerate(LAWS.values()):
        for k, x in enumerate(X):
            spot = (4.0 * column + 2, 4.0 * k + 2)
            found.append((2 + column, *spot, HEIGHT + x * CONTACT))
            if paired is not None:
                found.append((2 + column, spot[0] + 0.05, spot[1], HEIGHT + x * CONTACT))
    return found


def setup(*state: str) -> list[str]:
    """One membrane particle below each column, far from the others."""
    cells, n = places(), len(LAWS) * len(X)
    sheet = [
        f"create_atoms 1 single {4 * c + 2} {4 * k + 2} {HEIGHT}"
        for c in range(len(LAWS)) for k in range(len(X))
    ]  # fmt: skip
    pairs = [
        line
        for k, (one, other) in enumerate(pairwise(cells), n + 1)
        if one[0] == other[0] and one[2] == other[2]
        for line in (f"set atom {k} i_pair {k + 1}", f"set atom {k + 1} i_pair {k}")
    ]
    return [
        "units lj", "atom_style molecular", "atom_modify map yes", "newton on", "boundary p p f",
        f"region box block 0 {4 * len(LAWS)} 0 {4 * len(X)} 0 30",
        f"create_box {1 + len(LAWS)} box extra/special/per/atom 4",
        f"fix state all property/atom {PROPERTIES}", *sheet,
        *(f"create_atoms {t} single {x} {y} {z}" for t, x, y, z in cells),
        "mass * 1", "pair_style zero 4.0 nocoeff", "pair_coeff * *", "special_bonds lj 0 1 1",
        "neighbor 0.3 bin", "neigh_modify every 1 delay 0 check yes", "comm_modify cutoff 5.5",
        f"group cells type 2:{1 + len(LAWS)}",
        "set group cells d_next_division -1 d_detached_time -1", *pairs, *state, FIX,
        "fix_modify cells energy yes virial yes", "thermo_modify norm no",
        "compute e cells pe/atom fix", "compute s cells stress/atom NULL fix",
        "compute p all pressure NULL fix", "thermo_style custom step c_p[1] c_p[3]",
    ]  # fmt: skip


DUMP = (
    "write_dump all custom {}.dump id type x y z fx fy fz c_e c_s[1] c_s[3] c_s[5] "
    "modify sort id format float %.17g"
)
STEP = 1e-6


@pytest.mark.parametrize("ranks", [1, 2])
def test_energies_forces_and_virials(ranks: int, tmp_path: Path) -> None:
    """Those of the formulas; forces are minus the gradients, and those on the membrane opposite."""
    lines = [
        *setup(), "displace_atoms cells move 0.3 0.2 0",
        "run 0 post no", DUMP.format("at"), 'print "OUT $(c_p[1]*vol) $(c_p[3]*vol)"',
        'print "OUT $(f_cells[1]:%.15g) $(f_cells[2]:%.15g) $(f_cells[3]:%.15g)"',
    ]  # fmt: skip
    for axis, shift in enumerate((f"{STEP} 0 0", f"0 {STEP} 0", f"0 0 {STEP}")):
        back = " ".join(f"-{2 * float(v)}" for v in shift.split())
        lines += [f"displace_atoms cells move {shift}", "run 0 post no", DUMP.format(f"{axis}p"),
                  f"displace_atoms cells move {back}", "run 0 post no", DUMP.format(f"{axis}m"),
                  f"displace_atoms cells move {shift}"]  # fmt: skip
    (xx, zz), (adhesion, binding, division) = told(run(tmp_path, lines, ranks))

    def frame(name: str) -> dict[str, np.ndarray]:
        return snapshots(tmp_path / f"{name}.dump")[0]

    at = frame("at")
    cells = at["type"] > 1
    n = len(LAWS) * len(X)
    place = np.stack([at[axis] for axis in "xyz"], 1)
    forces = np.stack([at[f"f{axis}"] for axis in "xyz"], 1)
    way = place[cells] - place[:n][np.argmin(
        np.linalg.norm(place[cells][:, None] - place[None, :n], axis=2), axis=1
    )]  # fmt: skip
    x = np.linalg.norm(way, axis=1) / CONTACT
    energy, slope = np.zeros(len(x)), np.zeros(len(x))
    law = np.empty(len(x), object)
    for type_, (name, stiffness, lam, detach, paired) in enumerate(LAWS.values(), 2):
        mine = at["type"][cells] == type_
        u, du = u_kind(x[mine], name, lam, detach)
        k = stiffness if paired is None else paired
        energy[mine], slope[mine], law[mine] = k * u, k * du, name
    np.testing.assert_allclose(at["c_e"][cells], energy, rtol=1e-12, atol=1e-14)
    want = -(slope / CONTACT / (x * CONTACT))[:, None] * way
    np.testing.assert_allclose(forces[cells], want, rtol=1e-11, atol=1e-13)
    assert (np.abs(want) > 0.01).any(axis=1).sum() > 20
    np.testing.assert_allclose(forces.sum(0), 0, atol=1e-11)
    assert (adhesion, binding, division) == pytest.approx(
        (energy[law == "adhesive"].sum(), energy[law == "bound"].sum(), 0.0), rel=1e-10
    )
    np.testing.assert_allclose(at["c_s[3]"][cells], -want[:, 2] * way[:, 2], atol=1e-12)
    np.testing.assert_allclose(at["c_s[5]"][cells], -want[:, 0] * way[:, 2], atol=1e-12)
    assert (xx, zz) == pytest.approx(
        ((want[:, 0] * way[:, 0]).sum(), (want[:, 2] * way[:, 2]).sum()), rel=1e-5
    )
    for axis in range(3):
        up, down = (frame(f"{axis}{side}")["c_e"][cells] for side in "pm")
        np.testing.assert_allclose(-(up - down) / (2 * STEP), want[:, axis], atol=1e-6)


def test_a_restart_has_the_same_forces_and_numbers(tmp_path: Path) -> None:
    """Of all laws; given anew, with the values of a fix_modify."""
    change = ["fix_modify cells kind sticky law bound 2 detach 1.5 kind spring law adhesive 3 1.3"]
    counts = " ".join(f"$(f_cells[{n}])" for n in (1, 2, 3, *COUNTS, *range(8, 12)))
    report = [f'print "OUT {counts}"']
    lines = [
        *setup(), *change, "run 0 post no", *report, DUMP.format("one"),
        "write_restart half.restart", "clear", "read_restart half.restart",
        f"fix state all property/atom {PROPERTIES}",
        "pair_coeff * *", "neigh_modify every 1 delay 0 check yes", "comm_modify cutoff 5.5",
        FIX, *change, "compute e cells pe/atom fix", "compute s cells stress/atom NULL fix",
        "fix_modify cells energy yes virial yes", "run 0 post no", *report, DUMP.format("two"),
    ]  # fmt: skip
    first, second = told(run(tmp_path, lines))
    assert first == second
    assert first[3:11] == [7, 7, 7, 7, 7, 7, 14, 14]
    one, two = (snapshots(tmp_path / f"{name}.dump")[0] for name in ("one", "two"))
    for name in one:
        np.testing.assert_array_equal(one[name], two[name])
    for kind, law, k, lam, detach in (("sticky", "bound", 2, NONE, 1.5),
                                      ("spring", "adhesive", 3, 1.3, NONE)):  # fmt: skip
        mine = one["type"] == 2 + list(LAWS).index(kind)
        want = k * u_kind(np.array(X), law, lam, detach)[0]
        np.testing.assert_allclose(one["c_e"][mine], want, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("ranks", [1, 2])
def test_cells_beyond_their_end_leave(ranks: int, tmp_path: Path) -> None:
    """Bound ones too; those in pairs end them, or stay with `pairs stay yes`."""
    held = ["group membrane type 1", "timestep 0.01", "reset_timestep 0"]
    numbers = " ".join(f"$(f_cells[{n}])" for n in COUNTS)
    report = f'print "OUT {numbers} $(f_cells[8]) $(f_cells[10])"'
    for stay in ("no", "yes"):
        folder = tmp_path / stay
        folder.mkdir()
        fix = f"{FIX} pairs stay {stay} log events.csv every 2"
        lines = [line if line != FIX else fix for line in setup()]
        lines[lines.index(fix) : lines.index(fix)] = [*held]
        lines += ["run 6 post no", report]
        if stay == "yes":  # the pairs end at t = 1.9
            lines += ["timestep 0.2", "run 14 post no", report]
        outs = told(run(folder, lines, ranks))
        leaving = [sum(x > detach for x in X) for *_, detach, _ in LAWS.values()]
        each = [1 if paired is None else 2 for *_, paired in LAWS.values()]
        gone = [n * k * (k == 1 or stay == "no") for n, k in zip(leaving, each, strict=True)]
        left = [k * len(X) - n for n, k in zip(gone, each, strict=True)]
        assert outs[0] == [*left, sum(left[-2:]) / 2, sum(gone)]
        if stay == "yes":
            assert outs[1][:-2] == [k * (len(X) - n) for n, k in zip(leaving, each, strict=True)]
            assert outs[1][-2] == 0
            events = read_events(folder)
            ends = [event for event in events if event.kind == "division_end"]
            assert [event.cause for event in ends] == ["grown"] * 2 * len(X)
            deaths = [e.time for e in events if e.kind == "death" and e.type > 8]
            assert min(deaths) > 1.9


def test_a_cell_whose_spring_does_not_end_is_lost(tmp_path: Path) -> None:
    lines = [*setup(), f"set type 2 z {HEIGHT + 5.2}", "run 0"]
    message = error_of(run(tmp_path, lines))
    assert "Fix skin/cells: spring cell" in message
    assert "has lost the membrane on step 0" in message


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_cell_that_does_not_detach_may_be_anywhere(ranks: int, tmp_path: Path) -> None:
    """It keeps the energy of its plateau, and has no nearest membrane particle out of reach."""
    lines = [
        *setup(), f"set type 4 z {HEIGHT + 5.2}", "timestep 0.01", "run 4 post no",
        "compute nearest all reduce max f_cells[1] f_cells[7]", "group far type 4",
        "compute far far reduce max f_cells[1] f_cells[7]", "run 0 post no",
        f'print "OUT $(f_cells[{COUNTS[2]}]) $(f_cells[1]:%.12g) $(c_far[1]) $(c_far[2])"',
    ]  # fmt: skip
    ((count, adhesion, partner, distance),) = told(run(tmp_path, lines, ranks))
    assert count == len(X)
    assert adhesion >= len(X) * 9.0 * u_kind(np.array([9.9]), "adhesive", 1.4, NONE)[0][0]
    assert (partner, distance) == (0, -1)


def test_without_setup_ghosts_must_reach_as_far(tmp_path: Path) -> None:
    """A kind whose range is longer from now on is compared with ghosts when forces are needed."""
    change = "fix_modify cells kind late law adhesive 9 2.5"
    message = error_of(run(tmp_path, [*setup(), "run 1", change, "run 1 pre no"]))
    assert "needs a communication cutoff of at least 6.6 but has 5.5" in message
    lines = [*setup(), "run 1", change, "comm_modify cutoff 7", "run 1"]
    assert run(tmp_path, lines).returncode == 0


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_pair_ends_beyond_a_distance(ranks: int, tmp_path: Path) -> None:
    """With `apart`: not when its spring is full grown, but on the event step after it is wide."""
    fix = f"{FIX} apart 0.5 every 2 log events.csv"
    lines = [line if line != FIX else fix for line in setup()]
    lines += [
        "timestep 0.1", "run 30 post no", 'print "OUT $(f_cells[8]) $(time)"',
        "displace_atoms wide move 0.3 0.2 -0.45", "run 4 post no",
        'print "OUT $(f_cells[8]) $(time)"',
    ]  # fmt: skip
    last = len(LAWS) * len(X) + len(places())  # the younger of the last pair, which never leaves
    lines.insert(-5, f"group wide id {last - 2 * len(X) + 2}")
    before, after = told(run(tmp_path, lines, ranks))
    assert after[0] == before[0] - 1
    (end,) = [event for event in read_events(tmp_path) if event.cause == "grown"]
    assert end.time == pytest.approx(3.2)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("nerve law none", "nerve: there is no such kind"),
        ("loose type 3", "loose needs a value that can change, but got type"),
        ("loose", "loose needs a value that can change, but got nothing"),
        ("loose law bound -2", "loose law bound K = -2: must be a number >= 0"),
        ("loose generations 3", "loose: generations needs daughter"),
        ("loose detach 1", "loose detach lambda = 1: must be > 1"),
        ("loose cycle 1 1 1", "loose: cycle needs daughter"),
        ("bound-pair law none", "bound-pair: paired needs law bound or adhesive"),
    ],
)
def test_changes_that_are_rejected(change: str, message: str, tmp_path: Path) -> None:
    lines = [*setup(), f"fix_modify cells kind {change}", "run 0"]
    assert f"Fix skin/cells kind {message}" in error_of(run(tmp_path, lines))
