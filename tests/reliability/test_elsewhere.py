"""It runs where others run: other file systems, batch systems, directories, settings, limits."""

from __future__ import annotations

import errno
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from lammps_skin.cli import main
from lammps_skin.engine import ranks
from lammps_skin.engine.ranks import RankedEngine, check_shared_memory
from lammps_skin.errors import SimulationError
from lammps_skin.model.scene_keys import to_toml
from lammps_skin.run.remedies import remedy
from lammps_skin.run.simulation import Simulation
from lammps_skin.trajectory.store import Store

from tests.reliability.bad_input import TINY

BIN = Path(sys.executable).parent
SKIN = str(BIN / "skin")
LONGEST = 240.0  # seconds, on a busy machine
SHIM = """
#include <errno.h>
static int refuse(int number) { errno = number; return -1; }
int flock(int, int) { return refuse(%d); }
int link(const char *, const char *) { return refuse(EPERM); }
int linkat(int, const char *, int, const char *, int) { return refuse(EPERM); }
"""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with scene.toml."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.toml").write_text(to_toml(TINY))
    return tmp_path


def skin(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [SKIN, *arguments], env={**os.environ, **environment}, capture_output=True, text=True,
        timeout=LONGEST,
    )  # fmt: skip


def assert_runs(*arguments: str, **environment: str) -> None:
    ended = skin("run", "scene.toml", "-o", "run", *arguments, **environment)
    assert ended.returncode == 0, ended.stderr
    assert Store("run/skin.h5").steps.tolist() == [0, 1, 2, 3]


# ---- file systems


@pytest.mark.parametrize(
    "number", [errno.ENOLCK, pytest.param(errno.EOPNOTSUPP, marks=pytest.mark.slow)]
)
def test_neither_locks_nor_hard_links(number: int, here: Path) -> None:
    shim = here / "shim.so"
    command = ["g++", "-x", "c++", "-shared", "-fPIC", "-o", str(shim), "-"]
    # extern "C", for the names that LAMMPS, HDF5 and Python call
    code = 'extern "C" {' + (SHIM % number).replace("#include <errno.h>", "") + "}"
    subprocess.run(command, input=f"#include <errno.h>\n{code}", text=True, check=True)
    assert_runs(LD_PRELOAD=str(shim))
    for more in (["run", "run", "--resume", "--until", "0.05"], ["stats", "run"]):
        ended = skin(*more, LD_PRELOAD=str(shim))
        assert ended.returncode == 0, ended.stderr


# ---- batch systems


@pytest.mark.parametrize(
    "environment",
    [
        pytest.param(
            {"SLURM_JOBID": "1", "SLURM_NNODES": "1", "SLURM_NODELIST": os.uname().nodename,
             "SLURM_TASKS_PER_NODE": "2"}, marks=pytest.mark.slow,
        ),
        {"SLURM_JOB_ID": "1", "SLURM_NNODES": "4", "SLURM_NODELIST": "node[1-4]",
         "SLURM_TASKS_PER_NODE": "2(x4)", "PBS_NODEFILE": "/nowhere", "PMI_SIZE": "1",
         "PMI_RANK": "0", "PMI_FD": "77", "HYDRA_LAUNCHER": "ssh", "HYDRA_HOST_FILE": "/nowhere"},
    ],
    ids=["slurm", "others"],
)  # fmt: skip
def test_variables_of_a_batch_system(environment: dict[str, str], here: Path) -> None:
    assert_runs("--ranks", "2", **environment)


def test_settings_of_the_user_reach_the_ranks(monkeypatch: pytest.MonkeyPatch) -> None:
    """What another mpirun has left does not."""
    settings = ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "OMPI_MCA_btl",
                "PMIX_MCA_gds", "MPIR_CVAR_DEBUG_SUMMARY")  # fmt: skip
    left = ("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "OMPI_UNIVERSE_SIZE", "PMIX_RANK",
            "OMPI_APP_CTX_NUM_PROCS", "OMPI_MCA_ess_base_vpid", "OMPI_MCA_orte_hnp_uri",
            "PMIX_NAMESPACE", "PMIX_SERVER_URI3", "PMI_RANK", "SLURM_PROCID")  # fmt: skip
    for name in (*settings, *left):
        monkeypatch.setenv(name, "1")
    passed = ranks._environment()
    assert [name for name in (*settings, *left) if name in passed] == [*settings]


def test_under_mpirun(here: Path) -> None:
    command = [str(BIN / "mpirun"), "-launcher", "fork", "-np", "2", SKIN]
    ended = subprocess.run(
        [*command, "run", "scene.toml", "-o", "run"], capture_output=True, text=True,
        timeout=LONGEST,
    )  # fmt: skip
    assert ended.returncode == 2
    assert ended.stderr == (
        "error: mpirun has started 2 processes, and each would do the same: start one, with "
        "--ranks 2, or ranks=2 in Python\n"
    )
    assert not Path("run").exists()


@pytest.mark.parametrize("size", ["PMI_SIZE", "OMPI_COMM_WORLD_SIZE", "SLURM_STEP_NUM_TASKS"])
def test_python_under_mpirun(size: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(size, "3")
    with pytest.raises(SimulationError, match="mpirun has started 3 processes, and each"):
        Simulation.begin("two-cells")


# ---- the working directory, and that of temporary files


def test_modules_of_the_user_and_a_long_place_of_temporary_files(here: Path) -> None:
    for name in ("random", "numpy", "signal", "tempfile", "lammps"):
        (here / f"{name}.py").write_text('raise SystemExit("mine")')
    long = here / ("a" * 100)
    long.mkdir()
    assert_runs("--ranks", "2", TMPDIR=str(long))


# ---- starts that fail


def processes_with(name: str) -> list[str]:
    """Command lines of the processes in whose arguments a name occurs."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            line = path.read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            continue
        if name in line:
            found.append(line)
    return found


def assert_ended(name: str) -> None:
    """Soon there is no such process."""
    deadline = time.monotonic() + LONGEST
    while processes_with(name):
        assert time.monotonic() < deadline, processes_with(name)
        time.sleep(0.1)


def test_a_start_that_lammps_refuses_leaves_nothing(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ranks.secrets, "token_hex", lambda _: "refused-start")
    skin("build", "scene.toml", "-o", "run")
    (here / "run" / "cells.in").write_text("nonsense\n")
    with pytest.raises(SimulationError, match="Unknown command: nonsense"):
        Simulation.begin_built(here / "run", ranks=2)
    assert not processes_with("refused-start")


def test_a_start_that_hangs_ends(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An mpirun that waits for something and does not heed SIGTERM."""
    hanging = here / "mpirun"
    hanging.write_text("#!/bin/sh\ntrap '' TERM\necho waiting for the queue\nsleep 600 & wait $!\n")
    hanging.chmod(0o755)
    monkeypatch.setattr(ranks, "_mpirun", lambda: str(hanging))
    monkeypatch.setattr(ranks, "PATIENCE", 0.3)
    monkeypatch.setattr(ranks, "GRACE", 0.2)
    with pytest.raises(SimulationError, match=r"started 0 of 2 ranks.*: waiting for the queue"):
        RankedEngine(2, 1, here)
    assert not processes_with(str(hanging))


def test_ranks_end_with_the_process_that_started_them(here: Path) -> None:
    """Also in the middle of many steps."""
    code = """
import secrets, threading, os, signal
secrets.token_hex = lambda _: "orphaned-ranks"
from lammps_skin import Simulation
simulation = Simulation.begin("scene.toml", "run", ranks=2, variables={"dump_interval": 0,
                        "checkpoint_interval": 0})
threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGKILL)).start()
simulation.run(until=1e5)
"""
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, timeout=LONGEST)
    assert ended.returncode == -signal.SIGKILL, ended.stderr
    assert_ended("orphaned-ranks")


def test_an_mpirun_that_outlives_a_rank(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One of two ranks goes, and nobody ends the other."""
    waiting = here / "mpirun"
    waiting.write_text(f"""#!{sys.executable}
import os, sys, time
from multiprocessing.connection import Client
key = bytes.fromhex(os.environ["LAMMPS_SKIN_WORKER_KEY"])
both = []
for rank in range(2):
    both.append(Client("\\0" + sys.argv[-1], "AF_UNIX", authkey=key))
    both[rank].send(rank)
both[1].close()
time.sleep(600)
""")
    waiting.chmod(0o755)
    monkeypatch.setattr(ranks, "_mpirun", lambda: str(waiting))
    monkeypatch.setattr(ranks, "CLEARANCE", 0.1)
    monkeypatch.setattr(ranks, "GRACE", 0.1)
    with pytest.raises(SimulationError, match="a rank has ended, and mpirun did not end the oth"):
        RankedEngine(2, 1, here)
    assert not processes_with(str(waiting))


# ---- memory


def test_little_shared_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    class Small:
        f_bavail, f_frsize = 16, 4096

    monkeypatch.setattr(os, "statvfs", lambda _: Small)
    error = r"ranks = 2: MPI needs 4 MB of shared memory; /dev/shm has 0\.0655 MB; make it larger"
    with pytest.raises(SimulationError, match=error):
        check_shared_memory(2)


def test_a_crash_with_little_shared_memory(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MPICH ends without a word at 16 and 20 MB, and does not at 6, 18 or 24 MB."""

    class Small:
        f_bavail, f_frsize = 4000, 4096

    silent = here / "mpirun"
    silent.write_text("#!/bin/sh\nexit 245\n")
    silent.chmod(0o755)
    monkeypatch.setattr(os, "statvfs", lambda _: Small)
    monkeypatch.setattr(ranks, "_mpirun", lambda: str(silent))
    error = r"not start 2 ranks: it does not say why; /dev/shm has only 16\.4 MB: make it larger"
    with pytest.raises(SimulationError, match=error):
        RankedEngine(2, 1, here)


# ---- settings of the user


@pytest.mark.parametrize("language", ["de_DE", pytest.param("fr_FR", marks=pytest.mark.slow)])
def test_numbers_and_months_are_english_whatever_the_locale(language: str, here: Path) -> None:
    """Where the user's program has set another one: 0.25 would be 0, and Jul no month."""
    if not shutil.which("localedef"):
        pytest.skip("there is no localedef")
    name = f"{language}.UTF-8"
    made = subprocess.run(
        ["localedef", "-i", language, "-f", "UTF-8", str(here / name)], capture_output=True
    )
    if made.returncode:
        pytest.skip(f"there is no locale {name}")
    code = f"""
import locale
locale.setlocale(locale.LC_ALL, "{name}")
assert locale.localeconv()["decimal_point"] == ","
from lammps_skin import Simulation
with Simulation.begin("scene.toml", "run") as simulation:
    simulation.run()
    simulation.command("variable half equal 0.5")
with Simulation.resume("run") as simulation:
    print(simulation.timestep, simulation.time)
assert locale.localeconv()["decimal_point"] == ","
"""
    ended = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, "LOCPATH": str(here)},
        capture_output=True, text=True, timeout=LONGEST,
    )  # fmt: skip
    assert ended.stdout == "0.01 0.03\n", ended.stderr
    assert Store("run/skin.h5").steps.tolist() == [0, 1, 2, 3]


def test_backend_and_style_of_matplotlib(here: Path) -> None:
    """The same picture, whatever the user has set for others."""
    with Simulation.begin("scene.toml", "run") as simulation:
        simulation.run()
    drawing = ("snapshot", "run", "--view", "height", "-o")
    with pytest.raises(SystemExit) as drawn:
        main([*drawing, "a.png"])
    assert drawn.value.code == 0
    (here / "matplotlibrc").write_text("text.usetex: True\naxes.facecolor: black\n")
    notebook = {"MPLBACKEND": "module://matplotlib_inline.backend_inline"}
    ended = skin(*drawing, "b.png", MATPLOTLIBRC=str(here), **notebook)
    assert ended.returncode == 0, ended.stderr
    assert Path("a.png").read_bytes() == Path("b.png").read_bytes()


# ---- what is said after an error


@pytest.mark.parametrize(
    ("error", "said"),
    [
        ("Fix skin/motion: the run is unstable; try a smaller timestep than 0.25", "try 0.1"),
        ("Lost atoms: original 10 current 9", "numerics.timestep = 0.25; try 0.1"),
        ("Fix skin/motion: atom 3 of type 1 leaves the box", "other membrane.height"),
        (f"trajectory x: {os.strerror(errno.ENOSPC)}", "make room for its files"),
        (f"checkpoint x: {os.strerror(errno.EDQUOT)}", "make room for its files"),
        ("a rank was killed (SIGKILL)", "when memory runs out"),
        ("trajectory x: Input/output error", "mend that, and resume the run"),
        ("the run is unstable; the state that this run began with is like that", "change it or"),
    ],
)
def test_remedies(error: str, said: str, tmp_path: Path) -> None:
    told = remedy(error, tmp_path, 0.25, 0.1)
    assert said in told
    assert ("timestep" in told) == ("skin/motion" in error or "Lost" in error)
    assert remedy(error, tmp_path / "gone", 0.25, 0.1).startswith(f"{tmp_path / 'gone'} is no")


def test_a_directory_that_is_renamed(here: Path) -> None:
    def move(*_: object) -> None:
        if (here / "run").exists():
            (here / "run").rename(here / "moved")

    error = r"run is no longer there: put it back, and resume the run"
    simulation = Simulation.begin("scene.toml", "run")
    with pytest.raises(SimulationError, match=error) as told, simulation:
        simulation.run(progress=move, every=0.01)
    assert "timestep" not in str(told.value)
