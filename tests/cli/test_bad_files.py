"""Damaged built directories and text files: refused in one line that says what is wrong."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.start import lattice
from lammps_skin.start.build import build

# ---- built directories


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A tiny scene with all parts, built."""
    directory = tmp_path_factory.mktemp("original")
    tables = {"numerics.pair_form": "table", "numerics.table_points": 1000}
    build(Scene.load("one-stem").replace(**{"membrane.lattice": [12, 14], **tables}), directory)
    return directory


def cut(name: str, share: float) -> Callable[[Path], object]:
    """Keep the first part of a file."""

    def damage(directory: Path) -> None:
        content = (directory / name).read_bytes()
        (directory / name).write_bytes(content[: int(share * len(content))])

    return damage


def remove(name: str) -> Callable[[Path], object]:
    return lambda directory: (directory / name).unlink()


def fill(name: str, content: bytes) -> Callable[[Path], object]:
    return lambda directory: (directory / name).write_bytes(content)


def edit(name: str, old: str, new: str) -> Callable[[Path], object]:
    def damage(directory: Path) -> None:
        text = (directory / name).read_text()
        assert old in text
        (directory / name).write_text(text.replace(old, new, 1))

    return damage


DAMAGE = {
    "no script": (remove("skin.in"), r"directory built: holds no built scene \(there is no skin\."),
    "no scene": (remove("scene.toml"), r"scene file built/scene\.toml: No such file or directory"),
    "cut scene": (cut("scene.toml", 0.5), r"scene file built/scene\.toml: not TOML: "),
    "no numbers": (remove("scene.in"), r"built/scene\.in: states no start_time; build the scene a"),
    "start time": (
        edit("scene.in", "start_time index 0.0", "start_time index soon"),
        r"built/scene\.in: states no start_time; build the scene again",
    ),
    "no number": (edit("scene.in", "contact", "contract"), "Substitution for illegal variable con"),
    "nan": (edit("scene.in", "timestep index 0.5", "timestep index nan"), "Variable timestep: No"),
    "no part": (remove("cells.in"), "Cannot open input script .*/cells.in: No such file"),
    "no data": (remove("skin.data"), "Cannot open file .*/skin.data: No such file"),
    "empty data": (fill("skin.data", b""), "Unexpected end of data file"),
    "binary data": (fill("skin.data", bytes(range(256)) * 9), "Unknown identifier in data file: "),
    "cut atoms": (cut("skin.data", 0.1), "Unexpected end of data file"),
    "cut links": (cut("skin.data", 0.5), "Unexpected end of data file"),
    "no state": (
        lambda directory: fill(
            "skin.data", (directory / "skin.data").read_bytes().split(b"\nstate\n")[0]
        )(directory),
        r"data file .*/built/skin.data: has no section 'state', that of the cells; build the",
    ),
    "cut state": (
        cut("skin.data", 0.999),
        "Unexpected end of data file|Incorrect format in state",
    ),
    "wrong count": (edit("skin.data", "504 bonds", "50 bonds"), "Unknown identifier in data file:"),
    "no table": (remove("stretch.table"), "cannot open bond table potential file .*/stretch.table"),
    "no pair table": (remove("dermis_dermis.table"), "cannot open pair table potential file .*/de"),
    "cut table": (cut("stretch.table", 0.5), ".* parsing bond table 'STRETCH' line 4.. of 1"),
    "cut pair table": (cut("dermis_dermis.table", 0.5), ".* parsing pair table 'DERMIS_DERMIS' li"),
    "empty table": (fill("stretch.table", b""), "Did not find keyword STRETCH in table file"),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_damaged_directory(name, original, refused, tmp_path):
    damage, expected = DAMAGE[name]
    shutil.copytree(original, tmp_path / "built")
    damage(tmp_path / "built")
    text = refused("run", "built", "--until", "0.5")
    assert re.match(expected, text), text
    if not text.startswith(("directory", "scene file", "data file", "built/")):
        assert text.endswith(f"(starting the scene in {tmp_path}/built)")


@pytest.mark.parametrize(
    "option", [("--set", "seed=2"), ("--parameters", "weak5"), ("-o", "elsewhere")], ids=" ".join
)
def test_a_built_directory_is_not_changed(option, original, refused):
    text = f"{option[0]}: a built directory is run as it is; give the scene to change it"
    assert refused("run", original, *option) == text


def test_a_built_directory_needs_a_time_after_its_start(original, refused, tmp_path):
    shutil.copytree(original, tmp_path / "built")
    edit("scene.in", "start_time index 0.0", "start_time index 7.5")(tmp_path / "built")
    text = "--until = 7.5: must be a time after the start, 7.5"
    assert refused("run", "built", "--until", "7.5") == text


# ---- text files for skin evaluate


def change(number: int, line: str | None) -> Callable[[list[str]], list[str]]:
    """Replace a line, counted from 0, or leave it out."""

    def damage(lines: list[str]) -> list[str]:
        changed = list(lines)
        changed[number : number + 1 or None] = [] if line is None else [line]
        return changed

    return damage


FORMAT = "is none of 'lattice NX NY Lx Ly time', 'M|D|S|T|N x y z [m]', 'pair i j L'"
NO_HEADER = "has no line 'lattice NX NY Lx Ly time'"
TEXTS = {
    "no header": (change(0, None), NO_HEADER),
    "empty": (lambda _: [], NO_HEADER),
    "short header": (change(0, "lattice 12 14 6"), f"line 1: 'lattice 12 14 6' {FORMAT}"),
    "fraction": (change(0, "lattice 12.5 14 6 6 0"), f"line 1: 'lattice 12.5 14 6 6 0' {FORMAT}"),
    "count": (
        change(0, "lattice 12 16 6 6.93 0"),
        "lattice 12 x 16 needs 192 membrane particles, the file has 168",
    ),
    "time": (change(0, "lattice 12 14 6 6.062177826 -1"), "time: is -1, must be 0 to 1e+10"),
    "nan time": (change(0, "lattice 12 14 6 6.062177826 nan"), "time: is nan, must be finite"),
    "late": (change(0, "lattice 12 14 6 6.062177826 1e300"), "time: is 1e+300, must be 0 to 1e+10"),
    "letter": (change(2, "Q 1 2 3"), f"line 3: 'Q 1 2 3' {FORMAT}"),
    "truncated": (change(2, "M 1 2"), f"line 3: 'M 1 2' {FORMAT}"),
    "word": (change(2, "M 1 2 high"), f"line 3: 'M 1 2 high' {FORMAT}"),
    "infinite": (change(2, "M 1 2 inf"), f"line 3: 'M 1 2 inf' {FORMAT}"),
    "m": (change(-3, "T 4.5 4.5 12.6 -3"), f"line 171: 'T 4.5 4.5 12.6 -3' {FORMAT}"),
    "large m": (change(-3, f"T 4.5 4.5 12.6 {10**30}"), "line 171: 'T 4.5 4.5 12.6 1000"),
    "short pair": (change(-1, "pair 169 170"), f"line 173: 'pair 169 170' {FORMAT}"),
    "membrane pair": (change(-1, "pair 3 170 0.1"), "pair 3 170: must be two cells"),
    "long pair": (change(-1, "pair 169 170 2.81"), "pair 169 170 2.81: a dividing pair's natural"),
    "missing pair": (change(-1, "pair 169 999 0.1"), "pair 169 999: must be two cells"),
    "own pair": (change(-1, "pair 169 169 0.1"), "pair 169 169: must be two cells"),
    "negative pair": (change(-1, "pair 169 170 -1"), "pair 169 170 -1: a dividing pair's nat"),
    "nan pair": (change(-1, "pair 169 170 nan"), "pair 169 170 nan: a dividing pair's nat"),
    "second header": (lambda lines: [*lines, lines[0]], "line 174: states the lattice, which li"),
    "other header": (
        lambda lines: [*lines, "lattice 14 12 7 5.196 5"], "line 174: states the lattice, which li"
    ),
    "pair again": (
        lambda lines: [*lines, lines[-1]], "line 174: states a pair of cell 169, which line 173 d"
    ),
    "pair of another length": (
        lambda lines: [*lines, "", "pair 169 170 2.5"], "line 175: states a pair of cell 169, w"
    ),
    "pair turned round": (
        lambda lines: [*lines, "pair 170 169 0.1"], "line 174: states a pair of cell ",
    ),
    "triple": (
        lambda lines: [*lines, "pair 168 170 0.1"],
        "line 174: states a pair of cell 170, which line 173 does, too",
    ),
    "overlap": (
        lambda lines: [*lines[:-1], lines[-2]],
        "positions: the cells 170 and 171 overlap, 0 apart",
    ),
    "below": (change(-4, "S 1.5 1.5 -2"), "positions: z = -2 of particle 168 must be in [0, "),
    "torn": (change(5, "M 2 0 16.5"), "positions: the link of the particles "),
}  # fmt: skip


@pytest.mark.parametrize("name", TEXTS)
def test_text_file(name, text_file, refused, tmp_path):
    damage, expected = TEXTS[name]
    (tmp_path / "bad.txt").write_text("\n".join(damage(text_file)))
    text = refused("evaluate", "bad.txt", "-o", "out.txt")
    assert text.removeprefix("configuration bad.txt").lstrip(":, ").startswith(expected)
    assert text.startswith("configuration bad.txt")
    assert not (tmp_path / "out.txt").exists()


def test_text_file_that_contradicts_its_scene(text_file, refused, tmp_path):
    header = "lattice 12 14 7 6.0622 5.0"
    (tmp_path / "bad.txt").write_text("\n".join(change(0, header)(text_file)))
    text = refused("evaluate", "bad.txt")
    assert text.startswith("box = [7, 6.0622]: the lattice [12, 14] at spacing 0.5 gives [6, 6.06")


def test_text_file_that_is_no_text(refused, tmp_path):
    (tmp_path / "bad.txt").write_bytes(b"\xff\xfe")
    assert refused("evaluate", "bad.txt") == "configuration bad.txt: not text in UTF-8"


def test_output_that_cannot_be_written(text_file, refused, tmp_path):
    (tmp_path / "good.txt").write_text("\n".join(text_file))
    text = "output good.txt/x: Not a directory"
    assert refused("evaluate", "good.txt", "-o", "good.txt/x") == text


# ---- scene files that are none


def test_a_pipe_is_no_scene_file(refused, tmp_path):
    os.mkfifo(tmp_path / "scene.toml")
    assert refused("check", "scene.toml") == "scene file scene.toml: is no file"


def test_a_scene_file_is_not_endless(refused, tmp_path):
    (tmp_path / "scene.toml").write_text("# " + 1_000_000 * "-")
    assert refused("check", "scene.toml") == "scene file scene.toml: has more than 1000000 bytes"


@pytest.mark.parametrize(
    "key", ["seed", "end_time", "output.dump_interval", "cells.cycle_delay", "cells.arrangement"]
)
@pytest.mark.parametrize("number", [400 * "9", 5000 * "9", "0x" + 5000 * "f"], ids=[400, 5000, "f"])
def test_a_number_of_very_many_digits(number, key, refused, tmp_path):
    (tmp_path / "scene.toml").write_text(f"{key} = {number}")
    assert refused("check", "scene.toml").startswith("scene file scene.toml: ")
    assert refused("check", "two-cells", "--set", f"{key}={number}").startswith(f"{key} = ")


# ---- states that cannot be


@pytest.mark.parametrize("column", [5, 6])
def test_a_cell_that_is_due_at_no_time(column, original, refused, tmp_path):
    """The last line of the data file is the state of the last cell."""
    shutil.copytree(original, tmp_path / "built")
    *lines, last = (tmp_path / "built" / "skin.data").read_text().rstrip().split("\n")
    words = last.split()
    assert len(words) == 9
    words[column] = "nan"
    (tmp_path / "built" / "skin.data").write_text("\n".join([*lines, " ".join(words)]) + "\n")
    name = ["next_division", "birth_time"][column - 5]
    assert f"Fix skin/cells: {name} = nan of cell {words[0]} must be finite" in refused(
        "run", "built"
    )


def test_two_particles_in_one_place(refused, tmp_path):
    """Two of the membrane that are not linked."""
    scene = Scene.load("bare-membrane").replace(**{"membrane.lattice": [12, 14]})
    sites = lattice.positions((12, 14), scene.spacing, 20.0)
    sites[2] = sites[0]
    lines = ["lattice 12 14 6 6.062177826 0", *(f"M {x} {y} {z}" for x, y, z in sites)]
    (tmp_path / "one.txt").write_text("\n".join(lines))
    assert refused("evaluate", "one.txt") == (
        "configuration one.txt: forces on the particles 0, 2 are not finite; no two may be in one "
        "place"
    )


def test_a_device_is_not_replaced(refused, tmp_path):
    """By the file that a command writes beside it and then gives its name."""
    scene = Scene.load("two-cells").replace(**{"output.dump_interval": 1.0})
    build(scene, tmp_path / "run")
    lmp = [Path(sys.executable).parent / "lmp", "-in", "skin.in", "-var", "end_time", "2"]
    subprocess.run(lmp, cwd=tmp_path / "run", stdout=subprocess.DEVNULL, check=True)
    os.mkfifo(tmp_path / "pipe")
    assert refused("convert", "run", "-o", "pipe") == "output pipe: is no file"
    assert (tmp_path / "pipe").is_fifo()


# ---- builds that do not come to their end


@pytest.mark.parametrize("kilobytes", [1, 40])
def test_a_build_on_a_full_disk(kilobytes, tmp_path):
    """What is there stays as it was; else there is nothing."""
    build(Scene.load("one-stem"), tmp_path / "there")
    before = {path.name: path.read_bytes() for path in (tmp_path / "there").iterdir()}
    skin = Path(sys.executable).parent / "skin"
    for name in ("there", "new"):
        shell = f"ulimit -f {kilobytes}; exec {skin} build two-cells -o {name}"
        command = subprocess.run(
            ["bash", "-c", shell], cwd=tmp_path, capture_output=True, text=True
        )
        assert (command.returncode, command.stderr) == (
            2, f"error: directory {name}: File too large\n"
        )  # fmt: skip
    assert {path.name: path.read_bytes() for path in (tmp_path / "there").iterdir()} == before
    assert not (tmp_path / "new").exists()


def test_a_build_replaces_links(tmp_path):
    """What they lead to stays as it is."""
    (tmp_path / "built").mkdir()
    (tmp_path / "else").write_text("precious")
    (tmp_path / "built" / "skin.data").symlink_to(tmp_path / "else")
    build(Scene.load("two-cells"), tmp_path / "built")
    assert (tmp_path / "else").read_text() == "precious"
    assert not (tmp_path / "built" / "skin.data").is_symlink()


def test_letters_that_the_terminal_does_not_have(tmp_path):
    (tmp_path / "scene.toml").write_text('name = "x"\ndescription = "\u00e9 \u2603"\n', "utf-8")
    skin = [Path(sys.executable).parent / "skin", "check", "scene.toml"]
    command = subprocess.run(
        skin, cwd=tmp_path, capture_output=True, text=True,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )  # fmt: skip
    assert command.returncode == 0, command.stderr
