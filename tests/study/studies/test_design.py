"""What the file of a study says, and what is wrong with it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.cli.options import scene_from
from lammps_skin.errors import SceneError
from lammps_skin.model.scene import Scene
from lammps_skin.study.ensemble import members
from lammps_skin.study.studies.design import Design, built_in
from lammps_skin.study.studies.runs import Study

from tests.conftest import Answer


def test_the_full_product(study: Callable[..., Study]) -> None:
    """Of conditions and keys, with the values that the scene has where a condition is silent."""
    design = study(
        'windows = "1-2,2-3"',
        """
        [conditions.normal]
        [conditions.weak]
        cells.adhesion_stiffness = 2.5
        cells.kinds.stem.adhesion = "adhesive"
        [grid]
        membrane.bending_stiffness = [5.0, 10.0]
        end_time = [3.0, 4.0]
        """,
    ).design
    assert [point.label for point in design.points] == [
        f"{condition}, membrane.bending_stiffness={k}, end_time={end}"
        for condition in ("normal", "weak") for k in (5, 10) for end in (3, 4)
    ]  # fmt: skip
    assert design.keys == (
        "cells.adhesion_stiffness", "cells.kinds.stem.adhesion", "membrane.bending_stiffness",
        "end_time",
    )  # fmt: skip
    usual = design.scene.cells.adhesion_stiffness
    assert usual != 2.5
    for point in design.points:
        weak = point.condition == "weak"
        assert point.scene.cells.adhesion_stiffness == (2.5 if weak else usual)
        assert point.scene.cell_table["stem"].adhesion == ("adhesive" if weak else "bound")
        assert [*point.values.values()] == [
            point.scene.cells.adhesion_stiffness, point.scene.cell_table["stem"].adhesion,
            point.scene.membrane.bending_stiffness, point.scene.end_time,
        ]  # fmt: skip
    assert design.seeds == (1, 2)
    assert [str(window) for window in design.windows] == ["1-2", "2-3"]


def test_a_scene_by_its_name_or_file(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text('name = "mine"\nend_time = 7.0\n[cells]\nstem = 1\n')
    path = tmp_path / "one.toml"
    for source, name in (("two-cells", "two-cells"), ("mine.toml", "mine")):
        path.write_text(f'scene = "{source}"\n[set]\ncells.generations = 4\n')
        design = Design.load(path)
        assert design.scene.name == name and design.scene.cells.generations == 4
        (point,) = design.points
        assert point.label == "one" and point.scene == design.scene
    assert design.scene.end_time == 7.0


def test_paths_are_relative_to_the_file(tmp_path: Path) -> None:
    for name in "ab":
        np.save(tmp_path / f"{name}.npy", np.zeros((2, 2)))
    (tmp_path / "one.toml").write_text(
        'scene = "two-cells"\n[grid]\nmembrane.heights = ["a.npy", "b.npy"]\n'
    )
    points = Design.load(tmp_path / "one.toml").points
    assert [point.scene.membrane.heights for point in points] == [
        str(tmp_path / "a.npy"), str(tmp_path / "b.npy")
    ]  # fmt: skip


@pytest.mark.parametrize(("method", "number"), [("latin", 8), ("sobol", 8 * 4), ("morris", 8 * 3)])
def test_samples(study: Callable[..., Study], method: str, number: int) -> None:
    """Within their ranges, whole numbers as such, the same each time."""
    text = f"""
        [sample]
        method = "{method}"
        n = 8
        [sample.ranges]
        cells.generations = [2, 9]
        cells.radius = [1.0, 2.0]
        """
    design, again = study(end=text).design, study(end=text).design
    assert design.points == again.points and len(design.points) == number
    values = [point.values for point in design.points]
    assert {type(one["cells.generations"]) for one in values} == {int}
    assert {one["cells.generations"] for one in values} <= set(range(2, 10))
    radii = np.array([one["cells.radius"] for one in values])
    assert radii.min() < 1.3 < 1.7 < radii.max() and radii.min() >= 1 and radii.max() <= 2
    if method == "latin":  # one in each eighth
        assert sorted((8 * (radii - 1)).astype(int)) == list(range(8))


def test_sensitivity_of_a_linear_function(study: Callable[..., Study]) -> None:
    """y = 3 a - b of a, b from 0 to 1: Sobol 9/10 and 1/10, Morris 3 and -1 without sigma."""
    for method, columns, expected in (
        ("sobol", ("first", "total"), [[0.9, 0.9], [0.1, 0.1]]),
        ("morris", ("mu_star", "mu", "mu_error", "sigma"), [[3, 3, 0, 0], [1, -1, 0, 0]]),
    ):
        design = study(end=f"""
            [sample]
            method = "{method}"
            n = 256
            [sample.ranges]
            cells.radius = [1.0, 2.0]
            box_height = [100.0, 101.0]
            """).design
        assert design.sample
        y = [3 * point.values["cells.radius"] - point.values["box_height"]
             for point in design.points]  # fmt: skip
        names, found = design.sample.sensitivity(np.array(y))
        found = found[:, [names.index(name) for name in columns]]
        np.testing.assert_allclose(found, expected, atol=0.05 if method == "sobol" else 1e-4)


@pytest.mark.parametrize(
    ("begin", "end", "words"),
    [
        ("sceen = 1", "", "sceen = 1: unknown key; allowed: scene, seeds, .*; did you mean scene"),
        ("windows = [1, 2]", "", r"windows = \[1, 2\]: must be text, such as \"400-600,"),
        ('windows = ""', "", "windows = '': must be text"),
        ("seeds = [1, 2]", "", r"seeds = \[1, 2\]: must be text, such as \"1-8\""),
        ("", "[set]\nseed = 2", "set.seed = 2: `seeds` says with which seeds points run"),
        ("", "[grid]\ncells.radius = [1.4, 1.4000000000000001]", "2 points have this name"),
        ('windows = "1-9"', "", "windows = 1-9: 1-9 must be two times .* the end time, 3"),
        ('windows = "1-2,1.6-1.9"', "", "no frame is in 1.6-1.9, since .* = 0.5"),
        ('windows = "1-2"', "[grid]\noutput.dump_interval = [0.5, 3.0]",
         "no frame is in 1-2, since output.dump_interval = 3, of output.dump_interval=3"),
        ("", "[grid]\ncells.stem = 2", "grid.cells.stem = 2: must be an array of values"),
        ("", "[grid]\ncells.stem = [1, 1]", "the same value is given twice"),
        ("", "[grid]\ncells.steem = [1]", "cells.steem=1: cells.steem = 1: unknown key; .*stem"),
        ("", "[grid]\ncells.generations = [-1]", "cells.generations = -1: must be"),
        ("", "[grid]\ncells.stem = [50]", "cells.stem = 50 .*: do not fit"),
        ("", "[grid]\nseed = [1]", "seed: cannot be varied"),
        ("", "[conditions.a]\nend_time = 1\n[grid]\nend_time = [2]", "end_time: is varied twice"),
        ("conditions = 1", "", "conditions = 1: must be a table"),
        ("", "[sample]\nmethod = 'latn'", "sample.method = 'latn': .*; did you mean latin"),
        ("", "[sample]\nmethod = 'sobol'\nn = 6", "sample.n = 6: must be a power of 2"),
        ("", "[sample]\nmethod = 'latin'\nn = 0", "sample.n = 0: must be a whole number"),
        ("", "[sample]\nmethod = 'latin'\nn = 6", "sample.ranges = None: must be a table"),
        ("", "[sample]\nmethod = 'latin'\nn = 6\n[sample.ranges]\nend_time = [2, 1]",
         r"sample.ranges.end_time = \[2, 1\]: must be two numbers"),
        ("", "[sample]\nmethod = 'latin'\nn = 6\n[sample.ranges]\ncells.stem = [1.2, 1.4]",
         r"sample.ranges.cells.stem = \[1.2, 1.4\]: .*; all in it are rounded to 1"),
        ("", "[sample]\nmethod = 'latin'\nn = 6\n[sample.ranges]\nend_time = [2, 2.00000001]",
         r"end_time = .*: must hold more than one value; all in it are rounded to 2.0"),
        ("", f"[sample]\nmethod = 'latin'\nn = 6\n[sample.ranges]\nend_time = [1, {10**400}]",
         r"sample.ranges.end_time = .*: must be two numbers"),
        ("", "[sample]\nmethod = 'latin'\nn = 6\n[sample.ranges]\nend_time = [-1e308, 1e308]",
         r"sample.ranges.end_time = .*: must be two numbers"),
        ("", "[quick]\nseed = 1", "quick.seed = 1: unknown key; .*; did you mean seeds"),
    ],
)  # fmt: skip
def test_bad_studies(study: Callable[..., Study], begin: str, end: str, words: str) -> None:
    with pytest.raises(SceneError, match=f"study .*tiny.toml: .*{words}"):
        study(begin, end)


@pytest.mark.parametrize("seeds", ["0", "a", "3-1"])
def test_bad_seeds(tmp_path: Path, seeds: str) -> None:
    (tmp_path / "one.toml").write_text(f'scene = "two-cells"\nseeds = "{seeds}"\n')
    with pytest.raises(SceneError, match=f"one.toml: seeds = {seeds}: "):
        Design.load(tmp_path / "one.toml")


@pytest.mark.parametrize(
    ("content", "words"),
    [("", "scene = None: must be the name"), ("scene = 'x'", "scene 'x': neither"),
     ("scene", "not TOML"), ("scene = 'no.toml'", "no.toml: No such file")],
)  # fmt: skip
def test_bad_files_of_studies(
    skin: Callable[..., Answer], tmp_path: Path, content: str, words: str
) -> None:
    (tmp_path / "one.toml").write_text(content)
    answer = skin("study", "one.toml")
    assert answer.code == 2 and answer.err.startswith("error: study one.toml: ")
    assert words in answer.err and answer.err.count("\n") == 1
    assert not (tmp_path / "studies").exists()


def test_seeds_of_the_scene_itself(study: Callable[..., Study]) -> None:
    found = study(end="[set]\ncells.seed = 3")
    with pytest.raises(SceneError, match=r"study tiny: tiny: cells.seed = 3: must not be given"):
        len(found.runs)


def test_the_base_scene_is_that_of_the_runs(study: Callable[..., Study]) -> None:
    found = study(end="[grid]\ncells.generations = [3, 10]")
    assert isinstance(found.design.scene, Scene)
    assert [run.seed for run in found.runs] == [1, 2, 1, 2]
    assert len({run.directory for run in found.runs}) == 4
    # points of the same scene have the same runs
    same = study(end="[conditions.a]\n[conditions.b]")
    assert len(same.runs) == 2 and len(same.points) == 2


def test_an_ensemble_names_runs_alike(tmp_path: Path) -> None:
    """Of the same scene, whether its keys are given in a study or as options."""
    (tmp_path / "one.toml").write_text(
        'scene = "two-cells"\nseeds = 3\n[grid]\nparameters = ["weak5"]\n[set]\nend_time = 20.0'
    )
    (run,) = Study(Design.load(tmp_path / "one.toml"), tmp_path).runs
    scene = scene_from("two-cells", "weak5", ["end_time=20.0"])
    (member,) = members([scene], [3], tmp_path)
    assert run.directory == member.directory and run.table.parent == member.directory


def test_built_in_studies(
    skin: Callable[..., Answer], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each loads in full and quick, and can be copied and changed."""
    monkeypatch.chdir(tmp_path)
    assert "adhesion" in built_in()
    for name in built_in():
        full, quick = Design.load(Path(name)), Design.load(Path(name), quick=True)
        assert {point.label for point in quick.points} <= {point.label for point in full.points}
        assert full.scene.box_sides > quick.scene.box_sides
        assert full.scene.end_time > quick.scene.end_time and len(full.seeds) >= len(quick.seeds)
        assert skin("study", "write", name).code == 0
        assert Design.load(tmp_path / f"{name}.toml").points == full.points
        assert f"file {name}.toml: exists" in skin("study", "write", name).err
    assert "study 'stats': neither a subcommand nor a study; did you mean" in skin(
        "study", "stats", "a.toml"
    ).err
    assert "did you mean adhesion?" in skin("study", "adheson").err
    (tmp_path / "slow.toml").write_text('scene = "two-cells"')
    assert "--quick: the study has no table `quick`" in skin("study", "slow.toml", "--quick").err
