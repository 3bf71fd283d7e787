"""The pages of the documentation, and how tests read them."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "pyscripts" / "lammps_skin"
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md")), *sorted(DOCS.glob("studies/*.md"))]
BY_NAME = ["README.md", *(path.relative_to(DOCS).as_posix() for path in PAGES[1:])]


@cache
def text(name: str) -> str:
    """Text of a page, or of a file by its path in the tree."""
    path = DOCS / name if name in BY_NAME[1:] else ROOT / name
    return path.read_text("utf-8")


def section(page: str, title: str) -> str:
    """What stands below a heading, up to the next one that is not deeper."""
    found = re.search(rf"^(#+) {re.escape(title)}\n", text(page), re.MULTILINE)
    assert found, f"{page} has no heading {title!r}"
    rest = text(page)[found.end() :]
    return re.split(rf"^#{{1,{len(found[1])}}} ", rest, maxsplit=1, flags=re.MULTILINE)[0]


def rows(markdown: str) -> list[list[str]]:
    """Cells of all table rows, headings left out."""
    lines = markdown.splitlines()
    heads = {n for n, line in enumerate(lines[1:]) if re.fullmatch(r"\|( --- \|)+", line)}
    return [
        [cell.strip() for cell in line.strip("|").split(" | ")]
        for n, line in enumerate(lines)
        if line.startswith("|") and n not in heads and n - 1 not in heads
    ]


def codes(markdown: str) -> list[str]:
    """What stands between backticks, fences left out."""
    return re.findall(r"`([^`\n]+)`", re.sub(r"```.*?```", "", markdown, flags=re.DOTALL))


def fences(name: str, language: str = "") -> list[str]:
    """Fenced blocks of a page in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", text(name), re.MULTILINE | re.DOTALL)


def blocks(page: str) -> list[tuple[str, str]]:
    """Fenced blocks of a page in their order: language, text."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", text(page), re.MULTILINE | re.DOTALL)


def commands(start: str) -> Iterator[tuple[str, list[str]]]:
    """Lines of all pages that begin with a command, in blocks without a language: page, words."""
    for name in BY_NAME:
        for language, block in blocks(name):
            for line in () if language else block.splitlines():
                words = shlex.split(line, comments=True)
                if start in words[:4]:
                    yield name, words[words.index(start) + 1 :]
