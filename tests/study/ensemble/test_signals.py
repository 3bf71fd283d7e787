"""SIGTERM of an ensemble ends its children, quietly."""

import signal
import subprocess
import sys
import time
from pathlib import Path

SKIN = [sys.executable, "-c", "from lammps_skin.cli import main; main()"]


def descendants(pid: int) -> list[int]:
    """Processes that a process has started, in any of its threads, and those that they have."""
    threads = Path(f"/proc/{pid}/task").glob("*/children")
    children = [child for thread in threads for child in thread.read_text().split()]
    return [below for child in map(int, children) for below in (child, *descendants(child))]


def lives(pid: int) -> bool:
    """Whether a process is there and has not ended."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_sigterm_ends_the_children_quietly(tmp_path):
    command = [*SKIN, "ensemble", "two-cells", "--seeds", "1,2", "--jobs", "2",
               "--set", "end_time=100000", "--set", "output.dump_interval=1000",
               "--set", "dermis.present=false"]  # fmt: skip
    process = subprocess.Popen(
        command, cwd=tmp_path, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    deadline = time.monotonic() + 300
    logs = tmp_path / "ensemble" / "runs"
    while len(list(logs.glob("*/skin.h5"))) < 2 and time.monotonic() < deadline:
        time.sleep(0.1)
    children = descendants(process.pid)
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=300)
    assert process.returncode == 128 + signal.SIGTERM
    assert err == ""
    assert len(children) >= 2
    while any(map(lives, children)) and time.monotonic() < deadline + 30:
        time.sleep(0.1)
    assert not any(map(lives, children))
