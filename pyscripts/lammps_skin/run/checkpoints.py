"""Checkpoints of a run that Python drives: restart files that are whole, or known not to be."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

from lammps_skin.engine.built import SCENE_FILE
from lammps_skin.errors import SimulationError, SkinError
from lammps_skin.files import atomic_write, put_in_place, remove_leftovers, set_aside, sync
from lammps_skin.model.scene import Scene
from lammps_skin.run.results import EVENTS, LOG, MANIFEST, holds_results, restart_files
from lammps_skin.start.build import INTERVENTIONS, SCRIPTS
from lammps_skin.trajectory.recorder import interval, steps_between
from lammps_skin.trajectory.store import STORE

PART = "skin.step*.restart.part"  # while LAMMPS writes it; LAMMPS puts the step for the star
KEPT = 3
DATA = "skin.data"
TRIAL = """
import sys
from lammps_skin.errors import SkinError
from lammps_skin.run.simulation import Simulation
try:
    Simulation.begin_built(sys.argv[1], variables={"restart": sys.argv[2]}).close()
except SkinError as error:
    sys.exit(str(error).partition(" (starting")[0])
"""
LONGEST_TRIAL = 600.0  # seconds
MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
MAGIC = b"LammpS RestartT\0"  # how a restart file begins and ends


class Checkpoints:
    """Brings the restart files of a run to disk, and keeps the newest.

    LAMMPS writes to a name that no one reads. When the file, and the trajectory that belongs to
    it, are on disk, the file gets its name, and checkpoints.json the lengths and hashes of it
    and of the event log. Each change of a name is one step of the file system.

    Parameters
    ----------
    directory : Path
        A built scene.
    scene : Scene
    variables : mapping
        What is given to LAMMPS instead of the scene's values.

    Attributes
    ----------
    passed_over : list of Path
        Restart files that get another name when the run begins, since they are damaged.
    """

    def __init__(self, directory: Path, scene: Scene, variables: Mapping[str, object]) -> None:
        self.passed_over: list[Path] = []
        self._directory = directory
        self._variables = dict(variables)
        self._interval = interval("checkpoint_interval", scene, variables)
        self._kept: list[dict[str, Any]] = []
        self._begun = False

    def begin(self, engine: Any) -> None:
        """Before the first step: remove what comes after the state from which the run begins.

        That is all of an earlier run if the state is not from a restart file.
        """
        if self._begun:
            return
        resumed, now = "restart" in self._variables, engine.step()
        try:
            for part in self._directory.glob(PART):
                part.unlink()
            remove_leftovers(self._directory / MANIFEST)
            for path in self.passed_over:
                set_aside(path)
            for path in restart_files(self._directory):
                if not path.is_dir() and (not resumed or _step_of(path) > now):
                    path.unlink()
            if resumed:
                manifest = _read_manifest(self._directory) or {}
                listed = manifest.get("checkpoints", [])
                self._kept = [entry for entry in listed if entry["step"] <= now]
            self._write_manifest()
        except OSError as error:
            raise self._failure(self._directory / MANIFEST, error) from None
        self._begun = True

    def due(self, engine: Any, step: int) -> bool:
        """Whether LAMMPS writes a restart file at a step."""
        every = self._every(engine)
        return every > 0 and step % every == 0

    def stops(self, engine: Any, step: int) -> Iterator[int]:
        """Steps of checkpoints on the way to a step, this included."""
        every = self._every(engine)
        if every:
            yield from range((engine.step() // every + 1) * every, step + 1, every)

    def finish(self, engine: Any) -> None:
        """Make a checkpoint of the file that LAMMPS has written at this step, if it has."""
        part = self._part(engine.step())
        if part.exists():
            self._keep(part, engine.step(), engine.time())

    def write(self, engine: Any) -> None:
        """Write a checkpoint now, unless the run has none, or has one of this step."""
        step = engine.step()
        if not (self._begun and self._interval) or (self._kept and self._kept[-1]["step"] == step):
            return
        engine.command(f"write_restart {self._part(step)}")
        self._keep(self._part(step), step, engine.time())

    def latest(self) -> Path | None:
        """The last checkpoint, or the file from which the run began."""
        if self._kept:
            return self._path(self._kept[-1]["step"])
        given = self._variables.get("restart")
        return None if given is None else self._directory / str(given)

    def _every(self, engine: Any) -> int:
        return steps_between(self._interval, engine)

    def _path(self, step: int) -> Path:
        return self._directory / f"skin.step{step}.restart"

    def _part(self, step: int) -> Path:
        return self._directory / PART.replace("*", str(step))

    def _keep(self, part: Path, step: int, reached: float) -> None:
        """Bring all that belongs to a checkpoint to disk, give it its name, remove the oldest."""
        path = self._path(step)
        try:
            if (self._directory / STORE).exists():
                sync(self._directory / STORE)
            files = {path.name: _length_and_hash(part)}
            if (self._directory / EVENTS).exists():
                files[EVENTS] = _length_and_hash(self._directory / EVENTS)
            entry = {"step": step, "time": reached, "files": files}
            self._kept = [*self._kept[1 - KEPT :], entry]
            put_in_place(part, path, on_disk=True)
            self._write_manifest()
            kept = {self._path(entry["step"]) for entry in self._kept}
            for old in set(self._directory.glob("skin.step*.restart")) - kept:
                old.unlink()
        except OSError as error:
            raise self._failure(path, error) from None

    def _write_manifest(self) -> None:
        """Replace checkpoints.json in one step; without checkpoints there is none."""
        path = self._directory / MANIFEST
        if not self._interval:
            path.unlink(missing_ok=True)
            return
        content = {
            "inputs": {name: _hash(self._directory / name) for name in _inputs(self._directory)},
            "variables": {k: v for k, v in self._variables.items() if k != "restart"},
            "checkpoints": self._kept,
        }
        content["hash"] = content_hash(content)
        with atomic_write(path, on_disk=True) as part:
            part.write_text(json.dumps(content, indent=1, default=str) + "\n", "utf-8")

    def _failure(self, path: Path, error: OSError) -> SkinError:
        return SkinError(f"checkpoint {path}: {error.strerror}")


class Resumption(NamedTuple):
    """How to go on with a run.

    Attributes
    ----------
    restart : str or None
        Name of the restart file; None for the initial state.
    variables : dict
        What was given to the run.
    notes : list of str
        What is to be told.
    passed_over : list of Path
        Newer restart files, which are damaged.
    """

    restart: str | None
    variables: dict[str, Any]
    notes: list[str]
    passed_over: list[Path]


def find_resumption(directory: Path) -> Resumption:
    """The newest good checkpoint of a run, by its step.

    A checkpoint is good if its restart file and the event log up to it are what they were when it
    was made. A restart file of which no hash is known, as those that plain `lmp` writes, is read
    by another process first. A run that ended before its first checkpoint begins again.

    Raises
    ------
    SimulationError
        If there is none, if an input file has changed since the run began, and if a checkpoint
        cannot be read now, but may be good.
    """
    notes: list[str] = []
    passed_over: list[Path] = []
    manifest = _read_manifest(directory)
    if manifest is None:
        manifest = {}
        notes.append(f"checkpoints {directory / MANIFEST}: is damaged; hashes are not compared")
    listed = {_name(entry): entry for entry in manifest.get("checkpoints", [])}
    paths = sorted(restart_files(directory), key=_step_of, reverse=True)
    for path in paths:
        entry = listed.get(path.name)
        try:
            fault = _fault(directory, entry) or _fault_of_form(path)
        except OSError as error:
            raise SimulationError(
                f"checkpoint {path}: file {error.filename or path}: {error.strerror}; "
                "it may be good, and no older one is taken"
            ) from None
        if fault is None:
            _check_inputs(directory, manifest, set())
            fault = None if entry else _fault_of_content(directory, path)
        if fault is None:
            return Resumption(path.name, manifest.get("variables", {}), notes, passed_over)
        passed_over.append(path)
        notes.append(f"checkpoint {path}: {fault}")
    if paths:
        raise SimulationError(f"directory {directory}: has no good checkpoint; " + "; ".join(notes))
    began = "inputs" in manifest or ((directory / LOG).exists() and not holds_results(directory))
    if listed or not began:
        raise SimulationError(f"directory {directory}: holds no checkpoint to resume from")
    _check_inputs(directory, manifest, {DATA})
    notes.append("the run ended before its first checkpoint, and begins again")
    return Resumption(None, manifest.get("variables", {}), notes, [])


def checkpoint_times(directory: Path) -> dict[float, Path]:
    """Restart files by the times of their states, the oldest first; also while a run goes on."""
    try:
        entries = (_read_manifest(directory) or {}).get("checkpoints", [])
    except SkinError:
        return {}
    files = {float(entry["time"]): directory / _name(entry) for entry in entries}
    return {time: path for time, path in files.items() if path.exists()}


def _name(entry: Mapping[str, Any]) -> str:
    return f"skin.step{entry['step']}.restart"


def _check_inputs(directory: Path, manifest: Mapping[str, Any], more: set[str]) -> None:
    """Refuse to go on with another scene; the data file counts only where a run begins."""
    for name, expected in manifest.get("inputs", {}).items():
        path = directory / name
        if (name != DATA or name in more) and (not path.exists() or _hash(path) != expected):
            raise SimulationError(
                f"input {path}: is not what it was when the run began; the run cannot go on"
            )


def _fault(directory: Path, entry: Mapping[str, Any] | None) -> str | None:
    """What is wrong with the files of a checkpoint; raises `OSError` if that cannot be seen now."""
    for name, expected in entry["files"].items() if entry else ():
        try:
            found = list(_length_and_hash(directory / name, expected[0]))
        except (FileNotFoundError, IsADirectoryError) as error:
            return f"{name}: {error.strerror}"
        if found != expected:
            return f"{EVENTS} does not go with it" if name == EVENTS else "is damaged"
    return None


def _fault_of_form(path: Path) -> str | None:
    """What is wrong with the form of a restart file; raises `OSError` if that cannot be seen."""
    try:
        written = _read_head(path)[1]
    except (IsADirectoryError, ValueError, struct.error):
        return "is damaged"
    try:
        day, month, year = written.split()[:3]
        date = [int(year), MONTHS.index(month) + 1, int(day)]
    except ValueError:
        return "is damaged"
    if version("lammps").split(".")[:3] != [*map(str, date)]:
        return f"was written by LAMMPS {written}, and this is {version('lammps')}"
    return None


def _fault_of_content(directory: Path, path: Path) -> str | None:
    """What is wrong with a restart file, from a simulation elsewhere that begins with it.

    It may crash, or never end, which is why it is another process.
    """
    with tempfile.TemporaryDirectory(prefix="skin-") as copy:
        for name in [*_inputs(directory), path.name]:
            (Path(copy) / name).symlink_to((directory / name).resolve())
        command = [sys.executable, "-P", "-c", TRIAL, copy, path.name]
        try:
            trial = subprocess.run(command, capture_output=True, timeout=LONGEST_TRIAL, text=True)
        except subprocess.TimeoutExpired:
            return "is damaged"
    if trial.returncode == 0:
        return None
    if -trial.returncode in (signal.SIGKILL, signal.SIGTERM):
        raise SimulationError(f"checkpoint {path}: the process that tried it was killed")
    return f"cannot be read: {trial.stderr.strip()}" if trial.returncode == 1 else "is damaged"


def _step_of(path: Path) -> int:
    """Step of a restart file: in the names that we give, else in the file.

    Of a file that cannot be read it may be any: so that it is looked at, the highest.
    """
    word = path.name.split(".")[1]
    if word.startswith("step") and word[4:].isdigit():
        return int(word[4:])
    try:
        return _read_head(path)[0]
    except (OSError, ValueError, struct.error):
        return sys.maxsize


def _read_head(path: Path) -> tuple[int, str]:
    """Step and LAMMPS' version in a restart file.

    After the magic string come byte order and revision, and then flags with values: of the
    version (0), of the sizes of integers (1, 48, 2, 3), of the units (4) and of the step (5).
    """
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC or struct.unpack("=i", file.read(4)) != (1,):
            raise ValueError
        _, flag, size = struct.unpack("=3i", file.read(12))
        written = file.read(size)
        flags = struct.unpack("=10i", file.read(40))
        file.read(flags[9])
        step_flag, step = struct.unpack("=iq", file.read(12))
        if (flag, *flags[:9:2], step_flag) != (0, 1, 48, 2, 3, 4, 5):
            raise ValueError
        file.seek(-len(MAGIC), os.SEEK_END)
        if file.read() != MAGIC:
            raise ValueError
    return int(step), written.rstrip(b"\0").decode("ascii")


def _inputs(directory: Path) -> list[str]:
    """Files from which a run is made."""
    tables = (path.name for path in directory.glob("*.table"))
    names = [*SCRIPTS, "scene.in", INTERVENTIONS, SCENE_FILE, DATA, *tables]
    return sorted(name for name in names if (directory / name).exists())


def _read_manifest(directory: Path) -> dict[str, Any] | None:
    """What checkpoints.json says, nothing if there is no such file; None if it is damaged."""
    path = directory / MANIFEST
    try:
        manifest: dict[str, Any] = json.loads(path.read_text("utf-8"))
        whole = manifest.pop("hash") == content_hash(manifest)
    except FileNotFoundError:
        return {}
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None
    return manifest if whole else None


def content_hash(content: Mapping[str, Any]) -> str:
    """Hash of what checkpoints.json says; stands in it, too."""
    text = json.dumps(content, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def _length_and_hash(path: Path, length: int | None = None) -> tuple[int, str]:
    """Of a file or its beginning."""
    with path.open("rb") as file:
        content = file.read(-1 if length is None else length)
    return len(content), hashlib.sha256(content).hexdigest()


def _hash(path: Path) -> str:
    return _length_and_hash(path)[1]
