"""The parts of a scene, their keys, defaults and limits."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, PlainValidator, WithJsonSchema, create_model
from pydantic_core import PydanticCustomError

from lammps_skin.model.accuracy import DEFAULT_LEVEL, Level

USUAL_END = 1000.0  # time at which a run ends that says nothing of it
LARGEST = 1e12  # of any number, so that products of several stay finite
Positive = Annotated[float, Field(gt=0, le=LARGEST, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, le=LARGEST, allow_inf_nan=False)]
AboveOne = Annotated[float, Field(gt=1, allow_inf_nan=False)]
Fraction = Annotated[float, Field(gt=0, lt=1)]
Seed = Annotated[int, Field(ge=1, le=2**31 - 1)]
Count = Annotated[int, Field(ge=0, le=10_000_000)]


MOST_GENERATIONS = 1000


def _generations(value: Any) -> Any:
    if value == "endless" or (type(value) is int and 0 <= value <= MOST_GENERATIONS):
        return value
    raise PydanticCustomError(
        "generations", f'must be an integer from 0 to {MOST_GENERATIONS}, or "endless"'
    )


def _colour(value: Any) -> Any:
    if isinstance(value, str) and re.fullmatch("#[0-9a-fA-F]{6}", value):
        return value
    raise PydanticCustomError("colour", 'must be "#rrggbb", six hexadecimal digits')


Generations = Annotated[
    int | Literal["endless"],
    PlainValidator(_generations),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "integer", "minimum": 0, "maximum": MOST_GENERATIONS},
                {"enum": ["endless"]},
            ]
        }
    ),
]
HexColour = Annotated[
    str, PlainValidator(_colour), WithJsonSchema({"type": "string", "pattern": "#rrggbb"})
]


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
    packing: Literal["random", "cubic"] = Field("random", description="of the spheres at the start")
    volume_fraction: Annotated[float, Field(gt=0, le=1.5)] = Field(
        0.64, description="of the random packing"
    )
    frozen_below: NotNegative = Field(0.0, description="spheres that start lower are held")
    seed: Seed | None = Field(None, description="of the packing; the scene's seed if not given")


class Membrane(Part):
    """Triangular network of membrane particles."""

    lattice: tuple[Count, Count] = Field((100, 114), description="particles along x, rows along y")
    radius: Positive = Field(1.0, description="R_m")
    spacing_ratio: Fraction = Field(0.25, description="d2")
    height: Positive | None = Field(None, description="z at the start; 16 R_c if not given")
    heights: str | None = Field(None, description="file of heights at the start")
    heights_scale: Annotated[float, Field(ge=-10_000, le=10_000)] = 1.0
    noise: NotNegative = Field(0.0, description="standard deviation of z at the start")
    stretch_stiffness: NotNegative = 0.04
    elasticity: NotNegative = Field(1.25, description="a2")
    bending_stiffness: NotNegative = 0.5
    bending_form: Literal["cosine", "diverging"] = Field(
        "cosine", description="diverging: without end as a link folds up"
    )
    exclusion_stiffness: NotNegative = 0.04


class KindKeys(Part):
    """What a scene says of a kind of cells; see `cell_kinds` for what it does not say."""

    count: Count = Field(0, description="cells at the start")
    adhesion: Literal["bound", "adhesive", "none"] | None = Field(
        None, description="to the membrane: a spring without end, one with a range, none"
    )
    stiffness: NotNegative | None = Field(None, description="K of its adhesion")
    range: AboveOne | None = Field(None, description="lambda of its adhesion and detachment")
    detaches: bool | None = Field(None, description="leaves when it is further than the range")
    cycle_delay: NotNegative | None = Field(None, description="T0")
    cycle_rate: Positive | None = Field(None, description="gamma")
    first_phase: NotNegative | None = None
    daughter: str | None = Field(None, description="kind of the newborn of a division")
    generations: Generations | None = Field(None, description="divisions of a cell")
    after_last: str | None = Field(None, description="kind after the last division")
    color: HexColour | None = Field(None, description="in pictures")
    like: str | None = Field(None, description="kind whose keys are the defaults of this one")
    paired_with: str | None = Field(None, description="kind beside which it is stiffer or softer")
    paired_stiffness: NotNegative | None = Field(None, description="K while in such a pair")


class Cells(Part):
    """Stem, transit-amplifying (TA) and non-dividing (ND) cells, and kinds that a scene adds."""

    stem: Count = 0
    nd: Count = 0
    arrangement: Literal["ring", "cluster", "random", "core", "alternating", "halves"] = "ring"
    ring_radius: Annotated[float, Field(gt=0, lt=0.5)] = Field(0.3, description="over L_x")
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
    generations: Generations = Field(10, description="M")
    removal_in_pair: bool = Field(True, description="whether cells of a dividing pair may leave")
    division_distance: Annotated[float, Field(ge=0, le=1)] = Field(
        0.0, description="a pair parts when it is further apart, in units of 2 R_c"
    )
    kinds: dict[str, KindKeys] = Field({}, description="kinds of cells")

    def __hash__(self) -> int:
        return hash(self.model_dump_json())  # the table of kinds has no hash of its own


class Numerics(Part):
    """How it is computed. The level of accuracy gives the keys that are not given themselves."""

    accuracy: Level = DEFAULT_LEVEL
    integrator: Literal["euler", "rkl1", "rkl2"] = Field(
        "euler", description="forward Euler, or Runge-Kutta-Legendre of order 1 or 2"
    )
    stages: Annotated[int, Field(ge=3, le=99)] | None = Field(
        None,
        description="force evaluations in a step of rkl1 and rkl2; as many as the stiffest term "
        "of the scene needs if not given",
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


class Output(Part):
    """How often what is written, in time units; 0 is never."""

    thermo_interval: Positive = 2.0
    dump_interval: NotNegative = 10.0
    checkpoint_interval: NotNegative = 50.0


class StartKeys(Part):
    """The state of another run to begin with: its keys but `from`, which is a word of Python."""

    time: NotNegative | None = Field(None, description="of a frame; the last one if not given")
    content: str | None = Field(None, description="hash that the state must have")
    versions: str | None = Field(None, description="what made the run; tells, and is not compared")

    @property
    def run(self) -> str | None:
        """The run directory or trajectory, `start.from`."""
        run: str | None = getattr(self, "from", None)
        return run


if TYPE_CHECKING:
    Start = StartKeys
else:
    Start = create_model(
        "Start", __base__=StartKeys, **{"from": (str | None, Field(None, description="a run"))}
    )
