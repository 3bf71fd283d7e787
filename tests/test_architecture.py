"""The page on the architecture and the README name the rooms, modules, files and names."""

import ast
import importlib
import re
from pathlib import Path

import lammps_skin
from lammps_skin.model import potentials
from lammps_skin.model.terms import TERMS
from pages import BY_NAME, PACKAGE, ROOT, codes, fences, rows, section, text


def imports(path: Path) -> set[str]:
    """Modules that a source file imports from the package, as dotted names within it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("lammps_skin"):
            room = str(node.module).removeprefix("lammps_skin").lstrip(".")
            names = [f"{room}.{alias.name}".lstrip(".") for alias in node.names]
            found |= {name if is_module(name) else room for name in names}
    return found - {""}


def is_module(name: str) -> bool:
    place = PACKAGE.joinpath(*name.split("."))
    return place.is_dir() or place.with_suffix(".py").exists()


def room_of(name: str) -> str:
    """The room that a module is in."""
    return name.split(".")[0] if (PACKAGE / name.split(".")[0]).is_dir() else "lammps_skin"


def test_rooms() -> None:
    """Every room is named, nothing else is, and none imports one below it."""
    rooms = [row[0].strip("`") for row in rows(section("architecture.md", "The package"))
             if room_of(row[0].strip("`")) == row[0].strip("`")]  # fmt: skip
    there = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    assert sorted(rooms) == sorted(there | {"lammps_skin"})
    for path in PACKAGE.rglob("*.py"):
        inside = path.relative_to(PACKAGE)
        if inside.name == "__init__.py":
            continue
        room = inside.parts[0] if len(inside.parts) > 1 else "lammps_skin"
        allowed_rooms = rooms[: rooms.index(room) + 1]
        assert {room_of(name) for name in imports(path)} <= set(allowed_rooms), inside


def test_modules() -> None:
    """Every module of some rooms is named, nothing else is, and none imports one below it."""
    table = rows(section("architecture.md", "The package"))
    named = [row[0].strip("`") for row in table]
    named = [name for name in named if room_of(name) != name]
    for room in {room_of(name) for name in named}:
        folder = PACKAGE if room == "lammps_skin" else PACKAGE / room
        prefix = "" if room == "lammps_skin" else f"{room}."
        there = {f"{prefix}{path.stem}" for path in folder.glob("*.py") if path.stem != "__init__"}
        if prefix:
            there |= {f"{prefix}{path.parent.name}" for path in folder.glob("*/__init__.py")}
        mine = [name for name in named if room_of(name) == room]
        assert sorted(mine) == sorted(there)
        for n, module in enumerate(mine):
            place = PACKAGE.joinpath(*module.split("."))
            files = [*place.glob("*.py")] if place.is_dir() else [place.with_suffix(".py")]
            used = {found for path in files for found in imports(path) if room_of(found) == room}
            used = {found for found in used if not f"{found}.".startswith(f"{module}.")}
            used = {next((name for name in mine if f"{found}.".startswith(f"{name}.")), found)
                    for found in used}  # fmt: skip
            assert used <= set(mine[:n]), module


def test_names_of_the_architecture() -> None:
    """Functions and constants that the page names are in the files that it names beside them."""
    for what, cpp, *_ in rows(section("architecture.md", "What is stated twice")):
        files = [name for name in codes(cpp) if name.startswith("plugins/")]
        code = "".join(text(name) for name in files)
        for name in set(codes(cpp)) - set(files):
            assert re.search(rf"\b{name}\b", code), f"{what}: {name}"


def attribute(name: str) -> object:
    """What a dotted name of the package stands for; raises if it stands for nothing."""
    found: object = importlib.import_module("lammps_skin")
    for n, part in enumerate(parts := name.split(".")):
        try:
            found = getattr(found, part)
        except AttributeError:
            found = importlib.import_module(".".join(["lammps_skin", *parts[: n + 1]]))
    return found


def test_names_of_the_package() -> None:
    """Dotted names in the architecture, names that begin with the package, and imports."""
    named = re.findall(r"`([a-z]\w*(?:\.\w+)+)`", text("architecture.md"))
    modules = {path.stem for path in PACKAGE.iterdir()}
    found = {name for name in named if name.split(".")[0] in modules}
    for page in BY_NAME:
        found |= set(re.findall(r"`lammps_skin\.([\w.]+)`", text(page)))
        trees = [ast.parse(block) for block in fences(page, "python")]
        for node in (node for tree in trees for node in ast.walk(tree)):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("lammps_skin"):
                prefix = f"{node.module}.".removeprefix("lammps_skin.")
                found |= {f"{prefix}{alias.name}" for alias in node.names}
    assert {"model.potentials.stretch", "Scene"} <= found
    for name in sorted(found):
        attribute(name)


def test_sources_of_the_plugin() -> None:
    sources = {path for pattern in ("*.cpp", "*.h") for path in (ROOT / "plugins").glob(pattern)}
    named = set(codes(section("architecture.md", "plugins/")))
    for source in sources:
        assert {f"plugins/{source.stem}{suffix}" for suffix in (".cpp", ".h")} & named, source.name


PAGES_OF_STYLES = [f"docs/{path.name}" for path in (ROOT / "docs").glob("*_skin*.md")]


def test_terms() -> None:
    table = rows(section("architecture.md", "Terms"))
    assert [row[0].strip("`") for row in table] == list(TERMS)
    for row in table:
        assert callable(getattr(potentials, codes(row[2])[0].removeprefix("model.potentials.")))
    ours = {name for row in table for name in re.findall(r"`([^`]+)` \(ours\)", row[1])}
    registered = re.findall(
        r'style = "(\w+)";\s*plugin.name = "([\w/]+)"', text("plugins/skinplugin.cpp")
    )
    styles = {f"{style}{'' if style == 'fix' else '_style'} {name}" for style, name in registered}
    assert ours | {"fix skin/motion", "pair_style skin/core"} == styles
    titles = re.findall(r"^# (.+) command$", "\n".join(map(text, PAGES_OF_STYLES)), re.MULTILINE)
    assert sorted(titles) == sorted(styles)


def test_the_readme_names_every_public_name() -> None:
    table = section("README.md", "Python")
    assert {name for row in rows(table) for name in codes(row[0])} | {
        name for name in codes(table) if name.endswith("Error")
    } == set(lammps_skin.__all__)
