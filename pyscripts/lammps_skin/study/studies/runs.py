"""The folder of a study: its runs, what has become of them."""

from __future__ import annotations

import csv
import os
import shutil
import socket
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from lammps_skin.engine.built import SCENE_FILE
from lammps_skin.errors import SkinError
from lammps_skin.files import atomic_write
from lammps_skin.run.directory_lock import is_held
from lammps_skin.run.results import EVENTS, PROVENANCE
from lammps_skin.study.ensemble import Member, members
from lammps_skin.study.studies.design import Design, Point

DESIGN, TABLE, HISTORY = "study.toml", "observables.csv", "history.csv"
KEPT = {SCENE_FILE, TABLE, HISTORY, EVENTS, PROVENANCE}  # of a run that is done
HEADING = ("time", "event", "machine", "process", "error")
STATES = ("done", "running", "failed", "missing")


class StudyRun(Member):
    """A run of a study: a directory with its scene, its observables and its history.

    ``history.csv`` has a line whenever the run has begun, has been resumed, is done or has failed.
    """

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
            raise SkinError(f"history {self.directory / HISTORY}: {error}") from None

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
            elif path.name not in KEPT:
                path.unlink()


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
        folder = self.folder.absolute()
        return [
            Runs(point, [StudyRun(one.scene, folder)
                         for one in members([point.scene], self.design.seeds, folder)])
            for point in self.design.points
        ]  # fmt: skip

    @cached_property
    def runs(self) -> list[StudyRun]:
        """All runs, each once: points may have the same scene."""
        return list({run.directory: run for point in self.points for run in point.runs}.values())

    def missing(self, share: tuple[int, int] | None = None) -> list[StudyRun]:
        """Runs that are not done; of a share (k, n) each n-th of all runs, from the k-th on."""
        mine = self.runs if share is None else self.runs[share[0] - 1 :: share[1]]
        return [run for run in mine if not run.done]

    def write_design(self) -> None:
        """Write the design into the folder."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with atomic_write(self.folder / DESIGN) as part:
                part.write_text(self.design.text, "utf-8")
        except OSError as error:
            raise SkinError(f"folder {self.folder}: {error.strerror}") from None
