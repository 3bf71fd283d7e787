"""The folder of a study: its runs, what has become of them."""

from __future__ import annotations

import csv
import os
import shutil
import socket
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import ClassVar, NamedTuple

from lammps_skin.engine.built import SCENE_FILE
from lammps_skin.errors import SceneError, SkinError
from lammps_skin.files import atomic_write
from lammps_skin.model.scene import Scene
from lammps_skin.run.directory_lock import is_held
from lammps_skin.run.provenance import Provenance, refresh
from lammps_skin.run.results import EVENTS, PROVENANCE
from lammps_skin.study.ensemble import Member, members
from lammps_skin.study.result_keys import result_key
from lammps_skin.study.runner import Progress
from lammps_skin.study.studies.design import Design, Point
from lammps_skin.study.studies.forks import before
from lammps_skin.trajectory.store import STORE

DESIGN, TABLE, HISTORY = "study.toml", "observables.csv", "history.csv"
TRUNKS = "trunks"  # folder of the runs up to a fork
KEPT = {SCENE_FILE, TABLE, HISTORY, EVENTS, PROVENANCE}  # of a run that is done
HEADING = ("time", "event", "machine", "process", "error")
STATES = ("done", "running", "failed", "missing")


class StudyRun(Member):
    """A run of a study: a directory with its scene, its observables and its history.

    ``history.csv`` has a line whenever the run has begun, has been resumed, is done or has failed.

    Attributes
    ----------
    kept : set of str
        Files that stay when it is done.
    """

    kept: ClassVar[set[str]] = KEPT

    @property
    def table(self) -> Path:
        return self.directory / TABLE

    @property
    def error(self) -> str:
        """With what it has failed the last time; nothing if it has not, or is done."""
        history = [] if self.done else self.history
        return history[-1]["error"] if history and history[-1]["event"] == "failed" else ""

    @property
    def state(self) -> str:
        """One of `STATES`."""
        if self.done:
            return "done"
        if self.directory.is_dir() and is_held(self.directory):
            return "running"
        return "failed" if self.error else "missing"

    @property
    def history(self) -> list[dict[str, str]]:
        """Lines of the history."""
        try:
            with (self.directory / HISTORY).open(newline="", encoding="utf-8") as file:
                return list(csv.DictReader(file, HEADING))[1:]
        except FileNotFoundError:
            return []
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            reason = getattr(error, "strerror", None) or error
            raise SkinError(f"history {self.directory / HISTORY}: {reason}") from None

    def note(self, event: str, error: str = "") -> None:
        """Add a line to the history; what cannot be written, as on a full disk, is left out."""
        path = self.directory / HISTORY
        error = error.replace(str(self.directory), self.directory.name)
        with suppress(OSError):
            self.directory.mkdir(parents=True, exist_ok=True)
            new = not path.exists()
            with path.open("a", newline="", encoding="utf-8") as file:
                writer = csv.writer(file, lineterminator="\n")
                if new:
                    writer.writerow(HEADING)
                now = datetime.now(UTC).isoformat(timespec="milliseconds")
                writer.writerow((now, event, socket.gethostname(), os.getpid(), error))

    def tidy(self) -> None:
        """Remove the trajectory and what else only a run that goes on needs."""
        for path in self.directory.iterdir():
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            elif path.name not in self.kept:
                path.unlink()
        refresh(self.directory, [TABLE])


class Trunk(StudyRun):
    """A run up to a fork; its trajectory is kept, with the state from which others go on."""

    kept = KEPT | {STORE}

    @property
    def directory(self) -> Path:
        return self.folder / TRUNKS / super().directory.name


@dataclass(frozen=True)
class Branch(StudyRun):
    """A run from a fork on. Its scene is that of the whole time.

    Attributes
    ----------
    trunk : Trunk
        Its first part, which is run before if it has not been.
    """

    trunk: Trunk = field(kw_only=True)

    @property
    def key(self) -> str:
        return result_key(super().key, self.trunk.key, made_by=dict(self.made_by))

    @property
    def seconds(self) -> float:
        return max(super().seconds - self.trunk.seconds, 0.0)

    @property
    def begun(self) -> Scene:
        state = {"start.from": str(self.trunk.directory), "start.time": self.trunk.scene.end_time}
        return self.scene.replace(**state)

    def run(self, keep: bool = False, progress: Progress | None = None) -> None:
        if not self.done:
            self.trunk.run(progress=progress)
        super().run(keep, progress)


class Runs(NamedTuple):
    """The runs of a point, by ascending seeds."""

    point: Point
    runs: list[StudyRun]


@dataclass(frozen=True)
class Study:
    """A design, and the folder in which it is run."""

    design: Design
    folder: Path

    @cached_property
    def points(self) -> list[Runs]:
        """The runs of each point."""
        return [Runs(point, list(self._runs_of(point))) for point in self.design.points]

    def _runs_of(self, point: Point) -> Iterator[StudyRun]:
        folder, fork = self.folder.absolute(), self.design.fork
        try:
            found = members([point.scene], self.design.seeds, folder)
        except SceneError as error:
            raise SceneError(f"study {self.design.name}: {point.label}: {error}") from None
        for one in found:
            if fork is None:
                yield StudyRun(one.scene, folder)
            else:
                trunk = before(self.design.scene.replace(seed=one.seed), fork)
                yield Branch(one.scene, folder, trunk=Trunk(trunk, folder))

    @cached_property
    def runs(self) -> list[StudyRun]:
        """All runs, each once: points may have the same scene."""
        return list({run.directory: run for point in self.points for run in point.runs}.values())

    def missing(self, share: tuple[int, int] | None = None) -> list[StudyRun]:
        """Runs that are not done; of a share (k, n) each n-th of all runs, from the k-th on."""
        mine = self.runs if share is None else self.runs[share[0] - 1 :: share[1]]
        return [run for run in mine if not run.done]

    def todo(self, share: tuple[int, int] | None = None) -> list[StudyRun]:
        """The same after the runs up to a fork that they need."""
        missing = self.missing(share)
        trunks = {run.trunk: None for run in missing if isinstance(run, Branch)}
        return [*(trunk for trunk in trunks if not trunk.done), *missing]

    @property
    def provenance(self) -> Provenance:
        """What tells of each time that the study is run."""
        seeds = ", ".join(map(str, self.design.seeds))
        return Provenance(
            self.folder, self.design.name,
            f"A study with lammps-skin, of the scene {self.design.scene.name}",
            {"seeds": seeds, "parameters": self.design.scene.parameters},
            inputs=[DESIGN], results=["*.parquet"], goes_on=True,
        )  # fmt: skip

    def write_design(self) -> None:
        """Write the design into the folder."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with atomic_write(self.folder / DESIGN) as part:
                part.write_text(self.design.text, "utf-8")
        except OSError as error:
            raise SkinError(f"folder {self.folder}: {error.strerror}") from None
