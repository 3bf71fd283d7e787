"""skin stability: limits by bisection, estimates, what it writes, does again, refuses."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.errors import SceneError
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import lattice
from lammps_skin.study.stability.bisection import bisect
from lammps_skin.study.stability.hessian import largest_eigenvalue, mobilities
from lammps_skin.study.stability.methods import Method, methods, scaled
from lammps_skin.study.stability.trials import InitialState, Trials

from tests.cells.conftest import CONTACT, HEIGHT, place
from tests.study.ensemble.conftest import skin  # noqa: F401

pytestmark = pytest.mark.usefixtures("in_this_process")

STIFFNESS = 100.0
EIGENVALUE = 2 * STIFFNESS / CONTACT**2  # of two particles on one spring of binding


@pytest.fixture
def bound() -> Scene:
    """A stem cell that is bound to one membrane particle, and nothing else of any stiffness.

    Binding acts beyond the contact length and exclusion below it; with a sixth of the stiffness
    the latter has the same second derivative, 6 K / D^2.
    """
    return Scene.from_dict(
        {
            "name": "bound", "force_scale": "printed", "dermis": {"present": False},
            "membrane": {"lattice": [12, 14], "stretch_stiffness": 0.0, "bending_stiffness": 0.0,
                         "exclusion_stiffness": 0.0},
            "cells": {"stem": 1, "binding_stiffness": STIFFNESS, "cycle_delay": 1e6,
                      "membrane_exclusion_stiffness": STIFFNESS / 6},
            "numerics": {"accuracy": "reference"},
        }
    )  # fmt: skip


def trials_of(scene: Scene, folder: Path, interval: float, stiffness_limit: float = 30.0) -> Trials:
    """The cell a little further from the particle below it than it would like."""
    on_top = lattice.positions(scene.membrane.lattice, scene.spacing, HEIGHT)[50]
    cell = (Kind.STEM, (*on_top[:2], on_top[2] + CONTACT + 1e-3), 0)
    state = InitialState(scene, configuration=place(scene, [cell]))
    return Trials(scene, state, folder, interval, stiffness_limit)


def test_another_command_in_the_folder(bound: Scene, tmp_path: Path) -> None:
    """The same one, that ends while the first still has trials to do."""
    method = Method("euler", 1, 0.0)
    timestep = method.limit / EIGENVALUE / 2
    first, second = (trials_of(bound, tmp_path, 10 * timestep) for _ in range(2))
    assert first.eigenvalues(0.0) == second.eigenvalues(0.0)
    assert first.problem(method, timestep) == second.problem(method, timestep) == ""
    second.close()
    assert first.problem(method, timestep) == ""
    first.close()
    assert not list(tmp_path.glob("run-*"))


@pytest.mark.parametrize(
    "method", [Method("euler", 1, 0.0), Method("rkl1", 3, 0.0), Method("rkl2", 5, 0.0)]
)
def test_limit_of_one_spring(bound: Scene, tmp_path: Path, method: Method) -> None:
    """What is found is what theory says, and the estimate equals it."""
    theory = method.limit / EIGENVALUE
    with_many_steps = trials_of(bound, tmp_path, 60 * theory)
    (eigenvalue, _) = with_many_steps.eigenvalues(0.0)
    assert eigenvalue == pytest.approx(EIGENVALUE, rel=1e-4)
    limit = with_many_steps.limit(method, 0.02)
    assert limit.monotone
    assert limit.timestep == pytest.approx(theory, rel=0.05)
    assert limit.unstable.timestep <= 1.02 * limit.timestep


def test_reach_of_methods() -> None:
    """Stability polynomials are at most 1 in absolute value up to it, and not beyond.

    Forward Euler 1 + z; rkl1 P_s(1 + z / r), r = (s^2 + s) / 2; rkl2 1 - b + b P_s(1 + w z),
    w = 4 / (s^2 + s - 2), b = (s^2 + s - 2) / (2 s (s + 1)); P_s are Legendre polynomials.
    """
    for s in (3, 7, 12):
        legendre = np.polynomial.Legendre.basis(s)
        w = 4 / (s * s + s - 2)
        b = 1 / w * 2 / (s * s + s)
        polynomials = {
            "euler": lambda z: 1 + z,
            "rkl1": lambda z, p=legendre, s=s: p(1 + 2 * z / (s * s + s)),
            "rkl2": lambda z, p=legendre, w=w, b=b: 1 - b + b * p(1 + w * z),
        }
        for method in methods(s, 0.0):
            within = polynomials[method.integrator](np.linspace(-method.limit, 0, 1001))
            assert np.abs(within).max() <= 1 + 1e-12
            if method.integrator != "rkl2":
                beyond = polynomials[method.integrator](-1.01 * method.limit)
                assert abs(beyond) > 1


def rough(**changes: object) -> Scene:
    return Scene.from_dict(
        {
            "name": "rough", "dermis": {"present": False},
            "membrane": {"lattice": [12, 14], "noise": 0.1}, "cells": {"stem": 1},
            "numerics": {"accuracy": "reference", "integrator": "euler", "timestep": 1e-3,
                         "event_interval": 1.0, "largest_move": 0.0},
        }
    ).replace(**changes)  # fmt: skip


@pytest.mark.parametrize("limit", [8.0, pytest.param(0.0, marks=pytest.mark.slow)])
def test_largest_eigenvalue_is_that_of_the_whole_hessian(limit: float) -> None:
    """All second derivatives, column by column, with and without mobilities."""
    with Simulation.begin(rough(**{"numerics.stiffness_limit": limit})) as simulation:
        simulation.command("displace_atoms all random 0.02 0.02 0.02 5 units box")
        simulation.command("run 0 post no")
        begun = simulation.forces()
        mobility = mobilities(simulation) if limit else np.ones(len(begun.ids))
        found = largest_eigenvalue(simulation, mobility)
        np.testing.assert_allclose(simulation.forces().positions, begun.positions, atol=1e-12)
        columns = []
        for n in range(begun.positions.size):
            step = np.zeros(begun.positions.size)
            step[n] = 1e-6
            step = step.reshape(-1, 3)
            sides = []
            for sign in (-1, 1):
                simulation.move(begun.ids, begun.positions + sign * step)
                sides.append(simulation.forces().forces.ravel())
            columns.append((sides[0] - sides[1]) / 2e-6)
    hessian = np.array(columns)
    np.testing.assert_allclose(hessian, hessian.T, atol=1e-5)
    whole = np.linalg.eigvals(np.repeat(mobility, 3)[:, None] * hessian).real.max()
    assert found == pytest.approx(whole, rel=2e-3)
    assert (mobility.min() < 0.9) == (limit > 0)


def test_mobilities_are_those_of_a_run() -> None:
    """The number and the least of those that are below 1, as fix skin/motion counts them."""
    with Simulation.begin(rough(**{"numerics.stiffness_limit": 8.0})) as simulation:
        mobility = mobilities(simulation)
        motion = simulation.motion()
    lowered = mobility < 1 - 1e-9
    assert 0 < lowered.sum() < len(mobility)
    assert motion.steps == 1
    assert lowered.mean() == pytest.approx(motion.lowered)
    assert mobility.min() == pytest.approx(motion.lowest_mobility, rel=1e-6)


def test_limit_follows_stiffness(bound: Scene, tmp_path: Path) -> None:
    """Four times the stiffness of everything: a quarter of the timestep."""
    euler = Method("euler", 1, 0.0)
    found = []
    for factor in (1.0, 4.0):
        scene = scaled(bound, "stiffness", factor)
        assert scene.cells.membrane_exclusion_stiffness == factor * STIFFNESS / 6
        trials = trials_of(scene, tmp_path, 1.5 / factor)
        assert trials.eigenvalues(0.0)[0] == pytest.approx(factor * EIGENVALUE, rel=1e-3)
        found.append(trials.limit(euler, 0.05).timestep)
    assert found[0] / found[1] == pytest.approx(4, rel=0.06)


# ---- bisection


@pytest.mark.parametrize("guess", [1e-9, 0.01, 0.31, 0.3, 50.0])
def test_bisection(guess: float) -> None:
    tried: list[float] = []

    def problem(timestep: float) -> str:
        tried.append(timestep)
        return "too long" if timestep > 0.3 else ""

    limit = bisect(problem, guess, 1e-3, 10.0, 0.05)
    assert limit.timestep <= 0.3 < limit.unstable.timestep <= 1.05 * limit.timestep
    assert limit.monotone
    assert len(tried) == len(set(tried)) == len(limit.trials)
    assert min(tried) < limit.timestep and max(tried) > limit.unstable.timestep


def test_bisection_without_a_limit() -> None:
    always = bisect(lambda _: "", 1.0, 0.1, 5.0, 0.05)
    assert (always.timestep, always.unstable, always.monotone) == (5.0, None, True)
    never = bisect(lambda _: "bad", 1.0, 0.1, 5.0, 0.05)
    assert (never.timestep, never.unstable.timestep) == (0.0, 0.1)


def test_an_island_is_reported() -> None:
    """Stable again above the limit, or unstable below it: the shorter of both limits."""
    above = bisect(lambda t: "bad" if 1 < t < 1.4 else "", 0.6, 0.01, 100.0, 0.05)
    below = bisect(lambda t: "bad" if t > 1 or 0.6 < t < 0.7 else "", 1.0, 0.01, 100.0, 0.05)
    assert 0.9 < above.timestep < 1 and not above.monotone
    assert 0.5 < below.timestep < 0.6 and not below.monotone


# ---- what is scaled


def test_scaled() -> None:
    scene = Scene.from_dict({"cells": {"stem": 4, "nd": 1}, "numerics": {"accuracy": "fast"}})
    stiff = scaled(scene, "stiffness", 10)
    for part in ("dermis", "membrane", "cells"):
        before, after = (getattr(s, part).model_dump() for s in (scene, stiff))
        for key, value in before.items():
            factor = 10 if key.endswith("stiffness") else 1
            assert after[key] == (pytest.approx(factor * value) if factor > 1 else value)
    assert stiff.numerics == scene.numerics
    assert scaled(scene, "crowding", 0.5).cells.stem == 2
    adhesive = scaled(scene, "adhesion", 2).cells
    assert (adhesive.adhesion_stiffness, adhesive.binding_stiffness) == (10.0, 50.0)
    with pytest.raises(SceneError, match="is the same as x 1"):
        scaled(scene, "crowding", 0.9)
    own = scene.replace(**{"cells.kinds.own": {"like": "stem", "count": 2, "stiffness": 5.0}})
    for what, count, stiffness in (
        ("adhesion", 2, 10.0),
        ("crowding", 4, 5.0),
        ("stiffness", 2, 10),
    ):
        row = scaled(own, what, 2).cell_table["own"]
        assert (row.count, row.stiffness) == (count, stiffness)


# ---- the command

TINY = (
    "tiny.toml", "--set", "numerics.accuracy=reference", "--interval", 1, "--methods",
    "euler,rkl1-limit", "--tolerance", 0.2,
)  # fmt: skip


def test_command(skin, tmp_path):  # noqa: F811
    wanted = (*TINY, "--vary", "adhesion,crowding", "--factors", "1,3")
    answer = skin("stability", *wanted)
    assert answer.code == 0, answer.err
    with (tmp_path / "stability" / "tiny.csv").open() as file:
        rows = list(csv.DictReader(file))
    points = [(row["varied"], row["factor"], row["method"]) for row in rows]
    assert points == [
        (what, factor, method)
        for what in ("adhesion", "crowding") for factor in ("1", "3")
        for method in ("euler", "rkl1-limit")
    ]  # fmt: skip
    values = {
        point: float(row["eigenvalue_begin"]) for point, row in zip(points, rows, strict=True)
    }
    assert values["adhesion", "1", "euler"] == values["crowding", "1", "euler"]
    assert values["adhesion", "3", "euler"] > 2 * values["adhesion", "1", "euler"]
    for row in rows:
        assert 0 <= float(row["limit"]) < float(row["unstable"])
        reach = {"euler": 2, "rkl1-limit": 56}[row["method"]]
        assert float(row["estimate_end"]) == pytest.approx(
            reach / float(row["eigenvalue_end"]), rel=1e-5
        )
        assert bool(row["problem"]) == math.isfinite(float(row["unstable"]))
    page = (tmp_path / "stability" / "tiny.md").read_text()
    assert "| crowding | 3 | euler |" in page
    assert (tmp_path / "stability" / "tiny.png").read_bytes()[:4] == b"\x89PNG"

    kept = sorted((tmp_path / "stability" / "measured").iterdir())
    times = [path.stat().st_mtime_ns for path in kept]
    assert {path.suffix for path in kept} == {".json"}
    assert skin("stability", *wanted).code == 0
    assert sorted((tmp_path / "stability" / "measured").iterdir()) == kept
    assert [path.stat().st_mtime_ns for path in kept] == times


def test_command_goes_on(skin, tmp_path, monkeypatch):  # noqa: F811
    """After an interruption, with what is missing; from a run, whose state is the start."""
    arguments = ("--set", "output.checkpoint_interval=1.0", "-o", "run")
    assert skin("run", *TINY[:3], *arguments).code == 0
    wanted = (*TINY, "--from", "run", "--vary", "stretch,crowding", "--factors", "1,2")

    def interrupt(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(Trials, "limit", interrupt)
        answer = skin("stability", *wanted)
    assert answer.code == 130 and "the same command goes on" in answer.out
    answer = skin("stability", *wanted)
    assert answer.code == 0, answer.err
    assert "left out: crowding x 2: the state is given" in answer.out
    assert "Runs of 1 time units from run" in (tmp_path / "stability" / "tiny.md").read_text()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--vary", "colour"), "--vary colour: 'colour' must be one of stiffness, stretch"),
        (("--methods", "verlet"), "--methods verlet: 'verlet' must be one of euler, euler-limit"),
        (("--factors", "0"), "--factors 0: must be numbers above 0"),
        (("--factors", "1,x"), "--factors 1,x: must be numbers above 0"),
        (("--factors", "nan"), "--factors nan: must be numbers above 0"),
        (("--interval", "0"), "--interval 0: must be above 0"),
        (("--interval", "nan"), "--interval nan: must be above 0"),
        (("--tolerance", "0"), "--tolerance 0: must be above"),
        (("--from", "none"), "--from none: neither a restart file nor"),
        (("--vary", "crowding", "--factors", "1.1"), "nothing of it can be varied"),
        (("--vary", "crowding", "--factors", "99"), "nothing of it can be varied"),
        (("-o", "tiny.toml"), "tiny.toml"),
    ],
)
def test_refused(skin, tmp_path, options, message):  # noqa: F811
    answer = skin("stability", *TINY[:3], *options)
    assert answer.code == 2
    assert message in answer.err
    assert answer.err.startswith("error: ") and answer.err.count("\n") == 1
    assert not (tmp_path / "stability").exists()
