"""fix skin/motion beside other commands: what works as it should, and what is refused."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.engine.engine import open_lammps
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration

from tests.reliability.conftest import run_script, try_script

LINK = "0.04 2.0 1.25 0.25 1.0"
HYBRID = (
    "bond_style hybrid skin/stretch",
    "bond_coeff 1 skin/stretch 0.04 2.0 1.25 0.25 1.0",
    "dihedral_style hybrid skin/bend",
    "dihedral_coeff 1 skin/bend 0.5",
)
GAS = """
    units lj
    atom_style {style}
    boundary p p p
    newton on
    region box block 0 30 0 30 0 30
    create_box 1 box
    create_atoms 1 random {n} 123 box
    mass 1 1
    pair_style zero 1.0
    pair_coeff * *
    comm_modify vel yes
    neighbor 1.0 bin
    neigh_modify every 1 delay 0 check yes
    timestep 0.01
"""


def gas(commands: str, n: int = 50, style: str = "atomic") -> Any:
    engine = open_lammps(["-log", "none"])
    engine.commands_string(GAS.format(n=n, style=style) + commands)
    return engine


# ---- forces that are not the same when they are computed again

RANDOM = {
    "langevin": "fix f all langevin 1.0 1.0 1.0 4321",
    "variable": "variable v equal random(-1,1,77)\nfix f all addforce v_v 0 0",
    "variable of atoms, at times": (
        "variable v atom random(-1,1,77)\nfix f all addforce v_v 0 0 every 3"
    ),
    "pair style": "pair_style dpd 1.0 3.0 34387\npair_coeff * * 5.0 1.0",
}
SEVERAL = ("rkl1 stages 2", "rkl2 stages 5", "euler move 0.1")


@pytest.mark.parametrize("method", SEVERAL)
@pytest.mark.parametrize("name", RANDOM)
def test_random_forces_are_refused(name: str, method: str) -> None:
    engine = gas(f"{RANDOM[name]}\nfix motion all skin/motion {method}", n=5000)
    of = "pair forces" if name == "pair style" else "fix f of style"
    with pytest.raises(Exception, match=f"those of {of} .* use euler without move"):
        engine.command("run 5 post no")
    engine.close()


def test_diffusion_of_plain_euler() -> None:
    """<r^2> = 6 D t, with what 2,000 particles and 100 steps leave to chance."""
    engine = gas(f"{RANDOM['langevin']}\nfix motion all skin/motion euler", n=2000)
    engine.commands_string("compute msd all msd\nrun 100 post no")
    msd = engine.extract_compute("msd", 0, 1)[3]
    engine.close()
    assert msd / 6 == pytest.approx(1.0, abs=5 * np.sqrt(2 / (3 * 2000)))


FIXED = {
    "spring/self": "fix f all spring/self 1.0",
    "setforce": "fix f all setforce 0.3 0 0",
    "addforce of places": "variable v atom -x\nfix f all addforce v_v 0 0",
    "wall": "change_box all boundary p p f\nfix f all wall/harmonic zlo -1.0 5.0 0.0 20.0",
    "drag": "fix f all drag 1 2 3 0.1 0.5",
    "store/force": "fix f all store/force",
}


@pytest.mark.parametrize("name", FIXED)
def test_forces_that_are_the_same_are_not(name: str) -> None:
    engine = gas(f"{FIXED[name]}\nfix motion all skin/motion rkl2 stages 5 move 5.0")
    engine.command("run 3 post no")
    engine.close()


def test_other_fixes_have_their_forces_at_each_stage() -> None:
    """A spring to the place where a particle was, which a constant force pulls away."""
    engine = gas("fix f all spring/self 2.0\nfix g all addforce 1.0 0 0", n=1)
    engine.commands_string("fix motion all skin/motion rkl2 stages 5\ntimestep 0.05")
    start = engine.numpy.extract_atom("x")[0, 0]
    engine.command("run 20 post no")
    moved = engine.numpy.extract_atom("x")[0, 0] - start
    engine.close()
    assert moved == pytest.approx(0.5 * (1 - np.exp(-2.0)), rel=5e-4)


# ---- two of them, respa


@pytest.mark.parametrize("second", [*SEVERAL, "euler"])
def test_two_are_refused(second: str) -> None:
    engine = gas("group half id 1:25\ngroup rest subtract all half\nfix one half skin/motion euler")
    engine.command(f"fix two rest skin/motion {second}")
    if second == "euler":
        engine.commands_string("fix f all addforce 1.0 0 0\nrun 3 post no")
    else:
        with pytest.raises(
            Exception, match="it must be the only one, for a group of all that move"
        ):
            engine.command("run 3 post no")
    engine.close()


def test_respa_is_refused() -> None:
    engine = gas("run_style respa 2 2\nfix motion all skin/motion euler", style="molecular")
    with pytest.raises(Exception, match="not work with run_style respa: use run_style verlet"):
        engine.command("run 1 post no")
    engine.close()


# ---- a membrane


def sheet(**changes: Any) -> tuple[Scene, Configuration]:
    scene = Scene.load("bare-membrane").replace(
        **{
            "parameters": "printed", "membrane.lattice": [24, 28], "membrane.noise": 0.1,
            "output.dump_interval": 0.0, "numerics.accuracy": "balanced",
            "numerics.rounding": 0.0, **changes,
        }
    )  # fmt: skip
    return scene, Configuration.from_scene(scene)


def moved(*commands: str, time: float = 2.0, ranks: int = 1, **changes: Any) -> np.ndarray:
    """Where the particles of the sheet are after some time."""
    scene, configuration = sheet(**changes)
    with Simulation.begin(scene, configuration=configuration, ranks=ranks) as simulation:
        for command in commands:
            simulation.command(command)
        simulation.run(until=time)
        positions: np.ndarray = simulation.forces().positions
    assert np.abs(positions - configuration.positions).max() > 0.01
    return positions


@pytest.mark.parametrize("ranks", [1, 2])
def test_hybrid_bonds_and_dihedrals(ranks: int) -> None:
    """Also where `stiffness` asks for them, as most particles are slower here."""
    stiff = {"numerics.stiffness_limit": 5.0}
    plain = moved(**stiff)
    np.testing.assert_allclose(moved(*HYBRID, ranks=ranks, **stiff), plain, rtol=0, atol=1e-11)
    assert np.abs(plain - moved()).max() > 1e-4


def test_pairs_that_are_not_computed() -> None:
    """pair_modify compute no is as a pair style that exerts no forces."""
    strong = "pair_coeff 1 1 skin/lj 0.01 1.2 1.0"
    none = moved(strong, "pair_modify compute no")
    weak = moved("pair_coeff 1 1 skin/lj 0.0 0.5 1.0")
    np.testing.assert_allclose(none, weak, rtol=0, atol=1e-12)
    assert np.abs(moved(strong) - weak).max() > 1e-3


def test_a_tilt_by_a_whole_period() -> None:
    """The same periodic membrane in a triclinic box: forces, motion, and rounding."""
    tilt = ("box tilt large", "change_box all triclinic xy final 12.0")
    plain, tilted = moved(), moved(*tilt)
    rounded = moved(*tilt, **{"numerics.rounding": 1e-3})
    for found in (tilted, rounded):
        found -= 12.0 * np.round((found - plain) / 12.0) * (1, 0, 0)
    np.testing.assert_allclose(tilted, plain, rtol=0, atol=1e-11)
    assert 1e-4 < np.abs(rounded - plain).max() < 0.1


@pytest.mark.parametrize("how", ["reset_timestep 0", "displace_atoms all move 1.7 0.4 0.1"])
def test_what_happens_between_runs(how: str) -> None:
    """Lists are those of the run, though it begins on the step that the last one began on."""
    scene, configuration = sheet()
    ends = []
    for commands in ((), (how,)):
        with Simulation.begin(scene, configuration=configuration) as simulation:
            simulation.command("run 0")
            for command in commands:
                simulation.command(command)
            simulation.command("run 8")
            ends.append(simulation.forces().forces)
    scale = np.abs(ends[0]).max()
    np.testing.assert_allclose(ends[1], ends[0], rtol=0, atol=1e-9 * scale)


# ---- what is told


def told(directory: Path, commands: str, **changes: Any) -> str:
    scene, configuration = sheet(**changes)
    build(scene, directory, configuration)
    setup = (directory / "skin.in").read_text().rsplit("run ", 1)[0]
    return try_script(directory, f"{setup}\n{commands}").stdout


@pytest.mark.parametrize(("skin", "warns"), [(0.9, False), (0.02, True)])
def test_neighbor_lists_that_are_too_short(skin: float, warns: bool, tmp_path: Path) -> None:
    output = told(tmp_path, f"neighbor {skin} multi\nrun 8", **{"numerics.timestep": 0.25})
    warning = "further from where it had been listed than the neighbor skin allows"
    assert (warning in output) == warns
    assert f"instead of {skin} or a smaller timestep than" in output or not warns


TORN = "set atom 100 x 8.3\nrun 1"
TORN_LATER = "run 4\nset atom 100 x 8.3\nrun 1 pre no"
PULLED = "group one id 100\nfix pull one addforce 0 0 1e9\nrun 1"
DRAGGED = "group one id 100\nfix drag one move linear 0 0 50\nrun 400"
THROWN = "; the state that this run began with is like that"
SMALLER = "; try a smaller timestep than"


@pytest.mark.parametrize(
    ("commands", "recommended"),
    [(TORN, [THROWN]), (TORN_LATER, [THROWN]), (PULLED, [SMALLER]), (DRAGGED, [])],
    ids=["set", "set, no set-up", "force", "fix move"],
)
def test_a_timestep_where_it_is_the_cause(
    commands: str, recommended: list[str], tmp_path: Path
) -> None:
    output = told(tmp_path, commands, **{"numerics.largest_move": 0.0})
    error = next(line for line in output.splitlines() if "ERROR" in line)
    assert "link of atoms" in error
    assert [text for text in (THROWN, SMALLER) if text in error] == recommended


# ---- links that change


def test_links_of_another_style(tmp_path: Path) -> None:
    """In a hybrid style, links of `zero` are as those without stiffness; on 2 ranks, too."""
    ends = []
    none, ours = "bond_coeff 2 zero 1", "bond_coeff 1 skin/stretch {c}"
    for name, ranks, commands in (
        ("alone", 1, "bond_style skin/stretch\nbond_coeff 1 {c}\nbond_coeff 2 0.0 2 1.25 0.25 1"),
        ("hybrid", 1, f"bond_style hybrid skin/stretch zero\n{ours}\n{none}"),
        ("ranks", 2, f"bond_style hybrid zero skin/stretch\n{ours}\n{none}"),
    ):
        folder = tmp_path / name
        scene, configuration = sheet(**{"numerics.stiffness_limit": 5.0})
        build(scene, folder, configuration)
        data = (folder / "skin.data").read_text().replace("1 bond types", "2 bond types")
        (folder / "skin.data").write_text(data)
        script = (folder / "membrane.in").read_text()
        (folder / "membrane.in").write_text(
            re.sub(r"bond_style.*\nbond_coeff.*\n", commands.format(c=LINK) + "\n", script)
        )
        setup = (folder / "skin.in").read_text().rsplit("run ", 1)[0]
        run_script(
            folder,
            f"{setup}\ngroup far id > 500\nset group far bond 2\nrun 8\n"
            "write_dump all custom end id x y z modify sort id format float %.17g",
            ranks=ranks,
        )
        ends.append(np.loadtxt(folder / "end", skiprows=9)[:, 1:])
    for other in ends[1:]:
        np.testing.assert_allclose(other, ends[0], rtol=0, atol=1e-11)


CHANGES = (
    "fix change all bond/break 3 1 0.56",
    "delete_bonds all bond 1 remove",
)


@pytest.mark.parametrize("command", CHANGES)
def test_links_that_break(command: str) -> None:
    """Energies and forces at the end of a run are those of the links that are there then."""
    scene, configuration = sheet()
    with Simulation.begin(scene, configuration=configuration) as simulation:
        simulation.command("compute count all property/local btype")
        simulation.command("compute links all reduce sum c_count inputs local")
        before = simulation.energies()["stretch"]
        for line in (command, "run 8"):
            simulation.command(line)
        end = simulation.energies()["stretch"], simulation.forces().forces
        if "fix" in command:
            simulation.command("unfix change")
        simulation.command("run 0")
        again = simulation.energies()["stretch"], simulation.forces().forces
    assert abs(end[0] - before) > 0.1
    assert end[0] == pytest.approx(again[0], rel=1e-12, abs=1e-12)
    np.testing.assert_allclose(end[1], again[1], rtol=0, atol=1e-11 * np.abs(again[1]).max())


def test_coefficients_that_change_in_a_run() -> None:
    """fix adapt, against a run for each step with the coefficients of its beginning."""
    scene, configuration = sheet(**{"numerics.accuracy": "reference", "numerics.largest_move": 0.0})
    steps = 12
    with Simulation.begin(scene, configuration=configuration) as simulation:
        simulation.command("variable k equal 0.04*(1.0+0.2*step)")
        simulation.command("variable kb equal 0.5/(1.0+0.2*step)")
        simulation.command(
            "fix change all adapt 1 bond skin/stretch K 1 v_k dihedral skin/bend K 1 v_kb"
        )
        simulation.command(f"run {steps}")
        adapted = simulation.forces().positions
    with Simulation.begin(scene, configuration=configuration) as simulation:
        for step in range(steps):
            growth = 1 + 0.2 * step
            simulation.command(f"bond_coeff 1 {0.04 * growth:.17g} {LINK[5:]}")
            simulation.command(f"dihedral_coeff 1 {0.5 / growth:.17g}")
            simulation.command("run 1")
        given = simulation.forces().positions
    with Simulation.begin(scene, configuration=configuration) as simulation:
        simulation.command(f"run {steps}")
        constant = simulation.forces().positions
    box = np.array(configuration.box)[:2]
    for other in (given, constant):
        other[:, :2] -= box * np.round((other - adapted)[:, :2] / box)
    np.testing.assert_allclose(adapted, given, rtol=0, atol=1e-12)
    assert np.abs(adapted - constant).max() > 1e-4
