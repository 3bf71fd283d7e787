"""Scenes at the extremes end in a sane state, or in an error that says what went wrong."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.errors import SimulationError
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import lattice
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import CONTACT, HEIGHT, QUIET, place

LEVELS = ("reference", "balanced", "fast")
TOUGH = {
    "soft membrane": {"membrane.stretch_stiffness": 4e-5, "membrane.bending_stiffness": 5e-4},
    "stiff bending": {"membrane.bending_stiffness": 500.0},
    "stiff cells": {"cells.exclusion_stiffness": 40.0, "cells.membrane_exclusion_stiffness": 40.0},
    "no binding": {"cells.binding_stiffness": 0.0},
    "no bending": {"membrane.bending_stiffness": 0.0},
    "no stretching": {"membrane.stretch_stiffness": 0.0},
    "no exclusion": {"cells.exclusion_stiffness": 0.0, "cells.membrane_exclusion_stiffness": 0.0},
    "adhesion x 100": {"cells.adhesion_stiffness": 500.0, "cells.binding_stiffness": 2500.0},
    "growth x 100": {"cells.division_rate": 14.0},
    "links x 1000": {"membrane.stretch_stiffness": 40.0},
    "links x 1000 with a limit": {
        "membrane.stretch_stiffness": 40.0, "numerics.stiffness_limit": 100.0,
    },
    "all divide at once": {
        "cells.first_phase": 0.0, "cells.cycle_delay": 1.0, "cells.cycle_rate": 1e6,
    },
}  # fmt: skip
STIFF_CELLS = r"unstable on step \d+: .* most of it from pair forces with atom \d+ of type [123] "
STIFF_LINKS = r"unstable on step \d+: .* most of it from stretch, .*try a smaller timestep"
STIFF_SPRINGS = r"unstable on step \d+: .* most of it from division springs, which would need"
THROWN = "the state that this run began with is like that"
BEYOND = {  # what not every level can run: how each ends
    "links x 1000": (  # with fewer stages than they need
        {"membrane.stretch_stiffness": 40.0, "numerics.stages": 3},
        {"reference": "", "balanced": STIFF_LINKS, "fast": STIFF_LINKS},
    ),
    "cells x 1e9": (
        {"cells.exclusion_stiffness": 4e7, "cells.membrane_exclusion_stiffness": 4e7},
        {"reference": STIFF_CELLS, "balanced": "", "fast": ""},
    ),
    "division springs x 4e6": (  # Euler would need steps of ten thousands of parts
        {"cells.division_stiffness": 2e7, "end_time": 1.75},  # a step of thousands, with two pairs
        {"reference": STIFF_SPRINGS, "balanced": "", "fast": ""},
    ),
}  # fmt: skip
LONG = {("division springs x 4e6", "fast")}  # as on the level before it, which is quick
CROWD = r"unstable on step 1: .* pair forces with atom \d+ of type 3 at a distance of 0\.\d+, "
CROWDS = {  # ten thousand cells, thrown into one layer or in layers
    ("reference", "thrown"): rf"skin/core: .* of types 3 and 3 overlap on step 0: .*{THROWN}",
    ("balanced", "thrown"): rf"{CROWD}.*{THROWN}",
    ("fast", "thrown"): rf"{CROWD}.*{THROWN}",
    ("reference", "layers"): "",
    ("balanced", "layers"): "",
    ("fast", "layers"): "",
}


def small(level: str, **changes: Any) -> Scene:
    """TA cells over stem cells on a small free membrane, dividing every few time units."""
    return Scene.from_dict(
        {
            "name": "extreme", "end_time": 10.0, "dermis": {"present": False},
            "membrane": {"lattice": [20, 24]}, "cells": {"stem": 4, "arrangement": "random"},
            "numerics": {"accuracy": level}, "output": {**QUIET, "thermo_interval": 5.0},
        }
    ).replace(**{"cells.cycle_delay": 2.0, "cells.cycle_rate": 0.5, "cells.first_phase": 4.0,
                 "cells.division_rate": 0.7, **changes})  # fmt: skip


def run(scene: Scene, configuration: Configuration | None = None, **options: Any) -> str:
    """Run to the end: "" for a sane state, or the text of the error; printed, too."""
    outcome = ""
    try:
        with Simulation.begin(scene, configuration=configuration, **options) as simulation:
            simulation.run()
            assert_sane(simulation)
    except SimulationError as error:
        outcome = str(error)
    print(f"{scene.numerics.accuracy}: {outcome or 'a sane state'}")
    return outcome


def assert_sane(simulation: Simulation) -> None:
    """Finite, links within their singular length, cells not inside the membrane."""
    scene, particles = simulation.scene, simulation.forces()
    assert np.isfinite(particles.positions).all()
    assert np.isfinite(particles.forces).all()
    assert all(math.isfinite(value) for value in simulation.energies().values())
    sheet = particles.positions[particles.types == Kind.MEMBRANE]
    links, _ = lattice.links_and_hinges(scene.membrane.lattice)
    ends = sheet[links[:, 1]] - sheet[links[:, 0]]
    sides = np.array(scene.box_sides[:2])
    ends[:, :2] -= sides * np.round(ends[:, :2] / sides)
    singular = 2 * scene.membrane.radius * (1 + scene.membrane.spacing_ratio)
    if scene.membrane.stretch_stiffness:
        assert np.linalg.norm(ends, axis=1).max() < singular
    if scene.cells.membrane_exclusion_stiffness and len(simulation.cells().ids):
        assert simulation.cells().distance.min() > 0.5 * scene.contact


def ends(outcome: str, expected: str) -> bool:
    """Whether a run has ended in the expected error, or in a sane state if none is expected."""
    return bool(re.search(expected, outcome)) if expected else outcome == ""


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("extreme", TOUGH)
def test_extreme_parameters(extreme: str, level: str) -> None:
    assert run(small(level, **TOUGH[extreme])) == ""


@pytest.mark.parametrize(
    ("extreme", "level"),
    [pytest.param(extreme, level, marks=pytest.mark.slow if (extreme, level) in LONG else ())
     for extreme in BEYOND for level in LEVELS],
)  # fmt: skip
def test_parameters_beyond_a_level(extreme: str, level: str) -> None:
    changes, outcomes = BEYOND[extreme]
    assert ends(run(small(level, **changes)), outcomes[level])


@pytest.mark.slow
@pytest.mark.parametrize("level", ["balanced", "fast"])
def test_stiff_division_springs_to_the_end_of_divisions(level: str) -> None:
    assert run(small(level, **{"cells.division_stiffness": 2e7})) == ""


@pytest.mark.parametrize("factor", [0.5, 0.99, 1.01, 10.0])
def test_timestep_around_the_limit(factor: float) -> None:
    """A stem cell bound to one membrane particle: two springs in line, lambda = 2 K / D."""
    stiffness = 100.0  # of direct forces
    limit = 2 / (2 * stiffness / CONTACT)
    still = {"membrane.stretch_stiffness": 0.0, "membrane.bending_stiffness": 0.0,
             "cells.generations": 0, "cells.cycle_delay": 1e6, "cells.cycle_rate": 1e-6,
             "numerics.largest_move": 0.0, "output.thermo_interval": 40.0,
             "cells.membrane_exclusion_stiffness": 0.0}  # fmt: skip
    scene = small("reference", **still).replace(
        **{"cells.binding_stiffness": stiffness, "numerics.timestep": factor * limit,
           "cells.stem": 1, "end_time": 400 * limit, "numerics.event_interval": 0.0}
    )  # fmt: skip
    on_top = lattice.positions(scene.membrane.lattice, scene.spacing, HEIGHT)[100]
    start = place(scene, [(Kind.STEM, (*on_top[:2], on_top[2] + CONTACT + 1e-4), 0)])
    with Simulation.begin(scene, configuration=start) as simulation:
        simulation.run(until=20 * factor * limit)
        stretch = abs(float(simulation.cells().distance[0]) - CONTACT)
    assert (stretch < 1e-4) == (factor < 1)


@pytest.mark.parametrize("level", LEVELS)
def test_no_cells_and_one_cell(level: str) -> None:
    for stem in (0, 1):
        assert run(small(level, **{"cells.stem": stem})) == ""


@pytest.mark.parametrize("level", LEVELS)
def test_all_cells_removed(level: str) -> None:
    """TA cells that begin beyond the threshold leave, and the membrane goes on."""
    scene = small(level)
    far = [(Kind.TA, (2.0 + 2 * n, 3.0, HEIGHT + 2 * CONTACT), 3) for n in range(3)]
    with Simulation.begin(scene, configuration=place(scene, far)) as simulation:
        simulation.run()
        assert len(simulation.cells().ids) == 0
        assert_sane(simulation)


@pytest.mark.parametrize("level", LEVELS)
def test_smallest_box(level: str) -> None:
    assert run(small(level, **{"membrane.lattice": list(Scene.smallest_lattice)})) == ""


@pytest.mark.parametrize("level", LEVELS)
def test_folded_membrane(level: str) -> None:
    """Waves as high as they are long relax."""
    scene = small(level, **{"cells.stem": 0})
    start = Configuration.from_scene(scene)
    phase = 2 * np.pi * start.positions[:, 0] / scene.box_sides[0]
    start.positions[:, 2] += 2.5 * np.sin(2 * phase)
    assert run(scene, start) == ""


@pytest.mark.parametrize("level", LEVELS)
def test_sliver_triangle(level: str) -> None:
    """A triangle of area 1e-6, on which bending has no bound."""
    scene = small(level, **{"cells.stem": 0, "end_time": 2.0})
    start = Configuration.from_scene(scene)
    opposite, i, j, _ = start.hinges[200]
    x = start.positions
    middle = (x[i] + x[j]) / 2
    height = 2e-6 / np.linalg.norm(x[i] - x[j])
    x[opposite] = middle + height * (x[opposite] - middle) / np.linalg.norm(x[opposite] - middle)
    assert run(scene, start) == ""


@pytest.mark.parametrize("level", LEVELS)
def test_dense_dermis(level: str) -> None:
    scene = small(level, **{"dermis.present": True, "dermis.volume_fraction": 1.28})
    assert run(scene.replace(end_time=3.0)) == ""


@pytest.mark.parametrize(
    ("form", "ranks"),
    [("analytic", 1), ("table", 1), ("analytic", 2),
     pytest.param("table", 2, marks=pytest.mark.slow)],
)  # fmt: skip
def test_overstretched_link_is_named(form: str, ranks: int) -> None:
    free = {"cells.stem": 0, "numerics.largest_move": 0.0, "numerics.pair_form": form}
    with Simulation.begin(small("reference", **free), ranks=ranks) as simulation:
        simulation.command("group one id 101")
        simulation.command("fix pull one addforce 0 0 300")
        error = r"link of atoms \d+ and \d+ has length \S+ on step 1, .*try a smaller timestep"
        with pytest.raises(SimulationError, match=error):
            simulation.run()


def test_cell_through_the_membrane_is_named(tmp_path: Path) -> None:
    """A force that no term of the model has pushes a cell into the membrane."""
    scene = small("reference", **{"numerics.largest_move": 0.0})
    cells = [(Kind.STEM, (4.0, 4.0, HEIGHT + CONTACT), 0)]
    with Simulation.begin(scene, tmp_path, place(scene, cells)) as simulation:
        simulation.command("group sheet type membrane")
        simulation.command("fix hold sheet setforce 0 0 0")
        simulation.command("fix push cells addforce 0 0 -300")
        with pytest.raises(SimulationError, match=r"cell \d+ of type \d+ breaks through .*step"):
            simulation.run()


@pytest.mark.parametrize("push", [5.0, 40.0])
def test_cell_that_would_pierce_divides_the_step(push: float) -> None:
    """Pressed on a membrane that is held, a cell stays above it, in as short steps as it needs."""
    slow = {"cells.cycle_delay": 36.0, "cells.cycle_rate": 0.083, "numerics.event_interval": 2.0}
    long = {"numerics.timestep": 2.0, "numerics.stages": 13, "numerics.largest_move": 1e3}
    scene = small("fast", **slow, **long)
    cells = [(Kind.STEM, (4.0, 4.0, HEIGHT + CONTACT), 0)]
    with Simulation.begin(scene, configuration=place(scene, cells)) as simulation:
        simulation.command("group sheet type membrane")
        simulation.command("fix hold sheet setforce 0 0 0")
        simulation.command(f"fix push cells addforce 0 0 {-push}")
        simulation.run()
        assert 0.5 * CONTACT < float(simulation.cells().distance[0]) < CONTACT
        assert simulation.motion().divided > 0


def test_a_stem_cell_that_nothing_binds_is_named() -> None:
    """No division of the step keeps it at the membrane: the run does not try for ever."""
    scene = Scene.load("demo").replace(**{"cells.binding_stiffness": 0.0})
    named = pytest.raises(SimulationError, match=r"stem cell \d+ has lost the membrane on step \d+")
    with Simulation.begin(scene) as simulation, named:
        simulation.run()


def test_what_is_no_number_is_named() -> None:
    scene = small("reference", **{"cells.stem": 0, "numerics.largest_move": 0.0})
    with Simulation.begin(scene) as simulation:
        simulation.command("variable none atom 0/0")
        simulation.command("fix push all addforce 0 0 v_none")
        with pytest.raises(SimulationError, match=r"unstable on step \d+|Divide by 0"):
            simulation.run()


@pytest.mark.parametrize(
    ("form", "style"), [("skin", "lj"), ("analytic", "core"), ("table", "core")]
)
def test_overlap_is_named(form: str, style: str) -> None:
    """A force that no term of the model has throws one cell into another in a single step."""
    free = {"numerics.pair_form": form, "numerics.largest_move": 0.0}
    scene = small("reference", **free)
    cells = [(Kind.TA, (x, 6.0, HEIGHT + CONTACT), 3) for x in (4.0, 6.8)]
    with Simulation.begin(scene, configuration=place(scene, cells)) as simulation:
        first = int(simulation.cells().ids[0])
        simulation.command(f"group one id {first}")
        simulation.command(f"fix push one addforce {2.2 / scene.numerics.timestep} 0 0")
        error = (
            rf"skin/{style}: atoms {first} and {first + 1} of types 3 and 3 overlap on step 1: "
            r"their distance is 0\.6\d*, less than 0\.84; try a smaller timestep than 0\.01"
        )
        with pytest.raises(SimulationError, match=error):
            simulation.run()


def test_cells_may_overlap_without_exclusion() -> None:
    """Where a term is off its core is not watched."""
    scene = small("reference", **{"cells.exclusion_stiffness": 0.0, "end_time": 1.0})
    cells = [(Kind.TA, (x, 6.0, HEIGHT + CONTACT), 3) for x in (4.0, 4.5)]
    assert run(scene, place(scene, cells)) == ""


FORCES = {
    "pair": ({}, 0.95, r"pair forces with atom \d+ of type 3 at a distance of 0\.95\d*"),
    "springs": ({"cells.division_stiffness": 1e12}, 0.5, "division springs"),
    "bound": ({"cells.adhesion_stiffness": 1e12}, 9.0, "adhesion or binding"),
    "bend": ({"membrane.bending_stiffness": 1e12}, 9.0, "bend"),
    "stretch": ({"membrane.stretch_stiffness": 1e12}, 9.0, "stretch"),
}


@pytest.mark.parametrize(
    ("term", "ranks"),
    [*((term, 1) for term in (*FORCES, "push")), ("pair", 2),
     pytest.param("bend", 2, marks=pytest.mark.slow)],
)  # fmt: skip
def test_the_term_that_is_unstable_is_named(term: str, ranks: int) -> None:
    """A force that no step is short enough for, on a particle, and where it comes from."""
    changes, apart, named = FORCES.get(term, ({}, 9.0, "fix push of style addforce"))
    scene = small("reference", **{"numerics.largest_move": 1e-4, **changes})
    places = [(4.0 + n * apart, 6.0, HEIGHT + CONTACT + 0.1) for n in range(2)]
    start = place(scene, [(Kind.TA, at, 3) for at in places])
    start.positions[5, 2] += 0.1
    if term == "springs":
        start.pair[-2:] = len(start.pair) - np.array([0, 1])
        start.pair_start[-2:] = 0.0
    with Simulation.begin(scene, configuration=start, ranks=ranks) as simulation:
        if term == "push":
            simulation.command("fix push all addforce 0 1e9 0")
        error = rf"unstable on step 1: .*, most of it from {named}, which would need"
        with pytest.raises(SimulationError, match=error):
            simulation.run(until=scene.numerics.timestep)


@pytest.mark.parametrize(("push", "end"), [(-40.0, "-"), (40.0, "10")])
def test_particle_that_leaves_the_box_is_named(push: float, end: str) -> None:
    """Without a dermis nothing holds the membrane; here it is pushed to both ends of the box."""
    scene = small("balanced", **{"cells.stem": 0})
    with Simulation.begin(scene) as simulation:
        simulation.command(f"fix push all addforce 0 0 {push}")
        error = rf"atom \d+ of type \d leaves the box on step \d+: z = {end}.*membrane.height"
        with pytest.raises(SimulationError, match=error):
            simulation.run()


def ten_thousand(scene: Scene, how: str) -> Configuration:
    """Dividing and exhausted TA cells: thrown into one layer, or 1.39 apart in layers."""
    draw = np.random.default_rng(5)
    sides = np.array(scene.box_sides[:2])
    n, across = np.arange(10_000), 36
    spots = draw.random((len(n), 2)) * sides
    layer = np.zeros(len(n))
    if how == "layers":
        spots = np.column_stack([n % across, n // across % across]) / across * sides
        layer = n // across**2
    left = draw.integers(0, 10, len(n))
    cells = [
        (Kind.TA if m else Kind.EXHAUSTED, (x, y, HEIGHT + CONTACT + 2.8 * up), int(m))
        for (x, y), up, m in zip(spots, layer, left, strict=True)
    ]
    return place(scene, cells)


@pytest.mark.parametrize(
    ("level", "how"),
    [case if case[0] == "fast" else pytest.param(*case, marks=pytest.mark.slow) for case in CROWDS],
)
def test_ten_thousand_cells_on_a_quarter(level: str, how: str) -> None:
    """In one layer they are in the mean 0.5 apart; in layers only short steps part them."""
    scene = small(level, **{"membrane.lattice": [100, 114], "cells.stem": 1, "end_time": 4.0})
    assert ends(run(scene, ten_thousand(scene, how)), CROWDS[level, how])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two-cells", "one-stem"])
def test_ten_thousand_time_units(name: str) -> None:
    quiet = {"output.dump_interval": 0.0, "output.checkpoint_interval": 0.0}
    scene = Scene.load(name).replace(**quiet, end_time=10_000.0)
    with Simulation.begin(scene) as simulation:
        simulation.run()
        assert_sane(simulation)
        assert simulation.time == 10_000.0
        assert len(simulation.cells().ids) > scene.cells.stem
