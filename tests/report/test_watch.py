"""A run that goes on, watched in a terminal and in a browser."""

from __future__ import annotations

import csv
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from lammps_skin.analysis.observables import observables
from lammps_skin.cli.watch import sparkline
from lammps_skin.report.server import PageServer
from lammps_skin.report.watched import Watched
from lammps_skin.trajectory.store import Store

from tests.report.browser import Browser

SKIN = [sys.executable, "-c", "from lammps_skin.cli import main; main()"]
ENDLESS = ("--set", "end_time=100000.0", "--set", "output.dump_interval=20.0")
WRITTEN = "events.csv", "log.lammps"
PATIENCE = 150.0  # seconds


class Going:
    """A run in processes of its own, which stand still but for `go_on`."""

    def __init__(self, directory: Path, ranks: str) -> None:
        self.directory, self.ranks = directory, int(ranks)
        command = [*SKIN, "run", "one-stem", "-o", str(directory), *ENDLESS, "--ranks", ranks]
        settings = ("--set", "cells.generations=2", "--set", "output.checkpoint_interval=20.0",
                    "--set", "dermis.present=false")  # fmt: skip
        self.process = subprocess.Popen(
            [*command, *settings], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
        )
        self.go_on(4)

    @property
    def frames(self) -> int:
        path = self.directory / "skin.h5"
        return len(Store(path)) if path.exists() else 0

    def go_on(self, frames: int) -> None:
        """Let it make so many frames in all."""
        self.process.send_signal(signal.SIGCONT)
        deadline = time.monotonic() + PATIENCE
        while self.frames < frames:
            assert time.monotonic() < deadline and self.process.poll() is None
            time.sleep(0.05)
        self.process.send_signal(signal.SIGSTOP)
        before = None
        while before != (now := self._sizes()):  # ranks end the piece of the run that they are in
            before = now
            time.sleep(0.2 * self.ranks)

    def _sizes(self) -> list[int]:
        return [self.frames, *((self.directory / name).stat().st_size for name in WRITTEN)]


@pytest.fixture(scope="module", params=["1", pytest.param("2", marks=pytest.mark.slow)])
def going(
    tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest
) -> Iterator[Going]:
    """A run that goes on, on one rank or on two."""
    going = Going(tmp_path_factory.mktemp("going") / "run", request.param)
    yield going
    going.process.kill()
    going.process.wait()


def logged(directory: Path) -> Counter[str]:
    """Numbers of rows in the event log by kind."""
    with (directory / "events.csv").open() as file:
        return Counter(row["kind"] for row in csv.DictReader(file))


def in_terminal(*words: str, until: str) -> str:
    """What a command shows in a pseudo-terminal, until it shows something; then control-C."""
    pid, terminal = pty.fork()
    if not pid:
        os.environ |= {"COLUMNS": "120", "LINES": "40", "TERM": "xterm"}
        os.execv(sys.executable, [*SKIN, *words])
    shown, deadline = "", time.monotonic() + PATIENCE
    while not re.search(until, shown):
        assert time.monotonic() < deadline, shown
        if select.select([terminal], [], [], 0.1)[0]:
            shown += os.read(terminal, 65536).decode()
    os.write(terminal, b"\x03")
    while True:
        try:
            shown += (more := os.read(terminal, 65536)).decode()
        except OSError:  # the command has ended
            break
        if not more:
            break
    _, status = os.waitpid(pid, 0)
    os.close(terminal)
    assert os.waitstatus_to_exitcode(status) == 0, shown
    return re.sub(r"\x1b\[[\d;?]*[A-Za-z]", "", shown)  # without orders to the terminal


def test_numbers_in_the_terminal_are_those_of_the_files(going: Going) -> None:
    shown = in_terminal("watch", str(going.directory), until=r"last frame .*checkpoint")
    events, table = logged(going.directory), observables(going.directory)
    assert f"births {events['birth']:,}; removals " in shown
    assert f"last frame t = {table['time'][-1]:g}; last checkpoint t = " in shown
    for kind in ("stem", "TA"):
        number = re.findall(rf"\n{kind} cells +[▁-█]+ +([\d,]+)\r\n", shown)[-1]
        assert int(number) == table[kind.lower()][-1] > 0
    (covered,) = set(re.findall(r"covered fraction of the membrane +[▁-█]+ +([\d.]+)", shown))
    assert float(covered) == pytest.approx(table["coverage"][-1], rel=6e-3)
    assert " to go" in shown


def test_the_page_is_served_until_control_c(run: Path) -> None:
    """Also when the run has ended."""
    shown = in_terminal("watch", str(run), "--browser", until=r"t = 300 of 300, ended")
    assert re.search(r"http://127\.0\.0\.1:\d+/ \(control-C ends it\)", shown)


def test_it_grows_with_the_run_and_tells_of_its_end(going: Going) -> None:
    """Frames that are known are not measured again."""
    watched = Watched(going.directory)
    first = watched.look()
    assert first.running and not first.ended and first.speed > 0
    assert first.checkpoint <= first.time
    going.go_on(going.frames + 2)
    second = watched.look()
    assert second.time > first.time and len(second.table) >= len(first.table) + 2
    assert second.table.tobytes() == observables(going.directory).tobytes()
    events = logged(going.directory)
    assert (second.births, sum(second.removals.values())) == (events["birth"], events["death"])


def test_the_page_follows_the_run(going: Going, browser: Browser) -> None:
    browser.errors.clear()
    with PageServer(going.directory) as server:
        browser.open(server.address)
        frames = going.frames
        assert browser.value("page.steps.length") == frames
        births = "Number(document.querySelector('[data-column=births] b').textContent)"
        table = observables(going.directory)
        assert browser.value(births) == table["births"][-1]
        going.go_on(frames + 2)
        server.refresh(going.frames)
        browser.until(f"page.steps.length === {going.frames}")
        table = observables(going.directory)
        assert browser.value("page.time") == table["time"][-1]
        assert browser.value(births) == table["births"][-1]
        assert browser.value("page.views[0].drawn") == sum(
            table[kind][-1] for kind in ("stem", "ta", "exhausted", "nd")
        )
    assert browser.errors == []


def test_the_page_is_for_this_machine_alone(run: Path) -> None:
    with PageServer(run) as server:
        assert server.address.startswith("http://127.0.0.1:")
        for host, path, status in (("evil.example", "", 403), (None, "etc", 404)):
            request = urllib.request.Request(server.address + path)
            if host:
                request.add_header("Host", host)
            with pytest.raises(urllib.error.HTTPError) as refused:
                urllib.request.urlopen(request)
            assert refused.value.code == status
        with urllib.request.urlopen(f"{server.address}news?after=1") as answer:
            assert answer.status == 204


def test_a_run_that_has_ended(skin, run: Path) -> None:
    answer = skin("watch", run)
    assert answer.code == 0
    assert answer.out.startswith(f"one-stem in {run}: t = 300 of 300, ended\n")
    events = logged(run)
    assert f"births {events['birth']}; removals {events['death']} detached; " in answer.out


@pytest.mark.parametrize(("where", "said"), [("nowhere", "is none"), (".", "no trajectory")])
def test_bad_input(skin, where: str, said: str) -> None:
    answer = skin("watch", where)
    assert answer.code == 2 and said in answer.err and answer.err.count("\n") == 1


@pytest.mark.parametrize(
    ("values", "bars"),
    [
        ([0.0, 0.5, 1.0], "▁▅█"),
        ([3.0, 3.0], "▁▁"),
        ([float("nan"), 1.0, 2.0], " ▁█"),
        ([], ""),
        ([*range(16)], "▁▃▆█"),
    ],
)
def test_sparklines(values: list[float], bars: str) -> None:
    """A part shows its last value."""
    assert sparkline(values, width=4) == bars
