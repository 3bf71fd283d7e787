"""The checks that `make lint` makes, as tests."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def check(*command: str, **environment: str) -> None:
    """Run a Python tool in the tree; what it says is the message of a failure."""
    ended = subprocess.run(
        [sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True,
        env={"PATH": "/usr/bin:/bin", **environment},
    )  # fmt: skip
    assert ended.returncode == 0, f"{ended.stdout}{ended.stderr}"


def test_ruff():
    check("ruff", "check", "--no-cache", ".")


def test_mypy(tmp_path: Path):
    check("mypy", f"--cache-dir={tmp_path}", MYPYPATH="pyscripts")


def test_columns_of_the_plugin():
    """As LAMMPS has it, no line is longer than 100 columns."""
    sources = (ROOT / "plugins").iterdir()
    long = [
        f"{path.name}:{n}"
        for path in sources for n, line in enumerate(path.read_text().splitlines(), 1)
        if len(line) > 100
    ]  # fmt: skip
    assert not long
