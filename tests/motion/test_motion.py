"""fix skin/motion: forward Euler whose steps are divided where a particle would move too far."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.engine.engine import Forces, open_lammps
from lammps_skin.errors import SimulationError
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import FOUR_STEPS

CORNER = 2 * 24 + 5  # of the lattice of bare-membrane below


def sheet(**changes: Any) -> tuple[Scene, Configuration]:
    """A small rough membrane."""
    scene = Scene.load("bare-membrane").replace(
        **{
            "parameters": "printed",
            "membrane.lattice": [24, 28],
            "output.dump_interval": 0.0,
            "numerics.accuracy": "reference",
            **changes,
        }
    )
    return scene, Configuration.from_scene(scene)


def inverted(configuration: Configuration) -> Configuration:
    """The sheet with one corner pushed just through the link opposite to it."""
    opposite, i, j, _ = next(h for h in configuration.hinges if CORNER in h[:1])
    x = configuration.positions
    middle = (x[i] + x[j]) / 2
    x[opposite] = middle + 5e-3 * (middle - x[opposite])
    return configuration


def state_after(scene: Scene, configuration: Configuration, time: float, **more: Any) -> Forces:
    with Simulation.begin(scene, configuration=configuration, **more) as simulation:
        simulation.run(until=time)
        return simulation.forces()


def test_undivided_steps_are_those_of_fix_brownian() -> None:
    scene, configuration = sheet()
    ours = state_after(scene, configuration, 1.0)
    plain = state_after(scene.replace(**{"numerics.largest_move": 0.0}), configuration, 1.0)
    assert np.abs(ours.positions - configuration.positions).max() > 1e-3
    np.testing.assert_allclose(ours.positions, plain.positions, rtol=0, atol=1e-12)


def test_divided_step_is_a_chain_of_euler_steps(tmp_path: Path) -> None:
    """One step, against moves by hand with the forces that LAMMPS gives at each place."""
    scene, configuration = sheet(**{"numerics.largest_move": 2e-4})
    at = state_after(scene, configuration, 0.0)
    x, forces, remaining, pieces = at.positions, at.forces, scene.numerics.timestep, 0
    while remaining > 0:
        fastest = np.linalg.norm(forces, axis=1).max()
        piece = min(remaining, 2e-4 / fastest)
        x, remaining, pieces = x + piece * forces, remaining - piece, pieces + 1
        configuration.positions = x
        forces = state_after(scene, configuration, 0.0).forces

    assert pieces > 2
    _, fresh = sheet()
    with Simulation.begin(scene, tmp_path, fresh) as simulation:
        simulation.run(until=scene.numerics.timestep)
        moved = simulation.forces()
    delta = moved.positions - x
    delta[:, :2] -= fresh.box[:2] * np.round(delta[:, :2] / fresh.box[:2])
    np.testing.assert_allclose(delta, 0, atol=1e-12)


def test_all_move_as_the_members_of_a_group_do() -> None:
    scene, configuration = sheet(**{"numerics.timestep": 0.5, "numerics.rounding": 0.0})
    places = []
    for group in ("all", "every"):
        with Simulation.begin(scene, configuration=configuration) as simulation:
            simulation.command("group every union all")
            simulation.command("unfix motion")
            simulation.command(f"fix motion {group} skin/motion rkl1 stages 4 move 1.2")
            simulation.run(until=5.0)
            places.append(simulation.forces().positions)
    assert np.abs(places[0] - configuration.positions).max() > 1e-3
    np.testing.assert_allclose(*places, rtol=0, atol=1e-12)


def test_collapsed_triangle_is_survived() -> None:
    """A triangle just turned over throws its corner away, unless the step is divided."""
    scene, configuration = sheet(**{"membrane.noise": 0.02})
    start = inverted(configuration)
    moved = state_after(scene, start, 1.0).positions
    assert np.abs(moved[:, 2] - scene.membrane_height).max() < 1.0
    with pytest.raises(SimulationError, match="link of atoms"):
        state_after(scene.replace(**{"numerics.largest_move": 0.0}), start, 1.0)


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_inverted_triangle_ends_the_run(ranks: int) -> None:
    """It is named if it stays for two time units; no timestep turns back what began like that."""
    scene, configuration = sheet(**{"numerics.timestep": 0.5})
    message = r"triangle of atoms \d+ \d+ \d+ is inverted on step 5: .* this run began with is like"
    with Simulation.begin(scene, configuration=inverted(configuration), ranks=ranks) as simulation:
        simulation.command("fix freeze all setforce 0 0 0")
        simulation.run(until=2.0)
        with pytest.raises(SimulationError, match=message):
            simulation.run(until=3.0)


@pytest.mark.parametrize("how", [{"ranks": 2}, {"threads": 2}])
def test_ranks_and_threads_agree(how: dict[str, int]) -> None:
    scene, configuration = sheet(**{"numerics.largest_move": 1e-3})
    one, two = (state_after(scene, configuration, 0.1, **more) for more in ({}, how))
    np.testing.assert_array_equal(one.ids, two.ids)
    np.testing.assert_allclose(one.positions, two.positions, rtol=0, atol=1e-11)


def test_hopeless_steps_end_the_run() -> None:
    scene, configuration = sheet(**{"numerics.largest_move": 1e-12})
    message = r"unstable on step 1: the force on atom \d+ of type 1 is .* this run began with is"
    with pytest.raises(SimulationError, match=message):
        state_after(scene, configuration, 0.1)


@pytest.mark.parametrize(
    ("move", "ranks"), [(1e3, 1), (1e3, 2), (0.0, 1), pytest.param(0.0, 2, marks=pytest.mark.slow)]
)
def test_a_link_that_breaks_divides_the_step(move: float, ranks: int) -> None:
    """A particle that is pulled has a place of rest; without `move` its links break on the way."""
    scene, configuration = sheet(
        numerics={**FOUR_STEPS, "largest_move": move}, **{"membrane.noise": 0.0}
    )
    with Simulation.begin(scene, configuration=configuration, ranks=ranks) as simulation:
        simulation.command(f"group one id {CORNER}")
        simulation.command("fix pull one addforce 0 0 100")
        if not move:
            with pytest.raises(SimulationError, match=r"link of atoms .* on step 1, its singular"):
                simulation.run(until=0.5)
            return
        simulation.run(until=0.5)
        motion = simulation.motion()
    assert motion.divided >= 1 and motion.evaluations > 10


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_particles_beyond_the_neighbor_lists(ranks: int) -> None:
    """All drift by 0.25 in a step; at stage 4 of 5 alone they are beyond half of the skin."""
    scene, configuration = sheet(
        **{
            "membrane.noise": 0.0, "numerics.integrator": "rkl1", "numerics.stages": 5,
            "numerics.timestep": 0.25, "numerics.largest_move": 0.0, "numerics.neighbor_skin": 0.3,
        }
    )  # fmt: skip
    with Simulation.begin(scene, configuration=configuration, ranks=ranks) as simulation:
        simulation.command("fix drift all addforce 1 0 0")
        simulation.run(until=1.0)
        assert simulation.motion().beyond_lists == 4 * len(configuration.positions)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("", "needs a method: euler, rkl1 or rkl2"),
        ("0.05", "method = 0.05: must be euler, rkl1 or rkl2"),
        ("euler move 0", "move = 0: must be a number > 0"),
        ("euler move -1", "move = -1: must be a number > 0"),
        ("euler move nan", "floating"),
        ("euler move far", "floating"),
        ("euler move", r"move needs 1 value\(s\)"),
        ("euler stages 2", "euler stages = 2: must be 1 to 1"),
        ("rkl1 stages 1", "rkl1 stages = 1: must be 2 to 99"),
        ("rkl2 stages 2", "rkl2 stages = 2: must be 3 to 99"),
        ("rkl2 stages 100", "rkl2 stages = 100: must be 3 to 99"),
        ("rkl2 stages 3.5", "integer"),
        ("rkl1 stiffness 0", "stiffness = 0: must be a number > 0"),
        ("euler link 1", r"link needs 2 value\(s\)"),
        ("euler link 0 1", "link = 0: must be a number > 0"),
        ("euler link 2.4 0.1", "link 2.4 0.1: the second must be larger than the first"),
        ("rkl1 round 1e-5", r"round needs 2 value\(s\)"),
        ("rkl1 round 0 4", "round = 0: must be a number > 0"),
        ("rkl1 round 1e-13 4", "round = 1e-13: must be at least 1e-12"),
        ("rkl1 round 1e-5 0", "round 1e-5 0: the number of steps must be > 0"),
        ("euler margins", r"margins needs 1 value\(s\)"),
        ("euler margins 0", "margins = 0: must be a number > 0"),
        ("euler margins 1.5", "margins = 1.5 for type 1: must be a number > 0 and <= 1"),
        ("rkl1 colour 3", "Unknown fix skin/motion keyword: colour"),
    ],
)
def test_bad_arguments(arguments: str, message: str) -> None:
    engine = open_lammps(["-log", "none"])
    engine.commands_string("region box block 0 1 0 1 0 1\ncreate_box 1 box")
    with pytest.raises(Exception, match=message):
        engine.command(f"fix motion all skin/motion {arguments}")
    engine.close()
