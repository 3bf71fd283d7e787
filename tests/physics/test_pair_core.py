"""pair_style skin/core: no force, and an error where particles are closer than their core."""

import re
from pathlib import Path

import pytest
from lammps_skin.engine.engine import open_lammps
from test_pair_styles import BOX

from tests.reliability.conftest import try_script

CORE, CONTACT, FIRST = 0.25, 1.2, 0.1
PAIR = f"""
    pair_style hybrid/overlay skin/core lj/cut 2.0
    pair_coeff * * lj/cut 0.1 1.0
    pair_coeff 1 2 skin/core {CORE} {CONTACT} {FIRST}
"""
EACH = " ".join(f"c_each[{n}]" for n in range(1, 7))


@pytest.mark.parametrize(("apart", "ends"), [(0.301, False), (0.299, True), (7.701, True)])
@pytest.mark.parametrize("ranks", [1, 2])
def test_closer_than_the_core(apart: float, ends: bool, ranks: int, tmp_path: Path) -> None:
    """Also across the periodic edge, where 8 - 7.701 is less than 0.3, and with more ranks.

    What ranks have said can be lost when MPI ends them.
    """
    begin = BOX.split("create_atoms")[0]
    script = f"""{begin}
        create_atoms 1 single 0.1 4 4
        create_atoms 2 single {0.1 + apart} 4 4
        mass * 1
        special_bonds lj/coul 0.0 1.0 1.0
        {PAIR}
        run 0
        print "set up"
        fix still all nve/noforce
        run 1
    """
    process = try_script(tmp_path, script, ranks=ranks)
    output = process.stdout
    error = (
        r"Pair skin/core: atoms (1 and 2 of types 1 and 2|2 and 1 of types 2 and 1) overlap on "
        r"step 1: their distance is 0\.299\d*, less than 0\.3; the state that this run began with"
    )
    assert "set up" in output or (ranks > 1 and ends)
    assert (process.returncode != 0) == ends
    if ranks == 1 or "ERROR" in output:
        assert bool(re.search(error, output)) == ends, output


def test_a_timestep_is_recommended_where_steps_led_to_it() -> None:
    """The particle comes nearer by 0.06 in each step, from a direction that is no axis."""
    engine = open_lammps(["-log", "none"])
    engine.commands_string(f"{BOX}{PAIR}\nset atom 2 x 3.24 y 4.192 z 4.256\ngroup one id 2")
    engine.commands_string("run 0 post no\ntimestep 1.0\nvelocity one set -.036 -.0288 -.0384")
    engine.commands_string("fix fly one nve/noforce")
    with pytest.raises(Exception, match=r"on step 2: .* is 0\.2[78].*; try a smaller timestep"):
        engine.command("run 3 post no")
    engine.close()


def test_the_first_state_may_overlap_more() -> None:
    """Down to its own core."""
    engine = open_lammps(["-log", "none"])
    engine.commands_string(f"{BOX}{PAIR}\nset atom 2 x 3.121\nrun 0 post no")
    with pytest.raises(Exception, match=r"overlap on step 0: .* is 0\.119\d*, less than 0\.12"):
        engine.commands_string("set atom 2 x 3.119\nrun 0 post no")
    engine.close()


def test_no_force_and_no_energy() -> None:
    """Nor stress of single atoms, between particles within the core."""
    stress = f"""
        compute each all stress/atom NULL pair
        compute total all reduce sum {EACH}
        thermo_style custom step pe pxx pyz c_total[*]
    """
    values = []
    for commands in (PAIR, PAIR.replace("skin/core lj", "lj").rsplit("\n", 2)[0]):
        engine = open_lammps(["-log", "none"])
        engine.commands_string(f"{BOX}\nset atom 2 x 3.2\n{commands}\n{stress}\nrun 0 post no")
        values.append([engine.get_thermo(name) for name in ("pe", "fmax", "pxx", "pyz")])
        values[-1] += engine.numpy.extract_compute("total", 0, 1).tolist()
        engine.close()
    assert values[0] == values[1]
    assert values[0][0] != 0 and values[0][4] != 0


def test_alone_and_with_itself() -> None:
    """As the only pair style; energies of pairs within the core are 0, too."""
    engine = open_lammps(["-log", "none"])
    engine.commands_string(f"{BOX}\npair_style skin/core\npair_coeff * * 0.9 1.0 0.0")
    engine.command("run 0 post no")
    assert engine.get_thermo("pe") == 0
    engine.commands_string("create_atoms 2 single 4.1 4.8 4\nfix still all nve/noforce")
    engine.command("run 0 post no")
    with pytest.raises(Exception, match="overlap on step 1"):
        engine.command("run 1 post no")
    engine.close()


@pytest.mark.parametrize(
    ("coefficients", "message"),
    [
        ("0.3 1.0", "skin/core needs 3 coefficients .* got 2"),
        ("1.0 1.0 0", "core = 1.0 must be a number > 0 and < 1"),
        ("0 1.0 0", "core = 0 must be a number > 0 and < 1"),
        ("0.3 0 0", "contact length = 0 must be a number > 0"),
        ("0.3 1.0 -1", "first core = -1 must be a number >= 0"),
    ],
)
def test_refused(coefficients: str, message: str, tmp_path: Path) -> None:
    output = try_script(
        tmp_path, f"{BOX}\npair_style skin/core\npair_coeff * * {coefficients}"
    ).stdout
    assert re.search(f"ERROR.*{message}", output), output


def test_coefficients_survive_a_restart_file(tmp_path: Path) -> None:
    engine = open_lammps(["-log", "none"])
    engine.commands_string(f"{BOX}\npair_style skin/core\npair_coeff * * {CORE} {CONTACT} {FIRST}")
    engine.commands_string(f"run 0\nwrite_restart {tmp_path}/state\nclear")
    engine.command(f"read_restart {tmp_path}/state")
    engine.commands_string("set atom 2 x 3.2\nfix still all nve/noforce")
    with pytest.raises(Exception, match=r"overlap .* is 0\.2\d*, less than 0\.3"):
        engine.command("run 1 post no")
    engine.close()
