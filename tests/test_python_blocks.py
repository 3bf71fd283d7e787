"""Every Python block of the pages runs as printed, in order, page by page in a fresh directory."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from lammps_skin import Scene, Simulation
from pages import BY_NAME, ROOT, blocks

ELSEWHERE = {"README.md", "tutorial.md"}  # have tests of their own
NAMES = [
    name
    for name in BY_NAME
    if name not in ELSEWHERE and any(language == "python" for language, _ in blocks(name))
]
DATA = ROOT / "docs" / "data"
RUN = None  # stands for the run of the fixture
SHORTER = {  # the same with less to do
    '"end_time": 600.0': '"end_time": 1.0',
    "every=100.0": "every=1.0",
    '"runs/quarter-ring", 600.0': '"runs/quarter-ring", 120.0',
}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of a stem cell with descendants, with frames enough for all pages."""
    directory = tmp_path_factory.mktemp("one-stem") / "run"
    changes = {"end_time": 120.0, "output.dump_interval": 10.0, "dermis.present": False}
    with Simulation.begin(Scene.load("one-stem").replace(**changes), directory) as simulation:
        simulation.run()
    return directory


def table(folder: Path) -> None:
    """The table of a study, with the columns that the page reads."""
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    columns = {
        "condition": ["normal", "half"], "window": ["400-600", "400-600"],
        "zeta": [0.5, 0.4], "stem_on_tips": [0.6, 0.5],
    }  # fmt: skip
    folder.mkdir(parents=True)
    parquet.write_table(pyarrow.table(columns), folder / "table.parquet")


# what stands in the working directory, by the page: a file or directory, or how it is made
THERE: dict[str, dict[str, Path | Callable[[Path], None] | None]] = {
    "analysis.md": {"runs/one-stem": RUN, "many": DATA},
    "claims.md": {"docs": ROOT / "docs"},
    "compare.md": {"docs": ROOT / "docs"},
    "experiments.md": {"docs": ROOT / "docs"},
    "figures.md": {"runs/quarter-ring": RUN},
    "start.md": {"runs/soft": RUN},
    "studies.md": {"studies/adhesion": table},
    "trajectory.md": {"runs/one-stem": RUN},
}


def test_what_is_shortened_stands_on_pages() -> None:
    all_of_them = [one for page in NAMES for one in blocks(page)]
    python = "".join(block for language, block in all_of_them if language == "python")
    assert [long for long in SHORTER if long not in python] == []


@pytest.mark.parametrize("page", NAMES)
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_every_block_runs(
    page: str, run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, content in THERE.get(page, {}).items():
        place = tmp_path / name
        place.parent.mkdir(exist_ok=True)
        if callable(content):
            content(place)
        else:
            place.symlink_to(content or run)
    for language, block in blocks(page):
        if language == "toml" and (name := tomllib.loads(block).get("name")):
            Path(f"{name}.toml").write_text(block)
    namespace: dict[str, object] = {}
    for language, block in blocks(page):
        if language == "python":
            for long, short in SHORTER.items():
                block = block.replace(long, short)
            exec(compile(block, page, "exec"), namespace)
