"""What stands in the directory of a built scene: the scene, and the data file with its faults."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from lammps_skin.errors import SceneError, reading
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.scene import Scene

SCENE_FILE = "scene.toml"

# LAMMPS brings a particle back into the box one side at a time, and hangs on those further away
FURTHEST = 1e6


def load_built(directory: Path) -> Scene:
    """Scene of a directory that was built before."""
    if not (directory / "skin.in").is_file():
        raise SceneError(f"directory {directory}: holds no built scene (there is no skin.in)")
    return Scene.load(directory / SCENE_FILE)


def variable(directory: Path, name: str, default: float | None = None) -> Any:
    """Value of a numeric variable in the scene.in of a built scene, of the type of the default.

    Raises `SceneError` if there is none and no default.
    """
    path = directory / "scene.in"
    try:
        statements = [line.split() for line in path.read_text("utf-8").splitlines()]
        text = next(words[3] for words in statements if words[1:2] == [name]).strip('"')
        return float(text) if default is None else type(default)(text)
    except (OSError, ValueError, IndexError, StopIteration):
        if default is not None:
            return default
        raise SceneError(f"{path}: states no {name}; build the scene again") from None


def section(path: Path, title: str) -> Iterator[list[str]]:
    """Words of the lines of a section; none if there is no such section."""
    with path.open(encoding="utf-8") as file:
        for line in file:
            if line.split("#")[0].strip() == title:
                break
        next(file, None)
        for line in file:
            if not line.strip():
                break
            yield line.split()


def check_data(path: Path, kinds: Sequence[Kind]) -> None:
    """Raise `SceneError` for what LAMMPS would not find wrong.

    That is a particle too many sides of the box away from it, and a file without the state of the
    cells: LAMMPS would take 0 for all of it. `kinds` are those of the scene.
    """
    try:
        sides = _sides(path)
        for words in section(path, "Atoms"):
            for axis, side, place in zip("xyz", sides, map(float, words[3:6]), strict=False):
                if not abs(place) <= FURTHEST * side:
                    raise SceneError(
                        f"data file {path}: {axis} = {place:g} of atom {words[0]} must be within "
                        f"{FURTHEST:g} times the box of {side:g}; build the scene again"
                    )
        has_state = any(section(path, "state")) or not any(map(is_cell, kinds))
        is_whole = 0 < sum(1 for _ in section(path, "Dihedrals")) == _count(path, "dihedrals")
    except (OSError, ValueError):
        return
    if is_whole and not has_state:
        raise SceneError(
            f"data file {path}: has no section 'state', that of the cells; build the scene again"
        )


def particle_count(directory: Path) -> int:
    """Number of particles in the data file of a built scene; 0 if it does not state it."""
    try:
        return _count(directory / "skin.data", "atoms")
    except (OSError, ValueError):
        return 0


def _count(path: Path, name: str) -> int:
    """A number in the header; 0 if it states none."""
    with path.open(encoding="utf-8") as file:
        for line in file:
            if line.split()[1:] == [name]:
                return int(line.split()[0])
    return 0


def box_sides(path: Path) -> tuple[float, float, float]:
    """Sides of the box along x, y and z; raises `SkinError` if the header does not state them."""
    with reading(f"data file {path}"):
        x, y, z = _sides(path)
        return x, y, z


def _sides(path: Path) -> list[float]:
    """Sides of the box along x, y and z, as far as the header states them."""
    sides: list[float] = []
    with path.open(encoding="utf-8") as file:
        for line in file:
            words = line.split()
            if words[2:4] == [f"{'xyz'[len(sides)]}lo", f"{'xyz'[len(sides)]}hi"]:
                sides.append(float(words[1]) - float(words[0]))
            if len(sides) == 3 or words[:1] == ["Atoms"]:
                break
    return sides
