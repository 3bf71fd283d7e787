"""What to simulate: a validated description, from a TOML file or a built-in name."""

from __future__ import annotations

import math
import sys
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, ValidationError, model_validator

from lammps_skin.errors import SceneError
from lammps_skin.kinds import Kind
from lammps_skin.model import accuracy, parameters
from lammps_skin.model.accuracy import DEFAULT_LEVEL, LEVELS, Level
from lammps_skin.model.keys import as_tuples, first_line, merged, near, shown

LARGEST_FILE = 1_000_000  # bytes of a scene file
LARGEST = 1e12  # of any number, so that products of several stay finite
Positive = Annotated[float, Field(gt=0, le=LARGEST, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, le=LARGEST, allow_inf_nan=False)]
AboveOne = Annotated[float, Field(gt=1, allow_inf_nan=False)]
Fraction = Annotated[float, Field(gt=0, lt=1)]
Seed = Annotated[int, Field(ge=1, le=2**31 - 1)]
Count = Annotated[int, Field(ge=0, le=10_000_000)]


class Part(BaseModel):
    """One part of a scene: frozen, strict about types, no unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Dermis(Part):
    """Soft dermal spheres between the wall and the membrane."""

    present: bool = True
    radius: Positive = Field(1.4, description="R_d")
    stiffness: NotNegative = Field(0.04, description="K of dermis-dermis")
    membrane_stiffness: NotNegative = Field(0.04, description="K of dermis-membrane")
    wall_stiffness: NotNegative = Field(0.04, description="K of dermis-wall")
    attraction_range: AboveOne = Field(1.4, description="Lambda")
    softening: NotNegative = Field(0.125, description="a1")
    softening_onset: Fraction = Field(0.8, description="d1")
    volume_fraction: Annotated[float, Field(gt=0, le=1.5)] = 0.64
    frozen_below: NotNegative = Field(0.0, description="spheres that start lower are held")
    seed: Seed | None = Field(None, description="of the packing; the scene's seed if not given")


class Membrane(Part):
    """Triangular network of membrane particles."""

    lattice: tuple[Count, Count] = Field((100, 114), description="particles along x, rows along y")
    radius: Positive = Field(1.0, description="R_m")
    spacing_ratio: Fraction = Field(0.25, description="d2")
    height: Positive | None = Field(None, description="z at the start; 16 R_c if not given")
    noise: NotNegative = Field(0.0, description="standard deviation of z at the start")
    stretch_stiffness: NotNegative = 0.04
    elasticity: NotNegative = Field(1.25, description="a2")
    bending_stiffness: NotNegative = 0.5
    exclusion_stiffness: NotNegative = 0.04


class Cells(Part):
    """Stem, transit-amplifying (TA) and non-dividing (ND) cells."""

    stem: Count = 0
    nd: Count = 0
    arrangement: Literal["ring", "cluster", "random", "core", "alternating", "halves"] = "ring"
    seed: Seed | None = Field(None, description="of schedules and directions")
    radius: Positive = Field(1.4, description="R_c")
    exclusion_stiffness: NotNegative = Field(0.04, description="K of cell-cell exclusion")
    membrane_exclusion_stiffness: NotNegative = Field(0.04, description="K of cell-membrane")
    cell_adhesion_stiffness: NotNegative = Field(0.03, description="K of cell-cell adhesion")
    adhesion_stiffness: NotNegative = Field(25.0, description="K_ad")
    adhesion_range: AboveOne = Field(1.4, description="lambda, also of the removal threshold")
    binding_stiffness: NotNegative = Field(25.0, description="K of stem and ND cells")
    division_spring: Literal["length", "reduced"] = "reduced"
    division_stiffness: NotNegative = Field(5.0, description="K_div")
    division_rate: Positive = Field(0.14, description="beta_0, growth of the natural length")
    division_separation: Positive = Field(0.005, description="eps, half of it in units of R_c")
    cycle_delay: NotNegative = Field(36.0, description="T0")
    cycle_rate: Positive = Field(0.083, description="gamma")
    first_phase: NotNegative = Field(48.0, description="first elapsed times are uniform in [0, .)")
    generations: Annotated[int, Field(ge=0, le=1000)] = Field(10, description="M")


class Numerics(Part):
    """How it is computed. The level of accuracy gives the keys that are not given themselves."""

    accuracy: Level = DEFAULT_LEVEL
    integrator: Literal["euler", "rkl1", "rkl2"] = Field(
        "euler", description="forward Euler, or Runge-Kutta-Legendre of order 1 or 2"
    )
    stages: Annotated[int, Field(ge=3, le=99)] = Field(
        7, description="force evaluations in a step of rkl1 and rkl2"
    )
    timestep: Positive = 0.01
    largest_move: NotNegative = Field(
        0.05, description="of any particle in one step; longer steps are divided; 0: never"
    )
    stiffness_limit: NotNegative = Field(
        0.0, description="stiffer membrane particles move slower in proportion; 0: none"
    )
    pair_form: Literal["analytic", "table", "skin"] = Field(
        "analytic",
        description="pairs as lj/cut where that is exact, as tables, or in the plugin's styles",
    )
    table_style: Literal["linear", "spline"] = "linear"
    table_points: Annotated[int, Field(ge=100, le=1_000_000)] = 10_000
    event_interval: NotNegative = Field(
        0.2, description="time between steps that handle births and removals; 0: every step"
    )
    neighbor_skin: Positive = 0.3
    rounding: Annotated[float, Field(ge=0, le=1e-3)] | None = Field(
        None, description="of positions; 0: none; 1e-5 if not given and there are stem cells"
    )
    rounding_interval: Positive = Field(2.0, description="time between roundings")

    @property
    def evaluations(self) -> int:
        """Force evaluations in a step that is not divided."""
        return 1 if self.integrator == "euler" else self.stages


class Output(Part):
    """How often what is written, in time units; 0 is never."""

    thermo_interval: Positive = 2.0
    dump_interval: NotNegative = 10.0
    checkpoint_interval: NotNegative = 50.0


class Scene(Part):
    """A validated scene.

    Load one with `Scene.load`, vary it with `replace`. A named parameter set (`parameters`)
    gives values to the keys that are not given themselves.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$")] = "scene"
    description: str = ""
    parameters: Literal[
        "printed", "papilla", "weak5", "direct5", "earlier", "earlier-stiff"
    ] = "papilla"
    force_scale: Literal["printed", "direct"] = "printed"
    seed: Seed = 1
    box: tuple[Positive, Positive] | None = Field(
        None, description="L_x, L_y, checked against the lattice from which the box is derived"
    )
    box_height: Annotated[Positive, Field(le=10_000)] = Field(100.0, description="L_z")
    end_time: Positive = 1000.0
    dermis: Dermis = Dermis()
    membrane: Membrane = Membrane()
    cells: Cells = Cells()
    numerics: Numerics = Numerics()
    output: Output = Output()

    smallest_lattice: ClassVar[tuple[int, int]] = (12, 14)
    _given: dict[str, Any] = PrivateAttr(default_factory=dict)

    # ---- making scenes

    @classmethod
    def from_dict(cls, given: Mapping[str, Any]) -> Self:
        """Scene from nested keys; raises `SceneError` naming the key, the value and the remedy."""
        raw = merged({}, given)
        name = raw.get("parameters", parameters.DEFAULT)
        if not isinstance(name, str) or name not in parameters.SETS:
            raise SceneError(
                f"parameters = {shown(name)}: must be one of {', '.join(parameters.SETS)}"
                f"{near(name, parameters.SETS)}"
            )
        defaults = merged(parameters.SETS[name], {"numerics": _of_level(raw)})
        try:
            scene = cls.model_validate(as_tuples(merged(defaults, raw)))
        except ValidationError as error:
            raise SceneError(first_line(cls, error)) from None
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
            return cls.from_dict(tomllib.loads(_text(path)))
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
        given = merged({}, self._given)
        for key, value in changes.items():
            *parts, last = key.split(".")
            place = given
            for part in parts:
                place = place.setdefault(part, {})
                if not isinstance(place, dict):
                    raise SceneError(f"{key} = {shown(value)}: {part} has no keys")
            place[last] = value
        return type(self).from_dict(given)

    def given(self) -> dict[str, Any]:
        """What was given, as nested keys: enough to make this scene again."""
        return merged({}, self._given)

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
        return given if given is not None else 1e-5 if self.cells.stem else 0.0

    @property
    def has_cells(self) -> bool:
        return self.cells.stem + self.cells.nd > 0

    @property
    def cell_seed(self) -> int:
        return self.cells.seed or self.seed

    @property
    def dermis_seed(self) -> int:
        return self.dermis.seed or self.seed

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The kinds of particles of this scene, in the order of their LAMMPS types."""
        kinds = [Kind.DERMAL] if self.dermis.present else []
        kinds.append(Kind.MEMBRANE)
        if self.cells.stem:
            kinds += [Kind.STEM, Kind.TA, Kind.EXHAUSTED]
        if self.cells.nd:
            kinds.append(Kind.ND)
        return tuple(kinds)

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
        yield from self._cell_contradictions()
        yield from self._numerical_contradictions()

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
        if with_nd and not (cells.stem and cells.nd):
            yield (
                f"cells.arrangement = '{cells.arrangement}': needs both stem and ND cells, got "
                f"stem = {cells.stem} and nd = {cells.nd}"
            )
        if cells.arrangement == "alternating" and cells.stem != cells.nd:
            yield (
                f"cells.nd = {cells.nd}: must equal cells.stem = {cells.stem} in the alternating "
                "arrangement"
            )

    def _numerical_contradictions(self) -> Iterator[str]:
        numerics, output = self.numerics, self.output
        if numerics.event_interval > self.cells.cycle_delay + 1 / self.cells.cycle_rate:
            yield (
                f"numerics.event_interval = {numerics.event_interval:g}: must be shorter than a "
                f"cell cycle, {self.cells.cycle_delay + 1 / self.cells.cycle_rate:g}"
            )
        if 0 < self.rounding < 1e-12:
            yield f"numerics.rounding = {self.rounding:g}: must be 0 or at least 1e-12"
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


def _of_level(given: Mapping[str, Any]) -> dict[str, Any]:
    """Numerics of the level of accuracy, for what can be read of a scene not yet validated."""

    def part(name: str) -> Mapping[str, Any]:
        value = given.get(name)
        return value if isinstance(value, Mapping) else {}

    def time(keys: Mapping[str, Any], key: str, default: float) -> float:
        value = keys.get(key, default)
        usable = isinstance(value, (int, float)) and 0 < value <= sys.float_info.max
        return float(value) if usable else default

    level = part("numerics").get("accuracy", DEFAULT_LEVEL)
    if not isinstance(level, str) or level not in LEVELS:
        return {}
    output, cells = Output(), Cells()
    intervals = [time(part("output"), *item) for item in output.model_dump().items()]
    cycle = sum(
        (
            time(part("cells"), "cycle_delay", cells.cycle_delay),
            1 / time(part("cells"), "cycle_rate", cells.cycle_rate),
        )
    )
    end = time(given, "end_time", Scene.model_fields["end_time"].default)
    return accuracy.numerics(level, part("numerics"), [end, *intervals], cycle)
