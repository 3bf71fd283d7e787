"""``skin snapshot`` and ``skin figure``."""

from __future__ import annotations

import matplotlib.image
import pytest

from tests.cli.conftest import refused  # noqa: F401

SMALL = (
    "--set", "membrane.lattice=[24,28]", "--set", "dermis.present=false", "--set", "cells.stem=1",
    "--set", "end_time=2.0", "--set", "output.dump_interval=0.2",
)  # fmt: skip


def test_a_snapshot_between_frames_names_the_frame(skin, run, tmp_path):
    answer = skin("snapshot", run, "--time", 6.5, "--view", "section", "-o", "x.png")
    assert answer.out.strip() == "x.png: the frame at t = 5"
    assert skin("snapshot", run, "--time", 6.5, "--view", "section").code == 0
    assert (run / "snapshot-section-t5.png").exists()


def test_snapshot(skin, run, tmp_path):
    answer = skin("snapshot", run, "--time", 5, "--view", "section", "-o", "new/picture.png")
    assert answer.code == 0
    assert answer.out.strip() == "new/picture.png"
    assert matplotlib.image.imread(tmp_path / "new/picture.png").std() > 0.05


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--time", "400"], "time = 400: the nearest frame of"),
        (["--view", "top"], "view = 'top': must be one of"),
        (["--shift", "3"], "shift = '3': must be two numbers, such as 10,-5"),
        (["--zoom", "0"], "zoom = 0: must be from 0.1 to 100"),
        (["--show", "stem,fibre"], "show = 'stem,fibre': must be some of"),
        (["--view", "section", "-o", "/dev/null/a.png"], "output /dev/null/a.png: File exists"),
    ],
)
def test_snapshots_that_cannot_be_are_refused(refused, run, options, text):  # noqa: F811
    assert refused("snapshot", run, *options).startswith(text)


def test_figures_are_listed_with_what_they_cost(skin):
    answer = skin("figure", "--quick")
    assert answer.code == 0
    lines = answer.out.splitlines()
    assert any("potentials" in line and "nothing" in line for line in lines)
    assert any("chi_H" in line and "24 runs" in line for line in lines)


def test_a_figure_that_needs_no_run(skin, tmp_path):
    answer = skin("figure", 1, "-o", "out")
    assert (answer.code, answer.out.strip()) == (0, "out/figure-1.png: the potentials")
    assert matplotlib.image.imread(tmp_path / "out/figure-1.png").std() > 0.05


def test_a_figure_for_print_is_a_pdf_with_text(skin, tmp_path):
    assert skin("figure", 1, "--print", "-o", "out").out.startswith("out/figure-1.pdf: ")
    assert b"/FontFile2" in (tmp_path / "out/figure-1.pdf").read_bytes()  # TrueType, not outlines


def test_runs_are_not_started_without_a_word(refused, tmp_path):  # noqa: F811
    told = refused("figure", 3, "--quick", "--seeds", "1-2")
    assert told.startswith("figure 3 needs 6 runs of quarter-ring, quarter-cluster, quarter-random")
    assert told.endswith("--yes starts them")
    assert [path.name for path in tmp_path.iterdir()] == ["figures"]


def test_unknown_figures_are_refused(refused):  # noqa: F811
    assert refused("figure", 9) == "figure 9: must be one of 1, 2, 3, 4, 5, 6"
    assert refused("figure", 3, "--seeds", "one").startswith("--seeds one: must be")


@pytest.mark.usefixtures("in_this_process")
def test_missing_runs_are_run(skin, tmp_path):
    """A small scene in place of the paper's, and from then on nothing is missing."""
    first = skin("figure", 2, "--yes", "--quick", *SMALL)
    assert first.code == 0, first.err
    picture = tmp_path / "figures/figure-2-quick.png"
    assert matplotlib.image.imread(picture).std() > 0.02
    picture.unlink()
    assert skin("figure", 2, "--quick", *SMALL).code == 0
    assert picture.exists()
