"""Own input scripts around the built ones: what a user adds to ``skin.in``."""

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from lammps_skin.model.scene import Scene
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import FOUR_STEPS, QUIET

BUSY = {
    "membrane.lattice": [24, 28], "cells.stem": 2, "cells.nd": 1, "cells.arrangement": "random",
    "cells.cycle_delay": 2.0, "cells.cycle_rate": 0.5, "cells.first_phase": 2.0,
    "cells.division_rate": 1.4, "numerics": FOUR_STEPS, "output": QUIET,
}  # fmt: skip


def busy(scene: str = "no-dermis", **changes: object) -> Scene:
    """Two stem cells (673, 674) that divide every few time units, and an ND cell (675)."""
    return Scene.load(scene).replace(**{**BUSY, **changes})


def kind_rows(
    types: Sequence[object] = ("stem", "ta", "exhausted", "nd"),
    adhesion: str = "25 1.2",
    binding: str = "25",
    cycle: str = "2.0 0.5 2.0",
    generations: int = 10,
) -> str:
    """The four kinds of the model, or the first of them, as arguments of the fix."""
    detach = adhesion.split()[1]
    rows = [
        f"kind stem type {{}} law bound {binding} cycle {cycle} daughter ta",
        f"kind ta type {{}} law adhesive {adhesion} detach {detach} cycle {cycle} daughter ta "
        f"generations {generations} last exhausted",
        f"kind exhausted type {{}} law none detach {detach}",
        f"kind nd type {{}} law bound {binding}",
    ]
    return " ".join(row.format(type_) for row, type_ in zip(rows, types, strict=False))


def fix_line(scene: Scene, adhesion: str = "25 1.2") -> str:
    """The fix of the cells as a user would write it."""
    return (
        f"skin/cells {scene.seed} membrane membrane {kind_rows(adhesion=adhesion)} contact 2.4 "
        "spring 5 0.014 1.4 2.8 offset 0.007 every 2"
    )


def run_script(
    directory: Path,
    *lines: str,
    scene: Scene | None = None,
    start: Configuration | None = None,
    ranks: int = 1,
    arguments: tuple[str, ...] = (),
) -> subprocess.CompletedProcess[str]:
    """Run ``skin.in`` without its run command and then these lines, in a built directory."""
    if scene is not None:
        build(scene, directory, start)
    setup = (directory / "skin.in").read_text().splitlines()
    assert setup[-1].startswith("run ")
    quiet = ["thermo_style custom step time atoms", "thermo_modify lost error norm no"]
    script = [*setup[:-1], *quiet, *lines]
    return run(directory, script, ranks, arguments)


def run(
    directory: Path, script: Sequence[str], ranks: int = 1, arguments: tuple[str, ...] = ()
) -> subprocess.CompletedProcess[str]:
    """Run an input script in a directory."""
    (directory / "case.in").write_text("\n".join(script) + "\n")
    binaries = Path(sys.executable).parent
    launcher = [str(binaries / "mpirun"), "-launcher", "fork", "-np", str(ranks)]
    command = [*(launcher if ranks > 1 else []), str(binaries / "lmp"), "-log", "none"]
    return subprocess.run(
        [*command, *arguments, "-in", "case.in"],
        cwd=directory, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip


def told(process: subprocess.CompletedProcess[str]) -> list[list[float]]:
    """Numbers of the lines that a script prints as ``print "OUT ..."``."""
    assert process.returncode == 0, process.stdout[-1500:] + process.stderr[-1500:]
    lines = [line for line in process.stdout.splitlines() if line.startswith("OUT ")]
    return [[float(word) for word in line.split()[1:]] for line in lines]


def error_of(process: subprocess.CompletedProcess[str]) -> str:
    """The one error line of a run that was refused or has stopped."""
    assert process.returncode != 0
    errors = [line for line in process.stdout.splitlines() if line.startswith("ERROR")]
    assert len(errors) == 1, process.stdout[-1500:] + process.stderr[-1500:]
    return errors[0]


def snapshots(path: Path) -> list[dict[str, np.ndarray]]:
    """Frames of a dump as columns by name, sorted by the first one."""
    found = []
    for text in path.read_text().split("ITEM: TIMESTEP\n")[1:]:
        head, *rows = text.split("ITEM: ATOMS ")[1].splitlines()
        table = np.array([row.split() for row in rows], float)
        table = table[np.argsort(table[:, 0])]
        found.append(dict(zip(head.split(), table.T, strict=True)))
    return found
