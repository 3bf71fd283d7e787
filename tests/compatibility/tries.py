"""The table of LAMMPS commands that are tried beside our styles, and how one is tried.

The table is `commands/*.toml`. A row names a `command`, the `scene` that it is tried in, and the
`lines` that come after the set-up of the scene and before its run of 40 steps
(`@setup` stands for the set-up once more, `@plugin` for the path of the plugin). Keys of a row:

=========== ======================================================================================
works       the command works; the text says with what its numbers are compared
documented  it works, and means something else than a user may expect; the text says what
refused     what the error says that the run ends with; `says` may add to it
like        other lines that come to the same state of all particles; empty for the scene alone
check       equations of LAMMPS' expressions that hold at the end of the run, `left = right`, or
            `left ~ right` for a thousandth
verify      a function of `verifications` that looks at what the run has left
edit        texts of the set-up and what they are replaced by
run         number of steps, 40 if not given
after       lines that come after the run
balanced    false if other commands create or remove atoms, so that events do not account for all
atoms       false if there are no atoms to look at in the end
arguments   command line of LAMMPS
on_ranks    what the error says on several ranks, if that is something else; "hangs" where LAMMPS
            itself never ends there, which is not tried
young       true for the state of time 0, without deaths
slow        true if it is not for the quick tests
=========== ======================================================================================
"""

import csv
import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from lammps_skin import plugin

from tests.compatibility.scenes import STATE

HERE = Path(__file__).resolve().parent
FAMILIES = {path.stem: path for path in sorted((HERE / "commands").glob("*.toml"))}
STEPS = 40
CLOSE = {"rtol": 1e-9, "atol": 1e-9}


@dataclass(frozen=True)
class Row:
    """A command of the table."""

    command: str
    scene: str
    family: str
    lines: str = ""
    works: str = ""
    documented: str = ""
    refused: str = ""
    says: str = ""
    like: str | None = None
    check: Sequence[str] = ()
    verify: str = ""
    edit: dict[str, str] = field(default_factory=dict)
    run: int = STEPS
    after: str = ""
    balanced: bool = True
    atoms: bool = True
    arguments: str = ""
    on_ranks: str = ""
    young: bool = False
    slow: bool = False

    @property
    def result(self) -> str:
        return next(name for name in ("works", "documented", "refused") if getattr(self, name))


def table() -> list[Row]:
    """All rows, in the order of the page."""
    return [
        Row(family=family, **row)
        for family, path in FAMILIES.items()
        for row in tomllib.loads(path.read_text("utf-8"))["row"]
    ]


def script(row: Row, setup: str) -> str:
    """The input script of a try."""
    for old, new in row.edit.items():
        assert old in setup, f"{row.command}: no {old!r} in the set-up"
        setup = setup.replace(old, new)
    sides = [side for equation in row.check for side in re.split(" [=~] ", equation)]
    names = [f"side{n}" for n in range(len(sides))]
    checks = [f'variable {name} equal "{side}"' for name, side in zip(names, sides, strict=True)]
    columns = " ".join(f"v_{name}" for name in names)
    properties = STATE if row.scene != "membrane" else ""
    end = [
        f"thermo_style custom step time atoms temp pe {columns}",
        "thermo_modify norm no line one lost error format float %.17g",
        "thermo 10",
        f"run {row.run}",
        row.after,
    ]
    if row.atoms:
        end.append(
            f"write_dump all custom final.dump id type mol xu yu zu x y z {properties} "
            "modify sort id format float %.17g"
        )
    lines = row.lines.replace("@setup", setup).replace(
        "@plugin", f"{plugin.folder()}/skinplugin.so"
    )
    return "\n".join([setup, lines, *checks, *end]) + "\n"


@dataclass(frozen=True)
class Try:
    """What a run has left.

    Attributes
    ----------
    status : int
        0, 1 after an error of LAMMPS, negative for the signal that ended it.
    error : str
        LAMMPS' message.
    """

    row: Row
    directory: Path
    status: int
    error: str

    def read(self, name: str) -> str:
        return (self.directory / name).read_text()

    @cached_property
    def atoms(self) -> dict[str, np.ndarray]:
        """Columns of the final state, sorted by ID."""
        return read_dump(self.directory / "final.dump")

    @property
    def thermo(self) -> list[dict[str, float]]:
        """Rows of the thermo output of all runs, by column."""
        return read_thermo(self.read("log.lammps"))

    @property
    def events(self) -> list[dict[str, str]]:
        path = self.directory / "events.csv"
        return list(csv.DictReader(path.open(newline=""))) if path.exists() else []

    def events_of(self, kind: str) -> list[dict[str, str]]:
        return [event for event in self.events if event["kind"] == kind]


def read_dump(path: Path) -> dict[str, np.ndarray]:
    """Columns of the only frame of a dump file."""
    head, body = path.read_text().split("ITEM: ATOMS ")
    names, *lines = body.splitlines()
    assert int(head.split("ITEM: NUMBER OF ATOMS\n")[1].split()[0]) == len(lines)
    values = np.array([line.split() for line in lines], float).reshape(len(lines), -1)
    return dict(zip(names.split(), values.T, strict=True))


def read_thermo(log: str) -> list[dict[str, float]]:
    rows: list[dict[str, float]] = []
    columns: list[str] = []
    for line in log.splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            columns = words
        elif columns and len(words) == len(columns) and re.fullmatch(r"\d+", words[0]):
            rows.append(dict(zip(columns, map(float, words), strict=True)))
        elif line.startswith("Loop time"):
            columns = []
    return rows


# ---- what holds after each try


def assert_equations(done: Try) -> None:
    """The equations of the row."""
    last = done.thermo[-1]
    for n, equation in enumerate(done.row.check):
        left, right = (last[f"v_side{k}"] for k in (2 * n, 2 * n + 1))
        within = {"rtol": 1e-3} if " ~ " in equation else CLOSE
        assert np.isclose(left, right, **within), f"{equation}: {left!r} and {right!r}"


def assert_alike(done: Try, other: Try) -> None:
    """The same particles at the same places, with the same state and energy."""
    ours, theirs = done.atoms, other.atoms
    assert ours["id"].tolist() == theirs["id"].tolist()
    for name in ours.keys() - set("xyz"):
        values = ours[name]
        np.testing.assert_allclose(values, theirs[name], err_msg=name, **CLOSE)
    for name in ("Step", "Time", "PotEng"):
        assert np.isclose(done.thermo[-1][name], other.thermo[-1][name], **CLOSE), name


def assert_consistent(done: Try, start: dict[str, np.ndarray]) -> None:
    """No ID twice, no number that is none, pairs of two, and an event log that tells no lies.

    Where no other command creates or removes atoms it also accounts for all of them.
    """
    atoms = done.atoms
    ids = atoms["id"].astype(int).tolist()
    assert len(set(ids)) == len(ids)
    assert all(np.isfinite(values).all() for values in atoms.values())
    births = [(int(event["id"]), int(event["parent"])) for event in done.events_of("birth")]
    deaths = [int(event["id"]) for event in done.events_of("death")]
    known = set(start["id"].astype(int))
    parents = dict(births)
    assert len(parents) == len(births)
    assert not known & set(parents)
    assert len(set(deaths)) == len(deaths)
    assert not set(deaths) & set(ids)
    if done.row.balanced:
        assert set(ids) == (known | set(parents)) - set(deaths)
    if "i_parent" not in atoms:
        return
    mothers = dict(zip(ids, atoms["i_parent"].astype(int), strict=True))
    assert all(mothers.get(n, parent) == parent for n, parent in births)
    pairs = {n: int(other) for n, other in zip(ids, atoms["i_pair"], strict=True) if other}
    assert all(pairs.get(other) == n for n, other in pairs.items())
