"""The directory `lammps_inputs` is what `skin build` writes today."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
from lammps_skin.model.scene import Scene
from lammps_skin.start.build import build

SHIPPED = Path(__file__).resolve().parents[1] / "lammps_inputs"
SUFFIXES = {".in", ".toml", ".data", ".table"}  # of what `skin build` writes


def words_and_numbers(path: Path) -> tuple[list[str], list[float]]:
    """What a file says, its numbers apart."""
    words, numbers = [], []
    for word in path.read_text().split():
        try:
            numbers.append(float(word))
        except ValueError:
            words.append(word)
    return words, numbers


def test_built_directory_is_up_to_date(tmp_path: Path) -> None:
    """From its scene.toml.

    The packing may be another, and the last digits of tables, which differ between processors.
    """
    build(Scene.load(SHIPPED / "scene.toml"), tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {path.name for path in SHIPPED.iterdir() if path.suffix in SUFFIXES}
    tables = {name for name in names if name.endswith(".table")}
    for name in names - tables - {"skin.data"}:
        assert (tmp_path / name).read_text() == (SHIPPED / name).read_text(), name
    for name in tables:
        (words, numbers), (old_words, old_numbers) = (
            words_and_numbers(path / name) for path in (tmp_path, SHIPPED)
        )
        assert words == old_words, name
        np.testing.assert_allclose(numbers, old_numbers, rtol=1e-11, atol=1e-15, err_msg=name)
    sizes = [(path / "skin.data").read_text().splitlines()[:14] for path in (tmp_path, SHIPPED)]
    assert sizes[0] == sizes[1]


def test_data_without_the_state_of_its_cells_are_refused(tmp_path: Path) -> None:
    """By plain LAMMPS too: the cells would begin anew."""
    build(Scene.load("two-cells"), tmp_path)
    data = tmp_path / "skin.data"
    data.write_text(data.read_text().split("\nstate\n")[0])
    lmp = Path(sys.executable).with_name("lmp")
    ended = subprocess.run(
        [lmp, "-in", "skin.in", "-log", "none"], cwd=tmp_path, capture_output=True, text=True
    )
    assert ended.returncode == 1
    assert "skin.data has no section state, which holds the state of its cells" in ended.stdout
    assert not (tmp_path / "events.csv").exists()
