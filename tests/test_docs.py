"""The documents say what is so: links, commands, keywords of styles, variables, files."""

import re
import tomllib
from itertools import pairwise
from pathlib import Path

import pytest
from lammps_skin.analysis import energies
from lammps_skin.cli import COMMANDS, application
from lammps_skin.cli.options import scene_from
from lammps_skin.model.scene import Scene
from lammps_skin.model.scenes import BUILT_IN
from lammps_skin.run.evaluate import SHORT
from lammps_skin.start.build import INTERVENTIONS, SCRIPTS
from lammps_skin.study.studies.design import Design
from pages import BY_NAME, PAGES, ROOT, codes, commands, fences, rows, section, text
from typer.main import get_command

STUDIES = "studies.md"

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


def test_the_index_lists_every_page() -> None:
    """A page has a line in a list of docs/index.md, which is the table of contents of the site."""
    listed = re.findall(r"^\* \[.*?\]\((\S+)\): ", text("index.md"), re.MULTILINE)
    assert sorted([*listed, "README.md", "index.md"]) == sorted(BY_NAME)


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
        if name.startswith("-"):
            assert name in {option for one in group.params for option in one.opts}, name
            continue
        command = group.commands[name]
        context = command.make_context(name, list(words))
        if below := getattr(command, "commands", None):
            asked, *words = words if words[0] in below else ("run", *words)
            context = below[asked].make_context(asked, words)
        source = context.params.get("source") or context.params.get("scene")
        if source in BUILT_IN:
            settings = context.params["parameters"], context.params["settings"]
            scene_from(source, *settings)
        else:
            directory = context.params.get("resume")
            assert source is None or directory or source.endswith(".toml"), f"{page}: {source}"


def test_lmp_commands_name_variables() -> None:
    given = {"dir", "restart", *index_variables()}
    found = [
        (page, name)
        for page, words in commands("lmp") for flag, name in pairwise(words) if flag == "-var"
    ]  # fmt: skip
    assert found
    for page, name in found:
        assert name in given, f"{page}: {name}"


def test_toml_examples_are_scenes() -> None:
    blocks = [block for name in BY_NAME if name != STUDIES for block in fences(name, "toml")]
    assert blocks
    for block in blocks:
        Scene.from_dict(tomllib.loads(block))


def test_toml_examples_of_studies(tmp_path: Path) -> None:
    blocks = fences(STUDIES, "toml")
    assert text("docs/examples/adhesion.toml").endswith(blocks[0])
    for block in blocks:
        (tmp_path / "study.toml").write_text(block)
        assert len(Design.load(tmp_path / "study.toml").points) > 1


def test_terms_of_evaluate() -> None:
    """Each short name, its term, and the column of the log."""
    table = rows(section("inputs.md", "A configuration in a text file"))
    named = {row[0].strip("`"): [word.strip("`") for word in row[1:]] for row in table}
    assert named.keys() >= {"cc_ad", "total"}
    for short, term in {**SHORT, "cc_ad_shifted": "cell_cell_adhesion"}.items():
        assert named[short][0] == energies.COLUMNS[named[short][1]] == term


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
