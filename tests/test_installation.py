"""Installations: with pip, in place (``pip install -e``), and none."""

from __future__ import annotations

import os
import shutil
import site
import subprocess
import sys
import venv
from pathlib import Path

import lammps_skin
import pytest
from lammps_skin.plugin import folder, installed

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "pyscripts" / "lammps_skin"
SMALL = """
end_time = 0.5
[dermis]
present = false
[membrane]
lattice = [24, 28]
[cells]
stem = 2
arrangement = "cluster"
"""


def run(*command: str | Path, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a command; nothing of the environment of the tests names a Python."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    return subprocess.run(
        [*map(str, command)], cwd=cwd, capture_output=True, text=True, env=kept | environment
    )  # fmt: skip


def succeed(*command: str | Path, cwd: Path) -> str:
    """What a command prints that must not fail."""
    ended = run(*command, cwd=cwd)
    assert ended.returncode == 0, f"{ended.stdout}{ended.stderr}"
    return ended.stdout


def test_the_installation_has_plugin_and_scripts() -> None:
    assert (Path(folder()) / "skinplugin.so").is_file()
    assert (installed("lammps_inputs") / "skin.in").is_file()


def test_a_package_in_two_places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder is where the installation has put it, first or last."""
    (tmp_path / "site" / "plugins").mkdir(parents=True)
    for places in (["site", "source"], ["source", "site"]):
        monkeypatch.setattr(lammps_skin, "__path__", [str(tmp_path / place) for place in places])
        assert folder() == str(tmp_path / "site" / "plugins")
    monkeypatch.setattr(lammps_skin, "__path__", [str(tmp_path / "source")])
    assert folder() == str(tmp_path / "source" / "plugins")  # and nothing is raised


def test_sources_without_an_installation_say_so(tmp_path: Path) -> None:
    shutil.copytree(PACKAGE, tmp_path / "lammps_skin", ignore=shutil.ignore_patterns("plugins"))
    (tmp_path / "small.toml").write_text(SMALL)
    code = "from lammps_skin.cli import main; main()"
    ended = run(
        sys.executable, "-c", code, "build", "small.toml", "-o", "x",
        cwd=tmp_path, PYTHONPATH=str(tmp_path),
    )  # fmt: skip
    assert ended.returncode == 2
    scripts = tmp_path / "lammps_skin" / "lammps_inputs"
    assert ended.stderr == f"error: {scripts} is missing: install lammps-skin with pip\n"
    assert not (tmp_path / "x").exists()


@pytest.mark.slow
@pytest.mark.parametrize("how", [[], ["--editable"]], ids=["copied", "editable"])
def test_an_installation_works_and_goes(tmp_path: Path, how: list[str]) -> None:
    """In an environment of its own, which has the dependencies of this one."""
    environment = tmp_path / "venv"
    venv.create(environment, with_pip=True)
    python, bin_ = environment / "bin" / "python", environment / "bin"
    where = "import sysconfig; print(sysconfig.get_path('purelib'))"
    packages = Path(succeed(python, "-c", where, cwd=tmp_path).strip())
    borrowed = packages / "borrowed.pth"
    borrowed.write_text("\n".join(site.getsitepackages()))

    source = tmp_path / "source"
    ignored = shutil.ignore_patterns(".venv", ".git", "build", "runs", "plugins.so")
    shutil.copytree(ROOT, source, ignore=ignored)
    succeed(python, "-m", "pip", "install", "--quiet", "--no-deps", *how, source, cwd=tmp_path)
    modules = source / "pyscripts" if how else packages
    said = succeed(
        python, "-c",
        "import lammps.executable as e, lammps_skin as s; print(e.plugins[0]); print(s.__file__)",
        cwd=tmp_path,
    )  # fmt: skip
    plugins, module = map(Path, said.splitlines())
    assert plugins == packages / "lammps_skin" / "plugins"
    assert module == modules / "lammps_skin" / "__init__.py"

    (tmp_path / "small.toml").write_text(SMALL)
    succeed(bin_ / "skin", "run", "small.toml", "-o", "x", cwd=tmp_path)
    succeed(bin_ / "skin", "build", "small.toml", "-o", "y", cwd=tmp_path)
    lmp = "import lammps.executable as e; e.lmp()"
    succeed(python, "-c", lmp, "-in", "skin.in", cwd=tmp_path / "y")

    succeed(python, "-m", "pip", "uninstall", "--yes", "lammps-skin", cwd=tmp_path)
    borrowed.unlink()
    gone = run(python, "-c", "import lammps_skin", cwd=tmp_path)
    assert "No module named 'lammps_skin'" in gone.stderr
    assert not [path for path in packages.rglob("*") if "lammps_skin" in str(path)]
