"""Links and folds in hybrid styles, and with coefficients that `fix adapt` changes."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration

LINK = {"K": 0.04, "contact": 2.0, "a2": 1.25, "d2": 0.25, "scale": 1.0}
VALUES = [("bond", name, value) for name, value in LINK.items()] + [("dihedral", "K", 0.5)]
TERMS = ("stretch", "bend")


@pytest.fixture(scope="module")
def start() -> tuple[Scene, Configuration]:
    scene = Scene.load("bare-membrane").replace(
        **{
            "parameters": "printed", "membrane.lattice": [24, 28], "membrane.noise": 0.1,
            "output.dump_interval": 0.0, "numerics.rounding": 0.0,
        }
    )  # fmt: skip
    return scene, Configuration.from_scene(scene)


def link(**changes: float) -> str:
    return " ".join(f"{value:.17g}" for value in (LINK | changes).values())


def results(simulation: Any) -> tuple[np.ndarray, np.ndarray]:
    energies = simulation.energies()
    return np.array([energies[term] for term in TERMS]), simulation.forces().forces


def assert_same(got: Any, want: Any) -> None:
    for a, b in zip(got, want, strict=True):
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-12 * np.abs(b).max())


@pytest.mark.parametrize("hybrid", [False, True])
@pytest.mark.parametrize(("term", "name", "value"), VALUES)
def test_fix_adapt(
    term: str, name: str, value: float, hybrid: bool, start: tuple[Scene, Configuration]
) -> None:
    """Energies and forces are those of coefficients that were given."""
    scene, configuration = start
    style = "skin/stretch" if term == "bond" else "skin/bend"
    sub = f" {style}" if hybrid else ""
    changed = link(**{name: 0.9 * value}) if term == "bond" else "0.45"
    plain = link() if term == "bond" else "0.5"
    with Simulation.begin(scene, configuration=configuration) as simulation:
        for command in (
            f"{term}_style hybrid {style}" if hybrid else f"{term}_style {style}",
            f"{term}_coeff 1{sub} {plain}",
            "unfix motion",
            f"variable changed equal {0.9 * value:.17g}",
        ):
            simulation.command(command)
        before = results(simulation)
        simulation.command(f"fix change all adapt 1 {term} {style} {name} 1 v_changed")
        simulation.command("run 2")
        adapted = results(simulation)
        simulation.command("unfix change")
        simulation.command(f"{term}_coeff 1{sub} {changed}")
        given = results(simulation)
    assert_same(adapted, given)
    assert np.abs(adapted[1] - before[1]).max() > 1e-3 * np.abs(before[1]).max()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("bond skin/stretch d2 1 v_changed", "skin/stretch: d2 = 1.5 must be a number between"),
        ("bond skin/stretch a2 1 v_minus", "skin/stretch: a2 = -1.5 must be a number >= 0"),
        ("bond skin/stretch contact 1 v_minus", "contact length = -1.5 must be a number > 0"),
        ("bond skin/stretch r0 1 v_changed", "adapt bond"),
        ("dihedral skin/bend K 1 v_minus", "skin/bend: K = -1.5 must be a number >= 0"),
    ],
)
def test_what_they_cannot_become(
    change: str, message: str, start: tuple[Scene, Configuration]
) -> None:
    scene, configuration = start
    with Simulation.begin(scene, configuration=configuration) as simulation:
        simulation.command("variable changed equal 1.5")
        simulation.command("variable minus equal -1.5")
        with pytest.raises(Exception, match=message):
            for command in (f"fix change all adapt 1 {change}", "run 1"):
                simulation.command(command)


@pytest.mark.parametrize("ranks", [1, 2])
def test_stiffness_of_all_rows(ranks: int, start: tuple[Scene, Configuration]) -> None:
    """A step is the mobility times the force, across the periodic edges and edges of ranks, too.

    The bound of each particle: twice K u'' of its links, and of each of its triangles the sum of
    K (1 - c)(2 + c) times the sum of squared edges over the square of twice the area.
    """
    scene, configuration = start
    configuration = with_long_and_short_links(configuration)
    limit, timestep = 1.0, 0.001
    slow = scene.replace(
        **{
            "numerics.accuracy": "reference", "numerics.timestep": timestep,
            "numerics.stiffness_limit": limit, "numerics.largest_move": 0.0,
        }
    )  # fmt: skip
    with Simulation.begin(slow, configuration=configuration, ranks=ranks) as simulation:
        forces = simulation.forces().forces
        begin = simulation.forces().positions
        simulation.command("run 1")
        moved, motion = simulation.forces().positions - begin, simulation.motion()
    box = np.array(configuration.box)
    stiffness = bound(configuration, box)
    moved[:, :2] -= box[:2] * np.round(moved[:, :2] / box[:2])
    mobility = np.minimum(1.0, limit / stiffness)
    assert (mobility < 1.0).mean() > 0.5
    assert motion.lowered == pytest.approx((mobility < 1.0).mean())
    assert motion.lowest_mobility == pytest.approx(mobility.min())
    want = timestep * mobility[:, None] * forces
    np.testing.assert_allclose(moved, want, rtol=0, atol=1e-9 * np.abs(want).max())


def with_long_and_short_links(configuration: Configuration) -> Configuration:
    """One particle is drawn out of the membrane, another one close to its neighbor."""
    x = configuration.positions.copy()
    x[5 * 24 + 5, 2] += 2.1
    apart = x[15 * 24 + 11] - x[15 * 24 + 10]
    x[15 * 24 + 10] += (1 - 0.45 / np.linalg.norm(apart)) * apart
    return replace(configuration, positions=x)


def bound(configuration: Configuration, box: np.ndarray) -> np.ndarray:
    x, k_bend = configuration.positions, 0.5
    k, contact, a2, d2, _ = LINK.values()
    total = np.zeros(len(x))

    def vector(i: np.ndarray, j: np.ndarray) -> np.ndarray:
        d = x[j] - x[i]
        d[:, :2] -= box[:2] * np.round(d[:, :2] / box[:2])
        return d

    i, j = configuration.links.T
    s = np.linalg.norm(vector(i, j), axis=1) / contact
    long, short = s > 1.0, s < d2
    assert long.any() and short.any()
    ratio = d2 / np.where(long, 1 + d2 - s, np.where(short, s, d2))
    second = np.where(long | short, 13 * ratio**14 - 7 * ratio**8, a2) / d2**2 * k / contact**2
    for end in (i, j):
        np.add.at(total, end, 2 * second)

    one, a, b, two = configuration.hinges.T
    left = np.cross(vector(one, a), vector(one, b))
    right = np.cross(vector(two, b), vector(two, a))
    sides = [np.linalg.norm(n, axis=1) for n in (left, right)]
    c = (left * right).sum(axis=1) / (sides[0] * sides[1])
    fold = k_bend * (1 - c) * (2 + c)
    for top, p, q, size in ((one, a, b, sides[0]), (two, b, a, sides[1])):
        edges = sum((vector(m, n) ** 2).sum(axis=1) for m, n in ((top, p), (p, q), (q, top)))
        for corner in (top, p, q):
            np.add.at(total, corner, fold * edges / size**2)
    return total
