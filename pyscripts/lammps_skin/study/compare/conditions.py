"""Conditions that are compared: runs, ensembles and tables of them, as they lie on disk."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from lammps_skin.analysis.derived import fault
from lammps_skin.analysis.observables import Observables, Table, open_run, read_table
from lammps_skin.engine.built import SCENE_FILE
from lammps_skin.errors import SceneError, SkinError
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import value_of
from lammps_skin.run.results import TRAJECTORIES
from lammps_skin.study.claims.tables import flat
from lammps_skin.study.ensemble import by_seed, scene_of, with_seed
from lammps_skin.study.ranges import Window, windows_of
from lammps_skin.study.studies.tables import COURSES, MEANS, read_courses, read_means

TABLES = ".csv.gz"  # how the names of gathered tables end
OF_A_RUN = re.compile(r"-(\d+)-[0-9a-f]+\.csv$")  # how the name of the table of one run ends
UNNAMED = {"name", "description", "seed"}  # keys in which conditions differ without meaning


@dataclass(frozen=True)
class Condition:
    """Runs of one scene with one seed or several.

    Attributes
    ----------
    name : str
    table : Table
        Observables, with a column ``seed``.
    scene : Scene or None
        What was run; None if that is not known.
    path : Path
        Of the run or of the table.
    windows : tuple of Window
        Of the study of which it is a point; none of others.
    """

    name: str
    table: Table
    scene: Scene | None
    path: Path
    windows: tuple[Window, ...] = ()

    @cached_property
    def by_seed(self) -> Mapping[int, Table]:
        """The table of each seed."""
        return by_seed(self.table)

    @property
    def seeds(self) -> int:
        return len(self.by_seed)

    @property
    def end(self) -> float:
        """Time of the last frame that all seeds have."""
        return float(min(table["time"].max() for table in self.by_seed.values()))

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of what was observed."""
        return tuple(name for name in self.table.dtype.names or () if name not in ("seed", "time"))

    def value_of(self, key: str) -> float:
        """Value of a key of the scene; raises `SceneError` if it is no number, or not known."""
        if self.scene is None:
            raise SceneError(f"{key}: the scene of {self.name} ({self.path}) is not known")
        try:
            value = value_of(self.scene, key)
        except AttributeError:
            raise SceneError(f"{key}: is no key of a scene") from None
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise SceneError(f"{key} = {value!r} in {self.name}: must be a number")
        return float(value)

    def check(self, columns: Iterable[str]) -> None:
        """Raise `SkinError` for a column that there is not, nor can be made of those there are."""
        for column in columns:
            if wrong := fault(column, self.columns):
                raise SkinError(f"--columns {column}: {self.name} ({self.path}): {wrong}")


def read(sources: Sequence[str]) -> list[Condition]:
    """Conditions from paths, each with a name before it if wanted: ``soft=runs/soft``.

    A path is a run directory or a trajectory, the folder of an ensemble, of which each table is a
    condition, or such a table, or the folder of a study, of which each point is one. Conditions of
    one name get that of their folder before it.

    Raises
    ------
    SkinError
        For what is none of these, for less than two conditions, and for two of the same name.
    """
    found: list[Condition] = []
    for source in sources:
        name, path = _named(source)
        there = list(_read(path))
        for one in there:
            full = f"{name}/{one.name}" if name and len(there) > 1 else name or one.name
            found.append(replace(one, name=full))
    if len(found) < 2:
        raise SkinError(f"{', '.join(sources)}: is one condition; give at least two to compare")
    return _told_apart(found)


def _told_apart(conditions: list[Condition]) -> list[Condition]:
    """Those of one name have that of their folder before it, if that helps."""
    names = [one.name for one in conditions]
    for n, one in enumerate(conditions):
        if names.count(one.name) > 1:
            full = f"{one.path.resolve().parent.name}/{one.name}"
            conditions[n] = replace(one, name=full)
    names = [one.name for one in conditions]
    for one in conditions:
        if names.count(one.name) > 1:
            raise SkinError(
                f"condition {one.name}: there are two of this name; give names, such as "
                f"first={one.path}"
            )
    return conditions


def _named(source: str) -> tuple[str, Path]:
    """The name that is given, or nothing, and the path."""
    name, equals, rest = source.partition("=")
    if not equals or not name or "/" in name or Path(source).exists():
        return "", Path(source)
    return name, Path(rest)


def _read(path: Path) -> Iterator[Condition]:
    """Conditions at a path, by their own names."""
    if path.name.endswith((".csv", TABLES)) and path.is_file():
        yield _gathered(path)
    elif path.is_file() or any((path / name).exists() for name in TRAJECTORIES):
        with open_run(path) as run:
            table: Table = Observables(run.universe, run.events).run().results.table
            yield Condition(path.resolve().name, with_seed(table, run.seed), run.scene, path)
    elif (path / COURSES).is_file():
        scenes, windows = _points(path)
        for label, table in read_courses(path).items():
            yield Condition(label, table, scenes.get(label), path, windows)
    elif tables := sorted(path.glob(f"*{TABLES}")):
        yield from map(_gathered, tables)
    else:
        raise SkinError(
            f"{path}: is no run directory, no folder of an ensemble or a study that has been run, "
            "and no table of an ensemble"
        )


def _points(folder: Path) -> tuple[dict[str, Scene], tuple[Window, ...]]:
    """Scenes of the points of a study, by label, and its windows; none if they are not there."""
    if not (folder / MEANS).is_file():
        return {}, ()
    means, scenes = read_means(folder), {}
    for label, run in dict(zip(means["point"], means["run"], strict=True)).items():
        with suppress(SceneError):
            scenes[label] = Scene.load(folder / "runs" / run / SCENE_FILE)
    ends = dict.fromkeys(zip(means["start"], means["end"], strict=True))
    return scenes, tuple(Window(float(start), float(end)) for start, end in ends)


def windows_of_all(conditions: Sequence[Condition], given: str | None) -> list[Window]:
    """Windows that are given, else those of the study if all are points of it, else usual ones."""
    (own, *others) = {one.windows for one in conditions}
    if given is None and own and not others:
        return list(own)
    return windows_of(given, min(one.end for one in conditions))


def _gathered(path: Path) -> Condition:
    """A gathered table, or the table of one run, whose seed its name tells."""
    table = read_table(path)
    if "seed" not in (table.dtype.names or ()):
        of_a_run = OF_A_RUN.search(path.name)
        table = with_seed(table, int(of_a_run[1]) if of_a_run else 0)
    if "time" not in (table.dtype.names or ()) or not len(table):
        raise SkinError(f"table {path}: is no table of observables")
    given = scene_of(path) if path.suffix == ".gz" else {}
    try:
        scene = Scene.from_dict(given) if given else None
    except SceneError:  # of another version
        scene = None
    name = path.name.removesuffix(".gz").removesuffix(".csv")
    return Condition(name, table, scene, path)


def differences(conditions: Sequence[Condition]) -> list[str]:
    """In which keys each condition differs from the first, in words; nothing if not known."""
    lines = []
    first, *others = (
        dict(flat(one.scene.model_dump(mode="json", exclude=UNNAMED, exclude_none=True)))
        if one.scene
        else {}
        for one in conditions
    )
    for one, keys in zip(conditions[1:], others, strict=True):
        if first and keys:
            changed = [f"{key} = {keys[key]}" for key in keys if first.get(key) != keys[key]]
            changed += [f"without {key}" for key in first if key not in keys]
            lines += [f"{one.name}: {', '.join(changed)}"] * bool(changed)
    return lines
