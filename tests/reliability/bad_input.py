"""Bad input, as hypothesis draws it, and what becomes of it."""

from __future__ import annotations

import shutil
from copy import deepcopy
from pathlib import Path
from typing import Any

from hypothesis import strategies as st
from lammps_skin.engine.engine import lammps_message, open_lammps
from lammps_skin.errors import SkinError
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import to_toml
from lammps_skin.start.packing import dermal_count
from pydantic import BaseModel

from tests.cells.test_arguments import ARGUMENTS, SETTING
from tests.reliability.sandbox import Outcome, in_empty_directory, skin

WORDS = [
    "", "nan", "-nan", "inf", "-inf", "0", "-0.0", "-1", "1", "3", "0.5", "1e300", "-1e300",
    "1e-300", "1e400", "2147483647", "2147483648", "-2147483649", "9" * 30, "abc", "é", "\x7f",
    "1.5.2", "0x10", "1e", "1_000", "1 2 3", "*", "1*3", "0*", "NULL", "v_x", "c_pe", "${x}", "$x",
    "&", '"', "'", "#", "\\", "../up", "a" * 300, "true", "[1, 2]", "{}", "\t", "[", "=",
]  # fmt: skip
VALUES = [
    *(0, -1, 1, 2, 3, 5, 12, 14, 2**31 - 1, 2**31, 10**30, -(2**63) - 1),
    *(0.0, -0.0, -1.0, 1e-300, 1e-12, 1e-3, 0.01, 0.1, 0.5, 0.99, 1.0, 1.01, 1.4, 2.5, 10.0, 1e6),
    *(1e12, 1e13, 1e300, float("nan"), float("inf"), float("-inf")),
    *(True, False, "", "ring", "cluster", "random", "core", "halves", "table", "reduced", "direct"),
    *("printed", "weak5", "spline", "../up", "a b", "x\ny", "é", "$x", [], [1], [12, 14], [14, 13]),
    *("balanced", "fast", "rkl1", "rkl2", "$(1/0)", '"', "&", "x &\nshell touch mischief"),
    *([12.0, 14.0], [16, 16, 16], [-12, 14], [10**9, 10**9], [6.0, 6.06], {}, {"x": 1}),
]
TINY: dict[str, Any] = {
    "name": "tiny", "end_time": 0.03,
    "membrane": {"lattice": [12, 14], "height": 10.0},
    "dermis": {"present": False},
    "cells": {"stem": 1, "arrangement": "cluster"},
    "numerics": {"accuracy": "reference", "timestep": 0.01, "table_points": 100},
    "output": {"thermo_interval": 0.01, "dump_interval": 0.01, "checkpoint_interval": 0.02},
}  # fmt: skip
RUN = ("run", "scene.toml", "-o", "out")


# ---- text with some of its words spoilt


Damage = tuple[str, float, float, str]
damages = st.lists(
    st.tuples(
        st.sampled_from(["word", "word", "word", "drop", "double", "cut", "byte", "blank"]),
        st.floats(0, 0.999), st.floats(0, 0.999), st.sampled_from(WORDS),
    ),
    min_size=1, max_size=3,
)  # fmt: skip


def damaged(text: str, damage: list[Damage]) -> bytes:
    """The text with words replaced, lines dropped or doubled, an end cut off, bytes changed."""
    for kind, where, within, word in damage:
        lines = text.split("\n")
        line = int(where * len(lines))
        words = lines[line].split(" ")
        if kind == "word":
            words[int(within * len(words))] = word
            lines[line] = " ".join(words)
        elif kind == "drop":
            del lines[line]
        elif kind == "double":
            lines.insert(line, lines[line])
        elif kind == "blank":
            lines.insert(line, word)
        text = "\n".join(lines)
        if kind == "cut":
            text = text[: int(where * len(text))]
        elif kind == "byte" and text:
            place = int(where * len(text))
            text = text[:place] + chr(int(within * 256)) + text[place + 1 :]
    return text.encode("utf-8", "surrogateescape")


# ---- scene files


def keys_of(model: type[BaseModel], prefix: str = "") -> list[str]:
    """Dotted keys of a scene."""
    found = []
    for name, field in model.model_fields.items():
        part = field.annotation
        if isinstance(part, type) and issubclass(part, BaseModel):
            found += [prefix + name, *keys_of(part, f"{prefix}{name}.")]
        else:
            found.append(prefix + name)
    return found


keys = st.sampled_from([*keys_of(Scene), "cells.sede", "x", "membrane.lattice.x"])
changes = st.dictionaries(keys, st.sampled_from(VALUES), max_size=3)


def scene_text(changed: dict[str, Any]) -> str:
    """The tiny scene with some keys changed, as TOML."""
    given = {key: dict(v) if isinstance(v, dict) else v for key, v in TINY.items()}
    for key, value in changed.items():
        *parts, last = key.split(".")
        place: Any = given
        for part in parts:
            place = place.setdefault(part, {}) if isinstance(place, dict) else {}
        if isinstance(place, dict):
            place[last] = deepcopy(value)
    return to_toml(given)


def is_small(path: Path) -> bool:
    """Whether a scene can be run in a second; what is refused is small."""
    try:
        scene = Scene.load(path)
    except SkinError:
        return True
    particles = scene.membrane.lattice[0] * scene.membrane.lattice[1]
    if scene.dermis.present:
        particles += dermal_count(scene)
    steps = scene.end_time / scene.numerics.timestep
    cells = scene.cells.stem + scene.cells.nd
    return particles < 2000 and steps <= 50 and cells < 200 and scene.numerics.table_points < 20_000


def try_scene(content: bytes) -> Outcome:
    """Run a scene file, or check it where it is large."""

    def act(here: Path) -> int:
        path = here / "scene.toml"
        path.write_bytes(content)
        return skin(*RUN) if is_small(path) else skin("check", "scene.toml")

    return in_empty_directory(act)


# ---- command lines

ARGUMENTS_OF_SKIN = [
    *("run", "check", "build", "scenes", "evaluate", "convert", "two-cells", "scene.toml", "out"),
    *("-o", "--output", "--set", "--ranks", "--threads", "--until", "--force", "--parameters"),
    *("--help", "--frob", "-x", "cells.stem=2", "end_time=0.02", "cells.stem=abc", "=", "a=b=c"),
    *("cells=1", "0", "-1", "0.02", "nan", "1e300", "missing.toml", "../up", "printed", "weak5"),
    *("", " ", "a b", "é", "\n", "--", "-", "--set=seed=2", "--until=0.01", "--until=-1"),
]
command_lines = st.lists(st.sampled_from(ARGUMENTS_OF_SKIN), min_size=0, max_size=7)


def try_command(arguments: list[str]) -> Outcome:
    """A command line beside a tiny scene; runs of built-in scenes end at once."""

    def act(here: Path) -> int:
        (here / "scene.toml").write_text(scene_text({}))
        ends = [word for word in arguments if "until" in word or "end_time" in word]
        limited = arguments[:1] != ["run"] or "two-cells" not in arguments or ends
        return skin(*arguments) if limited else skin(*arguments, "--until", "0.02")

    return in_empty_directory(act)


# ---- tables, data files

TABLES = ["stretch.table", "cell_cell_exclusion.table", "membrane_exclusion.table"]


def try_built(original: str, name: str, damage: list[Damage]) -> Outcome:
    """Run a built scene one file of which is damaged."""

    def act(here: Path) -> int:
        shutil.copytree(original, here / "built")
        path = here / "built" / name
        path.write_bytes(damaged(path.read_text(), damage))
        return skin("run", "built")

    return in_empty_directory(act)


# ---- arguments of the fix

fix_words = st.lists(
    st.tuples(
        st.sampled_from(["replace", "replace", "drop", "insert", "swap"]),
        st.floats(0, 0.999), st.sampled_from([word for word in WORDS if word not in ("&", "#")]),
    ),
    min_size=1, max_size=3,
)  # fmt: skip


def try_fix(damage: list[tuple[str, float, str]]) -> Outcome:
    """Define fix skin/cells with spoilt arguments and run two steps."""
    words = "1 " + " ".join(f"{keyword} {values}" for keyword, values in ARGUMENTS.items())
    spoilt = words.split()
    for kind, where, word in damage:
        place = int(where * len(spoilt))
        if kind == "replace":
            spoilt[place] = word
        elif kind == "drop":
            del spoilt[place]
        elif kind == "insert":
            spoilt.insert(place, word)
        else:
            spoilt[place], spoilt[-1] = spoilt[-1], spoilt[place]

    def act(_: Path) -> int:
        lammps = open_lammps(["-log", "none"])
        try:
            for command in SETTING.values():
                lammps.commands_string(command)
            lammps.command(f"fix cells cells skin/cells {' '.join(spoilt)}")
            lammps.command("run 2 post no")
        except Exception as error:
            import sys

            print(f"error: {lammps_message(str(error))}", file=sys.stderr)
            return 2
        finally:
            lammps.close()
        return 0

    return in_empty_directory(act)
