"""The scenes at the age of their tries, and LAMMPS to try commands in."""

import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest

from tests.cells.conftest import FOUR_STEPS
from tests.compatibility.scenes import AGE, SCENES, build_scene
from tests.compatibility.tries import Row, Try, script

ROOT = Path(__file__).resolve().parents[2]
SERVER = [sys.executable, "-m", "tests.compatibility.server"]

Runner = Callable[[Path, str], int]
Tried = Callable[..., Try]


@pytest.fixture(scope="session")
def run_in() -> Iterator[Runner]:
    """Run `try.in` of a directory with a command line; the exit status."""
    quiet = os.environ | {"OMP_WAIT_POLICY": "passive"}  # threads that wait leave the cores alone
    with subprocess.Popen(
        SERVER, cwd=ROOT, env=quiet, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as server:

        def run(directory: Path, arguments: str) -> int:
            assert server.stdin is not None and server.stdout is not None
            server.stdin.write(json.dumps([str(directory), shlex.split(arguments)]) + "\n")
            server.stdin.flush()
            return int(server.stdout.readline())

        yield run
        assert server.stdin is not None
        server.stdin.close()


@pytest.fixture(scope="session")
def scenes(tmp_path_factory: pytest.TempPathFactory, run_in: Runner) -> Path:
    """Directory of all scenes, run to the age of the tries."""
    folder = tmp_path_factory.mktemp("scenes")
    for name in SCENES:
        directory = folder / name
        build_scene(name, directory)
        setup = (directory / "setup.in").read_text()
        steps = round(AGE / FOUR_STEPS["timestep"])
        run = steps if SCENES[name]["cells"]["stem"] else 0  # alone, the membrane would be flat
        young = f"run {run}\nwrite_data skin.data nocoeff\n"
        (directory / "try.in").write_text(setup + young)
        shutil.copyfile(directory / "skin.data", directory / "young.data")
        (directory / "young.in").write_text(setup.replace("skin.data", "young.data"))
        assert run_in(directory, "-log none") == 0, (directory / "error.txt").read_text()
        setup = setup.replace("start_step index 0", f"start_step index {steps}")
        setup = setup.replace("start_time index 0.0", f"start_time index {AGE}")
        (directory / "setup.in").write_text(setup)
    return folder


@pytest.fixture(scope="session")
def tried(tmp_path_factory: pytest.TempPathFactory, scenes: Path, run_in: Runner) -> Tried:
    """Try a row on a number of ranks; the same script is run once."""
    done: dict[tuple[str, str, int], Try] = {}

    def attempt(row: Row, ranks: int = 1) -> Try:
        scene = scenes / row.scene
        text = script(row, (scene / ("young.in" if row.young else "setup.in")).read_text())
        key = (text, row.arguments, ranks)
        if key not in done:
            directory = tmp_path_factory.mktemp("try")
            for path in (*scene.glob("*.data"), *scene.glob("*.table")):
                (directory / path.name).symlink_to(path)
            (directory / "try.in").write_text(text)
            run = run_in if ranks == 1 else partial(run_on_ranks, ranks)
            status = run(directory, row.arguments)
            error = directory / "error.txt"
            message = " ".join(error.read_text().split()) if error.exists() else ""
            done[key] = Try(row, directory, status, message)
        return done[key]

    return attempt


def run_on_ranks(ranks: int, directory: Path, arguments: str) -> int:
    """Run `try.in` of a directory on several ranks; the exit status."""
    launcher = [str(Path(sys.executable).parent / "mpirun"), "-launcher", "fork", "-np", str(ranks)]
    command = [*launcher, *SERVER, str(directory), *shlex.split(arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, timeout=120).returncode
