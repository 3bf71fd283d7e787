"""The tutorial, followed literally in an empty directory: every block, in order."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from lammps_skin import read_table
from lammps_skin.study.ensemble import window_mean
from pages import blocks, text

SHORTER = {  # in the quick test, where the same commands have less to do
    "--until 400": "--until 10",
    "--time 200": "--time 0",
    "end_time=400": "end_time=10",
    "--seeds 1-4": "--seeds 1 --jobs 1",
    "350, 400": "0, 10",
}


def follow(directory: Path, shorter: dict[str, str]) -> str:
    """Write the files and run the commands that the page shows, after the installation."""
    page = text("tutorial.md")
    for long, short in shorter.items():
        assert long in page
        page = page.replace(long, short)
    script = ["set -euxo pipefail"]
    for language, block in blocks("tutorial.md"):
        for long, short in shorter.items():
            block = block.replace(long, short)
        if language in ("toml", "python"):
            named = re.findall(r"`(\w+\.(?:toml|py))`", page.partition(block)[0])[-1]
            script.append(f"cat > {named} <<'END'\n{block}END")
        elif not language and "pip install" not in block:
            script.append(block)
    ended = subprocess.run(
        ["bash", "-c", "\n".join(script)], cwd=directory, capture_output=True, text=True,
        env=os.environ | {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"},
    )  # fmt: skip
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


def test_every_block_runs(tmp_path: Path) -> None:
    said = follow(tmp_path, SHORTER)
    for name in ("demo-400.png", "heights-200.png", "many/demo.csv.gz", "many/half.csv.gz"):
        assert (tmp_path / name).exists()
    assert re.search(r"^coverage +half +0\.\d\d ", said, re.MULTILINE)


@pytest.mark.slow
def test_the_conclusions_hold(tmp_path: Path) -> None:
    """What the page says of its own question, and of the time at which papillae form."""
    follow(tmp_path, {})
    late = {
        (scene, name): window_mean(read_table(tmp_path / f"many/{scene}.csv.gz"), name, 350, 400)
        for scene in ("demo", "half")
        for name in ("ta", "papillae", "height_std", "coverage", "stem_on_tips")
    }
    assert late["demo", "papillae"].low > 1 > late["half", "papillae"].value
    for name in ("ta", "height_std"):
        assert late["half", name].high < late["demo", name].low
    assert late["half", "coverage"].value > 0.95
    early = window_mean(read_table(tmp_path / "many/demo.csv.gz"), "papillae", 0, 200)
    assert early.value == 0
