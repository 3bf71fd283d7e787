"""What has been measured, on disk: files that are named by a hash of all that they depend on."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lammps_skin.engine.engine import Motion
from lammps_skin.errors import SkinError
from lammps_skin.files import atomic_write

VERSION = 1  # to be raised when what is measured means something else


class EndState(NamedTuple):
    """Where all particles are at the end of an interval.

    Attributes
    ----------
    ids : (n,) array
    positions : (n, 3) array
        In the periodic box.
    motion : Motion
        How they came there.
    problem : str
        Why there are none, or nothing.
    """

    ids: Any
    positions: Any
    motion: Motion
    problem: str = ""


class Timing(NamedTuple):
    """CPU seconds of a time unit.

    Attributes
    ----------
    seconds : float
        Median of rounds.
    ratio, spread : float
        Over the seconds of the reference in the same round: median, and half of the difference
        between the largest and the smallest.
    problem : str
        Why there are none, or nothing.
    """

    seconds: float
    ratio: float
    spread: float
    problem: str = ""


class ResultFolder:
    """A folder of results; a file that is there is complete."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise SkinError(f"folder {folder}: {error.strerror}") from None

    def path(self, kind: str, name: str, key: str, suffix: str) -> Path:
        """Where a result is."""
        return self.folder / f"{kind}-{name}-{key}{suffix}"

    def save_end_state(self, path: Path, reached: EndState) -> None:
        with atomic_write(path) as part:
            np.savez(
                part, ids=reached.ids, positions=reached.positions,
                motion=np.array(reached.motion), problem=np.array(reached.problem),
            )  # fmt: skip

    def load_end_state(self, path: Path) -> EndState:
        with np.load(path) as file:
            motion = Motion(*file["motion"].tolist())
            return EndState(file["ids"], file["positions"], motion, str(file["problem"]))

    def save_timing(self, path: Path, timing: Timing) -> None:
        with atomic_write(path) as part:
            part.write_text(json.dumps(timing._asdict()))

    def load_timing(self, path: Path) -> Timing:
        values: Mapping[str, Any] = json.loads(path.read_text())
        return Timing(**values)
