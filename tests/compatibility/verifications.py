"""What rows of the table look at, in what a run has left: functions of the try and of the scene
alone."""

import re

import numpy as np
from lammps_skin.model import potentials

from tests.compatibility.tries import CLOSE, Try, read_dump

SIDES = np.array([12.0, 12.124355652982141])


def lineage(done: Try, plain: Try) -> None:
    """Cells still divide and leave."""
    assert done.events_of("birth")
    assert done.events_of("death")


def no_events(done: Try, plain: Try) -> None:
    """Nothing divides or leaves."""
    assert not done.events


def same_events(done: Try, plain: Try) -> None:
    """The same cells divide and leave at the same times as without the command."""
    names = ("kind", "id", "parent", "type", "divisions_left", "cause")
    assert [[e[k] for k in names] for e in done.events] == [
        [e[k] for k in names] for e in plain.events
    ]
    times = [[float(e["time"]) for e in t.events] for t in (done, plain)]
    np.testing.assert_allclose(*times, **CLOSE)


def same_positions(done: Try, plain: Try) -> None:
    """All particles are where they are without the command, or at a periodic image."""
    assert done.atoms["id"].tolist() == plain.atoms["id"].tolist()
    for axis, side in zip("xyz", [*SIDES, np.inf], strict=True):
        apart = done.atoms[axis] - plain.atoms[axis]
        image = np.round(apart / side) * side if np.isfinite(side) else 0.0
        np.testing.assert_allclose(apart - image, 0.0, atol=CLOSE["atol"])


def shifted(done: Try, plain: Try) -> None:
    """All particles are 1.5 and 0.3 further in x and y than without the command."""
    for axis, shift in (("xu", 1.5), ("yu", 0.3), ("zu", 0.0)):
        np.testing.assert_allclose(done.atoms[axis], plain.atoms[axis] + shift, atol=1e-4)


def turned(done: Try, plain: Try) -> None:
    """The membrane is turned by half a turn about the centre of the box."""
    for axis, side in zip(("x", "y"), SIDES, strict=True):
        apart = (done.atoms[axis] + plain.atoms[axis]) / side
        np.testing.assert_allclose(apart, np.round(apart), atol=1e-6)


def doubled(done: Try, plain: Try) -> None:
    """Two copies have twice the particles and the energy."""
    assert len(done.atoms["id"]) == 2 * len(plain.atoms["id"])
    assert np.isclose(done.thermo[-1]["PotEng"], 2 * plain.thermo[-1]["PotEng"], **CLOSE)


def same_energy(done: Try, plain: Try) -> None:
    assert np.isclose(done.thermo[-1]["PotEng"], plain.thermo[-1]["PotEng"], **CLOSE)


def halts_at_births(done: Try, plain: Try) -> None:
    """The run ends at the first step with more than ten births."""
    times = [float(event["time"]) for event in done.events_of("birth")]
    assert 10 < len(times) < 20
    assert times[10] > times[-1] - 0.5


def stem_cells_rest(done: Try, plain: Try) -> None:
    """TA cells divide, stem cells don't."""
    stems = set(plain.atoms["id"][plain.atoms["type"] == 2].astype(int))
    parents = {int(event["parent"]) for event in done.events_of("birth")}
    assert parents
    assert not parents & stems


def inherited(done: Try, plain: Try) -> None:
    """A newborn has the clone and the molecule of the founder of its line."""
    atoms = read_dump(done.directory / "clones.dump")
    clones = dict(zip(atoms["id"].astype(int), atoms["i_clone"].astype(int), strict=True))
    parents = {int(e["id"]): int(e["parent"]) for e in done.events_of("birth")}
    assert parents
    for cell, clone in clones.items():
        founder = cell
        while founder in parents:
            founder = parents[founder]
        assert clone == founder
    assert (done.atoms["mol"] == np.where(done.atoms["type"] > 1, 7, 0)).all()


def pair_table(done: Try, plain: Try) -> None:
    """Energies and forces in the file of pair_write are those of the formulas in Python."""
    table = rows_of(done, "pairs.txt")
    energy = 0.04 * potentials.truncated(table[:, 1] / 2.8, 1.0)
    np.testing.assert_allclose(table[:, 2], energy, rtol=1e-6, atol=1e-12)


def overlaid_pair_table(done: Try, plain: Try) -> None:
    """Exclusion and adhesion of two stem cells are one table."""
    table = rows_of(done, "pairs.txt")
    x = table[:, 1] / 2.8
    energy = 0.04 * potentials.truncated(x, 1.0) + 0.03 * potentials.shifted_adhesion(x, 1.2)
    np.testing.assert_allclose(table[:, 2], energy, rtol=1e-6, atol=1e-12)


def bond_table(done: Try, plain: Try) -> None:
    """Energies in the file of bond_write are those of the formula in Python."""
    table = rows_of(done, "bonds.txt")
    energy = 0.04 * potentials.stretch(table[:, 1] / 2.0, 1.25, 0.25)
    np.testing.assert_allclose(table[:, 2], energy, rtol=1e-6, atol=1e-12)


def dihedral_table(done: Try, plain: Try) -> None:
    """Energies in the file of dihedral_write are those of the formula."""
    table = rows_of(done, "dihedrals.txt")
    angle = np.radians(table[:, 1])
    np.testing.assert_allclose(table[:, 2], 0.25 * (1 + np.cos(angle)) ** 2, atol=1e-6)


def rows_of(done: Try, name: str) -> np.ndarray:
    """Numbers of a table file of LAMMPS."""
    lines = [line.split() for line in done.read(name).splitlines()]
    return np.array([w for w in lines if len(w) == 4 and w[0].isdigit()], float)


def last_frame(done: Try, plain: Try) -> None:
    """The last frame of x.dump holds the final state."""
    text = done.read("x.dump").split("ITEM: TIMESTEP\n")[-1]
    names, *lines = text.split("ITEM: ATOMS ")[1].splitlines()
    values = np.array([line.split() for line in lines], float)
    for name, column in zip(names.split(), values.T, strict=True):
        if name in done.atoms:
            np.testing.assert_allclose(column, done.atoms[name], rtol=1e-5, err_msg=name)


def warns_of_two_integrators(done: Try, plain: Try) -> None:
    assert "atoms are time integrated more than once" in done.read("log.lammps")


def printed_equal(done: Try, plain: Try) -> None:
    """Both numbers of printed.txt are the same, and not 0."""
    left, right = map(float, done.read("printed.txt").split())
    assert left != 0
    assert np.isclose(left, right, **CLOSE)


def warns_of_inherit(done: Try, plain: Try) -> None:
    """LAMMPS warns that daughters do not move."""
    warnings = re.findall("WARNING: (.*)", done.read("log.lammps"))
    assert any("inherit" in warning for warning in warnings)


def warns_of_lists(done: Try, plain: Try) -> None:
    """A warning says that particles have moved beyond the neighbor lists."""
    assert re.search("WARNING: .*neighbor", done.read("log.lammps"))
