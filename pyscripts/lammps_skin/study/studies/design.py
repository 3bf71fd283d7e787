"""What a study runs: a scene, what is varied of it, and seeds, from a TOML file."""

from __future__ import annotations

import os
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from lammps_skin.errors import SceneError
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import PATHS, merged, near, shown, value_of
from lammps_skin.model.scenes import BUILT_IN
from lammps_skin.start.arrangements import place_cells
from lammps_skin.study.ranges import Window, seeds_of, windows_of
from lammps_skin.study.studies.forks import check_varied, fork_time, windows_after
from lammps_skin.study.studies.samples import Sample

KEYS = ("scene", "seeds", "windows", "fork", "set", "conditions", "grid", "sample")
TEXTS = {"seeds": "1-8", "windows": "400-600,800-1000"}  # keys whose values are text: examples
MOST_POINTS = 100_000
BUILT_IN_STUDIES = Path(__file__).parent / "built_in"
FILES = {".".join(path) for path in PATHS}  # keys of a scene whose values are paths

Keys = dict[str, Any]  # dotted keys of a scene and their values


@dataclass(frozen=True)
class Point:
    """One choice of all that is varied.

    Attributes
    ----------
    label : str
        Of the condition, of the keys of the grid, of the sample.
    condition : str or None
    scene : Scene
        Without a seed of its own.
    values : mapping
        Values of all keys that the study varies, also where they are those of the scene.
    """

    label: str
    condition: str | None
    scene: Scene
    values: Mapping[str, Any]


@dataclass(frozen=True)
class Design:
    """A study as its file says it.

    Attributes
    ----------
    name : str
        Of the file.
    text : str
        All of the file.
    scene : Scene
        Of which keys are varied.
    points : tuple of Point
        In the order of conditions, of the grid, of the sample: the last varies first.
    keys : tuple of str
        That are varied, dotted.
    seeds : tuple of int
        Of each point.
    windows : tuple of Window
        Of time, over which means are taken.
    sample : Sample or None
    fork : float or None
        Time up to which all points of a seed are one run.
    """

    name: str
    text: str
    scene: Scene
    points: tuple[Point, ...]
    keys: tuple[str, ...]
    seeds: tuple[int, ...]
    windows: tuple[Window, ...]
    sample: Sample | None
    fork: float | None

    @classmethod
    def load(cls, path: Path, quick: bool = False) -> Design:
        """Design of a file, or of the built-in study of this name.

        With `quick` what the file gives in its table ``quick`` counts more. Raises `SceneError`
        naming the key, the value and what is allowed.
        """
        path = source_of(path)
        try:
            text = path.read_text("utf-8-sig")
            given = tomllib.loads(text)
        except (OSError, UnicodeDecodeError) as error:
            reason = getattr(error, "strerror", None) or "not text in UTF-8"
            raise SceneError(f"study {path}: {reason}") from None
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise SceneError(f"study {path}: not TOML: {error}") from None
        try:
            faster = _table(given.pop("quick", {}), "quick")
            _check_keys(faster, "quick.")
            if quick and not faster:
                raise SceneError("--quick: the study has no table `quick`")
            given = merged(given, faster) if quick else given
            return _design(path.stem, text, given, path.parent)
        except SceneError as error:
            raise SceneError(f"study {path}: {error}") from None


def built_in() -> dict[str, Path]:
    """Files of the built-in studies, by their names."""
    return {path.stem: path for path in sorted(BUILT_IN_STUDIES.glob("*.toml"))}


def source_of(path: Path) -> Path:
    """The file of a study: of what is none, that of the built-in study of this name."""
    known = built_in()
    if path.suffix == ".toml" or path.is_file():
        return path
    if str(path) not in known:
        raise SceneError(
            f"study {str(path)!r}: neither a .toml file nor one of {', '.join(known)}"
            f"{near(str(path), known)}"
        )
    return known[str(path)]


def _design(name: str, text: str, given: Mapping[str, Any], folder: Path) -> Design:
    _check_keys(given)
    for key, example in TEXTS.items():
        value = given.get(key, example)
        one_seed = key == "seeds" and type(value) is int
        if not one_seed and not (isinstance(value, str) and value.strip()):
            raise SceneError(f'{key} = {shown(value)}: must be text, such as "{example}"')
    scene = _scene(given, folder)
    conditions = {
        label: flat(_table(keys, f"conditions.{label}"), folder)
        for label, keys in _table(given.get("conditions", {}), "conditions").items()
    }
    grid = flat(_table(given.get("grid", {}), "grid"), folder)
    for key, values in grid.items():
        if not isinstance(values, list) or not values:
            raise SceneError(f"grid.{key} = {shown(values)}: must be an array of values")
        if any(value in values[:n] for n, value in enumerate(values)):
            raise SceneError(f"grid.{key} = {shown(values)}: the same value is given twice")
    sample = Sample.of(_table(given["sample"], "sample")) if "sample" in given else None
    in_conditions = dict.fromkeys(key for keys in conditions.values() for key in keys)
    varied = [*in_conditions, *grid, *(sample.ranges if sample else ())]
    for key in varied:
        if key in ("seed", "name"):
            raise SceneError(f"{key}: cannot be varied; `seeds` says with which seeds points run")
        if varied.count(key) > 1:
            raise SceneError(f"{key}: is varied twice, by conditions, grid or sample")
    if "fork" in given:
        check_varied(varied)
    points = tuple(_points(name, scene, conditions, grid, sample, folder, varied))
    label, number = Counter(point.label for point in points).most_common(1)[0]
    if number > 1:
        raise SceneError(f"{label}: {number} points have this name")
    end, text_of_windows = min(point.scene.end_time for point in points), given.get("windows")
    if "fork" in given:
        after = {point.label: point.scene for point in points}
        fork = fork_time(given["fork"], scene, after)
        windows = windows_after(text_of_windows, fork, end)
    else:
        fork, windows = None, windows_of(text_of_windows, end, "windows = ")
    for window, point in product(windows if text_of_windows else (), points):
        interval = point.scene.output.dump_interval
        if interval and not window.holds_frame(interval):
            raise SceneError(
                f"windows = {text_of_windows}: no frame is in {window}, since "
                f"output.dump_interval = {interval:g}, of {point.label}"
            )
    return Design(
        name, text, scene, points, tuple(varied),
        tuple(seeds_of(given.get("seeds", "1-8"), "seeds = ")), tuple(windows), sample, fork,
    )  # fmt: skip


def _check_keys(given: Mapping[str, Any], prefix: str = "") -> None:
    for key, value in given.items():
        if key not in KEYS:
            raise SceneError(
                f"{prefix}{key} = {shown(value)}: unknown key; allowed: {', '.join(KEYS)}"
                f"{near(key, KEYS)}"
            )


def _scene(given: Mapping[str, Any], folder: Path) -> Scene:
    """The scene with what is set for all points."""
    source = given.get("scene")
    if isinstance(source, Mapping):
        scene = Scene.from_dict(source, folder)
    elif isinstance(source, str):
        scene = Scene.load(source if source in BUILT_IN else _source(source, folder))
    else:
        raise SceneError(
            f"scene = {shown(source)}: must be the name of a built-in scene, a .toml file, or a "
            "table of the keys of a scene"
        )
    changes = flat(_table(given.get("set", {}), "set"), folder)
    if "seed" in changes:
        raise SceneError(
            f"set.seed = {shown(changes['seed'])}: `seeds` says with which seeds points run"
        )
    return scene.replace(**changes)


def _source(source: str, folder: Path) -> str | Path:
    """A scene file, relative to the file of the study; what is none is left to the error."""
    return folder / source if source.endswith(".toml") else source


def _points(
    name: str, scene: Scene, conditions: Mapping[str, Keys], grid: Keys,
    sample: Sample | None, folder: Path, varied: list[str],
) -> Iterator[Point]:  # fmt: skip
    """The full product of conditions, grid and sample."""
    choices: list[tuple[str | None, Keys]] = list(conditions.items()) or [(None, {})]
    in_grid = [
        [(f"{key}={_word(value)}", key, _absolute(key, value, folder)) for value in values]
        for key, values in grid.items()
    ]
    drawn = sample.points(scene) if sample else [{}]
    number = len(choices) * len(drawn)
    for values in in_grid:
        number *= len(values)
    if number > MOST_POINTS:
        raise SceneError(f"{number:,} points: must be at most {MOST_POINTS:,}")
    for (condition, keys), cell, (n, own) in product(
        choices, product(*in_grid), enumerate(drawn, 1)
    ):
        words = [condition or "", *(word for word, _, _ in cell), f"sample {n}" if own else ""]
        label = ", ".join(filter(None, words)) or name
        changes = {**keys, **{key: value for _, key, value in cell}, **own}
        try:
            changed = scene.replace(**changes)
            if changed.start.run is None:
                place_cells(changed)
        except SceneError as error:
            raise SceneError(f"{label}: {error}") from None
        yield Point(label, condition, changed, {key: _value(changed, key) for key in varied})


def flat(table: Mapping[str, Any], folder: Path, prefix: str = "") -> Keys:
    """Dotted keys of nested ones; paths are absolute, those that were not relative to a folder."""
    found: Keys = {}
    for key, value in table.items():
        if isinstance(value, Mapping):
            found |= flat(value, folder, f"{prefix}{key}.")
        else:
            found[prefix + key] = _absolute(prefix + key, value, folder)
    return found


def _absolute(key: str, value: Any, folder: Path) -> Any:
    return os.path.abspath(folder / value) if key in FILES and isinstance(value, str) else value


def _table(value: Any, key: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise SceneError(f"{key} = {shown(value)}: must be a table of keys")
    return value


def _word(value: Any) -> str:
    """A value in a label."""
    return f"{value:.15g}" if isinstance(value, float) else str(value)


def _value(scene: Scene, key: str) -> Any:
    """What a scene has at a dotted key: what was given, or what it is else; None without any."""
    parts = key.split(".")
    place: Any = scene.given()
    for part in parts:
        if isinstance(place, (list, tuple)):  # of interventions
            place = next((one for one in place if one.get("name") == part), None)
        else:
            place = place.get(part) if isinstance(place, Mapping) else None
    if place is not None:
        return place
    if parts[:2] == ["cells", "kinds"]:
        return getattr(scene.cell_table.get(parts[2]), parts[-1], None)
    try:
        return value_of(scene, key)
    except AttributeError:
        return None
