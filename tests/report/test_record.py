"""What the page is made of: arrays and words."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.errors import SkinError
from lammps_skin.model.scene import Scene
from lammps_skin.report import library
from lammps_skin.report.packing import pack, quantised
from lammps_skin.report.page import page, report
from lammps_skin.report.pictures import surface
from lammps_skin.report.record import MOST_FRAMES, MOST_POINTS, chosen, fitting, record
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import lattice
from lammps_skin.trajectory.dump import write_dump
from lammps_skin.trajectory.store import Store


def unpacked(packed: bytes) -> dict[str, np.ndarray]:
    """Arrays as the page unpacks them."""
    head, _, body = gzip.decompress(packed).partition(b"\n")
    found, at = {}, 0
    for one in json.loads(head):
        kind = np.dtype(f"<{one['type']}")
        size = int(np.prod(one["shape"])) * kind.itemsize
        planes = np.frombuffer(body[at : at + size], np.uint8).reshape(kind.itemsize, -1)
        values = np.frombuffer(planes.T.tobytes(), kind).reshape(one["shape"])
        found[one["name"]] = np.cumsum(values, axis=0, dtype=kind) if one["steady"] else values
        at += size
    assert at == len(body)
    return found


def test_packed_arrays_come_back() -> None:
    random = np.random.default_rng(1)
    given = {
        "steady": random.integers(0, 65536, (5, 7, 3)).astype("u2"),
        "small": random.integers(0, 256, (5, 4)).astype("u1"),
        "whole": random.integers(-9, 9, 11).astype("i4"),
        "real": random.normal(size=6),
        "none": np.zeros(0, "f4"),
    }
    found = unpacked(pack(given, ("steady", "small")))
    for name, values in given.items():
        assert found[name].dtype == values.dtype and np.array_equal(found[name], values)


def test_quantised_within_half_a_step() -> None:
    values = np.linspace(-3.0, 5.0, 1001)
    whole = quantised(values, -3.0, 5.0, "u2")
    assert whole[0] == 0 and whole[-1] == 65535
    assert np.abs(-3.0 + 8.0 * whole / 65535 - values).max() <= 8.0 / 65535 / 2 + 1e-12
    assert not quantised(np.ones(3), 1.0, 1.0, "u1").any()


def test_a_periodic_surface_covers_the_box_without_jumps() -> None:
    """Every triangle of the lattice is there, those through a side once on each side of it."""
    shape, spacing = (6, 4), 1.0
    box = np.array([6.0, 4 * np.sqrt(3) / 2])
    first = lattice.positions(shape, spacing, 0.0)
    copies, corners = surface(first, lattice.triangles(shape), box)
    points = np.concatenate([first[:, :2], first[copies[:, 0], :2] + copies[:, 1:] * box])
    a, b, c = points[corners].transpose(1, 0, 2)
    doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    assert doubled == pytest.approx(np.full(len(corners), np.sqrt(3) / 2))
    inside = np.unique(np.sort(np.where(corners < len(first), corners, -1), axis=1), axis=0)
    assert len(inside[(inside >= 0).all(axis=1)]) == 2 * 5 * 3
    middle = points[corners].mean(axis=1) % box
    assert len(np.unique(middle.round(6), axis=0)) == len(lattice.triangles(shape))


def test_frames_that_are_drawn() -> None:
    assert chosen(5, 9) == [0, 1, 2, 3, 4]
    assert chosen(101, 5) == [0, 25, 50, 75, 100]
    assert fitting(10) == MOST_FRAMES
    assert fitting(45_600) * 45_600 <= MOST_POINTS


def test_cells_and_events_are_those_of_the_run(run: Path) -> None:
    told, packed = record(run)
    found = unpacked(packed)
    assert found["number"].tolist() == [
        sum(told["table"][kind["label"]][n] for kind in told["kinds"])
        for n in range(len(told["frames"]))
    ]
    assert (found["cell_clone"] == found["cell_id"][0]).all()  # of one stem cell
    assert len(found["event_time"]) == len((run / "events.csv").read_text().splitlines()) - 1
    founder = found["cell_id"] == found["cell_id"][0]
    born = found["cell_age"][~founder]
    assert np.isnan(found["cell_age"][founder]).all() and len(born) and born.min() >= 0
    ends = told["ranges"]["cells"]
    assert 0.9 < np.mean(born <= ends["age"]) <= 1
    heights = told["ranges"]["low"][2] + found["cells"][:, 2] / 65535 * (
        told["ranges"]["high"][2] - told["ranges"]["low"][2]
    )
    assert np.mean((heights >= ends["height"][0]) & (heights <= ends["height"][1])) > 0.9
    assert dict((key, value) for key, value, given in told["keys"] if given)["end_time"] == "300.0"


def test_warnings_in_plain_words(run: Path, tmp_path: Path) -> None:
    (tmp_path / "skin.h5").write_bytes((run / "skin.h5").read_bytes())
    told = record(tmp_path).told
    assert any("no events.csv" in line for line in told["warnings"])
    assert any(line.startswith("Cells cover") for line in told["warnings"])
    assert told["events"] is None


def test_names_of_runs_cannot_break_the_page(run: Path) -> None:
    one = record(run, frames=2)
    named = one._replace(told={**one.told, "name": "</script><b>&"})
    html = page([named])
    assert "</script><b>" not in html
    assert "<title>&lt;/script&gt;&lt;b&gt;&amp;</title>" in html


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["nowhere"], "nowhere"),
        (["RUN", "--frames", "1"], "frames = 1: must be 2 or more"),
        (["RUN"] * 5, "runs: are 5, must be 1 to 4"),
        (["RUN", "-o", "RUN"], "RUN"),
    ],
)
def test_bad_input(skin, run: Path, given: list[str], said: str) -> None:
    answer = skin("report", *(word.replace("RUN", str(run)) for word in given))
    assert answer.code == 2
    assert answer.err.startswith("error: ") and answer.err.count("\n") == 1
    assert said.replace("RUN", str(run)) in answer.err


def test_the_command(skin, run: Path, tmp_path: Path) -> None:
    answer = skin("report", run, "-o", "new/page.html", "--frames", "2")
    assert answer.code == 0 and answer.out.startswith("new/page.html: ")
    assert (tmp_path / "new/page.html").stat().st_size < 3e6


def test_what_is_missing_is_named(monkeypatch: pytest.MonkeyPatch, run: Path, tmp_path: Path):
    monkeypatch.setattr(library, "PACKAGE", "no-such-package")
    with pytest.raises(SkinError, match=r"three\.js: needs .*pip install 'trimesh>=5,<6'"):
        report([run], tmp_path / "report.html")


def test_a_dump_gives_the_same(run: Path, tmp_path: Path) -> None:
    """Of a plain `lmp` run, whose frames have six digits."""
    for path in run.iterdir():
        if path.suffix not in (".h5", ".restart"):
            (tmp_path / path.name).symlink_to(path)
    store = Store(run / "skin.h5")
    write_dump(tmp_path / "skin.dump", store, store.scene.kinds)
    ours, theirs = record(run), record(tmp_path)
    for name, values in unpacked(ours.packed).items():
        other = unpacked(theirs.packed)[name]
        assert other == pytest.approx(values, rel=1e-4, abs=3, nan_ok=True), name
    assert theirs.told["frames"] == ours.told["frames"]
    assert theirs.told["kinds"] == ours.told["kinds"]


def test_interventions_are_told(tmp_path: Path) -> None:
    scene = Scene.from_dict({
        "end_time": 2.0, "dermis": {"present": False}, "membrane": {"lattice": [24, 28]},
        "cells": {"stem": 2, "arrangement": "cluster"}, "output": {"dump_interval": 1.0},
        "interventions": [{"name": "cull", "at": 1.0, "remove": ["stem"]}],
    })  # fmt: skip
    with Simulation.begin(scene, tmp_path) as simulation:
        simulation.run()
    told = record(tmp_path).told
    assert told["events"]["interventions"] == {"cull": "2 removed"}
    assert told["event_names"] == {"kind": ["removal"], "cause": ["cull"]}
