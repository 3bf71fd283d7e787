"""Scenes that are run in a second, and the command."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from lammps_skin.model.scene import Scene

from tests.conftest import Answer

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


@pytest.fixture
def skin(skin: Callable[..., Answer], tmp_path: Path) -> Callable[..., Answer]:
    """Call ``skin`` with arguments, in a directory that holds tiny.toml alone."""
    (tmp_path / "tiny.toml").write_text(TINY)
    return skin


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    path = tmp_path / "tiny.toml"
    path.write_text(TINY)
    return Scene.load(path)
