"""Measured rates of which the expected cost of a run is made, and how fast this machine is.

The rates are of one core of an AMD EPYC, from ``python benchmarks/run_cost.py fit``. How many times
longer a run takes on another machine is stored in the cache directory of the user, by
`lammps_skin.study.cost.calibrate`.
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import astuple, dataclass, replace
from pathlib import Path

from lammps_skin.files import atomic_write


@dataclass(frozen=True)
class Rates:
    """Seconds of one core.

    Attributes
    ----------
    evaluation : float
        Of an evaluation of all forces, whatever its size.
    membrane, dermal, cell : float
        Of an evaluation, for each particle of a kind.
    rebuild : float
        Of a rebuild of the neighbor lists, for each particle.
    frame : float
        Of a frame of the trajectory.
    start, packed : float
        Until the first step: of a process that loads the package and LAMMPS, and for each dermal
        particle that is packed.
    """

    evaluation: float = 4.0e-6
    membrane: float = 4.4e-8
    dermal: float = 7.7e-8
    cell: float = 1.01e-6
    rebuild: float = 4.2e-7
    frame: float = 7.6e-3
    start: float = 1.7
    packed: float = 3.6e-4

    def times(self, running: float, starting: float) -> Rates:
        """Those of a machine on which a run, and its start, take so many times longer."""
        starts = {"start": self.start * starting, "packed": self.packed * starting}
        scaled = Rates(*(running * rate for rate in astuple(self)))
        return replace(scaled, **starts)


SHIPPED = Rates()


def calibration_file() -> Path:
    """Where the calibration is stored."""
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(cache) / "lammps-skin" / "calibration.json"


def stored() -> tuple[float, float] | None:
    """How many times longer a run, and its start, take on this machine; None if not calibrated.

    A calibration of other shipped rates does not count, nor does a file that holds none.
    """
    try:
        found = json.loads(calibration_file().read_text("utf-8"))
        running, starting = float(found["running"]), float(found["starting"])
        same = found["rates"] == list(astuple(SHIPPED))
    except (OSError, ValueError, TypeError, KeyError):
        return None
    good = all(0 < factor < math.inf for factor in (running, starting))
    return (running, starting) if same and good else None


def rates_here() -> Rates:
    """The shipped rates, as calibrated."""
    return SHIPPED.times(*(stored() or (1.0, 1.0)))


def store(running: float, starting: float) -> None:
    """Store how many times longer a run, and its start, take on this machine."""
    path = calibration_file()
    path.parent.mkdir(parents=True, exist_ok=True)
    found = {"running": running, "starting": starting, "rates": astuple(SHIPPED)}
    with atomic_write(path) as part:
        part.write_text(json.dumps(found), "utf-8")
