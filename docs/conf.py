"""How Sphinx makes the site of these pages: ``make docs``."""

from __future__ import annotations

import re
from importlib import metadata
from typing import Any

from docutils import nodes
from lammps_skin.cli import COMMANDS, application
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from typer.main import get_command

project = "lammps-skin"
release = metadata.version("lammps-skin")
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
exclude_patterns = ["data", "examples", "figures", "install"]
highlight_language = "none"
default_role = "literal"  # of docstrings

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4

html_theme = "furo"
html_title = "lammps-skin"
html_math_renderer = "mathml"
html_copy_source = False

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings state types
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True


class SkinCommands(SphinxDirective):
    """The subcommands of ``skin`` with their arguments and options, as ``--help`` has them."""

    def run(self) -> list[nodes.Node]:
        group = get_command(application(*COMMANDS))
        text = "\n".join(
            _reference(f"{name} {below}".strip(), command, summary if not below else command.help)
            for name, summary in COMMANDS.items()
            for below, command in _with_subcommands(group.commands[name])
        )
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def _with_subcommands(command: Any) -> list[tuple[str, Any]]:
    """A command without a name, and all below it with theirs."""
    return [("", command), *getattr(command, "commands", {}).items()]


def _reference(name: str, command: Any, summary: str) -> str:
    """A subcommand as Markdown."""
    context = command.make_context(name, [], resilient_parsing=True)
    usage = " ".join(command.collect_usage_pieces(context))
    records = [found for one in command.params if (found := one.get_help_record(context))]
    rows = [f"| `{option}` | {_cell(meaning)} |" for option, meaning in records]
    head = ["| option | |", "| --- | --- |"] if rows else []
    return "\n".join(
        [_index([f"skin {name}"]), f"## skin {name}", "", summary, "",
         "```", f"skin {name} {usage}", "```", "", *head, *rows, ""]
    )  # fmt: skip


def _cell(text: str) -> str:
    """Plain text as a cell of a table in Markdown."""
    return re.sub(r"([\\|<*_\[\]])", r"\\\1", text)


def add_contents(_: Sphinx, page: str, source: list[str]) -> None:
    """Make the lists of index.md the table of contents: a part for each second-level heading."""
    if page != "index":
        return
    head, *parts = re.split(r"^## ", source[0], flags=re.MULTILINE)
    for part in parts:
        caption = part.splitlines()[0]
        listed = "\n".join(re.findall(r"^\* \[.*?\]\((\S+)\.md\)", part, re.MULTILINE))
        hidden = f":::{{toctree}}\n:hidden:\n:caption: {caption}\n\n{listed}\n:::\n"
        head += f"## {part}\n{hidden}\n"
    source[0] = head


def add_terms(_: Sphinx, page: str, source: list[str]) -> None:
    """Make the lists of glossary.md glossaries, whose terms are in the index."""
    if page == "glossary":
        lists = re.compile(r"((?:^(?:\* \*\*|  ).*\n)+)", re.MULTILINE)
        glossaries = lists.sub(r":::{glossary}\n\1:::\n", source[0])
        source[0] = re.sub(r"^\* \*\*(.*?)\*\*: ", r"\n\1\n  ", glossaries, flags=re.MULTILINE)


def add_index(_: Sphinx, page: str, source: list[str]) -> None:
    """Put the styles and the keys of the scene into the index, each at its heading."""
    styles = re.compile(r"^(?=# (\S+ \S+) command$)", re.MULTILINE)
    source[0] = styles.sub(lambda found: _index([found[1]]), source[0])
    if page == "scene":
        keys = re.findall(r"^\| `([a-z_.]+)` \| [`n]", source[0], re.MULTILINE)
        source[0] = source[0].replace("## Keys\n", f"{_index(keys)}## Keys\n", 1)


def _index(words: list[str]) -> str:
    """Entries of the index that lead to what follows."""
    return "".join(f":::{{index}} single: {word}\n:::\n\n" for word in words)


def _inline(writer: Any, node: nodes.math) -> None:
    writer.body.append(convert(node.astext(), display="inline"))
    raise nodes.SkipNode


def _block(writer: Any, node: nodes.math_block) -> None:
    writer.body.append(convert(node.astext(), display="block"))
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    """Equations are written as MathML, which browsers draw without a network."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    app.add_directive("skin-commands", SkinCommands)
    app.connect("source-read", add_contents)
    app.connect("source-read", add_terms)
    app.connect("source-read", add_index)
