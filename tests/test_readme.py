"""Every code block of the README runs, in order, in a fresh directory."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from pages import ROOT, blocks

BLOCKS = blocks("README.md")
MADE = [
    "runs/one-stem/skin.h5", "runs/two-cells/events.csv", "runs/one-stem/snapshot-3d-last.png",
    "runs/one-stem/vtk", "report.html", "ensemble", "figures/figure-3-quick.png", "forces.txt",
    "two/skin.dump", "two/skin.h5", "runs/seed-3/skin.h5",
]  # fmt: skip

KEPT = "HOME", "PATH"  # of the environment, and how ranks wait

SHORTER = {
    "--until 40": "--until 10", "--until 200": "--until 20", "end_time 20": "end_time 5",
    "--seeds 1-2 --set end_time=20": "--seeds 1 --set end_time=2 --jobs 1",
}  # fmt: skip


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """A directory like a fresh clone in which the package has been installed."""
    for name in ("README.md", "docs", "lammps_inputs"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / ".venv").symlink_to(sys.prefix)
    return tmp_path


@pytest.mark.parametrize(
    "shorter", [SHORTER, pytest.param({}, marks=pytest.mark.slow)], ids=["shorter", "as printed"]
)
def test_every_block_runs(clone: Path, shorter: dict[str, str]) -> None:
    """As printed, or with less to do. Python blocks run twice, as a cell of a notebook does.

    `make` is what runs this test.
    """
    python = [code for language, code in BLOCKS if language == "python"]
    shell = [code for language, code in BLOCKS if not language and not code.startswith("make ")]
    assert len(python) + len(shell) == len(BLOCKS) - 1
    (clone / "block.py").write_text("\n".join(python))
    lines = ["set -euxo pipefail", *shell, f"cd {clone}", "python block.py", "python block.py"]
    script = "\n".join(lines)
    for long, short in shorter.items():
        assert long in script
        script = script.replace(long, short)
    ended = subprocess.run(
        ["bash", "-c", script], cwd=clone, capture_output=True, text=True,
        env={key: os.environ[key] for key in os.environ if key in KEPT or key.startswith("MPIR_")},
    )  # fmt: skip
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert not [name for name in MADE if not (clone / name).exists()]
