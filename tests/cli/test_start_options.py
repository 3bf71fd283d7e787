"""`--from` and `--at`, and where paths of a scene lead."""

from __future__ import annotations

import numpy as np
import pytest
from lammps_skin.engine.built import load_built
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import to_toml
from lammps_skin.start.configuration import Configuration

TWO = ("--set", "output.dump_interval=1", "--set", "end_time=3")


@pytest.fixture
def parent(skin, tmp_path):
    """The run of a scene, with frames from 0 to 3."""
    assert skin("run", "two-cells", *TWO, "-o", "parent").code == 0
    return tmp_path / "parent"


def test_begin_with_the_state_of_a_run(skin, refused, parent, tmp_path):
    """Paths are relative to the scene file, or to the current directory on a command line."""
    (tmp_path / "scenes").mkdir()
    given = Scene.load("two-cells").replace(end_time=9.0).given()
    file = tmp_path / "scenes" / "fork.toml"
    file.write_text(to_toml({**given, "start": {"from": "../parent", "time": 2.0}}))
    content = Configuration.from_run(parent, 2.0).origin.content
    commands = {
        "file": ("scenes/fork.toml",),
        "options": ("two-cells", "--from", "parent", "--at", 2),
        "trajectory": ("two-cells", "--from", "parent/skin.h5", "--at", 2),
        "other": ("scenes/fork.toml", "--from", "parent", "--at", 2, "--seed", 7),
    }
    for name, words in commands.items():
        assert skin("build", *words, "-o", name).code == 0
        assert load_built(tmp_path / name).start.content == content, name
    assert skin("build", "two-cells", "--from", "parent", "-o", "last").code == 0
    assert load_built(tmp_path / "last").start.time == 3.0
    assert skin("check", "scenes/fork.toml").code == 0
    late = ["--set", "interventions=[{name='w', at=2.5, remove='ta'}]"]
    for words in (["check"], ["run", "-o", "late"]):
        told = skin(*words, "two-cells", "--from", "parent", "--set", "end_time=4", *late)
        assert "is not after start.time = 3" in " ".join((told.out + told.err).split()), words
    assert "nearest are at 1 and 2" in refused("check", "scenes/fork.toml", "--at", 1.5)
    assert "--until = 2: must be a time after the start, 2" in refused("run", "file", "--until", 2)
    assert "--until = 1: must be a time after" in refused("run", "scenes/fork.toml", "--until", 1)
    assert "--at: a built directory is run as it is" in refused("run", "file", "--at", 1)
    assert "start.time = 1.0: needs start.from" in refused(
        "build", "two-cells", "--at", 1, "-o", "x"
    )
    ended = skin("run", "file", "--until", 3)
    assert ended.code == 0 and "reached t = 3," in ended.out


SOFTER = """
name = "softer"
end_time = 9.0
[dermis]
present = false
[membrane]
lattice = [16, 18]
[output]
dump_interval = 1.0
[numerics]
timestep = 0.25
[[interventions]]
name = "seeds"
at = 1.0
add = "nd"
places = [[1.0, 1.0], [4.0, 4.0]]
[[interventions]]
name = "softening"
at = 2.0
set = {membrane.bending_stiffness = 0.125}
[[interventions]]
name = "more"
at = 5.0
add = "nd"
places = [[1.0, 4.0]]
"""


def test_check_tells_of_the_state_that_a_run_begins_with(skin, tmp_path):
    """Its run and time, its cells, the values in force, and what is left to do."""
    (tmp_path / "softer.toml").write_text(SOFTER)
    assert skin("run", "softer.toml", "--until", 3, "-o", "first").code == 0
    lines = [" ".join(line.split()) for line in skin("check", "softer.toml").out.splitlines()]
    assert {"nd particles 0", "bend on K = 0.5", "cells at the end about 3", "steps 36"} <= {*lines}
    assert not any(line.startswith("begins ") for line in lines)
    for at, bend in ((("--at", 1), "0.5"), ((), "0.125")):
        out = skin("check", "softer.toml", "--from", "first", *at).out
        lines = [" ".join(line.split()) for line in out.splitlines()]
        time = at[1] if at else 3
        assert f"begins with the state of {tmp_path / 'first'} at t = {time}" in lines
        assert {
            "nd particles 2", f"bend on K = {bend}", "cells at the end about 3",
            f"steps {4 * (9 - time)}, from t = {time} to 9",
        } <= {*lines}  # fmt: skip
        in_force = (
            "interventions.softening.at = 2: is not after start.time = 3, and its values hold"
        )
        assert (in_force in out) == (time == 3)
    measured = skin("check", "softer.toml", "--from", "first", "--measure")
    assert measured.code == 0 and "ms measured" in measured.out


def test_check_tells_of_heights(skin, tmp_path):
    np.save(tmp_path / "wave.npy", np.full((3, 4), 22.0))
    given = ("--set", "membrane.heights=wave.npy", "--set", "membrane.lattice=[12, 14]")
    out = skin("check", "no-dermis", *given, "--set", "cells.stem=0").out
    assert f"begins at t = 0 with a membrane of the heights in {tmp_path / 'wave.npy'}\n" in out
