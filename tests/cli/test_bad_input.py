"""Invalid input is rejected with one line that names the key, the value and what is allowed."""

from __future__ import annotations

import re

import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.model.scenes import BUILT_IN
from lammps_skin.start.build import build

TOP_KEYS = "allowed: name, description, parameters, force_scale, seed, box, box_height, end_time"

# ---- values of a scene: what is given to --set, and how the refusal begins

SETTINGS = {
    # keys
    "colour=red": f"colour = 'red': unknown key; {TOP_KEYS}",
    "cells.sede=3": "cells.sede = 3: unknown key; allowed: stem, nd, arrangement, ring_radius",
    "output.dump=3": "output.dump = 3: unknown key; allowed: thermo_interval, dump_interval",
    "cells=5": "cells = 5: must be a table of keys",
    "membrane.lattice.x=3": "membrane.lattice.x = 3: lattice has no keys",
    "[bold]x[/bold]=1": "[bold]x[/bold] = 1: unknown key",
    "a\nb\x1b[31m=1": "a b [31m = 1: unknown key",
    "cells.seed": "--set cells.seed: must be KEY=VALUE, such as cells.seed=3",
    "=3": "--set =3: must be KEY=VALUE, such as cells.seed=3",
    # types and units
    "numerics.timestep=0.01 s": "numerics.timestep = '0.01 s': must be a number, in the reduced",
    "numerics.timestep=[0.01]": "numerics.timestep = [0.01]: must be a valid number",
    "cells.stem=1.5": "cells.stem = 1.5: must be a valid integer",
    "cells.stem=true": "cells.stem = True: must be a valid integer",
    "cells.stem='two'": "cells.stem = 'two': must be a valid integer",
    "dermis.present=yes": "dermis.present = 'yes': must be a valid boolean",
    "seed=2020-01-01": "seed = datetime.date(2020, 1, 1): must be a valid integer",
    "name=../x": "name = '../x': must be up to 64 letters, digits, '.', '_', '-', not '.' at first",
    # ranges of numbers
    "numerics.timestep=0": "numerics.timestep = 0: must be greater than 0",
    "numerics.timestep=-0.01": "numerics.timestep = -0.01: must be greater than 0",
    "numerics.timestep=nan": "numerics.timestep = nan: must be a finite number",
    "numerics.neighbor_skin=inf": "numerics.neighbor_skin = inf: must be a finite number",
    "membrane.elasticity=1e300": "membrane.elasticity = 1e+300: must be less than or equal to 1000",
    "end_time=-1": "end_time = -1: must be greater than 0",
    "seed=0": "seed = 0: must be greater than or equal to 1",
    "seed=99999999999999999999": "seed = 99999999999999999999: must be less than or equal to",
    "cells.stem=-1": "cells.stem = -1: must be greater than or equal to 0",
    "cells.generations=1001": "cells.generations = 1001: must be an integer from 0 to 1000, or",
    "cells.adhesion_range=1": "cells.adhesion_range = 1: must be greater than 1",
    "membrane.spacing_ratio=1": "membrane.spacing_ratio = 1: must be less than 1",
    "dermis.volume_fraction=2": "dermis.volume_fraction = 2: must be less than or equal to 1.5",
    "numerics.table_points=10": "numerics.table_points = 10: must be greater than or equal to 100",
    "box_height=1e5": "box_height = 100000.0: must be less than or equal to 10000",
    "cells.ring_radius=0.5": "cells.ring_radius = 0.5: must be less than 0.5",
    # choices
    "dermis.packing=hexagonal": "dermis.packing = 'hexagonal': must be 'random' or 'cubic'",
    "parameters=paper": "parameters = 'paper': must be one of printed, papilla, weak5, direct5",
    "force_scale=half": "force_scale = 'half': must be 'printed' or 'direct'",
    "cells.arrangement=spiral": "cells.arrangement = 'spiral': must be 'ring', 'cluster', 'random'",
    "numerics.pair_form=magic": "numerics.pair_form = 'magic': must be 'analytic', 'table'",
    # lattice and box
    "membrane.lattice=24": "membrane.lattice = 24: must be an array of two values",
    "membrane.lattice=[24]": "membrane.lattice = [24]: must be an array of two values",
    "membrane.lattice=[24,28,3]": "membrane.lattice = [24, 28, 3]: must be an array of two values",
    "membrane.lattice=[24.5,28]": "membrane.lattice = 24.5: must be a valid integer",
    "membrane.lattice=[24,27]": "membrane.lattice = [24, 27]: the number of rows must be even",
    "membrane.lattice=[10,12]": "membrane.lattice = [10, 12]: must be at least [12, 14]",
    "membrane.lattice=[9999,9998]": "membrane.lattice = [9999, 9998]: more than 50,000,000 part",
    "box=[50,50]": "box = [50, 50]: the lattice [24, 28] at spacing 0.5 gives [12, 12.1244]; leave",
    "box=[12]": "box = [12]: must be an array of two values",
    "box_height=10": "box_height = 10: must be at least 32, the membrane's height 22.4 and room",
    "cells.radius=10": "box_height = 100: must be at least 204",
    # what contradicts each other
    "cells.radius=0.3": "cells.radius = 0.3: must be above 0.4434, or cells pass through the mesh",
    "cells.division_separation=0.5": "cells.division_separation = 0.5: must be below 0.5",
    "cells.arrangement=core": "cells.arrangement = 'core': needs both stem and ND cells, got stem",
    "end_time=0.001": "end_time = 0.001: must be at least the timestep, 0.01",
    "end_time=1e13": "end_time = 10000000000000.0: must be less than or equal to 1000000000000",
    "output.dump_interval=0.001": "output.dump_interval = 0.001: must be at least the timestep",
    "output.checkpoint_interval=1e10": "output.checkpoint_interval = 1e+10: more than 2.15e+09 st",
    "numerics.event_interval=100": "numerics.event_interval = 100: must be shorter than a cell cyc",
    # what does not fit
    "membrane.radius=0.1": "box of 1.2 x 1.212 x 100: too small for the range 3.36 of cell_cell_",
    "cells.adhesion_range=1e9": "box of 12 x 12.12 x 100: too small for the range 2.8e+09 of cell_",
    "numerics.neighbor_skin=20": "box of 12 x 12.12 x 100: too small for the range 3.36 of cell_",
    "membrane.noise=1e3": "membrane.noise = 1000: puts a particle at z = ",
    "membrane.noise=2": "positions: the link of the particles ",
}


@pytest.mark.parametrize("setting", SETTINGS, ids=repr)
def test_setting(setting, refused, tmp_path):
    assert refused("run", "two-cells", "--set", setting).startswith(SETTINGS[setting])
    assert not any(tmp_path.iterdir())


def test_positions_that_noise_spoils_are_named(refused):
    high = refused("run", "two-cells", "--set", "membrane.noise=1e3")
    assert re.fullmatch(
        r"membrane\.noise = 1000: puts a particle at z = \S+, which must be in \[0, 100\)", high
    )
    torn = refused("run", "two-cells", "--set", "membrane.noise=2")
    assert torn.endswith("long, must be between 0 and 2.5")


@pytest.mark.parametrize(
    ("arrangement", "stem", "nd", "why"),
    [
        ("ring", 10, 0, "two would be 2.225 apart, below 2 R_c = 2.8, with cells.ring_radius"),
        ("cluster", 40, 0, "there is room for 21 at most"),
        ("cluster", 21, 0, "two would be"),
        ("random", 21, 0, "at random only 1"),
        ("core", 9, 1, "two would be 2.463 apart, below 2 R_c = 2.8"),
        ("alternating", 9, 9, "two would be"),
        ("halves", 8, 8, "two would be"),
    ],
)
def test_cells_that_do_not_fit(arrangement, stem, nd, why, refused, tmp_path):
    settings = [f"cells.arrangement={arrangement}", f"cells.stem={stem}", f"cells.nd={nd}"]
    options = [word for setting in settings for word in ("--set", setting)]
    for command in (("run",), ("build", "-o", "x"), ("check",)):
        text = refused(command[0], "two-cells", *options, *command[1:])
        assert text.startswith(
            f"cells.stem = {stem} and cells.nd = {nd}: do not fit in the arrangement "
            f"'{arrangement}' on a membrane of 12 x 12.12: {why}"
        )
    assert not any(tmp_path.iterdir())


def test_alternating_cells_come_in_equal_numbers(refused):
    options = ("--set", "cells.nd=1", "--set", "cells.arrangement=alternating")
    text = "cells.nd = 1: must equal cells.stem = 2 in the alternating arrangement"
    assert refused("check", "two-cells", *options) == text


def test_a_dermis_needs_a_possible_number_of_particles(refused):
    none = refused("check", "one-stem", "--set", "dermis.volume_fraction=1e-9")
    many = refused("check", "one-stem", "--set", "dermis.radius=0.001")
    assert none == (
        "dermis: radius 1.4 and volume_fraction 1e-09 give 0 particles; must be 1 to 10,000,000"
    )
    assert many.startswith("dermis: radius 0.001 and volume_fraction 0.64 give 475,")
    cubic = ("--set", "dermis.packing=cubic")
    many = refused("check", "one-stem", "--set", "dermis.radius=0.001", *cubic)
    assert many.startswith("dermis: radius 0.001 and cubic packing give 389,")


# ---- scene files

SCENE_FILES = {
    b"cells = [": "not TOML: Invalid value",
    b"name = 'a'\nname = 'b'": "not TOML: Cannot overwrite a value",
    b"x = " + b"[" * 5000: "not TOML: nested too deeply",
    b"\xff\xfename": "not text in UTF-8",
    b"[cells]\nsede = 3": "cells.sede = 3: unknown key; allowed: stem",
    b"[cells.stem]\nx = 1": "cells.stem = {'x': 1}: must be a valid integer",
    b"parameters = 3": "parameters = 3: must be one of printed, papilla, weak5, direct5",
    b'"a\\nb" = 1': f"a b = 1: unknown key; {TOP_KEYS}",
}


@pytest.mark.parametrize("content", SCENE_FILES, ids=lambda content: repr(content[:20]))
def test_scene_file(content, refused, tmp_path):
    (tmp_path / "bad.toml").write_bytes(content)
    for command in (("run",), ("check",), ("build", "-o", "x")):
        text = refused(command[0], "bad.toml", *command[1:])
        assert text.startswith(f"scene file bad.toml: {SCENE_FILES[content]}")
    assert [path.name for path in tmp_path.iterdir()] == ["bad.toml"]


def test_a_description_is_no_command(skin, tmp_path):
    """It stands in a comment of scene.in."""
    text = 'x\nshell touch mischief\n""" & " \u2028 😀 \x7f \x00'
    for n, letter in enumerate([text, text.replace('"', "'")]):
        scene = Scene.load("two-cells").replace(description=letter, end_time=0.05)
        build(scene, tmp_path / f"built{n}")
        assert skin("run", f"built{n}").code == 0
        assert Scene.load(tmp_path / f"built{n}" / "scene.toml") == scene
    assert not any(tmp_path.glob("**/mischief"))


# ---- command lines

NAMES = ", ".join(BUILT_IN)
SMALL = ("run", "two-cells", "-o", "x")
COMMAND_LINES = {
    ("frob",): "No such command 'frob'.",
    ("--frob",): "No such option: --frob",
    ("run",): "Missing argument 'SCENE|DIR'.",
    ("run", "demo", "two-cells"): "Got unexpected extra argument(s) (two-cells)",
    ("run", "two-cells", "--frob"): "No such option: --frob",
    ("run", "two-cells", "--ranks"): "Option '--ranks' requires an argument.",
    (*SMALL, "--ranks", "0"): "ranks = 0: must be a whole number from 1 to 4096",
    (*SMALL, "--threads", "-2"): "threads = -2: must be a whole number from 1 to 4096",
    (*SMALL, "--ranks", "two"): "Invalid value for '--ranks': ",
    (*SMALL, "--until", "soon"): "Invalid value for '--until': ",
    (*SMALL, "--until", "-5"): "--until = -5: must be a time after the start, 0",
    (*SMALL, "--until", "0"): "--until = 0: must be a time after the start, 0",
    (*SMALL, "--until", "nan"): "--until = nan: must be a time after the start, 0",
    (*SMALL, "--until", "inf"): "--until = inf: must be a time after the start, 0",
    (*SMALL, "--until", "1e300"): "end_time = 1e+300: must be less than or equal to 1000000000000",
    (*SMALL, "--until", "0.001"): "end_time = 0.001: must be at least the timestep, 0.01",
    ("run", "nowhere"): f"scene 'nowhere': neither a .toml file nor one of {NAMES}",
    ("run", ""): "scene '': neither a .toml file nor one of ",
    ("run", "missing.toml"): "scene file missing.toml: No such file or directory",
    ("run", "folder"): "directory folder: holds no built scene (there is no skin.in)",
    ("run", "two-cells", "-o", "a b"): "directory 'a b': LAMMPS cannot read a path with ' ' in it",
    ("run", "demo", "-o", "\u00fc"): "directory '\u00fc': LAMMPS cannot read a path with '\\xfc'",
    ("run", "two-cells", "-o", "a*b"): "directory 'a*b': LAMMPS cannot read a path with '*' in it",
    ("run", "two-cells", "-o", "a#b"): "directory 'a#b': LAMMPS cannot read a path with '#' in it",
    ("run", "two-cells", "-o", "a%b"): "directory 'a%b': LAMMPS cannot read a path with '%' in it",
    ("run", "two-cells", "-o", "a\udcffb"): "directory 'a\\udcffb': LAMMPS cannot read a path",
    ("run", "two-cells", "-o", "a$b"): "directory 'a$b': LAMMPS cannot read a path with '$' in it",
    ("build", "two-cells", "-o", "file/x"): "directory file/x: Not a directory",
    ("check",): "SCENE: is missing; skin scenes lists the built-in ones",
    ("check", "demo", "--parameters", "paper"): "parameters = 'paper': must be one of printed, pap",
    ("build", "demo"): "Missing option '-o' / '--output'.",
    ("build", "bare-membrane", "-o", "file"): "directory file: Not a directory",
    ("scenes", "demo"): "Got unexpected extra argument(s) (demo)",
    ("evaluate",): "Missing argument 'FILE'.",
    ("evaluate", "missing.txt"): "configuration missing.txt: No such file or directory",
    ("evaluate", "folder"): "configuration folder: Is a directory",
}  # fmt: skip


@pytest.mark.parametrize("arguments", COMMAND_LINES, ids=" ".join)
def test_command_line(arguments, refused, tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    assert refused(*arguments).startswith(COMMAND_LINES[arguments])
    assert {path.name for path in tmp_path.iterdir()} == {"folder", "file"}


@pytest.mark.parametrize("name", ["events.csv", "skin.dump", "skin.h5"])
def test_results_are_not_overwritten(name, refused, tmp_path):
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / name).write_text("precious")
    text = (
        "directory x: holds results of a run; skin run x --resume --until 1 goes on with it, "
        "--force replaces them"
    )
    assert refused(*SMALL, "--until", "1") == text
    assert (tmp_path / "x" / name).read_text() == "precious"


@pytest.mark.parametrize(
    "bad",
    [("--set", "cells.stem=40"), ("--set", "cells.x=1"), ("--until", "-1"), ("--ranks", "0")],
    ids=" ".join,
)
def test_a_refusal_keeps_results_also_with_force(bad, refused, tmp_path):
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / "events.csv").write_text("precious")
    refused(*SMALL, "--force", *bad)
    assert (tmp_path / "x" / "events.csv").read_text() == "precious"
