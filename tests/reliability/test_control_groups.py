"""What control groups allow of memory and cores, in the files of both their versions."""

from __future__ import annotations

from pathlib import Path

import pytest
from lammps_skin.engine.machine import memory_limits, quotas


def write_groups(
    root: Path, kind: str, mounted: str, group: str, controllers: str = "memory"
) -> Path:
    """Files of /proc of a process in a control group, mounted below a folder."""
    process, mount = root / "self", root / "mounted"
    number, controllers, options = (
        ("0", "", "rw,nsdelegate") if kind == "cgroup2" else ("4", controllers, f"rw,{controllers}")
    )
    process.mkdir()
    (process / "cgroup").write_text(f"1:name=systemd:/x\n{number}:{controllers}:{group}\n")
    (process / "mountinfo").write_text(
        f"22 1 0:1 / / rw - ext4 /dev/sda1 rw\n"
        f"35 31 0:32 {mounted} {mount} rw,relatime shared:9 - {kind} cgroup {options}\n"
    )
    return process


@pytest.mark.parametrize(
    ("kind", "name", "unlimited"),
    [("cgroup2", "memory.max", "max"), ("cgroup", "memory.limit_in_bytes", "9223372036854771712")],
)
@pytest.mark.parametrize(
    ("mounted", "group", "limited"),
    [("/", "/user/job", "user"), ("/", "/user/job", "user/job"), ("/", "/", "."),
     ("/docker/a", "/docker/a/cri:job", "cri:job"), ("/docker/a", "/elsewhere", ".")],
)  # fmt: skip
def test_limits_of_control_groups(
    kind: str, name: str, unlimited: str, mounted: str, group: str, limited: str, tmp_path: Path
) -> None:
    """Of the group, of one above it, in a container."""
    process = write_groups(tmp_path, kind, mounted, group)
    for level in {"user/job", "user", "job", limited}:
        (tmp_path / "mounted" / level).mkdir(parents=True, exist_ok=True)
        (tmp_path / "mounted" / level / name).write_text(f"{unlimited}\n")
    (tmp_path / "mounted" / limited / name).write_text("400000000\n")
    assert min(memory_limits(process)) == 400_000_000


@pytest.mark.parametrize(
    ("kind", "files", "unlimited"),
    [
        ("cgroup2", {"cpu.max": "250000 100000\n"}, {"cpu.max": "max 100000\n"}),
        (
            "cgroup", {"cpu.cfs_quota_us": "250000\n", "cpu.cfs_period_us": "100000\n"},
            {"cpu.cfs_quota_us": "-1\n", "cpu.cfs_period_us": "100000\n"},
        ),
    ],
)  # fmt: skip
def test_cores_of_control_groups(
    kind: str, files: dict[str, str], unlimited: dict[str, str], tmp_path: Path
) -> None:
    process = write_groups(tmp_path, kind, "/", "/user/job", "cpu,cpuacct")
    for level, contents in (("user", files), ("user/job", unlimited)):
        (tmp_path / "mounted" / level).mkdir(parents=True)
        for name, text in contents.items():
            (tmp_path / "mounted" / level / name).write_text(text)
    assert list(quotas(process)) == [2.5]


def test_no_control_groups(tmp_path: Path) -> None:
    assert list(memory_limits(tmp_path)) == list(quotas(tmp_path)) == []
