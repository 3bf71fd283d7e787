"""Which runs and tables a figure takes, which it asks for, and that it can be drawn."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
from lammps_skin.analysis.observables import COLUMNS, write_table
from lammps_skin.errors import FigureError
from lammps_skin.figures.paper import FIGURES, Request, figure_of, run_of
from lammps_skin.model.scene import Scene
from lammps_skin.model.scenes import BUILT_IN
from lammps_skin.study.ensemble import Member, with_seed


def rows(value, times=(0.0, 10.0)):
    """A table of one run with the same value in all columns but the time."""
    table = np.full(len(times), value, [(name, float) for name in COLUMNS])
    table["time"] = times
    return table


def request(number, folder, seeds=None):
    scenes = {name: Scene.load(f"quarter-{name}") for name in FIGURES[number].scenes}
    return Request(number, scenes, seeds, folder)


@pytest.mark.parametrize("number", FIGURES)
@pytest.mark.parametrize("size", ["quarter", "paper"])
def test_scenes_of_the_figures_are_built_in(number, size):
    assert all(f"{size}-{name}" in BUILT_IN for name in FIGURES[number].scenes)


@pytest.mark.parametrize("number", [0, 7, -1])
def test_unknown_figures_are_refused(number):
    with pytest.raises(FigureError, match=rf"figure {number}: must be one of 1, 2, 3, 4, 5, 6"):
        figure_of(number)


def test_the_potentials_need_nothing(tmp_path):
    assert not request(1, tmp_path).missing


def test_every_seed_that_has_no_table_is_missing(tmp_path):
    asked = request(3, tmp_path)
    assert len(asked.missing) == 3 * 8
    done = Member(asked.scenes["ring"].replace(seed=2), tmp_path)
    write_table(rows(1.0), done.table)
    assert len(asked.missing) == 3 * 8 - 1
    assert done not in asked.missing


def test_a_gathered_table_is_taken_as_it_is(tmp_path):
    asked = request(3, tmp_path)
    for name, scene in asked.scenes.items():
        parts = [with_seed(rows(seed), seed) for seed in ((1, 2, 3) if name == "ring" else (1,))]
        write_table(np.concatenate(parts), Member(scene, tmp_path).gathered)
    assert not asked.missing
    lines = asked.draw().axes[0].lines
    assert [line.get_ydata()[0] for line in lines[:3]] == [2, 1, 1]


def test_given_seeds_are_completed_by_runs(tmp_path):
    asked = request(3, tmp_path, seeds=[2, 5])
    for scene in asked.scenes.values():
        write_table(
            np.concatenate([with_seed(rows(s), s) for s in (1, 2)]),
            Member(scene, tmp_path).gathered,
        )
    missing = asked.missing
    assert [member.scene.seed for member in missing] == [5, 5, 5]
    for member in missing:
        write_table(rows(8.0), member.table)
    assert not asked.missing
    assert asked.draw().axes[0].lines[0].get_ydata()[0] == 5  # of seeds 2 and 5


def test_tables_with_other_columns_are_refused(tmp_path):
    asked = request(3, tmp_path, seeds=[1, 2])
    for scene in asked.scenes.values():
        old = with_seed(rows(1.0), 1)[["seed", "time", "zeta"]]
        write_table(old, Member(scene, tmp_path).gathered)
        write_table(rows(1.0), Member(scene.replace(seed=2), tmp_path).table)
    with pytest.raises(FigureError, match=r"quarter-ring .* have different columns"):
        asked.draw()


@pytest.mark.parametrize("number", [n for n in FIGURES if FIGURES[n].of == "table"])
def test_figures_of_tables(tmp_path, number):
    asked = request(number, tmp_path)
    for scene in asked.scenes.values():
        write_table(with_seed(rows(1.0), 1), Member(scene, tmp_path).gathered)
    for axes in asked.draw().axes:
        assert axes.lines


# ---- runs


def test_a_run_is_found_only_if_it_is_the_same_and_complete(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = Scene.load("one-stem").replace(end_time=10.0, **{"output.dump_interval": 5.0})
    member = Member(scene, tmp_path / "ensemble")
    assert run_of(member) is None
    shutil.copytree(run, "runs/one-stem")
    assert run_of(member) is not None
    assert run_of(Member(scene.replace(seed=2), tmp_path)) is None
    assert run_of(Member(scene.replace(parameters="weak5"), tmp_path)) is None

    shutil.copytree(run, member.directory)
    assert run_of(member) == member.directory
    (tmp_path / "runs/one-stem/scene.toml").write_text("[[")
    assert run_of(member) == member.directory


@pytest.mark.parametrize("number", [2, 4])
def test_figures_of_runs(run, tmp_path, number):
    scenes = {
        name: Scene.load("one-stem").replace(end_time=10.0, **{"output.dump_interval": 5.0})
        for name in FIGURES[number].scenes
    }
    asked = Request(number, scenes, None, tmp_path)
    assert len(asked.missing) == len(scenes)
    shutil.copytree(run, Member(next(iter(scenes.values())), tmp_path).directory)
    assert not asked.missing
    figure = asked.draw()
    assert len(figure.axes) == 8
    for axes in figure.axes:
        assert np.asarray(axes.images[0].get_array()).std() > 0.02
