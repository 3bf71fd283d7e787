"""Configurations edited by hand: what describes no possible state is refused, and named."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from lammps_skin import Configuration, Scene, Simulation
from lammps_skin.errors import ConfigurationError, SceneError
from lammps_skin.kinds import Kind

SCENE = Scene.load("two-cells").replace(**{"membrane.lattice": [12, 14]})
N = 170  # 168 membrane particles and two stem cells
FIRST, SECOND = 168, 169


@pytest.fixture(scope="module")
def good() -> Configuration:
    return Configuration.from_scene(SCENE)


def put(name: str, index: object, value: object) -> Callable[[Configuration], None]:
    """Set entries of an array."""

    def edit(configuration: Configuration) -> None:
        getattr(configuration, name)[index] = value

    return edit


def give(name: str, value: object) -> Callable[[Configuration], None]:
    """Replace an array."""
    return lambda configuration: setattr(configuration, name, value)


def pair_up(configuration: Configuration) -> None:
    configuration.pair[[FIRST, SECOND]] = SECOND + 1, FIRST + 1


CASES = {
    "positions nan": (put("positions", (3, 1), np.nan), "positions: entry 3, 1 is nan, must be fi"),
    "positions inf": (put("positions", (0, 2), np.inf), "positions: entry 0, 2 is inf, must be fi"),
    "positions shape": (give("positions", np.zeros((N, 2))), "positions: has shape (170, 2), must"),
    "positions short": (give("positions", np.zeros((3, 3))), "positions: has shape (3, 3), must b"),
    "positions text": (give("positions", [["a"] * 3] * N), "positions: must be an array of number"),
    "positions ragged": (give("positions", [[1.0], [2.0, 3.0]]), "positions: must be an array of "),
    "positions none": (give("positions", None), "positions: must be an array of numbers"),
    "above": (put("positions", (FIRST, 2), 100.0), "positions: z = 100 of particle 168 must be in"),
    "below": (put("positions", (FIRST, 2), -1e-9), "positions: z = -1e-09 of particle 168 must be"),
    "box nan": (put("box", 2, np.nan), "box: entry 2 is nan, must be finite"),
    "box shape": (give("box", np.ones(2)), "box: has shape (2,), must be (3,)"),
    "box zero": (put("box", 0, 0.0), "box of 0 x 6.062 x 100: too small for the range "),
    "box negative": (put("box", 1, -6.0), "box of 6 x -6 x 100: too small for the range "),
    "kinds 0": (put("kinds", 5, 0), "kinds: entry 5 is 0, must be 1 to"),
    "kinds 7": (put("kinds", 5, 7), "kinds: the scene has no particles of kind 7"),
    "kinds float": (give("kinds", np.full(N, 2.0)), "kinds: must be an array of whole numbers"),
    "kinds absent": (put("kinds", FIRST, 1), "kinds: the scene has no particles of kind dermal"),
    "no membrane": (give("kinds", np.full(N, 3)), "kinds: there is no membrane particle (2)"),
    "links range": (put("links", (0, 0), N), "links: entry 0, 0 is 170, must be 0 to 169"),
    "links negative": (put("links", (4, 1), -1), "links: entry 4, 1 is -1, must be 0 to 169"),
    "links cell": (put("links", (0, 0), FIRST), "links: must join membrane particles"),
    "links float": (give("links", np.zeros((4, 2))), "links: must be an array of whole numbers"),
    "links shape": (give("links", np.zeros((4, 3), int)), "links: has shape (4, 3), must be (n, 2"),
    "links own": (put("links", (0, 1), 0), "positions: the link of the particles 0 and 0 is 0 lon"),
    "links twice": (
        lambda c: put("links", 0, c.links[7][::-1])(c),
        "links: the particles 7 and 8 have more than one",
    ),
    "hinges twice": (
        lambda c: put("hinges", 0, c.hinges[7][::-1])(c),
        "hinges: the particles 7 and 8 have more than one",
    ),
    "box of another scene": (
        put("box", 0, 7.0),
        "box: is [7.0, 6.062178, 100.0], must be that of ",
    ),
    "box height": (put("box", 2, 90.0), "box: is [6.0, 6.062178, 90.0], must be that of the sc"),
    "pair of two ages": (
        lambda c: (pair_up(c), put("pair_start", FIRST, -1.0)(c)),
        "pair_start: -1 and 0 of the particles 168 and 169, who are a pair, must be equal",
    ),
    "hinges range": (put("hinges", (2, 3), 999), "hinges: entry 2, 3 is 999, must be 0 to 169"),
    "hinges cell": (put("hinges", (2, 3), FIRST), "hinges: must join membrane particles"),
    "overlap": (
        lambda c: put("positions", FIRST, c.positions[SECOND])(c),
        "positions: the cells 168 and 169 overlap, 0 apart",
    ),
    "overlap through the edge": (
        lambda c: put("positions", FIRST, c.positions[SECOND] + [c.box[0], -c.box[1], 1e-4])(c),
        "positions: the cells 168 and 169 overlap, 0.0001 apart",
    ),
    "exhausted": (put("kinds", FIRST, Kind.EXHAUSTED), "divisions_left: 10 for particle 168, a ex"),
    "m < 0": (put("divisions_left", FIRST, -1), "divisions_left: entry 168 is -1, must be 0 to 21"),
    "m shape": (give("divisions_left", np.zeros(3, int)), "divisions_left: has shape (3,), must b"),
    "m float": (give("divisions_left", np.zeros(N)), "divisions_left: must be an array of whole n"),
    "done < 0": (put("divisions_done", SECOND, -2), "divisions_done: entry 169 is -2, must be 0 t"),
    "parent < 0": (put("parent", SECOND, -2), "parent: entry 169 is -2, must be 0 to 2147483647"),
    "pair one way": (put("pair", FIRST, SECOND + 1), "pair: particle 168 and id 170 are not each"),
    "pair self": (put("pair", FIRST, FIRST + 1), "pair: particle 168 and id 169 are not each oth"),
    "pair nobody": (put("pair", FIRST, 9999), "pair: particle 168 and id 9999 are not each other'"),
    "pair membrane": (
        lambda c: put("pair", [FIRST, 0], [1, FIRST + 1])(c),
        "pair: particle 168 and id 1 are not each other's",
    ),
    "next nan": (put("next_division", FIRST, np.nan), "next_division: entry 168 is nan, must be f"),
    "birth inf": (put("birth_time", FIRST, -np.inf), "birth_time: entry 168 is -inf, must be fini"),
    "start text": (give("pair_start", ["x"] * N), "pair_start: must be an array of numbers"),
    "time nan": (give("time", np.nan), "time: is nan, must be finite"),
    "time < 0": (give("time", -1.0), "time: is -1, must be 0 to 5e+11"),
    "time text": (give("time", "soon"), "time: must be an array of numbers"),
}


@pytest.mark.parametrize("name", CASES)
def test_refused(name, good, tmp_path):
    edit, expected = CASES[name]
    bad = deepcopy(good)
    edit(bad)
    with pytest.raises((ConfigurationError, SceneError)) as refusal:
        Simulation.begin(SCENE, directory=tmp_path / "run", configuration=bad)
    assert str(refusal.value).startswith(expected)
    assert "\n" not in str(refusal.value)
    assert not (tmp_path / "run").exists()


def test_a_torn_link_is_named_with_what_it_may_be(good):
    bad = deepcopy(good)
    bad.positions[7, 2] += 5
    message = r"link of the particles \d+ and \d+ is 5\.0\d+ long, must be between 0 and 2\.5"
    with pytest.raises(ConfigurationError, match=message):
        bad.check(SCENE)


def test_what_is_possible_is_taken(good):
    """The original, a dividing pair that overlaps, lists for arrays, a place outside the box."""
    paired = deepcopy(good)
    paired.positions[FIRST] = paired.positions[SECOND] + [0, 0, 1e-3]
    pair_up(paired)
    listed = replace(deepcopy(good), positions=good.positions.tolist(), kinds=good.kinds.tolist())
    shifted = deepcopy(good)
    shifted.positions[:, 0] += 3 * good.box[0]
    for configuration in (good, paired, listed, shifted):
        configuration.check(SCENE)
    with Simulation.begin(SCENE, configuration=listed) as simulation:
        assert len(simulation.cells().ids) == 2
