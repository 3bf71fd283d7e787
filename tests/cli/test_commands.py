"""Every command of ``skin``, really run on tiny scenes."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.cli.cores import warn_of_crowding
from lammps_skin.engine import engine
from lammps_skin.kinds import Kind
from lammps_skin.model.parameters import SETS
from lammps_skin.model.scene import Scene
from lammps_skin.model.scenes import BUILT_IN
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import configuration
from lammps_skin.start.configuration import Configuration
from lammps_skin.trajectory.store import Store

from tests.trajectory.conftest import same

SMALLEST = ("--set", "membrane.lattice=[12,14]")
COMMANDS = ("scenes", "check", "build", "run", "evaluate")
SKIN = [sys.executable, "-c", "from lammps_skin.cli import main; main()"]


def row(text: str, name: str) -> str:
    """What stands after a name in a table."""
    return next(line for line in text.splitlines() if line.startswith(name))[len(name) :].strip()


def energies(lines: list[str]) -> dict[str, float]:
    """Energies in the output of ``skin evaluate``."""
    words = (line.split() for line in lines if line.startswith("# E "))
    return {name: float(value) for _, _, name, value in words}


# ---- help and lists


def test_skin_alone_prints_the_help(skin):
    answer = skin()
    assert answer.code == 0
    assert all(re.search(rf"^  {command}\b", answer.out, re.M) for command in COMMANDS)


def test_the_help_loads_nothing_that_takes_long():
    code = (
        "import sys; from lammps_skin.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: print(*{name.split('.')[0] for name in sys.modules})"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    loaded = set(ended.stdout.splitlines()[-1].split())
    assert "lammps_skin" in loaded
    assert not loaded & {"numpy", "scipy", "matplotlib", "lammps", "MDAnalysis", "h5py", "pydantic"}


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_each_command(skin, command):
    answer = skin(command, "--help")
    assert answer.code == 0
    assert answer.out.startswith(f"Usage: skin {command} ")


def test_scenes_lists_all_scenes_and_sets(skin):
    lines = skin("scenes").out.splitlines()
    first_words = [line.split()[0] for line in lines if line.strip()]
    assert set(BUILT_IN) | set(SETS) <= set(first_words)
    demo = next(line for line in lines if line.split()[:1] == ["demo"])
    assert demo.split()[-6:] == ["40", "x", "46", "6", "0", "320"]


# ---- check


def test_check_counts_what_build_makes(skin):
    text = skin("check", "one-stem", *SMALLEST).out
    scene = Scene.load("one-stem").replace(**{"membrane.lattice": [12, 14]})
    configuration = Configuration.from_scene(scene)
    for kind in (Kind.DERMAL, Kind.MEMBRANE, Kind.STEM):
        assert int(row(text, f"{kind.label} particles")) == (configuration.kinds == kind).sum()
    assert int(row(text, "links")) == len(configuration.links)
    assert row(text, "steps") == "400"


def test_check_says_what_is_off_and_why(skin):
    text = skin(
        "check", "no-dermis", "--set", "cells.stem=0", "--set", "cells.nd=2",
        "--set", "membrane.bending_stiffness=0",
    ).out  # fmt: skip
    assert row(text, "dermis ").split() == ["off", "by", "dermis.present"]
    assert row(text, "wall").split() == ["off", "no", "dermis"]
    assert row(text, "adhesion").split() == ["off", "no", "stem", "cells"]
    assert row(text, "bend").split() == ["off", "its", "K", "is", "0"]
    assert row(text, "binding").split() == ["on", "K", "=", "25"]


def test_check_builds_nothing(skin, monkeypatch):
    """It estimates the largest scene without packing its dermis and without LAMMPS."""

    def refuse(*_, **__):
        raise AssertionError("something was built")

    monkeypatch.setattr(configuration, "pack_dermis", refuse)
    monkeypatch.setattr(engine, "open_lammps", refuse)
    assert skin("check", "paper-nd-d").code == 0


def test_check_measures(skin):
    text = skin("check", "bare-membrane", *SMALLEST, "--measure").out
    assert "ms expected" in text
    assert 1e-3 < float(re.search(r"([\d.e-]+) ms measured", text)[1]) < 100


def test_check_says_what_could_be_left_out(skin):
    text = skin("check", "no-dermis").out
    assert "folds may pass" in " ".join(text.split()) and "membrane.exclusion" in text
    assert "dermis.present" not in text.split("could be left out")[1]
    assert "dermis.frozen_below" in skin("check", "quarter-ring").out


def test_check_measures_what_could_be_left_out():
    from lammps_skin.study.simplifications import measured

    scene = Scene.load("one-stem").replace(**{"cells.stem": 0})
    found = {next(iter(saving.changes)): saving.time for saving in measured(scene, steps=4)}
    assert list(found) == [
        "dermis.frozen_below", "dermis.present", "membrane.exclusion_stiffness",
    ]  # fmt: skip
    assert 0 < found["dermis.present"] < 1


def test_savings_are_measured_with_the_dividing_pairs_of_a_run(tmp_path):
    from lammps_skin.study.simplifications import measured

    fast = {"cells.cycle_delay": 0.5, "cells.cycle_rate": 2.0, "cells.first_phase": 0.5}
    scene = Scene.load("one-stem").replace(
        **fast, **{"membrane.lattice": [24, 28], "end_time": 2.0, "output.dump_interval": 1.0}
    )
    with Simulation.begin(scene, tmp_path / "run") as simulation:
        simulation.run()
    fork = scene.replace(**{"start.from": str(tmp_path / "run"), "end_time": 9.0})
    assert Configuration.from_scene(fork).pair.any()
    found = {next(iter(saving.changes)): saving.time for saving in measured(fork, steps=4)}
    assert 0 < found["dermis.present"] < 1


def test_cost_grows_with_what_it_is_made_of():
    from lammps_skin.study.cost import estimate

    scene = Scene.load("quarter-ring")
    whole = estimate(scene)
    assert estimate(scene.replace(end_time=2000.0)).steps == 2 * whole.steps
    assert estimate(scene.replace(**{"dermis.present": False})).first_step < whole.first_step
    rare = estimate(scene.replace(**{"numerics.event_interval": 2.0}))
    assert rare.seconds < 0.95 * whole.seconds and rare.first_step < whole.first_step
    small = estimate(Scene.load("bare-membrane"))
    large = estimate(Scene.load("bare-membrane").replace(**{"membrane.lattice": [80, 92]}))
    assert 3 < large.first_step / small.first_step < 4  # an evaluation costs something by itself
    assert large.memory > small.memory


# ---- build


def test_build_makes_what_lmp_runs(skin, tmp_path):
    answer = skin("build", "one-stem", *SMALLEST, "-o", "built", "--set", "end_time=0.1")
    assert answer.code == 0
    assert "168 membrane, 1 stem" in answer.out and "built in built" in answer.out
    lmp = Path(sys.executable).parent / "lmp"
    ended = subprocess.run([lmp, "-in", "skin.in"], cwd="built", capture_output=True, text=True)
    assert ended.returncode == 0, ended.stdout[-500:]
    assert (tmp_path / "built" / "skin.dump").stat().st_size > 0


def test_set_and_parameters_reach_the_scene(skin):
    skin("build", "two-cells", "-o", "built", "--parameters", "printed", "--set", "cells.seed=3",
         "--set", "cells.division_spring=length", "--set", "description=a = 'b'")  # fmt: skip
    scene = Scene.load("built/scene.toml")
    assert (scene.parameters, scene.cells.seed, scene.description) == ("printed", 3, "a = 'b'")
    assert (scene.cells.division_spring, scene.cells.adhesion_range) == ("length", 1.4)


# ---- run


LIVELY = (*SMALLEST, "--set", "cells.cycle_delay=1.0", "--set", "cells.cycle_rate=0.5",
          "--set", "cells.first_phase=1.0", "--set", "cells.division_rate=1.0")  # fmt: skip


def test_run_tells_what_happened_and_where_it_is(skin, tmp_path):
    answer = skin("run", "one-stem", *LIVELY, "--until", "20")
    assert answer.code == 0, answer.err
    directory = tmp_path / "runs" / "one-stem"
    events = [line.split(",")[1] for line in (directory / "events.csv").read_text().splitlines()]
    births, removals = events.count("birth"), events.count("death")
    assert births > 3 and removals > 0
    kinds = Store(directory / "skin.h5")[-1].kinds.tolist()
    names = {Kind.STEM: "stem", Kind.TA: "TA", Kind.EXHAUSTED: "exhausted"}
    cells = ", ".join(f"{kinds.count(k)} {name}" for k, name in names.items() if k in kinds)
    assert f"  {cells}; {births} births, {removals} removals\n" in answer.out
    assert "one-stem: reached t = 20," in answer.out
    assert "in runs/one-stem:" in answer.out
    for name in ("events.csv", "skin.h5", "log.lammps"):
        assert re.search(rf"^  {name} ", answer.out, re.M)


def test_a_finished_run_does_not_say_how_to_go_on(skin):
    """The last checkpoint is that of the end; --until goes on from there all the same."""
    changes = ("--set", "output.checkpoint_interval=0.2", "--until", "0.5")
    answer = skin("run", "bare-membrane", *SMALLEST, *changes)
    assert re.search(r"skin\.\*\.restart +checkpoints$", answer.out, re.M)
    assert "resume" not in answer.out
    again = skin("run", "runs/bare-membrane", "--resume", "--until", "0.7")
    assert again.code == 0, again.err
    assert "bare-membrane: goes on at t = 0.5\n" in again.out
    assert "bare-membrane: reached t = 0.7," in again.out


def test_a_run_says_what_was_changed_for_its_stability(skin):
    """Nothing, or steps that were divided and particles that moved slower."""
    assert "slowed" not in skin("run", "two-cells", "--until", "1").out
    slow = "numerics.stiffness_limit=0.001"
    answer = skin("run", "two-cells", "--until", "1", "-o", "slow", "--set", slow)
    assert re.search(r"[1-9]\d\.\d\d% of the particles slowed", answer.out)
    short = ("--set", "numerics.accuracy=fast", "--set", "numerics.neighbor_skin=0.02")
    answer = skin("run", "two-cells", "--until", "20", "-o", "short", *short)
    assert re.search(
        r"\d% of the particles moved beyond the neighbor .* the run is (not )?valid", answer.out
    )


def test_what_cannot_be_resumed(skin, tmp_path):
    short = ("--set", "output.checkpoint_interval=0.2", "--until", "0.3")
    skin("run", "bare-membrane", *SMALLEST, *short, "-o", "x")
    for arguments, said in (
        (("x",), "directory x: has reached t = 0.3; --until takes it further"),
        (("x", "--until", "0.1"), "directory x: has reached t = 0.3; --until takes it further"),
        (("x", "--force"), "as it is; give that alone: skin run x --resume"),
        (
            ("bare-membrane", "--until", "9"),
            "as it is; give that alone: skin run runs/bare-membrane --resume --until 9",
        ),
        (("x", "--set", "cells.seed=3"), "--set: a built directory is run as it is"),
    ):
        answer = skin("run", *arguments, "--resume")
        assert answer.code == 2
        assert said in answer.err and len(answer.err.splitlines()) == 1
    for scene in ("x", "bare-membrane"):
        answer = skin("run", scene, *(() if scene == "x" else (*SMALLEST, *short, "-o", "x")))
        assert "directory x: holds results of a run; skin run x --resume " in answer.err
    answer = skin("run", "bare-membrane", *SMALLEST, "-o", "x")
    assert "it is one of bare-membrane with other keys; give this one" in answer.err
    answer = skin("run", "two-cells", "--seed", "5", "-o", "x")
    assert answer.err == (
        "error: directory x: holds results of a run; it is one of bare-membrane, seed 1; give "
        "this one another directory by -o, or skin run x --resume goes on with it, --force "
        "replaces them\n"
    )


def test_inputs_of_results_are_not_replaced(skin, tmp_path):
    skin("run", "bare-membrane", *SMALLEST, "--until", "0.1", "-o", "x")
    before = Path("x/scene.toml").read_text()
    answer = skin("build", "two-cells", "-o", "x")
    assert answer.code == 2
    assert answer.err == (
        "error: directory x: holds results of a run; its inputs belong to them; give another\n"
    )
    assert Path("x/scene.toml").read_text() == before


def test_a_built_directory_runs_as_it_is(skin, tmp_path):
    short = (*SMALLEST, "--set", "output.dump_interval=0.1")
    skin("build", "one-stem", *short, "-o", "built")
    assert skin("run", "built", "--until", "0.3").code == 0
    assert skin("run", "one-stem", *short, "--until", "0.3", "-o", "direct").code == 0
    frames, others = (list(Store(f"{name}/skin.h5")) for name in ("built", "direct"))
    assert len(frames) == 4 and all(map(same, frames, others))
    assert Scene.load("built/scene.toml").end_time == 200


def test_force_replaces_results(skin, tmp_path):
    checkpoints = ("--set", "output.checkpoint_interval=0.1")
    assert skin("run", "two-cells", *checkpoints, "--until", "0.3", "-o", "x").code == 0
    before = {path.name for path in Path("x").iterdir()}
    assert {"skin.step3.restart", "checkpoints.json", "events.csv"} <= before
    answer = skin("run", "bare-membrane", *SMALLEST, "--until", "0.1", "-o", "x", "--force")
    assert answer.code == 0
    after = {path.name for path in Path("x").iterdir()}
    assert {name for name in after if "restart" in name} == {"skin.step1.restart"}
    assert len(Path("x/events.csv").read_text().splitlines()) == 1


def test_run_on_ranks_and_threads(skin, monkeypatch):
    monkeypatch.setattr("lammps_skin.cli.cores.cores", lambda: 3)
    answer = skin(
        "run", "bare-membrane", "--until", "0.1", "--ranks", "2", "--threads", "2", "-o", "x"
    )
    log = Path("x/log.lammps").read_text()
    assert "1 by 2 by 1 MPI processor grid" in log or "2 by 1 by 1 MPI processor grid" in log
    assert "on 4 procs" in log
    assert answer.out.startswith("2 ranks of 2 threads on 3 cores: they take turns, and nothing is")


@pytest.mark.parametrize(
    ("processes", "threads", "said"),
    [
        (64, 1, "64 runs on 4 cores: they"), (1, 5, "1 run of 5 threads on 4 cores: they"),
        (4, 1, ""), (2, 2, ""),
    ],
)  # fmt: skip
def test_more_processes_than_cores_are_told_of(processes, threads, said, capsys, monkeypatch):
    monkeypatch.setattr("lammps_skin.cli.cores.cores", lambda: 4)
    warn_of_crowding(processes, "run", threads)
    out = capsys.readouterr().out
    assert out.startswith(said) and bool(out) == bool(said)


def test_interrupted_run_ends_cleanly(tmp_path):
    command = [*SKIN, "run", "two-cells", "-o", "x", "--until", "100000"]
    process = subprocess.Popen(
        command, cwd=tmp_path, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    deadline = time.monotonic() + 60
    while not (tmp_path / "x" / "skin.h5").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert err == ""
    assert "two-cells: interrupted at t = " in out and "skin.h5" in out
    assert re.search(r"skin\.\*\.restart +checkpoints; go on: skin run x --resume$", out, re.M)
    assert (tmp_path / "x" / "events.csv").read_text().startswith("time,kind,id")


def test_a_run_that_blows_up_says_when_and_names_its_files(skin):
    answer = skin(
        "run", "bare-membrane", *SMALLEST, "--set", "membrane.bending_stiffness=1e9",
        "--set", "numerics.accuracy=reference", "--until", "1", "-o", "x",
    )  # fmt: skip
    assert answer.code == 2
    assert len(answer.err.splitlines()) == 1
    end = "the state that this run began with is like that (after t = 0, change it or the scene; "
    assert end in answer.err and "most of it from bend" in answer.err
    assert "bare-membrane: stopped after t = 0" in answer.out and "log.lammps" in answer.out


# ---- evaluate


def test_evaluate_writes_a_file_or_stdout(skin, text_file, tmp_path):
    (tmp_path / "small.txt").write_text("\n".join(text_file))
    answer = skin("evaluate", "small.txt")
    assert answer.code == 0 and answer.err == ""
    assert skin("evaluate", "small.txt", "-o", "forces.txt").out == ""
    assert (tmp_path / "forces.txt").read_text() == answer.out
    rows = [line.split() for line in answer.out.splitlines() if not line.startswith("#")]
    assert [words[1] for words in rows] == ["M"] * 168 + ["S", "T", "T"]
    total = np.sum([[float(word) for word in words[2:5]] for words in rows], axis=0)
    assert np.allclose(total, 0, atol=1e-9)


def test_evaluate_takes_parameters_and_settings(skin, text_file, tmp_path):
    (tmp_path / "small.txt").write_text("\n".join(text_file))
    plain = energies(skin("evaluate", "small.txt").out.splitlines())
    assert plain["ad"] > 0 and plain["div"] > 0
    double = ("--set", "cells.adhesion_stiffness=10")
    changed = energies(skin("evaluate", "small.txt", *double).out.splitlines())
    assert changed["ad"] == pytest.approx(2 * plain["ad"], rel=1e-12)
    other = energies(skin("evaluate", "small.txt", "--parameters", "papilla").out.splitlines())
    assert other["ad"] == pytest.approx(25 / (5 * 2.4) * plain["ad"], rel=1e-12)
    assert other["div"] == plain["div"]


def test_the_entry_point_is_installed():
    skin = Path(sys.executable).parent / "skin"
    ended = subprocess.run([skin, "frob"], capture_output=True, text=True, env=os.environ)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert ended.stderr == "error: No such command 'frob'.\n"
