"""CITATION.cff says what the README and pyproject.toml say, and is valid."""

from __future__ import annotations

import re
import subprocess
import tomllib
import venv
from pathlib import Path

import pytest
from pages import ROOT, section


def test_it_says_what_others_say() -> None:
    told = (ROOT / "CITATION.cff").read_text("utf-8")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert f"\nversion: {project['version']}\n" in told
    assert f"\nlicense: {project['license']}\n" in told
    cited = section("README.md", "Citation and licence")
    assert "CITATION.cff" in cited
    for doi in re.findall(r"doi\.org/([\w./-]+\w)", cited):
        assert f"doi: {doi}\n" in told
    names = re.findall(r"([A-Z]\.) ([A-Z]\w+)", cited.split("Interplay")[0])
    assert len(names) == 6
    for given, family in names:
        assert f"{{given-names: {given}, family-names: {family}}}" in told


@pytest.mark.slow
def test_it_is_valid(tmp_path: Path) -> None:
    """With cffconvert in an environment of its own."""
    venv.create(tmp_path / "environment", with_pip=True)
    programs = tmp_path / "environment" / "bin"
    pip = [programs / "python", "-m", "pip", "install", "--quiet", "cffconvert>=2"]
    subprocess.run(pip, check=True)
    judge = [programs / "cffconvert", "--validate", "-i", ROOT / "CITATION.cff"]
    found = subprocess.run(judge, capture_output=True, text=True)
    assert found.returncode == 0, found.stdout + found.stderr
