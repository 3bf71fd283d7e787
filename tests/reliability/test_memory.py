"""Memory stays flat and ids are never used twice, over many births and after clear."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.engine.engine import lammps_message, open_lammps
from lammps_skin.errors import SimulationError
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import memory

from tests.cells.conftest import of_kind, read_events
from tests.reliability.conftest import STATE

LARGEST_ID = 2**31 - 1
STEM = 24
HEIGHT = 5.0
# nothing moves but for births; daughters are beyond the range of adhesion and leave at once
SETTING = """
units lj
atom_style molecular
newton on
atom_modify map {kind}
boundary p p f
region box block 0 12 0 12 0 20
create_box 4 box
fix state all property/atom {state}
mass * 1
pair_style zero 4.0 nocoeff
pair_coeff * *
special_bonds lj/coul 0.0 1.0 1.0
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
comm_modify cutoff 5.0
timestep 0.01
thermo 1000000
"""
CELLS = """
group cells type 2:4
set group cells i_divisions_left 1 d_next_division -1 d_detached_time -1
fix cells cells skin/cells 1 membrane 1 contact 2.4 &
    kind stem type 2 law bound 25 cycle 0 1000 0 daughter exhausted &
    kind exhausted type 3 law none detach 1.1 &
    spring 5 0.014 0.14 2.8 offset 0.007 log {log}
"""


def start(lammps: Any, log: Path, first_id: int = 145, kind: str = "yes") -> None:
    """Stem cells above a square sheet of particles, in an empty LAMMPS with a map of a kind."""
    lammps.commands_string(SETTING.format(kind=kind, state=STATE))
    sheet = np.insert(np.indices((12, 12)).reshape(2, -1).T + 0.5, 2, HEIGHT, axis=1)
    spots = np.random.default_rng(1).permutation(sheet)[:STEM]
    spots += np.array([0.2, 0.1, 1.15 * 2.4])
    places = np.concatenate([sheet, spots])
    ids = [*range(1, 145), *range(first_id, first_id + STEM)]
    lammps.create_atoms(len(ids), ids, [1] * 144 + [2] * STEM, places.ravel().tolist())
    lammps.commands_string(CELLS.format(log=log))


def births(lammps: Any) -> int:
    return int(lammps.extract_fix("cells", 0, 1, 8, 0))


def resident() -> int:
    """Bytes of this process in memory."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


@pytest.fixture
def lammps() -> Iterator[Any]:
    engine = open_lammps(["-log", "none"])
    yield engine
    engine.close()


@pytest.mark.parametrize(("kind", "of_each"), [("hash", 0), ("yes", 8)])
@pytest.mark.parametrize("wanted", [4_000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_births_leave_no_memory_behind(
    wanted: int, kind: str, of_each: int, lammps: Any, tmp_path: Path
) -> None:
    """LAMMPS' map of atoms, an array by itself, has eight bytes for each id ever given."""
    start(lammps, tmp_path / "events.csv", kind=kind)
    lammps.command("run 100 post no")
    early, before = resident(), births(lammps)
    while births(lammps) < wanted:
        lammps.command("run 100 pre no post no")
    assert resident() - early < 3e5 + of_each * wanted
    assert before < wanted / 2

    lammps.command("unfix cells")
    newborn = [event.id for event in of_kind(read_events(tmp_path), "birth")]
    dead = [event.id for event in of_kind(read_events(tmp_path), "death")]
    assert newborn == list(range(145 + STEM, 145 + STEM + len(newborn)))
    assert len(dead) == len(set(dead)) > wanted - 2 * STEM
    assert set(dead) <= set(newborn)


def test_clear_leaves_no_memory_behind(lammps: Any, tmp_path: Path) -> None:
    """Each time a run with hundreds of births, whose arrays are all given back."""
    sizes = []
    for _ in range(30):
        start(lammps, tmp_path / "events.csv")
        lammps.command("run 50 post no")
        assert births(lammps) > 100
        lammps.command("clear")
        sizes.append(resident())
    assert sizes[-1] - sizes[5] < 1e6


# ---- the largest id


def test_ids_run_out(lammps: Any, tmp_path: Path) -> None:
    """The last births get the last ids; the next one ends the run in an error."""
    start(lammps, tmp_path / "events.csv", first_id=LARGEST_ID - STEM - 99)
    with pytest.raises(Exception) as error:
        lammps.command("run 100")
    text = lammps_message(str(error.value))
    expected = rf"Fix skin/cells: out of atom IDs on step \d+, the largest is {LARGEST_ID}"
    assert re.fullmatch(expected, text), text
    lammps.command("clear")
    ids = [event.id for event in of_kind(read_events(tmp_path), "birth")]
    assert ids[0] == LARGEST_ID - 99
    assert np.diff(ids).tolist() == [1] * (len(ids) - 1)
    assert ids[-1] <= LARGEST_ID


def test_the_largest_id_is_taken(lammps: Any, tmp_path: Path) -> None:
    start(lammps, tmp_path / "events.csv", first_id=LARGEST_ID - STEM + 1)
    with pytest.raises(Exception, match="out of atom IDs on step"):
        lammps.command("run 100")
    lammps.command("clear")
    assert not read_events(tmp_path)


def test_more_ranks_than_there_is_memory_for(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(memory, "installed", lambda: 2.5e9)
    error = r"ranks = 26: each needs at least 0\.1 GB of memory; there are 2\.5 GB"
    with pytest.raises(SimulationError, match=error):
        Simulation.begin("two-cells", tmp_path / "run", ranks=26)
    assert not (tmp_path / "run").exists()
