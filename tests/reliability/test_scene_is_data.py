"""Nothing in a scene file is carried out, or is built if it does not fit."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from lammps_skin.errors import SceneError
from lammps_skin.model.scene import Scene
from lammps_skin.start import memory
from lammps_skin.start.configuration import Configuration

from tests.reliability.bad_input import RUN, scene_text
from tests.reliability.sandbox import Outcome, Sandbox, in_empty_directory, skin

MISCHIEF = [
    "x\nshell touch mischief\n",
    "x\r\nshell touch mischief\r\n",
    "x\u2028shell touch mischief\u2028y\x85shell touch mischief\x0bz",
    "x &\nshell touch mischief\nprint &",
    'x """\nshell touch mischief\n"""',
    "x '\nshell touch mischief\n' \"\nshell touch mischief\n\"",
    "${dir} ${missing} $x $(1/0) $(missing) $(v_missing) v_missing",
    "`touch mischief`; $(touch mischief) | touch mischief && touch mischief",
    "[bold]x[/bold] {0} %s %n \\ \\n # \x1b[31m \x00",
]
NAMES = [
    *MISCHIEF,
    "../up",
    "/tmp/up",
    "..",
    ".",
    ".x",
    "a/b",
    "a\\b",
    "~",
    "-x",
    "",
    "x" * 65,
    "é",
]
CHOICES = ["parameters", "force_scale", "cells.arrangement", "cells.division_spring",
           "numerics.accuracy", "numerics.integrator", "numerics.pair_form",
           "numerics.table_style"]  # fmt: skip
NUMBERS = ["seed", "end_time", "membrane.radius", "cells.stem", "output.dump_interval"]


@pytest.fixture(scope="module")
def sandbox() -> Iterator[Sandbox]:
    sandbox = Sandbox()
    yield sandbox
    sandbox.close()


def try_change(change: dict[str, Any], arguments: tuple[str, ...]) -> Outcome:
    """A command with the tiny scene, some keys of which are changed, in scene.toml."""

    def act(here: Path) -> int:
        (here / "scene.toml").write_text(scene_text(change), "utf-8")
        code = skin(*arguments)
        if (here / "out" / "scene.in").exists():
            print((here / "out" / "scene.in").read_text("utf-8"))
        return code

    return in_empty_directory(act)


@pytest.mark.parametrize("text", MISCHIEF, ids=range(len(MISCHIEF)))
def test_a_description_changes_a_comment_alone(text: str, sandbox: Sandbox) -> None:
    outcome = sandbox(try_change, {"description": text}, RUN)
    plain = sandbox(try_change, {}, RUN)
    assert (outcome.code, plain.code) == (0, 0), outcome
    assert set(outcome.files) == set(plain.files)
    assert outcome.files["a/b/out/skin.h5"] > 0
    changed, given = (text_of_script(o).splitlines() for o in (outcome, plain))
    assert changed[0].startswith("# tiny: ")
    assert changed[1:] == given[1:]


def text_of_script(outcome: Outcome) -> str:
    """What scene.in says."""
    return outcome.out[outcome.out.index("# tiny: ") :]


@pytest.mark.parametrize("key", ["name", *CHOICES, *NUMBERS])
def test_other_texts_are_refused(key: str, sandbox: Sandbox) -> None:
    for text in NAMES if key == "name" else MISCHIEF:
        outcome = sandbox(try_change, {key: text}, ("run", "scene.toml"))
        outcome.check()
        assert outcome.code == 2
        assert key in outcome.err
        assert set(outcome.files) == {"a/b/scene.toml"}


def test_a_run_is_written_below_runs(sandbox: Sandbox) -> None:
    outcome = sandbox(try_change, {"name": "a.-_1"}, ("run", "scene.toml"))
    outcome.check()
    assert outcome.code == 0
    others = {name for name in outcome.files if not name.startswith("a/b/runs/a.-_1/")}
    assert others == {"a/b/scene.toml"}


# ---- sizes


@pytest.mark.parametrize(
    ("changes", "refusal"),
    [
        ({"membrane.lattice": [10**6, 10**6]}, "membrane.lattice = [1000000, 1000000]: more than"),
        ({"membrane.lattice": [10**30, 2]}, "membrane.lattice = "),
        ({"cells.stem": 10**7}, "cells.stem = 10000000 and cells.nd = 0: do not fit"),
        ({"cells.stem": 10**7, "cells.arrangement": "random"}, "cells.stem = 10000000 and cells."),
        ({"dermis.present": True, "dermis.radius": 1e-4}, "dermis: radius 0.0001 and volume_"),
        ({"numerics.table_points": 10**12}, "numerics.table_points = 1000000000000: must be less"),
        ({"end_time": 1e12, "numerics.timestep": 1e-9}, "end_time = 1e+12: more than 1e+12 steps"),
    ],
    ids=str,
)
@pytest.mark.parametrize(
    "command", [RUN, ("check", "scene.toml"), ("build", "scene.toml", "-o", "x")]
)
def test_absurd_sizes(
    changes: dict[str, Any], refusal: str, command: tuple[str, ...], sandbox: Sandbox
) -> None:
    outcome = sandbox(try_change, changes, command)
    outcome.check()
    assert outcome.code == 2
    assert refusal in outcome.err
    assert set(outcome.files) == {"a/b/scene.toml"}


@pytest.mark.parametrize("keys", [{}, {"dermis.present": True, "dermis.radius": 0.45}], ids=str)
def test_what_does_not_fit_into_memory(
    keys: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The refusal comes before anything is built."""
    scene = Scene.load("bare-membrane").replace(**{"membrane.lattice": (1000, 1000), **keys})
    particles = sum(memory.particle_counts(scene))
    assert particles == 1_000_000 if not keys else particles > 2_000_000
    monkeypatch.setattr(memory, "installed", lambda: 1.5e9)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(SceneError, match=rf"^membrane.lattice .* {particles:,} .* 1\.5 GB$"):
        Configuration.from_scene(scene)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 10_000


def test_memory_of_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    """That of the machine, or what is allowed to the process."""
    total = Path("/proc/meminfo").read_text().split()[1]
    unlimited = (resource.RLIM_INFINITY, resource.RLIM_INFINITY)
    monkeypatch.setattr(resource, "getrlimit", lambda _: unlimited)
    assert memory.installed() == 1024 * int(total)
    monkeypatch.setattr(resource, "getrlimit", lambda _: (10**9, 10**9))
    assert memory.installed() == 10**9
