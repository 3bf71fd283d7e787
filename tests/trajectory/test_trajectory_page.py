"""Every block of docs/trajectory.md and of the radial distribution in docs/analysis.md runs."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.cli import main

DOCS = Path(__file__).resolve().parents[2] / "docs"


def blocks(page: str) -> list[tuple[str, str]]:
    """Language and text of the fences of a page."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", (DOCS / page).read_text("utf-8"), re.M | re.S)


@pytest.fixture
def runs(run, tmp_path, monkeypatch) -> Path:
    """A directory in which runs/one-stem was run by Python and runs/plain by lmp."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(run.driven, tmp_path / "runs" / "one-stem")
    shutil.copytree(run.directory, tmp_path / "runs" / "plain")
    (tmp_path / "runs" / "plain" / "skin.h5").unlink()
    return tmp_path


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_blocks_run_in_order(runs, capsys):
    found = blocks("trajectory.md")
    assert {language for language, _ in found} == {"", "python"} and len(found) >= 6
    names: dict[str, Any] = {}
    for language, text in found:
        if language == "python":
            exec(text, names)
            continue
        for line in text.splitlines():
            skin, *words = shlex.split(line, comments=True)
            assert skin == "skin"
            with pytest.raises(SystemExit) as end:
                main(words)
            assert end.value.code == 0, line
    written = ("runs/plain/skin.h5", "cells.pdb", "membrane.dcd")
    assert all((runs / name).exists() for name in written)
    told = capsys.readouterr().out.splitlines()
    assert any(re.fullmatch(r"[\d.]+ [\d.]+", line) for line in told)


def test_radial_distribution_runs(runs):
    (text,) = (text for _, text in blocks("analysis.md") if "InPlaneRDF" in text)
    names: dict[str, Any] = {}
    exec(text, names)
    assert np.isfinite(names["found"].rdf).all()
