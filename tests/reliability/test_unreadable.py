"""Directories and files that may not be read or written end in one line, and nothing is lost."""

from __future__ import annotations

import ctypes
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation

from tests.reliability.bad_input import TINY
from tests.reliability.sandbox import Outcome, Sandbox, in_empty_directory, skin

CAPABILITIES = 0x20080522  # version of the structures of capset(2)
PASSES_OVER_PERMISSIONS = 0b110  # CAP_DAC_OVERRIDE and CAP_DAC_READ_SEARCH
AS_SCENE = ("run", "scene.toml", "-o")


@pytest.fixture(scope="module")
def sandbox() -> Iterator[Sandbox]:
    sandbox = Sandbox()
    yield sandbox
    sandbox.close()


@pytest.fixture(scope="module")
def ended(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Directory of a run with three checkpoints."""
    directory = tmp_path_factory.mktemp("ended")
    scene = Scene.from_dict(TINY).replace(**{"output.checkpoint_interval": 0.01})
    with Simulation.begin(scene, directory) as simulation:
        simulation.run()
    assert len(list(directory.glob("skin.step*.restart"))) == 3
    return str(directory)


def obey_permissions() -> None:
    """From now on the permissions of files count for this process, also if it is root's."""
    libc = ctypes.CDLL(None)
    header, sets = (ctypes.c_uint32 * 2)(CAPABILITIES, 0), (ctypes.c_uint32 * 6)()
    libc.capget(header, sets)
    for effective_and_permitted in (0, 1):
        sets[effective_and_permitted] &= ~PASSES_OVER_PERMISSIONS
    libc.capset(header, sets)


def try_locked(ended: str, name: str, mode: int, arguments: tuple[str, ...]) -> Outcome:
    """A command beside a run, of which one file, or the directory itself, is locked."""

    def act(here: Path) -> int:
        shutil.copytree(ended, here / "run")
        shutil.copy(here / "run" / "scene.toml", here)
        locked = here / "run" / name
        usual = locked.stat().st_mode
        obey_permissions()
        locked.chmod(mode)
        assert not os.access(locked, os.R_OK if mode == 0 else os.W_OK)
        try:
            return skin(*arguments)
        finally:
            locked.chmod(usual)

    return in_empty_directory(act)


@pytest.mark.parametrize("mode", [0, 0o500], ids=["unreadable", "read-only"])
@pytest.mark.parametrize(
    "arguments",
    [
        (*AS_SCENE, "run", "--force"),
        (*AS_SCENE, "run/below"),
        ("build", "scene.toml", "-o", "run/below"),
        ("run", "run", "--force"),
        ("run", "run", "--resume", "--until", "0.05"),
    ],
    ids=lambda arguments: "-".join(arguments[:4]),
)
def test_locked_directory(
    mode: int, arguments: tuple[str, ...], ended: str, sandbox: Sandbox
) -> None:
    """No file is changed; the log may say that a run was to go on."""
    outcome = sandbox(try_locked, ended, ".", mode, arguments)
    outcome.check()
    assert outcome.code == 2
    assert "Permission denied" in outcome.err or "'run' is not readable" in outcome.err
    before, after = sizes(ended), in_run(outcome)
    assert after.pop("log.lammps") >= before.pop("log.lammps")
    assert after == before


@pytest.mark.parametrize(
    "arguments",
    [("run", "run/scene.toml"), ("check", "run/scene.toml"), ("evaluate", "run/x.txt"),
     ("stats", "run"), ("convert", "run"), ("export", "run"), ("snapshot", "run")],
    ids="-".join,
)  # fmt: skip
def test_what_is_read_in_a_locked_directory(
    arguments: tuple[str, ...], ended: str, sandbox: Sandbox
) -> None:
    outcome = sandbox(try_locked, ended, ".", 0, arguments)
    outcome.check()
    assert outcome.code == 2
    assert "run" in outcome.err
    assert in_run(outcome) == sizes(ended)


@pytest.mark.parametrize(
    "name",
    ["checkpoints.json", "events.csv", "log.lammps", "scene.in", "scene.toml", "skin.h5",
     "skin.in", "skin.step3.restart"],
)  # fmt: skip
def test_locked_file(name: str, ended: str, sandbox: Sandbox) -> None:
    """The run is not resumed without the file, and is left as it was."""
    outcome = sandbox(try_locked, ended, name, 0, ("run", "run", "--resume", "--until", "0.05"))
    outcome.check()
    assert outcome.code == 2
    assert name in outcome.err and "Permission denied" in outcome.err
    assert in_run(outcome) == sizes(ended)


def sizes(directory: str) -> dict[str, int]:
    return {path.name: path.stat().st_size for path in Path(directory).iterdir()}


def in_run(outcome: Outcome) -> dict[str, int]:
    """Sizes of the files in the run's directory."""
    return {
        name.removeprefix("a/b/run/"): size
        for name, size in outcome.files.items()
        if name.startswith("a/b/run/")
    }


@pytest.mark.parametrize("place", ["1e300", "-1e12", "inf", "nan"])
def test_a_particle_too_far_away_for_lammps(place: str, ended: str, sandbox: Sandbox) -> None:
    """LAMMPS would go round and round until it is in the box."""
    outcome = sandbox(try_far, ended, place)
    assert outcome.code == 2
    assert f"skin.data: y = {float(place):g} of atom 3 must be within 1e+06 times" in outcome.err


def try_far(ended: str, place: str) -> Outcome:
    def act(here: Path) -> int:
        shutil.copytree(ended, here / "run")
        data = here / "run" / "skin.data"
        lines = data.read_text().splitlines()
        row = lines.index("Atoms # molecular") + 4
        words = lines[row].split()
        lines[row] = " ".join([*words[:4], place, *words[5:]])
        data.write_text("\n".join(lines) + "\n")
        return skin("run", "run", "--force")

    return in_empty_directory(act)
