"""What a study leaves: runs, their history, tables in Parquet; failures are rows."""

from __future__ import annotations

import errno
import os
import re
import resource
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random

import numpy as np
import pandas as pd
import pyarrow.parquet as parquet
import pytest
from lammps_skin.analysis.observables import COLUMNS, read_table
from lammps_skin.analysis.statistics import mean
from lammps_skin.model.scene import Scene
from lammps_skin.study.runner import _attempt
from lammps_skin.study.studies.design import Design, built_in
from lammps_skin.study.studies.runs import KEPT, Study
from lammps_skin.study.studies.tables import read_courses, write_tables

from tests.conftest import Answer
from tests.run.crates import activities, crate
from tests.study.studies.conftest import events

GRID = "[grid]\ncells.generations = [3, 10]"
WINDOWS = 'windows = "0.5-1.5,2-3"'
UNSTABLE = """
    [conditions.sound]
    [conditions.unstable]
    numerics.timestep = 0.5
    numerics.largest_move = 0.0
    membrane.noise = 0.3
    """


@pytest.fixture
def done(study: Callable[..., Study]) -> Study:
    """A study of four runs, done in some order."""
    found = study(WINDOWS, GRID)
    for run in Random(1).sample(found.runs, 4):
        assert _attempt(run, False) is None
    write_tables(found)
    return found


def test_runs_and_tables(done: Study, study: Callable[..., Study]) -> None:
    for run in done.runs:
        names = {path.name for path in run.directory.iterdir()}
        assert names == KEPT
        assert Scene.load(run.directory / "scene.toml").cell_seed == run.seed
    assert events(done.runs) == [["begun", "done"]] * 4

    table = pd.read_parquet(done.folder / "table.parquet")
    assert table["cells.generations"].tolist() == [3, 3, 3, 3, 10, 10, 10, 10]
    assert table["seed"].tolist() == [1, 1, 2, 2, 1, 1, 2, 2]
    assert table["window"].tolist() == ["0.5-1.5", "2-3"] * 4
    assert table["status"].tolist() == ["done"] * 8 and table["error"].isna().all()
    assert [*table.columns[-len(COLUMNS) + 1 :]] == list(COLUMNS[1:])
    for n, run in enumerate(done.runs):
        own = read_table(run.table)
        late = own[(own["time"] >= 2) & (own["time"] <= 3)]
        assert table["height_std"][2 * n + 1] == late["height_std"].mean()
        assert table["run"][2 * n] == run.directory.name

    courses = read_courses(done.folder)
    assert [*courses] == ["cells.generations=3", "cells.generations=10"]
    own = np.concatenate([read_table(run.table) for run in done.runs[2:]])
    for column in COLUMNS:
        np.testing.assert_array_equal(courses["cells.generations=10"][column], own[column])

    # in another folder, done in another order, the bytes are the same
    other = study(WINDOWS, GRID, folder="other")
    for run in other.runs:
        _attempt(run, False)
    for ours, theirs in zip(write_tables(done), write_tables(other), strict=True):
        assert ours.read_bytes() == theirs.read_bytes()


def test_what_is_done_is_not_run_again(
    skin: Callable[..., Answer], done: Study, tmp_path: Path
) -> None:
    """The commands find it all; a seed more is all that is to do."""
    before = [(run.table.read_bytes(), run.table.stat().st_mtime_ns) for run in done.runs]
    answer = skin("study", "tiny.toml", "-o", "study")
    assert answer.code == 0 and "2 points with 2 seeds: 4 runs, 4 of them done" in answer.out
    assert "4 of 4 runs done" in skin("study", "status", "tiny.toml", "-o", "study").out
    (told,) = activities(crate(tmp_path / "study"))
    assert {link["@id"] for link in told["result"]} == {"table.parquet", "courses.parquet"}
    assert told["object"][0] == {"@id": "study.toml"}
    for run in (tmp_path / "study" / "runs").iterdir():  # what was removed is not named any more
        (of_run,) = activities(crate(run))
        assert {link["@id"] for link in of_run["result"]} == {"events.csv", "observables.csv"}

    assert "papilla_height" not in skin("study", "show", "tiny.toml", "-o", "study").out
    columns = "ta,stem-ta,height_std>0,births"
    answer = skin("study", "show", "tiny.toml", "-o", "study", "--columns", columns)
    table = parquet.read_table(done.folder / "table.parquet").to_pandas()
    late = table[(table["window"] == "2-3") & (table["cells.generations"] == 3)]
    found = mean(late["ta"].to_numpy(), least=0.0)
    assert f"{found.value:.3g} [{found.low:.3g}, {found.high:.3g}]" in answer.out
    assert max(map(len, answer.out.splitlines())) <= 80  # and no cell is broken
    compared = skin("compare", "study", "--columns", columns)  # in the study's own windows
    assert compared.code == 0 and "cells.generations=10: cells.generations = 10" in compared.out
    told = {cell for line in answer.out.splitlines() for cell in re.split("  +", line.strip())}
    only = {cell for cell in told if cell not in compared.out}
    assert only <= {"point", "t = 0.5-1.5:", "t = 2-3:"}
    assert skin("study", "plot", "tiny.toml", "-o", "study", "--picture", "a.pdf").code == 0
    assert skin("study", "plot", "tiny.toml", "-o", "study", "--against", "time").code == 0
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")
    assert (done.folder / "tiny.png").stat().st_size > 10_000
    for words, told in (
        (["show", "--columns", "zeta,,ta"], "--columns : there is no column ''; allowed: "),
        (["show", "-o", "elsewhere"], "study tiny.toml: no run is done in elsewhere"),
        (["status", "-o", "tiny.toml"], "history "),
        (["show", "--columns", "zetta"], "--columns zetta: there is no column zetta; did you mean"),
        (["plot", "--against", "tme"], "--against tme: must be one of time, cells.generations"),
        (["run", "--share", "3/2"], "--share 3/2: must be K/N"),
        (["run", "--share", ""], "--share : must be K/N"),
        (["run", "--share", "1/2", "--jobs", "2"], "--share 1/2: runs one after the other; --jobs"),
        (["run", "--share", "1/2", "--scheduler", "a:1"], "--share 1/2: runs one after the other"),
    ):
        answer = skin("study", words[0], "tiny.toml", "-o", "study", *words[1:])
        assert answer.code == 2 and answer.err.startswith(f"error: {told}"), answer.err
    assert before == [(run.table.read_bytes(), run.table.stat().st_mtime_ns) for run in done.runs]
    assert events(done.runs) == [["begun", "done"]] * 4


def test_a_failing_run_is_a_row(skin: Callable[..., Answer], study: Callable[..., Study]) -> None:
    """Whether it is unstable or the disk is full; the others are done, in the same process."""
    found = study('windows = "2-3"', UNSTABLE)
    first, second, *unstable = found.runs
    assert _attempt(first, False) is None
    with no_larger_files(60):
        _attempt(second, False)
    for run in unstable:
        _attempt(run, False)
    write_tables(found)
    table = pd.read_parquet(found.folder / "table.parquet")
    assert table["status"].tolist() == ["done", "failed", "failed", "failed"]
    assert os.strerror(errno.EFBIG) in table["error"][1]
    assert table["error"][2].count("after t = ") == 1
    assert str(found.folder) not in "".join(table["error"][1:])
    assert table["height_std"].isna().tolist() == [False, True, True, True]
    answer = skin("study", "show", "tiny.toml", "-o", "study", "--columns", "ta")
    assert answer.out.endswith("3 of 4 runs are not in it: skin study status tells why\n")
    answer = skin("study", "status", "tiny.toml", "-o", "study")
    assert "1 of 4 runs done" in answer.out and answer.out.count("failed: unstable, seed ") == 2
    assert _attempt(second, False) is None  # once there is space
    assert events([second]) == [["begun", "failed", "begun", "done"]]  # it had left nothing yet
    assert second.state == "done" and not second.error


@contextmanager
def no_larger_files(kilobytes: int) -> Iterator[None]:
    """No file can become larger, as if the disk were full."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (kilobytes * 1024, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_kinds_of_some_points_alone(study: Callable[..., Study]) -> None:
    """Their columns are empty elsewhere."""
    found = study(end="[conditions.plain]\n[conditions.mutant.cells.kinds.mutant]\nlike = 'stem'")
    for run in found.runs[::2]:
        assert _attempt(run, False) is None
    write_tables(found)
    table = pd.read_parquet(found.folder / "table.parquet")
    assert table["status"].tolist() == ["done", "done", "missing", "missing"] * 2
    assert table["mutant"].isna().tolist() == [True] * 4 + [False, False, True, True]
    assert table["condition"].tolist() == ["plain"] * 4 + ["mutant"] * 4
    assert table["cells.kinds.mutant.like"].tolist()[4:] == ["stem"] * 4


@pytest.mark.usefixtures("in_this_process")
def test_the_study_of_adhesion(
    skin: Callable[..., Answer], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Quick, from its file to the answer."""
    monkeypatch.chdir(tmp_path)
    answer = skin("study", "adhesion", "--quick")
    assert answer.code == 0 and "12 points with 2 seeds: 24 runs, 0 of them done" in answer.out
    answer = skin("study", "show", "adhesion", "--quick", "--columns", "zeta,zeta_nd")
    table = pd.read_parquet(tmp_path / "studies" / "adhesion-quick" / "table.parquet")
    assert table["status"].tolist() == ["done"] * 24
    for condition, rows in table.groupby("condition"):
        found = mean(rows["zeta_nd"].to_numpy())
        lines = [row for row in answer.out.splitlines() if row.split()[:1] == [condition]]
        assert lines and {line.split()[1] for line in lines} == {"2"}
        assert f"{found.value:.3g} [{found.low:.3g}, {found.high:.3g}]" in lines[-1]


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted({*built_in()} - {"adhesion"}))
def test_built_in_studies_run(
    name: str, skin: Callable[..., Answer], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Quick, from the file to the answer: every run ends well, and is in the tables."""
    monkeypatch.chdir(tmp_path)
    answer = skin("study", name, "--quick")
    assert answer.code == 0, answer.err
    answer = skin("study", "show", name, "--quick", "--columns", "coverage")
    assert answer.code == 0, answer.err
    table = pd.read_parquet(tmp_path / "studies" / f"{name}-quick" / "table.parquet")
    assert set(table["status"]) == {"done"} and table["coverage"].between(0, 1).all()
    for point in Design.load(Path(name), quick=True).points[:20]:
        assert (table["point"] == point.label).any()
