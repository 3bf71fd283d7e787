"""What to simulate: a validated description, from a TOML file or a built-in name."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, PrivateAttr, ValidationError, model_validator

from lammps_skin.errors import SceneError
from lammps_skin.kinds import Kind
from lammps_skin.model import interventions as changing
from lammps_skin.model import parameters
from lammps_skin.model.cell_kinds import CellKind, cell_kinds, contradictions, reached
from lammps_skin.model.interventions import Intervention
from lammps_skin.model.level import of_level
from lammps_skin.model.parts import (
    USUAL_END,
    Cells,
    Dermis,
    Membrane,
    Numerics,
    Output,
    Part,
    Positive,
    Seed,
    Start,
)
from lammps_skin.model.scene_keys import (
    as_tuples,
    entry,
    first_line,
    merged,
    near,
    no_entry,
    shown,
    value_of,
    with_absolute_paths,
)

LARGEST_FILE = 1_000_000  # bytes of a scene file


class Scene(Part):
    """A validated scene.

    Load one with `Scene.load`, vary it with `replace`. A named parameter set (`parameters`)
    gives values to the keys that are not given themselves.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$")] = "scene"
    description: str = ""
    parameters: Literal[
        "printed", "papilla", "weak5", "direct5", "earlier", "earlier-stiff", "earlier-full"
    ] = parameters.DEFAULT
    force_scale: Literal["printed", "direct"] = "printed"
    seed: Seed = 1
    box: tuple[Positive, Positive] | None = Field(
        None, description="L_x, L_y, checked against the lattice from which the box is derived"
    )
    box_height: Annotated[Positive, Field(le=10_000)] = Field(100.0, description="L_z")
    end_time: Positive = USUAL_END
    dermis: Dermis = Dermis()
    membrane: Membrane = Membrane()
    cells: Cells = Cells()
    numerics: Numerics = Numerics()
    output: Output = Output()
    start: Start = Start()
    interventions: tuple[Intervention, ...] = Field((), description="done in the course of a run")

    smallest_lattice: ClassVar[tuple[int, int]] = (12, 14)
    _given: dict[str, Any] = PrivateAttr(default_factory=dict)

    # ---- making scenes

    @classmethod
    def from_dict(cls, given: Mapping[str, Any], folder: Path | None = None) -> Self:
        """Scene from nested keys; raises `SceneError` naming the key, the value and the remedy.

        Paths in it are relative to a folder, the current one if none is given.
        """
        raw = changing.with_nested_changes(with_absolute_paths(given, folder or Path()))
        name = raw.get("parameters", parameters.DEFAULT)
        if not isinstance(name, str) or name not in parameters.SETS:
            raise SceneError(
                f"parameters = {shown(name)}: must be one of {', '.join(parameters.SETS)}"
                f"{near(name, parameters.SETS)}"
            )
        defaults = merged(parameters.SETS[name], {"numerics": of_level(raw)})
        keys = as_tuples(merged(defaults, raw))
        try:
            scene = cls.model_validate(keys)
        except ValidationError as error:
            raise SceneError(first_line(cls, error, keys)) from None
        scene._given = {**raw, "parameters": name}
        return scene

    @classmethod
    def load(cls, source: str | Path) -> Self:
        """Scene from a TOML file or the name of a built-in scene."""
        from lammps_skin.model.scenes import BUILT_IN

        path = Path(source)
        if isinstance(source, str) and source in BUILT_IN:
            return cls.from_dict({"name": source, **BUILT_IN[source]})
        if path.suffix != ".toml":
            raise SceneError(
                f"scene {str(source)!r}: neither a .toml file nor one of {', '.join(BUILT_IN)}"
                f"{near(source, BUILT_IN)}"
            )
        try:
            return cls.from_dict(tomllib.loads(_text(path)), path.parent)
        except (OSError, UnicodeDecodeError) as error:
            reason = getattr(error, "strerror", None) or "not text in UTF-8"
            raise SceneError(f"scene file {path}: {reason}") from None
        except tomllib.TOMLDecodeError as error:
            raise SceneError(f"scene file {path}: not TOML: {error}") from None
        except RecursionError:
            raise SceneError(f"scene file {path}: not TOML: nested too deeply") from None
        except ValueError as error:
            raise SceneError(f"scene file {path}: {error}") from None
        except SceneError as error:
            raise SceneError(f"scene file {path}: {error}") from None

    def replace(self, **changes: Any) -> Self:
        """A scene with some keys changed: ``scene.replace(**{"cells.seed": 3})``."""
        given = self.given()
        for key, value in changes.items():
            *parts, last = key.split(".")
            if parts[:1] == ["interventions"]:
                given.setdefault("interventions", [])
            place: Any = given
            named = given.get("interventions")  # the only array whose tables have names
            for part in parts:
                above, place = place, entry(place, part)
                if not isinstance(place, dict) and (place is None or place is not named):
                    why = no_entry(above, part) or f"{part} has no keys"
                    raise SceneError(f"{key} = {shown(value)}: {why}")
            if isinstance(place, list):
                raise SceneError(f"{key} = {shown(value)}: is no key; one is {key}.at")
            place[last] = merged({}, value) if isinstance(value, Mapping) else value
        return type(self).from_dict(given)

    def given(self) -> dict[str, Any]:
        """What was given, as nested keys: enough to make this scene again."""
        given = merged({}, self._given)
        if "interventions" in given:
            given["interventions"] = [merged({}, entry) for entry in given["interventions"]]
        return given

    # ---- derived quantities

    @property
    def spacing(self) -> float:
        """Rest spacing of the membrane, 2 R_m d2."""
        return 2 * self.membrane.radius * self.membrane.spacing_ratio

    @property
    def box_sides(self) -> tuple[float, float, float]:
        """L_x, L_y of the lattice, and L_z."""
        nx, ny = self.membrane.lattice
        return nx * self.spacing, ny * self.spacing * math.sqrt(3) / 2, self.box_height

    @property
    def membrane_height(self) -> float:
        """z of the flat membrane."""
        height = self.membrane.height
        return 16 * self.cells.radius if height is None else height

    @property
    def contact(self) -> float:
        """Contact length of cells and membrane, R_c + R_m."""
        return self.cells.radius + self.membrane.radius

    @property
    def rounding(self) -> float:
        """To what positions are rounded, so that ranks and threads do not change the lineage."""
        given = self.numerics.rounding
        return given if given is not None else 1e-5 if self.divides else 0.0

    @property
    def has_cells(self) -> bool:
        """Whether there are cells, from the start or later."""
        return self.cell_count > 0 or any(one.add for one in self.interventions)

    @property
    def divides(self) -> bool:
        """Whether there are cells that divide."""
        return any(kind.daughter for kind in self.cell_kinds)

    @property
    def cell_count(self) -> int:
        """Number of cells at the start."""
        return sum(kind.count for kind in self.cell_table.values())

    @property
    def cell_seed(self) -> int:
        return self.cells.seed or self.seed

    @property
    def dermis_seed(self) -> int:
        return self.dermis.seed or self.seed

    @cached_property
    def cell_table(self) -> dict[str, CellKind]:
        """All kinds of cells by their labels, in the order of their numbers."""
        return cell_kinds(self.cells)

    @cached_property
    def cell_kinds(self) -> tuple[CellKind, ...]:
        """The kinds of cells that can occur, in the order of their numbers."""
        made = [one.enters for one in self.interventions if one.enters]
        found = {kind.label for stage in self.stages for kind in reached(stage.cell_table, made)}
        return tuple(kind for label, kind in self.cell_table.items() if label in found)

    @property
    def stages(self) -> tuple[Self, ...]:
        """This scene, and what it is after each of the interventions that set keys."""
        return self, *self.later_stages

    @cached_property
    def later_stages(self) -> tuple[Self, ...]:
        """What the scene is after each of the interventions that set keys."""
        stages = [self]
        for one in self.interventions:
            if one.set:
                stages.append(stages[-1]._with(one.set))
        return tuple(stages[1:])

    def _with(self, changes: Mapping[str, Any]) -> Self:
        """This scene with other values of some keys, all else being as it is."""
        keys = merged(self.model_dump(), changing.nested(changes))
        keys["interventions"] = tuple(one for one in self.interventions if not one.set)
        return type(self).model_validate(as_tuples(keys))

    @property
    def kinds_of_cells(self) -> tuple[Kind, ...]:
        """The kinds of cells that reports name, whether they can occur or not."""
        return tuple(row.kind for row in self.cell_table.values())

    @property
    def all_kinds(self) -> tuple[Kind, ...]:
        """The kinds of particles that reports name, in the order of their numbers from 1."""
        return (Kind.DERMAL, Kind.MEMBRANE, *self.kinds_of_cells)

    def kind(self, number: int) -> Kind:
        """The kind of a number."""
        return self.all_kinds[number - 1]

    @property
    def begins(self) -> float:
        """Time at which a run of it begins, as far as the scene says so."""
        return self.start.time or 0.0

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The kinds of particles of this scene, in the order of their LAMMPS types."""
        dermis = [Kind.DERMAL] if self.dermis.present else []
        return (*dermis, Kind.MEMBRANE, *(row.kind for row in self.cell_kinds))

    @property
    def longest_range(self) -> float:
        """The longest of the ranges of cells, in contact lengths."""
        return max(row.range for row in self.cell_kinds)

    @property
    def shortest_cycle(self) -> float:
        """Mean duration of the fastest cell cycle that the scene states at its start."""
        return min(kind.cycle for kind in self.cell_table.values())

    # ---- what the single keys cannot know

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        for problem in self._contradictions():
            raise ValueError(problem)
        return self

    def _contradictions(self) -> Iterator[str]:
        nx, ny = self.membrane.lattice
        least = self.smallest_lattice
        if ny % 2:
            yield f"membrane.lattice = [{nx}, {ny}]: the number of rows must be even"
        if nx < least[0] or ny < least[1]:
            yield f"membrane.lattice = [{nx}, {ny}]: must be at least [{least[0]}, {least[1]}]"
        if nx * ny > 50_000_000:
            yield f"membrane.lattice = [{nx}, {ny}]: more than 50,000,000 particles"
        lx, ly, lz = self.box_sides
        if self.box and max(abs(self.box[0] - lx), abs(self.box[1] - ly)) > 1e-3:
            yield (
                f"box = [{self.box[0]:g}, {self.box[1]:g}]: the lattice [{nx}, {ny}] at spacing "
                f"{self.spacing:g} gives [{lx:.6g}, {ly:.6g}]; leave box out or change the lattice"
            )
        if self.membrane_height + 4 * self.contact > lz:
            yield (
                f"box_height = {lz:g}: must be at least {self.membrane_height + 4 * self.contact:g}"
                f", the membrane's height {self.membrane_height:g} and room for cells"
            )
        if self.dermis.present and self.membrane_height < 4 * self.dermis.radius:
            yield (
                f"membrane.height = {self.membrane_height:g}: must be at least 4 R_d = "
                f"{4 * self.dermis.radius:g} to hold a dermis"
            )
        yield from contradictions(self.cells)
        yield from self._cell_contradictions()
        yield from self._numerical_contradictions()
        yield from self._start_contradictions()
        limits = changing.Limits(self.box_sides, 2 * self.cells.radius, self.numerics.timestep)
        yield from changing.contradictions(self.interventions, self.cell_table, limits)
        yield from self._stage_contradictions()

    def _stage_contradictions(self) -> Iterator[str]:
        """What is wrong with the scene after its interventions."""
        former = self
        for one in self.interventions:
            place = changing.place(one)
            if one.set:
                try:
                    stage = former._with(one.set)
                except ValidationError as error:
                    yield f"{place}.set: {first_line(type(self), error)}"
                    return
                for key in changing.KEPT_APART:
                    was, is_now = (value_of(scene, key) for scene in (former, stage))
                    if bool(was) != bool(is_now):
                        yield (
                            f"{place}.set.{key} = {is_now:g}: must be "
                            f"{'greater than 0' if was else 0}, since this force keeps particles "
                            f"apart, and neither ends nor begins in a run"
                        )
                former = stage
        present = [kind.label for kind in self.cell_kinds]
        for one in self.interventions:
            for key in ("remove", "convert"):
                for label in getattr(one, key) or ():
                    if label not in (*present, changing.ALL):
                        yield (
                            f"{changing.place(one)}.{key} = {shown(label)}: there can be no cells "
                            f"of this kind; there can be {', '.join(present) or 'none'}"
                        )

    def _start_contradictions(self) -> Iterator[str]:
        start = self.start
        for key in ("time", "content", "versions"):
            value = getattr(start, key)
            if start.run is None and value is not None:
                yield f"start.{key} = {shown(value)}: needs start.from, the run that it is of"
        if start.run is not None and self.membrane.heights is not None:
            yield (
                f"membrane.heights = {shown(self.membrane.heights)}: cannot be given with "
                "start.from, a run with a membrane of its own"
            )
        if self.end_time <= self.begins:
            yield f"end_time = {self.end_time:g}: must be after start.time = {self.begins:g}"

    def _cell_contradictions(self) -> Iterator[str]:
        cells, membrane = self.cells, self.membrane
        mesh = 2 * membrane.radius * (1 + membrane.spacing_ratio) / math.sqrt(3)
        if self.has_cells and self.contact <= mesh:
            yield (
                f"cells.radius = {cells.radius:g}: must be above {mesh - membrane.radius:.4g}, or "
                f"cells pass through the mesh (R_c + R_m must exceed {mesh:.4g}, the circumradius "
                "of a triangle of links at their singular length)"
            )
        start = 2 * cells.division_separation * cells.radius
        if start >= cells.radius:
            yield f"cells.division_separation = {cells.division_separation:g}: must be below 0.5"
        with_nd = cells.arrangement in ("core", "alternating", "halves")
        others = self.cell_count - cells.nd
        if with_nd and not (others and cells.nd):
            yield (
                f"cells.arrangement = '{cells.arrangement}': needs both stem and ND cells, got "
                f"stem = {others} and nd = {cells.nd}"
            )
        if cells.arrangement == "alternating" and others != cells.nd:
            yield (
                f"cells.nd = {cells.nd}: must equal cells.stem = {others} in the alternating "
                "arrangement"
            )

    def _numerical_contradictions(self) -> Iterator[str]:
        numerics, output = self.numerics, self.output
        if numerics.event_interval > self.shortest_cycle:
            yield (
                f"numerics.event_interval = {numerics.event_interval:g}: must be shorter than a "
                f"cell cycle, {self.shortest_cycle:g}"
            )
        if numerics.rounding and numerics.rounding < 1e-12:
            yield f"numerics.rounding = {numerics.rounding:g}: must be 0 or at least 1e-12"
        intervals = {
            "output.thermo_interval": (output.thermo_interval, 2**31 - 1),
            "output.dump_interval": (output.dump_interval, 2**31 - 1),
            "output.checkpoint_interval": (output.checkpoint_interval, 2**31 - 1),
            "end_time": (self.end_time, 10**12),
        }
        for key, (value, most) in intervals.items():
            if 0 < value < numerics.timestep:
                yield f"{key} = {value:g}: must be at least the timestep, {numerics.timestep:g}"
            if value / numerics.timestep > most:
                yield f"{key} = {value:g}: more than {most:.3g} steps of {numerics.timestep:g}"


def _text(path: Path) -> str:
    """Text of a scene file; not of a device or a pipe, which may never end."""
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise SceneError("is no file")
    if path.is_file() and path.stat().st_size > LARGEST_FILE:
        raise SceneError(f"has more than {LARGEST_FILE} bytes")
    return path.read_text("utf-8-sig")  # with or without a byte order mark
