"""``skin stats`` of a run that goes on: some state of it, or one line."""

import subprocess
import sys
from pathlib import Path

import pytest
from lammps_skin.model.parameters import DEFAULT

SKIN = [sys.executable, "-P", "-c", "from lammps_skin.cli import main; main()"]
LMP = str(Path(sys.executable).parent / "lmp")


def looks(skin, command, **options):
    """Answers of `skin stats`, one after the other until a command has ended, and one more."""
    process = subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **options
    )
    try:
        ended = False
        while not ended:
            ended = process.poll() is not None
            yield skin("stats", "run")
    finally:
        process.kill()
    assert process.wait() == 0


def check(answers):
    """Raise if one is neither a state nor one line; the states, the last of which is of the end."""
    states = []
    for answer in answers:
        if answer.code:
            assert answer.code == 2 and not answer.out
            assert answer.err.startswith("error: ") and answer.err.count("\n") == 1
        else:
            assert not answer.err and answer.out.startswith(f"tiny, {DEFAULT}, seed 1: ")
            states.append(answer.out.splitlines()[0])
    assert not answer.code and states[-1].endswith(" 61 frames, t = 0 to 3")


@pytest.fixture
def often(skin, tmp_path):
    """The scene, with frames and checkpoints every few steps."""
    scene = tmp_path / "tiny.toml"
    often = scene.read_text().replace("dump_interval = 0.5", "dump_interval = 0.05")
    scene.write_text(often.replace("checkpoint_interval = 0.0", "checkpoint_interval = 0.1"))


@pytest.mark.slow
@pytest.mark.usefixtures("often")
def test_stats_meanwhile(skin):
    """From before there is a directory, and while another run takes the place of the first."""
    check(looks(skin, [*SKIN, "run", "tiny.toml", "-o", "run"]))
    check(looks(skin, [*SKIN, "run", "tiny.toml", "-o", "run", "--force"]))


@pytest.mark.slow
@pytest.mark.usefixtures("often")
def test_stats_while_it_is_resumed(skin):
    assert skin("run", "tiny.toml", "-o", "run", "--until", "1").code == 0
    check(looks(skin, [*SKIN, "run", "run", "--resume", "--until", "3"]))


@pytest.mark.slow
@pytest.mark.usefixtures("often")
def test_stats_while_lammps_runs_alone(skin, tmp_path):
    """The dump is read, whose last frame may not be whole."""
    assert skin("build", "tiny.toml", "-o", "run").code == 0
    check(looks(skin, [LMP, "-in", "skin.in"], cwd=tmp_path / "run"))
