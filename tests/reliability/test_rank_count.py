"""How many ranks a run gets that is not told how many, and what cells do on them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from lammps_skin.engine import machine, rank_count, ranks
from lammps_skin.engine.rank_count import choose, worthwhile
from lammps_skin.engine.ranks import RanksError
from lammps_skin.errors import SkinError

from tests.cells.conftest import assert_same_events, read_events

QUICK = ("--set", "cells.cycle_delay=1", "--set", "cells.cycle_rate=1", "--set",
         "cells.first_phase=1", "--set", "cells.division_rate=2")  # fmt: skip


@pytest.mark.parametrize(
    ("particles", "cores", "expected"),
    [
        (674, 2, 1), (2321, 2, 1), (3999, 2, 1), (4000, 2, 2), (14_357, 1, 1), (14_357, 2, 2),
        (14_357, 4, 4), (14_357, 64, 7), (57_931, 16, 16), (57_931, 64, 28), (920_000, 128, 128),
    ],
)  # fmt: skip
def test_ranks_of_particles_and_cores(particles: int, cores: int, expected: int) -> None:
    assert worthwhile(particles, cores) == expected


@pytest.fixture
def eight_cores(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """A machine with 8 cores, none of them busy, and no mpirun around."""
    monkeypatch.setattr(rank_count, "cores", lambda: 8)
    monkeypatch.setattr(rank_count, "idle_cores", lambda: 8)
    monkeypatch.setattr(rank_count, "launched", lambda: False)
    monkeypatch.setattr(ranks, "_shared_memory", lambda: 1e9)
    return monkeypatch


def test_all_idle_cores(eight_cores: pytest.MonkeyPatch) -> None:
    assert choose(60_000) == (8, "")
    assert choose(60_000, threads=3) == (2, "")
    eight_cores.setattr(rank_count, "installed", lambda: 350e6)
    assert choose(60_000) == (3, "")


@pytest.mark.parametrize(("idle", "expected"), [(7, 7), (3, 3), (0, 1), (None, 8)])
def test_cores_of_others_are_left_to_them(
    idle: int | None, expected: int, eight_cores: pytest.MonkeyPatch
) -> None:
    eight_cores.setattr(rank_count, "idle_cores", lambda: idle)
    found, why = choose(60_000)
    assert found == expected
    told = f"ranks = {expected}: other programs use the rest of 8 cores; --ranks 8 starts 8"
    assert why == ("" if expected == 8 else told)


@pytest.mark.parametrize("size", ["PMI_SIZE", "OMPI_COMM_WORLD_SIZE", "SLURM_STEP_NUM_TASKS"])
def test_one_rank_in_a_job_of_mpi(size: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rank_count, "cores", lambda: 8)
    monkeypatch.setenv(size, "1")
    found, why = choose(60_000)
    assert found == 1 and why.startswith("ranks = 1: mpirun or srun has started this process")


def test_one_rank_with_little_shared_memory(eight_cores: pytest.MonkeyPatch) -> None:
    eight_cores.setattr(ranks, "_shared_memory", lambda: 32e6)
    found, why = choose(60_000)
    assert found == 1 and "ranks = 1: /dev/shm has only 32 MB" in why


def test_idle_cores_of_this_process(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Three cores, of which core 2 is another's: 0 is idle, 1 is not, whatever 2 is."""
    monkeypatch.setattr(machine, "STATISTICS", tmp_path / "stat")
    monkeypatch.setattr(machine, "_own_cores", lambda: {0, 1})
    monkeypatch.setattr(machine.time, "monotonic", iter([0.0, 0.2]).__next__)

    def write(idle: int) -> None:
        rows = [f"cpu{core} 5 0 5 {ticks} 7 0 0" for core, ticks in ((0, idle), (1, 9), (2, idle))]
        (tmp_path / "stat").write_text("\n".join([f"cpu 15 0 15 {2 * idle + 9} 21", *rows, "intr"]))

    write(100)
    monkeypatch.setattr(machine.time, "sleep", lambda _: write(120))
    assert machine.idle_cores() == 1


def test_cores_by_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine, "_own_cores", lambda: set(range(8)))
    monkeypatch.setattr(machine, "quotas", lambda: iter([5.5]))
    monkeypatch.delenv(machine.LIMIT, raising=False)
    assert machine.cores() == 5
    monkeypatch.setenv(machine.LIMIT, "3")
    assert machine.cores() == 3
    monkeypatch.setenv(machine.LIMIT, "two")
    with pytest.raises(SkinError, match="LAMMPS_SKIN_CORES = two: must be a whole number from 1"):
        machine.cores()


# ---- runs


@pytest.fixture
def small_ranks(eight_cores: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """A scene of 846 particles gets two of them."""
    eight_cores.setattr(rank_count, "PARTICLES", 400)
    return eight_cores


def test_a_run_on_as_many_ranks_as_pay_off(
    skin: Callable[..., Any], small_ranks: pytest.MonkeyPatch
) -> None:
    """Its progress says how many; the lineage is that of one, also after going on on one."""
    answer = skin("run", "one-stem", "--until", 5, "-o", "two", *QUICK)
    assert answer.code == 0 and "t/s  2 ranks; " in answer.out
    assert "on 2 procs" in Path("two/log.lammps").read_text()
    answer = skin("run", "two", "--resume", "--until", 10, "--ranks", 1)
    assert answer.code == 0 and "t/s  1 rank; " in answer.out
    skin("run", "one-stem", "--until", 10, "-o", "one", "--ranks", 1, *QUICK)
    assert sum(event.kind == "birth" for event in read_events(Path("one"))) > 5
    assert_same_events(Path("two"), Path("one"))


def test_one_rank_where_no_more_start(
    skin: Callable[..., Any], small_ranks: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    broken = tmp_path / "mpirun"
    broken.write_text("#!/bin/sh\necho no network\nexit 1\n")
    broken.chmod(0o755)
    small_ranks.setattr(ranks, "_mpirun", lambda: str(broken))
    answer = skin("run", "one-stem", "--until", 0.5)
    assert answer.code == 0 and "t/s  1 rank; " in answer.out
    assert answer.out.count("ranks = 1: mpirun could not start 2 ranks: no network") == 1
    answer = skin("run", "one-stem", "--until", 0.5, "--ranks", 2, "--force")
    assert answer.code == 2 and "mpirun could not start 2 ranks: no network" in answer.err

    def missing() -> str:
        raise RanksError("there is no mpirun")

    small_ranks.setattr(ranks, "_mpirun", missing)
    assert choose(60_000) == (1, "ranks = 1: there is no mpirun")
