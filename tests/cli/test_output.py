"""What is printed: nothing that a terminal obeys, no key cut, progress also in a file."""

from __future__ import annotations

import re
from importlib.metadata import version
from types import SimpleNamespace

import pytest
from lammps_skin.cli.monitor import NOTEWORTHY, TOO_MUCH, RunMonitor
from lammps_skin.cli.output import console, print_table
from lammps_skin.cli.progress import Progress
from lammps_skin.engine.engine import Motion
from lammps_skin.model.scene import Scene
from lammps_skin.study.simplifications import candidates

SMALL = ("--set", "membrane.lattice=[12,14]")
ORDERS = ("\x1b]0;x\x07", "\x1b[2J", "\x9b31m", "\x08\x08", "\r", "\x7f", "\u202e", "\x00")


@pytest.mark.parametrize("order", ORDERS, ids=ascii)
def test_nothing_gives_orders_to_the_terminal(order, capsys):
    for thing in (f"a{order}b", [["k", f"a{order}b"]]):
        if isinstance(thing, str):
            console.print(thing)
        else:
            print_table([order, "head"], thing)
        out = capsys.readouterr().out
        assert "a" in out and "b" in out
        assert all(c.isprintable() or c == "\n" for c in out)


def test_a_description_gives_no_orders_and_has_one_line(skin, tmp_path):
    text = 'description = "\\u001b]0;owned\\u0007 skin\\nscene: fine"\n'
    (tmp_path / "x.toml").write_text(f"{text}[membrane]\nlattice = [12, 14]\n")
    answer = skin("check", "x.toml")
    first, second, *_ = answer.out.splitlines()
    assert first == "scene: ]0;owned skin scene: fine" and not second
    assert "\x1b" not in answer.out


@pytest.mark.parametrize("columns", [80, 50])
@pytest.mark.parametrize("name", ["quarter-nd-b", "no-dermis"])
def test_keys_are_whole_in_narrow_terminals(name, columns, skin, monkeypatch):
    monkeypatch.setattr(console, "width", columns)
    out = skin("check", name, "--parameters", "earlier-stiff").out
    assert "…" not in out
    assert max(map(len, out.splitlines()[1:])) <= columns
    for saving in candidates(Scene.load(name)):
        for key, value in saving.changes.items():
            assert f"{key} = {str(value).lower()} " in out


def test_numbers_are_not_broken_in_narrow_terminals(capsys, monkeypatch):
    monkeypatch.setattr(console, "width", 30)
    print_table(["", *"abcdefg"], [["x", *["123456.7"] * 7]], right=True)
    assert capsys.readouterr().out.split("\n")[2].split()[1:] == ["123456.7"] * 7


def test_progress_in_a_file(skin):
    out = skin("run", "two-cells", *SMALL, "--until", "10").out
    shown = re.findall(r"^t = (\S+) of 10  2 stem.*; (\d+)%", out, re.M)
    assert [int(share) for _, share in shown] == [*range(10, 101, 10)]
    assert [float(time) for time, _ in shown] == [*range(1, 11)]


def test_progress_that_begins_in_the_middle_and_of_nothing(capsys, monkeypatch):
    """The share is that of the whole, and the time to go that of the speed since the start."""
    clock = [0.0]
    monkeypatch.setattr("lammps_skin.cli.progress.time.monotonic", lambda: clock[0])
    with Progress(30.0, start=20.0) as progress:
        for clock[0], done in ((1, 20.5), (2, 21.0), (4, 24.0), (5, 24.5), (9, 30.0)):
            progress.show(done, "on")
    told = capsys.readouterr().out.splitlines()
    assert told == ["on; 70%, 18 s to go", "on; 80%, 6 s to go", "on; 100%"]
    with Progress(5.0, start=5.0) as progress:
        progress.show(5.0, "there")
    assert capsys.readouterr().out.startswith("there; 100%")


def test_versions(skin):
    answer = skin("--version")
    assert answer.code == 0
    assert answer.out == f"lammps-skin {version('lammps-skin')}, LAMMPS {version('lammps')}\n"


def test_seed_and_accuracy_reach_the_scene(skin):
    given = ("--seed", "7", "--accuracy", "fast")
    assert skin("build", "two-cells", *SMALL, *given, "-o", "x").code == 0
    scene = Scene.load("x/scene.toml")
    assert (scene.seed, scene.cell_seed, scene.numerics.accuracy) == (7, 7, "fast")
    out = skin("check", "two-cells", *given).out
    assert re.search(r"^seeds +cells 7, dermis 7", out, re.M)
    assert re.search(r"^accuracy +fast", out, re.M)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("--seed", "0"), "seed = 0: must be greater than or equal to 1"),
        (("--accuracy", "fst"), "numerics.accuracy = 'fst': must be 'reference', 'balanced' or "),
        (("--seed", "2", "--set", "seed=2"), "--set seed=2: seed = 2 is given, too"),
        (("--set", "seed=1", "--set", "seed = 2"), "--set seed = 2: seed = 1 is given, too"),
        (
            ("--accuracy", "fast", "--set", "numerics.accuracy=balanced"),
            "--set numerics.accuracy=balanced: numerics.accuracy = 'fast' is given, too",
        ),
        (
            ("--parameters", "weak5", "--set", "parameters=papilla"),
            "--set parameters=papilla: parameters = 'weak5' is given, too",
        ),
        (
            ("--seed", "5", "--set", "cells.seed=3"),
            "--seed 5: would not change the cells, whose seed is given: cells.seed = 3",
        ),
    ],
)
def test_options_that_contradict_each_other(given, said, refused):
    assert refused("check", "two-cells", *given).startswith(said)


@pytest.mark.parametrize(
    ("share", "said"),
    [
        (0.5 * NOTEWORTHY, None), (2 * NOTEWORTHY, "the run is valid"),
        (0.9 * TOO_MUCH, "the run is valid"), (1.1 * TOO_MUCH, "the run is not valid"),
    ],
)  # fmt: skip
def test_beyond_the_neighbor_lists(share, said):
    """Whether the run is valid is said with the share."""
    stages, steps, particles = 5, 100, 1000
    beyond = share * (stages - 1) * steps * particles
    monitor = SimpleNamespace(
        _motion=Motion(0, steps, stages * steps, 0, 1, steps, beyond), _particles=particles,
        _tissue=[], living=lambda: "", births=0, removals=0,
    )  # fmt: skip
    for name in ("_beyond", "_verdict"):
        setattr(monitor, name, getattr(RunMonitor, name).__get__(monitor))
    _, *lines = RunMonitor.lines(monitor, SimpleNamespace(exists=lambda: False))
    assert bool(lines) == (said is not None)
    assert said is None or (f"{share:.2%} of the particles" in lines[0] and said in lines[0])
