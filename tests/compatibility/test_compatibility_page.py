"""docs/compatibility.md says what the table of commands says."""

import re
import shutil
from collections import Counter
from pathlib import Path

from tests.compatibility.conftest import Runner
from tests.compatibility.page import PAGE, whole
from tests.compatibility.tries import table


def test_page_holds_the_table() -> None:
    text = PAGE.read_text("utf-8")
    assert text == whole(text), "make it anew: python -m tests.compatibility.page"


def test_commands_are_named_once() -> None:
    names = Counter((row.family, row.command) for row in table())
    assert max(names.values()) == 1


def test_example_runs(scenes: Path, run_in: Runner, tmp_path: Path) -> None:
    """Shortened: it heals for 120 steps."""
    directory = tmp_path / "wound"
    shutil.copytree(scenes / "cells", directory)
    example = re.findall("^```\n(.*?)^```$", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)[0]
    short = re.sub(r"^run +4000$", "run 120", example, flags=re.MULTILINE)
    assert short.count("run 120") == 2
    (directory / "try.in").write_text(short)
    assert run_in(directory, "") == 0, (directory / "error.txt").read_text()
    assert len((directory / "density.txt").read_text().splitlines()) > 100
