"""Fix skin/cells that is given anew goes on; what another log, clear and run 0 do."""

from pathlib import Path

import pytest
from lammps_skin.start.build import build

from tests.cells.conftest import of_kind, read_events
from tests.cells.scripts import busy, fix_line, run_script, told

COUNTS = 'print "OUT $(f_cells[9]) $(f_cells[10]) $(f_cells[11])"'


@pytest.mark.parametrize(
    ("again", "log"),
    [
        (["unfix cells", "fix cells cells"], "events.csv"),
        (["fix cells cells"], "events.csv"),
        (["unfix cells", "fix others cells"], "./events.csv"),
        (["unfix cells", "run 1 post no", "fix cells cells"], "events.csv"),
        (["fix cells cells", "fix cells cells"], "events.csv"),
        (["unfix cells", "fix one cells", "unfix one", "fix others cells"], "events.csv"),
        (["fix others cells", "unfix cells"], "events.csv"),
        (["fix one cells", "unfix cells", "unfix one", "fix others cells"], "events.csv"),
        (["fix one cells", "unfix cells", "fix others cells", "unfix one"], "events.csv"),
        (["fix one cells", "unfix one"], "events.csv"),
    ],
    ids=[
        "unfix-fix",
        "fix-anew",
        "another-id",
        "run-between",
        "twice",
        "twice-other-ids",
        "before-unfix",
        "never-run",
        "three",
        "one-more",
    ],
)
def test_fix_given_anew_goes_on(again: list[str], log: str, tmp_path: Path) -> None:
    """With the log, the counts and the IDs of the one before."""
    fix = f"{fix_line(busy(), adhesion='20 1.2')} log {log}"
    name = "others" if "fix others cells" in again else "cells"
    lines = [
        "run 16 post no", COUNTS, "shell cp events.csv before.csv",
        *(f"{line} {fix}" if line.startswith("fix ") else line for line in again),
        "run 0 post no", COUNTS.replace("f_cells", f"f_{name}"), "shell cp events.csv at.csv",
        "run 16 post no", COUNTS.replace("f_cells", f"f_{name}"),
    ]  # fmt: skip
    before, at, after = told(run_script(tmp_path, *lines, scene=busy()))
    assert before == at
    assert before[0] >= 3
    assert after[0] > at[0]
    text = (tmp_path / "events.csv").read_text()
    assert text.startswith((tmp_path / "before.csv").read_text())
    events = read_events(tmp_path)
    births = [event.id for event in of_kind(events, "birth")]
    assert births == list(range(676, 676 + len(births)))
    assert len(births) == after[0]
    assert len(of_kind(events, "death")) == after[1]


def test_restarted_fix_given_anew_goes_on(tmp_path: Path) -> None:
    """With another ID, before it has run."""
    first = ["run 16 post no", COUNTS, "write_restart half.restart"]
    before = told(run_script(tmp_path, *first, scene=busy()))
    log = (tmp_path / "events.csv").read_text()
    counts = COUNTS.replace("f_cells", "f_others")
    lines = ["unfix cells", f"fix others cells {fix_line(busy())} log events.csv", "run 0 post no",
             counts, "run 4 post no"]  # fmt: skip
    restart = ("-var", "restart", "half.restart")
    assert told(run_script(tmp_path, *lines, arguments=restart)) == before
    assert log.count("birth") >= 3
    assert (tmp_path / "events.csv").read_text().startswith(log)


def test_what_ends_in_a_run_without_steps_is_logged(tmp_path: Path) -> None:
    """A pair of which a cell is deleted, though there is no step after it."""
    lines = ["run 16 post no", "write_restart half.restart"]
    assert run_script(tmp_path, *lines, scene=busy()).returncode == 0
    log = (tmp_path / "events.csv").read_text()
    restart = ("-var", "restart", "half.restart")
    gone = f"group gone id {max(event.id for event in of_kind(read_events(tmp_path), 'birth'))}"
    assert run_script(tmp_path, "run 0", arguments=restart).returncode == 0
    assert (tmp_path / "events.csv").read_text() == log
    lines = [gone, "delete_atoms group gone compress no", "run 0", "unfix cells"]
    assert run_script(tmp_path, *lines, arguments=restart).returncode == 0
    text = (tmp_path / "events.csv").read_text()
    assert text.startswith(log)
    (ends,) = text[len(log) :].splitlines()
    assert ",division_end," in ends
    assert ends.endswith("partner_removed")


def test_another_log_begins_anew(tmp_path: Path) -> None:
    lines = ["run 16 post no", "unfix cells", f"fix cells cells {fix_line(busy())} log second.csv",
             "run 16 post no", COUNTS]  # fmt: skip
    process = run_script(tmp_path, *lines, scene=busy())
    assert "cannot close" not in process.stdout
    ((births, *_),) = told(process)
    first = len(of_kind(read_events(tmp_path), "birth"))
    (tmp_path / "second.csv").rename(tmp_path / "events.csv")
    assert first + len(of_kind(read_events(tmp_path), "birth")) == births
    assert first >= 3


def test_clear_begins_anew(tmp_path: Path) -> None:
    """After the command clear nothing is left of the fix before."""
    build(busy(), tmp_path)
    setup = (tmp_path / "skin.in").read_text().splitlines()[:-1]
    lines = ["run 16 post no", "shell cp events.csv first.csv", "clear", *setup, "run 16 post no"]
    process = run_script(tmp_path, *lines, "print 'OUT $(f_cells[9])'")
    ((births,),) = told(process)
    assert (tmp_path / "events.csv").read_text() == (tmp_path / "first.csv").read_text()
    assert len(of_kind(read_events(tmp_path), "birth")) == births
