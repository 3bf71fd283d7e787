"""The documents say what is so: links, commands, keys, scenes, keywords, variables, modules."""

import ast
import importlib
import inspect
import json
import re
import tomllib
from itertools import pairwise
from pathlib import Path
from typing import Any

import lammps_skin
import numpy as np
import pytest
from lammps_skin.analysis import energies
from lammps_skin.cli import COMMANDS, application
from lammps_skin.cli.options import scene_from
from lammps_skin.model import parameters, potentials
from lammps_skin.model.accuracy import LEVELS
from lammps_skin.model.cell_kinds import CellKind
from lammps_skin.model.interventions import (
    NEEDS,
    RESERVED,
    SETTABLE,
    SETTABLE_OF_KINDS,
    Intervention,
    Region,
)
from lammps_skin.model.parts import KindKeys
from lammps_skin.model.scene import Scene
from lammps_skin.model.scenes import BUILT_IN
from lammps_skin.model.terms import TERMS, Terms
from lammps_skin.run.evaluate import SHORT
from lammps_skin.start.build import INTERVENTIONS, SCRIPTS
from lammps_skin.start.packing import FORCE_TOLERANCE, dermal_count
from pages import BY_NAME, PACKAGE, PAGES, ROOT, codes, commands, fences, rows, section, text
from pydantic import BaseModel
from typer.main import get_command

# ---- links


def slugs(page: str) -> set[str]:
    """Anchors of the headings of a page."""
    titles = re.findall(r"^#+ (.+)$", text(page), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=BY_NAME)
def test_links_resolve(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text("utf-8")):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        linked = (page.parent / path).resolve() if path else page
        assert linked.exists(), target
        if anchor:
            assert anchor in slugs(str(linked.relative_to(ROOT))), target


@pytest.mark.parametrize("page", BY_NAME)
def test_named_files_are_there(page: str) -> None:
    rooms = ("plugins", "pyscripts", "tests", "lammps_inputs", "docs", "benchmarks")
    for name in codes(text(page)):
        if name.startswith(tuple(f"{room}/" for room in rooms)):
            assert (ROOT / name).exists(), name


# ---- commands


def test_skin_commands_parse() -> None:
    """Also the scenes, keys and values that they name."""
    group = get_command(application(*COMMANDS))
    found = list(commands("skin"))
    assert {words[0] for _, words in found} >= {"check", "build", "run"}
    for page, (name, *words) in found:
        context = group.commands[name].make_context(name, list(words))
        source = context.params.get("source") or context.params.get("scene")
        if source in BUILT_IN:
            settings = context.params["parameters"], context.params["settings"]
            scene_from(source, *settings)
        else:
            directory = context.params.get("resume")
            assert source is None or directory or source.endswith(".toml"), f"{page}: {source}"


def test_lmp_commands_name_variables() -> None:
    given = {"dir", "restart", *index_variables()}
    for page, words in commands("lmp"):
        for flag, name in pairwise(words):
            assert flag != "-var" or name in given, f"{page}: {name}"


def test_toml_examples_are_scenes() -> None:
    blocks = [block for name in BY_NAME for block in fences(name, "toml")]
    assert blocks
    for block in blocks:
        Scene.from_dict(tomllib.loads(block))


def test_terms_of_evaluate() -> None:
    """Each short name, its term, and the column of the log."""
    table = rows(section("inputs.md", "A configuration in a text file"))
    named = {row[0].strip("`"): [word.strip("`") for word in row[1:]] for row in table}
    assert named.keys() >= {"cc_ad", "total"}
    for short, term in {**SHORT, "cc_ad_shifted": "cell_cell_adhesion"}.items():
        assert named[short][0] == energies.COLUMNS[named[short][1]] == term


# ---- the scene


def fields(model: type[BaseModel], prefix: str = "") -> dict[str, dict[str, Any]]:
    """JSON schema of every key of a scene."""
    schema = model.model_json_schema()["properties"]
    found = {}
    for name, field in model.model_fields.items():
        if inspect.isclass(field.annotation) and issubclass(field.annotation, BaseModel):
            found |= fields(field.annotation, f"{name}.")
        elif name not in ("kinds", "interventions"):  # which have pages of their own
            found[prefix + name] = schema[name]
    return found


def allowed(schema: dict[str, Any]) -> str:
    """What a schema allows, in the words of the page."""
    if "anyOf" in schema:
        choices = [choice for choice in schema["anyOf"] if choice.get("type") != "null"]
        return ", ".join(map(allowed, choices))
    if "enum" in schema:
        return ", ".join(f'`"{value}"`' for value in schema["enum"])
    if schema["type"] == "array":
        return f"{schema['maxItems']} of {allowed(schema['prefixItems'][0])}"
    if schema["type"] in ("string", "boolean"):
        return {"string": "text", "boolean": "`true`, `false`"}[schema["type"]]
    signs = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
    limits = [f"{sign} {schema[key]}" for key, sign in signs.items() if key in schema]
    whole = ["integer"] if schema["type"] == "integer" else []
    return ", ".join(whole + [limit for limit in limits if limit != f"<= {1e12}"])


def value_of(scene: BaseModel, key: str) -> str:
    """Value of a dotted key, as the page writes it."""
    value: Any = scene
    for part in key.split("."):
        value = getattr(value, part)
    return "none" if value is None else f"`{json.dumps(value)}`"


def test_keys_of_a_scene() -> None:
    table = {row[0].strip("`"): row[1:3] for row in rows(section("scene.md", "Keys"))}
    default = Scene.from_dict({})
    assert table == {
        key: [value_of(default, key), allowed(schema)] for key, schema in fields(Scene).items()
    }


def test_keys_of_a_kind_of_cells() -> None:
    table = {row[0].strip("`"): row[1:3] for row in rows(section("kinds.md", "Keys"))}
    plain = KindKeys()
    written = {"type": "string", "pattern": "#rrggbb"}
    assert table == {
        key: [
            value_of(plain, key),
            '`"#rrggbb"`' if written in schema["anyOf"] else allowed(schema),
        ]
        for key, schema in ((key, {"anyOf": [one], **one}) for key, one in fields(KindKeys).items())
    }


def test_keys_of_an_intervention() -> None:
    shapes = [f"within.{key}" for key in Region.model_fields]
    table = {row[0].strip("`"): row[1:] for row in rows(section("interventions.md", "Keys"))}
    assert sorted(table) == sorted([*Intervention.model_fields, *shapes])
    for key, others in NEEDS.items():
        assert codes(table[key][0]) == list(others), key
    assert codes(table["name"][1])[-len(RESERVED) :] == list(RESERVED)
    settable = [codes(row[0]) for row in rows(section("interventions.md", "What can be set"))]
    assert [key for keys in settable[:-1] for key in keys] == list(SETTABLE)
    assert settable[-1] == list(SETTABLE_OF_KINDS)


def test_rows_of_the_kinds_of_cells() -> None:
    def words(row: CellKind) -> list[str]:
        generations = "`cells.generations`" if row.generations == 10 else "-"
        return [
            f"`{row.label}`", str(int(row.kind)), f"`{row.adhesion}`",
            "yes" if row.detaches else "no", f"`{row.daughter}`" if row.daughter else "-",
            "endless" if row.daughter and row.generations is None else generations,
            f"`{row.after_last}`" if row.after_last else "-",
        ]  # fmt: skip

    kinds = Scene.from_dict({}).cell_table.values()
    assert rows(section("kinds.md", "The four rows")) == [words(row) for row in kinds]


def test_levels_of_accuracy() -> None:
    scenes = [Scene.from_dict({"numerics": {"accuracy": level}}) for level in LEVELS]
    table = rows(section("scene.md", "Accuracy"))
    assert {row[0] for row in table} == {key for level in LEVELS.values() for key in level}
    for key, *values in table:
        assert values == [value_of(scene, f"numerics.{key}") for scene in scenes], key


def test_parameter_sets() -> None:
    markdown = section("scene.md", "Parameter sets")
    names = re.findall(r"`([\w-]+)`", markdown.split("| --- |")[0].splitlines()[-1])
    assert names == list(parameters.SETS)
    scenes = [Scene.from_dict({"parameters": name}) for name in names]
    differing = [
        key for key in fields(Scene)
        if key != "parameters" and len({value_of(scene, key) for scene in scenes}) > 1
    ]  # fmt: skip
    table = {row[0].strip("`"): row[1:] for row in rows(markdown)}
    assert table == {key: [value_of(scene, key) for scene in scenes] for key in differing}

    x = np.linspace(1.0, 2.0, 10_001)
    pulls = [
        Terms.of(scene).adhesion / scene.contact
        * potentials.adhesion_slope(x, scene.cells.adhesion_range).max()
        for scene in scenes
    ]  # fmt: skip
    said = re.search(r"particle is ([\d., and]+), in this", markdown.replace("\n", " "))
    assert said
    assert re.findall(r"[\d.]+\d", said[1]) == [f"{pull:.2f}" for pull in pulls]


def test_built_in_scenes() -> None:
    table = rows(section("scene.md", "Built-in scenes"))
    scenes = [(name, Scene.load(name)) for name in BUILT_IN]
    assert table == [
        [
            f"`{name}`", "{} x {}".format(*scene.membrane.lattice), str(scene.cells.stem),
            str(scene.cells.nd), f"`{scene.cells.arrangement}`", f"{scene.end_time:g}",
        ]
        for name, scene in scenes
    ]  # fmt: skip
    prose = " ".join(section("scene.md", "Built-in scenes").split())
    for name in ("paper-ring", "quarter-ring"):
        scene = Scene.load(name)
        lx, ly, _ = scene.box_sides
        assert f"{lx:g} x {ly:.3f}" in prose
        assert f"{dermal_count(scene):,}" in prose
    prose = " ".join(section("scene.md", "The initial state").split())
    assert f"force component is below {FORCE_TOLERANCE:g} " in prose


# ---- the styles


def test_keywords_of_the_fix() -> None:
    known = re.findall(r'keyword == "(\w+)"', text("plugins/fix_skin_cells_settings.cpp"))
    table = rows(section("fix_skin_cells.md", "Syntax"))
    assert sorted(row[0].strip("`") for row in table) == sorted(known)
    known = re.findall(r'word == "(\w+)"', text("plugins/skin_cell_kinds.cpp"))
    of_kinds = rows(section("fix_skin_cells.md", "Kinds of cells"))
    assert sorted(row[0].strip("`") for row in of_kinds) == sorted(known)
    code = text("plugins/skin_model_kinds.cpp")
    known = re.findall(r'\{"(\w+)", SkinCellKind::', code) + re.findall(r'keyword == "(\w+)"', code)
    of_model = rows(section("fix_skin_cells.md", "The kinds of the model in few words"))
    assert sorted(row[0].strip("`") for row in of_model) == sorted(known)
    code = re.sub(r"\s+", " ", text("plugins/fix_skin_cells_settings.cpp"))
    found = re.search(r"required = \{(.*?)\}", code)
    assert found
    always = {row[0].strip("`") for row in table if row[2] == "always"}
    assert always == set(re.findall(r"\w+", found[1]))


def test_properties_of_cells() -> None:
    code = text("plugins/skin_cell_state.h")
    found = re.search(r'PROPERTIES =\s*"(.*?)"\s*"(.*?)"', code)
    assert found
    table = rows(section("fix_skin_cells.md", "Per-atom properties"))
    assert [row[0].strip("`") for row in table] == (found[1] + found[2]).split()


def test_output_of_the_fix() -> None:
    heading = "Restart, fix_modify, output, run start/stop, minimize info"
    markdown = section("fix_skin_cells.md", heading)
    code = text("plugins/fix_skin_cells.h")
    terms, counts = (re.search(rf"enum {name} {{(.*?)}}", code) for name in ("Term", "Count"))
    columns = re.search(r"NCOLUMNS = (\d+)", code)
    numbered = re.search(r"NFIRST = (\d+)", text("plugins/skin_cell_kinds.h"))
    assert terms and counts and columns and numbered
    vector, array = markdown.split("| array column |")
    fixed = terms[1].count(",") + counts[1].count(",") + int(numbered[1])
    places = ", ".join(row[0] for row in rows(vector))
    assert places == ", ".join([*(str(n) for n in range(1, fixed + 3)), "..."])
    assert len(rows(array)) == int(columns[1])
    assert f"vector of length {fixed} or more" in markdown
    assert f"array with {columns[1]} columns" in " ".join(markdown.split())


def test_event_log() -> None:
    markdown = section("fix_skin_cells.md", "Event log")
    header = re.search(r'HEADER\[\] = "(.*?)\\n"', text("plugins/skin_event_log.cpp"))
    assert header
    columns = markdown.split("| `kind` | `cause` | |")[0]
    assert [name for row in rows(columns) for name in codes(row[0])] == header[1].split(",")
    told = {tuple(codes(" ".join(row[:2]))) for row in rows(markdown) if len(row) == 3}
    parts = "events", "interventions"
    code = "".join(text(f"plugins/fix_skin_cells_{part}.cpp") for part in parts)
    calls = re.findall(r"lineage\.(?:write|log\.write)\(.*?;", code, re.DOTALL)
    assert {word for pair in told for word in pair} == set(re.findall(r'"(\w+)"', "".join(calls)))


# ---- the input scripts


def index_variables() -> list[str]:
    """Names in the scene.in of the built scene."""
    return re.findall(r"^variable +(\w+) index", text("lammps_inputs/scene.in"), re.MULTILINE)


def test_variables_of_the_input_scripts() -> None:
    markdown = section("inputs.md", "Variables")
    named = [name for row in rows(markdown) for name in codes(row[0])]
    assert sorted(named) == sorted(["dir", "restart", *index_variables()])


def test_files_of_the_input_scripts() -> None:
    named = [name for row in rows(section("inputs.md", "Files")) for name in codes(row[0])]
    assert set(SCRIPTS) <= set(named)
    assert {"scene.in", "scene.toml", "skin.data", INTERVENTIONS, "*.table"} == set(named) - set(
        SCRIPTS
    )


def test_columns_of_thermo_output() -> None:
    columns = ["Step", "Time", "Atoms"]
    for part in ("membrane", "dermis", "cells"):
        script = re.sub(r"&\s+", "", text(f"lammps_inputs/{part}.in"))
        found = re.search(r'variable +columns string "\$\{columns\} (.*?)"', script)
        assert found
        columns += found[1].split()
    markdown = section("inputs.md", "What is written").split("The thermo output has")[1]
    assert [name for row in rows(markdown) for name in codes(row[0])] == columns


# ---- the house


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


def test_the_readme_names_every_page() -> None:
    linked = set(re.findall(r"\]\(docs/(\w+\.md)", text("README.md")))
    assert linked == {path.name for path in (ROOT / "docs").glob("*.md")}
