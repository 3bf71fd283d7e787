"""What holds of every file of the repository: it needs nothing beside it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ROOMS = (".ci", "benchmarks", "docs", "lammps_inputs", "plugins", "pyscripts", "tests")
TOP = ("CMakeLists.txt", "Makefile", "README.md", "pyproject.toml")
TEXTS = {"", ".c", ".cpp", ".csv", ".h", ".in", ".md", ".py", ".sh", ".toml", ".txt"}
FILES = [ROOT / name for name in TOP] + [
    path for room in ROOMS for path in sorted((ROOT / room).rglob("*"))
    if path.is_file() and path.suffix in TEXTS
]  # fmt: skip


def places(source: str, file: Path) -> Iterator[Path]:
    """Places that a Python source computes from where it lies."""
    expressions = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.expr))
    for code in {ast.unparse(node) for node in expressions}:
        if "__file__" in code:
            try:
                place = eval(code, {"Path": Path, "__file__": str(file)})
            except NameError:  # it needs more than the place of the file
                continue
            if isinstance(place, Path):
                yield place.resolve()


def climbs_to_nothing(path: str, file: Path) -> bool:
    """Whether a path with ".." in a file leads to nothing of the repository.

    It starts where the file lies, or, as commands of the pages do, in a room.
    """
    targets = [(start / path).resolve() for start in (file.parent, *(ROOT / r for r in ROOMS))]
    installed = (ROOT / ".venv", ROOT / "runs")
    return not any(
        (target.is_relative_to(ROOT) and target.exists()) or target.is_relative_to(made)
        for target in targets for made in installed
    )  # fmt: skip


CLIMBING = re.compile(r"(?<![\w/])(?:\.\./)+[\w.-]+(?:/[\w.-]+)+")


def test_places_of_python_files_are_in_the_repository() -> None:
    sources = {path: path.read_text("utf-8") for path in FILES if path.suffix == ".py"}
    found = [
        (path, place)
        for path, source in sources.items() if "__file__" in source
        for place in places(source, path)
    ]  # fmt: skip
    assert found
    for path, place in found:
        assert place.is_relative_to(ROOT), f"{path}: {place}"


def test_climbing_paths_stay_in_the_repository() -> None:
    """A single name, as "../up", is bad input of a test."""
    found = [
        (str(path.relative_to(ROOT)), climbing)
        for path in FILES
        for climbing in CLIMBING.findall(path.read_text("utf-8"))
        if climbs_to_nothing(climbing, path)
    ]
    assert not found


def test_no_file_names_a_place_of_a_developer() -> None:
    homes = re.compile(r"(?<![\w.])/(?:home|Users|root|work)/\w+")
    assert not [path for path in FILES if homes.search(path.read_text("utf-8"))]


def test_paths_out_of_the_repository_are_found() -> None:
    file = ROOT / "tests" / "physics" / "test_some.py"
    out = 'Path(__file__).resolve().parents[2].parent / "elsewhere" / "data"'
    assert ROOT.parent / "elsewhere" / "data" in places(f"x = {out}", file)
    up = "/".join(3 * [".."])
    assert CLIMBING.findall(f"cat {up}/elsewhere/data") == [f"{up}/elsewhere/data"]
    assert climbs_to_nothing(f"{up}/elsewhere/data", file)
    assert climbs_to_nothing("/".join(["..", "elsewhere", "data"]), file)
    assert not climbs_to_nothing("/".join(["..", "test_repository.py"]), file)


def test_columns_of_the_plugin():
    """As LAMMPS has it, no line is longer than 100 columns."""
    sources = (ROOT / "plugins").iterdir()
    long = [
        f"{path.name}:{n}"
        for path in sources for n, line in enumerate(path.read_text().splitlines(), 1)
        if len(line) > 100
    ]  # fmt: skip
    assert not long


def test_names_of_test_files_are_unique() -> None:
    """Two of one name cannot be collected together."""
    names = sorted(path.name for path in (ROOT / "tests").rglob("test_*.py"))
    assert names == sorted(set(names))
