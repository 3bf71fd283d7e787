"""`make pages` makes every table and picture of the pages, by commands that there are."""

from __future__ import annotations

import re
import shlex
import subprocess
from functools import cache

import pytest
from lammps_skin.cli import COMMANDS, application
from lammps_skin.cli.options import scene_from
from lammps_skin.model.scenes import BUILT_IN
from pages import ROOT
from typer.main import get_command


def make(*arguments: str) -> str:
    answer = subprocess.run(["make", *arguments], cwd=ROOT, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stderr
    return answer.stdout


@cache
def commands() -> list[list[str]]:
    """Words of all commands of `make pages`, without the variables in front of them."""
    lines = make("-nB", "pages").replace("\\\n", "").splitlines()
    return [shlex.split(re.sub(r"^(\w+=\S+ )+", "", line)) for line in lines]


def test_all_that_is_there_is_made() -> None:
    folders = (ROOT / "docs" / "data", ROOT / "docs" / "figures")
    there = {str(path.relative_to(ROOT)) for folder in folders for path in folder.rglob("*")
             if path.is_file() and "runs" not in path.parts}  # fmt: skip
    by_hand = {"docs/figures/ovito.png"}  # by a program of its own, as docs/programs.md says
    assert there - set(make("made").split()) == by_hand


def test_commands_of_skin() -> None:
    """Also the scenes, keys and values that they name."""
    group = get_command(application(*COMMANDS))
    found = [words[1:] for words in commands() if words and words[0].endswith("/skin")]
    assert {name for name, *_ in found} >= {"ensemble", "claims", "figure", "run", "snapshot"}
    for name, *words in found:
        given = group.commands[name].make_context(name, list(words)).params
        scenes = given.get("scenes") or [given.get("source") or given.get("scene")]
        for scene in scenes:
            if scene in BUILT_IN:
                scene_from(scene, given["parameters"], given["settings"], given.get("accuracy"))
            else:
                assert scene is None or str(scene).endswith("papilla.toml"), words


def test_scripts() -> None:
    """They are there, and know the options that they are given."""
    found = [words for words in commands() if words and words[0].endswith("/python")]
    found = [words for words in found if not words[1].startswith("-")]
    assert {words[1] for words in found} >= {"docs/pages.py", "benchmarks/scaling.py"}
    for _, script, *words in found:
        source = (ROOT / script).read_text("utf-8")
        for word in words:
            assert not word.startswith("-") or f'"{word}"' in source, (script, word)


@pytest.mark.parametrize("page", ["ensembles.md", "readings.md"])
def test_generated_pages_are_made(page: str) -> None:
    assert f"docs/{page}" in make("made").split()
