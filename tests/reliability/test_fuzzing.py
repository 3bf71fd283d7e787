"""Whatever is given is run or refused in one line: no crash, no hang, no traceback."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lammps_skin.model.scene import Scene
from lammps_skin.start.build import build

from tests.reliability import bad_input as bad
from tests.reliability.sandbox import Outcome, Sandbox

MANY = 68  # times as many cases in `make science`


@pytest.fixture(scope="module")
def sandbox() -> Iterator[Sandbox]:
    sandbox = Sandbox()
    yield sandbox
    sandbox.close()


def cases(number: int) -> Any:
    """So many cases in the quick tests, always the same ones, and many more in the slow ones."""
    many = pytest.param(MANY * number, marks=pytest.mark.slow)
    return pytest.mark.parametrize("number", [number, many])


def try_all(number: int, strategy: st.SearchStrategy[Any], check: Callable[[Any], None]) -> None:
    """Carry out a check with so many cases, and no fewer."""
    profile = settings(
        max_examples=number, deadline=None, database=None, derandomize=True,
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    tried = []

    def counted(case: Any) -> None:
        tried.append(case)
        check(case)

    profile(given(strategy)(counted))()
    assert len(tried) >= number


@cases(50)
def test_scene_files(number: int, sandbox: Sandbox) -> None:
    def check(case: tuple[dict[str, Any], list[bad.Damage]]) -> None:
        changes, damage = case
        text = bad.damaged(bad.scene_text(changes), damage)
        outcome = sandbox(bad.try_scene, text)
        outcome.check()
        assert_whole_directory(outcome)

    try_all(number, st.tuples(bad.changes, bad.damages | st.just([])), check)


def assert_whole_directory(outcome: Outcome) -> None:
    """A run directory that is there is complete; nothing is written beside it."""
    built = {Path(name).name for name in outcome.files if name.startswith("a/b/out/")}
    others = {name for name in outcome.files if not name.startswith("a/b/out/")}
    assert others == {"a/b/scene.toml"}, others
    if built:
        assert {"skin.in", "scene.in", "scene.toml", "skin.data", "log.lammps"} <= built
    assert built or outcome.code or "size" in outcome.out


@cases(40)
def test_command_lines(number: int, sandbox: Sandbox) -> None:
    try_all(number, bad.command_lines, lambda words: sandbox(bad.try_command, words).check())


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A tiny scene with tables."""
    directory = tmp_path_factory.mktemp("built")
    scene = Scene.from_dict(bad.TINY).replace(**{"numerics.pair_form": "table"})
    build(scene, directory)
    return str(directory)


@cases(20)
def test_table_files(number: int, sandbox: Sandbox, built: str) -> None:
    def check(case: tuple[str, list[bad.Damage]]) -> None:
        sandbox(bad.try_built, built, *case).check()

    try_all(number, st.tuples(st.sampled_from(bad.TABLES), bad.damages), check)


@cases(20)
def test_data_files(number: int, sandbox: Sandbox, built: str) -> None:
    def check(damage: list[bad.Damage]) -> None:
        sandbox(bad.try_built, built, "skin.data", damage).check()

    try_all(number, bad.damages, check)


@cases(20)
def test_arguments_of_the_fix(number: int, sandbox: Sandbox) -> None:
    try_all(number, bad.fix_words, lambda damage: sandbox(bad.try_fix, damage).check())
