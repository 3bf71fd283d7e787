"""A membrane at given heights: where its particles, the dermis under it and cells on it are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.errors import SceneError
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration
from lammps_skin.start.packing import dermal_count, surface
from lammps_skin.start.sheet import membrane_at_start, read_heights
from matplotlib.image import imsave
from PIL import Image
from scipy.spatial import cKDTree

from tests.pages import fences

HEIGHT, R_C, R_M, R_D, CONTACT = 12.0, 1.4, 1.0, 1.4, 2.4


def scene_with(**changes: Any) -> Scene:
    """A membrane of 12 x 12.1 without a dermis."""
    given = {"membrane": {"lattice": [24, 28], "height": HEIGHT}, "dermis": {"present": False}}
    return Scene.from_dict(given).replace(**changes)


def waves(rows: int, columns: int) -> np.ndarray:
    """Two waves along x and one along y, at the nodes of an array over the box."""
    y, x = np.mgrid[0:rows, 0:columns] / [[[rows]], [[columns]]]
    return wave(x, y)


def wave(x: Any, y: Any) -> Any:
    """The same at places in units of the box."""
    return 0.4 * np.sin(4 * np.pi * x) + 0.3 * np.cos(2 * np.pi * y)


# ---- the membrane


def test_heights_are_interpolated_periodically() -> None:
    scene = scene_with()
    for shape in ((40, 48), (41, 30), (300, 17)):
        sheet = membrane_at_start(scene, waves(*shape))
        x, y = sheet[:, :2].T / np.array(scene.box_sides[:2])[:, None]
        np.testing.assert_allclose(sheet[:, 2], HEIGHT + wave(x, y), atol=3e-3, err_msg=str(shape))
    np.testing.assert_array_equal(
        membrane_at_start(scene, np.full((1, 1), 2.5))[:, 2], np.full(24 * 28, HEIGHT + 2.5)
    )


def test_a_file_says_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An array, and images of 8 and 16 bits and in colours, whose top is the largest y."""
    heights = waves(64, 48)
    low, high = heights.min(), heights.max()
    np.save(tmp_path / "array.npy", heights)
    shades = (heights - low) / (high - low)
    eight = Image.fromarray(np.round(shades[::-1] * 255).astype(np.uint8))
    eight.save(tmp_path / "eight.png")
    eight.convert("RGBA").save(tmp_path / "colours.png")
    sixteen = Image.fromarray(np.round(shades[::-1] * 65535).astype(np.uint16))
    sixteen.save(tmp_path / "sixteen.png")
    monkeypatch.chdir(tmp_path)
    expected = membrane_at_start(scene_with(), heights)
    roundings = {"array.npy": 0, "eight.png": 1 / 255, "colours.png": 1 / 255, "sixteen.png": 2e-5}
    for name, rounding in roundings.items():
        keys = {"membrane.heights": name}
        if name != "array.npy":
            keys |= {"membrane.heights_scale": high - low, "membrane.height": HEIGHT + low}
        found = membrane_at_start(scene_with(**keys))
        np.testing.assert_allclose(found, expected, atol=(high - low) * rounding, err_msg=name)


def files(folder: Path) -> dict[str, Path]:
    """Files that hold no heights."""
    made = {name: folder / name for name in ("text.npy", "cut.npy", "cut.png", "red.png", "o.npy")}
    made["text.npy"].write_text("1 2 3\n4 5 6\n")
    np.save(made["cut.npy"], waves(20, 20))
    imsave(made["cut.png"], waves(20, 20), cmap="gray")
    for name in ("cut.npy", "cut.png"):
        made[name].write_bytes(made[name].read_bytes()[:-200])
    imsave(made["red.png"], waves(20, 20), cmap="viridis")
    np.save(made["o.npy"], np.array([[{}]]), allow_pickle=True)
    return {**made, "missing.npy": folder / "missing.npy", "folder": folder}


BAD_FILES = {
    "text.npy": "is neither a numpy array",
    "cut.npy": "is neither a numpy array",
    "cut.png": "is damaged",
    "red.png": "is in colour, must be in grey",
    "o.npy": "is neither a numpy array",
    "missing.npy": "there is no such file",
    "folder": "there is no such file",
}


def test_files_that_hold_no_heights(tmp_path: Path) -> None:
    made = files(tmp_path)
    assert set(made) == set(BAD_FILES)
    for name, refusal in BAD_FILES.items():
        with pytest.raises(SceneError, match=f"membrane.heights = .*: {refusal}") as error:
            read_heights(made[name])
        assert "\n" not in str(error.value)


def step(height: float) -> np.ndarray:
    heights = np.zeros((28, 24))
    heights[10:18, 8:16] = height
    return heights


def ridge() -> np.ndarray:
    heights = np.zeros((28, 24))
    heights[14] = 0.6
    return heights


BAD_HEIGHTS: dict[str, tuple[Any, dict[str, Any], str]] = {
    "a row": (np.zeros(4), {}, r"heights: has shape \(4,\), must be \(rows, columns\)"),
    "a volume": (np.zeros((4, 4, 4)), {}, r"has shape \(4, 4, 4\), must be"),
    "nothing": (np.zeros((0, 4)), {}, r"has shape \(0, 4\), must be"),
    "words": ([["a", "b"]], {}, "heights: must be an array of numbers"),
    "ragged": ([[1.0, 2.0], [3.0]], {}, "heights: must be an array of numbers"),
    "NaN": (np.array([[0.0, np.nan]]), {}, "entry 0, 1 is nan, must be finite"),
    "wall": (np.full((2, 2), -11.5), {}, "come down to 0.5, must stay above 1, R_m; raise"),
    "no dermis": (
        np.full((2, 2), -9.0), {"dermis.present": True},
        r"come down to 3, must stay above 3.8, R_m \+ 2 R_d",
    ),
    "top": (np.full((2, 2), 80.0), {}, "come up to 92, must stay below 90.4, which leaves room"),
    "steep": (step(6.0), {}, r"a link at x, y = .* would be .* long, must be below 2.5"),
    "folded": (ridge(), {}, "would fold by more than a right angle at x, y = "),
}  # fmt: skip


@pytest.mark.parametrize(("heights", "changes", "refusal"), BAD_HEIGHTS.values(), ids=BAD_HEIGHTS)
def test_heights_that_cannot_be(heights: Any, changes: dict[str, Any], refusal: str) -> None:
    with pytest.raises(SceneError, match=refusal) as error:
        Configuration.from_scene(scene_with(**changes), heights)
    assert "\n" not in str(error.value)


def test_heights_and_the_state_of_a_run_exclude_each_other() -> None:
    with pytest.raises(SceneError, match=r"membrane\.heights = .*: cannot be given with start"):
        scene_with(**{"membrane.heights": "a.npy", "start.from": "b"})
    with pytest.raises(SceneError, match=r"heights: are those of the run in start\.from"):
        Configuration.from_scene(scene_with(**{"start.from": "b"}), waves(8, 8))


# ---- a papilla


@pytest.fixture(scope="module")
def papilla() -> tuple[Scene, Configuration]:
    """A papilla 6 high on a membrane of 16 x 16, with a dermis, and cells on and around it."""
    given = {"membrane": {"lattice": [32, 36], "height": HEIGHT}, "cells": {"stem": 7}}
    scene = Scene.from_dict(given).replace(**{"cells.arrangement": "cluster", "end_time": 4.0})
    y, x = np.mgrid[0:64, 0:64] / 64 - 0.5
    heights = 6.0 * np.exp(-((16 * x) ** 2 + (15.6 * y) ** 2) / (2 * 2.5**2))
    return scene, Configuration.from_scene(scene, heights)


def test_cells_stand_on_the_membrane(papilla: tuple[Scene, Configuration]) -> None:
    """The nearest particle of the membrane is at the contact length, whatever its slope."""
    _, start = papilla
    _, distances = start.nearest_membrane()
    np.testing.assert_allclose(distances[start.is_cell], CONTACT, rtol=1e-12)
    heights = start.positions[start.is_cell, 2]
    assert np.ptp(heights) > 0.5
    sheet = start.positions[start.kinds == Kind.MEMBRANE]
    over = cKDTree(sheet[:, :2]).query(start.positions[start.is_cell, :2])[1]
    assert (heights > sheet[over, 2] + 1.0).all()


def test_the_dermis_fills_the_papilla(papilla: tuple[Scene, Configuration]) -> None:
    """As densely as below it, and no sphere is on the other side of the membrane."""
    scene, start = papilla
    sides = np.array([*scene.box_sides[:2], 400.0])
    sheet, spheres = (start.wrapped()[start.kinds == kind] for kind in (Kind.MEMBRANE, Kind.DERMAL))
    seen_from_above = cKDTree(sheet[:, :2], boxsize=sides[:2])
    assert (spheres[:, 2] < sheet[seen_from_above.query(spheres[:, :2])[1], 2] - R_M).all()
    _, distances = start.nearest_membrane()
    assert 2.1 < distances[start.kinds == Kind.DERMAL].min() < CONTACT
    # places at least R_m below the membrane
    points = np.random.default_rng(5).random((200_000, 3)) * [*sides[:2], HEIGHT + 6.0]
    points = points[points[:, 2] < sheet[seen_from_above.query(points[:, :2])[1], 2]]
    points = points[cKDTree(sheet, boxsize=sides).query(points)[0] > R_M]
    away = cKDTree(spheres, boxsize=sides).query(points)[0]
    inside = points[:, 2] > HEIGHT
    assert inside.sum() > 2000
    for part in (inside, ~inside):
        assert (away[part] < R_D).mean() == pytest.approx(0.62, abs=0.06)
    assert away.max() < 2.2 * R_D


def test_the_number_of_spheres(papilla: tuple[Scene, Configuration]) -> None:
    """That of the volume under the membrane, less a layer of R_m along its true surface."""
    scene, start = papilla
    sheet = start.positions[start.kinds == Kind.MEMBRANE]
    lx, ly, _ = scene.box_sides
    added = 6.0 * 2 * np.pi * 2.5**2  # volume of the papilla
    area = surface(scene, sheet)
    assert 1.1 < area / (lx * ly) < 1.4
    volume = lx * ly * HEIGHT + added - R_M * area
    expected = 0.64 * volume / (4 / 3 * np.pi * R_D**3)
    assert dermal_count(scene, sheet) == pytest.approx(expected, rel=0.01)
    assert (start.kinds == Kind.DERMAL).sum() == dermal_count(scene, sheet)
    flat = membrane_at_start(scene)
    assert surface(scene, flat) == pytest.approx(lx * ly) and np.ptp(flat[:, 2]) == 0


def test_the_papilla_stays(papilla: tuple[Scene, Configuration]) -> None:
    """It is relaxed well enough to begin with, and stands after some time."""
    scene, start = papilla
    with Simulation.begin(scene, configuration=start) as simulation:
        before = simulation.forces()
        simulation.run()
        after = simulation.forces()
    of_spheres = before.types == Kind.DERMAL
    assert np.abs(before.forces[of_spheres]).max() < 1.01 * 0.02
    top = after.positions[after.types == Kind.MEMBRANE, 2].max()
    assert HEIGHT + 4.5 < top < HEIGHT + 6.5


def test_the_recipe_of_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The arrays of both ways are the same; the scene of the page begins with them."""
    monkeypatch.chdir(tmp_path)
    blocks = [block for block in fences("start.md", "python") if "heights" in block]
    recipe, direct = blocks
    toml = next(block for block in fences("start.md", "toml") if "heights" in block)
    Path("papilla.toml").write_text(toml)
    names: dict[str, Any] = {}
    exec(recipe, names)
    one = Configuration.from_scene(Scene.load("papilla.toml"))
    exec(direct, names)
    np.testing.assert_array_equal(names["state"].positions, one.positions)
    sheet = one.positions[one.kinds == Kind.MEMBRANE]
    assert np.ptp(sheet[:, 2]) == pytest.approx(8.0, abs=0.1)


def test_noise_that_leaves_the_box_is_named() -> None:
    scene = Scene.load("bare-membrane").replace(
        **{"membrane.lattice": (12, 14), "membrane.noise": 1e6}
    )
    with pytest.raises(SceneError, match=r"membrane.noise = 1e\+06: puts .* z = .*100\)"):
        Configuration.from_scene(scene)
