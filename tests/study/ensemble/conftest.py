"""Scenes that are run in a second, and the command."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest
from lammps_skin.cli import main
from lammps_skin.model.scene import Scene

TINY = """\
name = "tiny"
end_time = 3.0
[dermis]
present = false
[membrane]
lattice = [12, 14]
[cells]
stem = 1
cycle_delay = 0.5
cycle_rate = 2.0
first_phase = 0.5
[numerics]
accuracy = "reference"
[output]
dump_interval = 0.5
checkpoint_interval = 0.0
"""


class Answer(NamedTuple):
    """What a command has left."""

    code: int
    out: str
    err: str


@pytest.fixture
def skin(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[..., Answer]:
    """Call ``skin`` with arguments, in a directory that holds tiny.toml alone."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.toml").write_text(TINY)

    def call(*arguments: object) -> Answer:
        capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            main([str(argument) for argument in arguments])
        return Answer(end.value.code, *capsys.readouterr())

    return call


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    path = tmp_path / "tiny.toml"
    path.write_text(TINY)
    return Scene.load(path)
