"""Which moves of single corners fix skin/motion calls inverted, on the ranks of mpirun.

Run as ``python watch.py MESH.npz OUT.json [hybrid]``: positions, hinges, low and high corners of
the box, numbers of moved particles and their new places. OUT.json has the error of each move.
"""

import json
import sys

import numpy as np
from lammps_skin.engine.engine import open_lammps

SCRIPT = """
units lj
atom_style molecular
newton on
boundary {boundary}
comm_modify cutoff 1.3
special_bonds lj/coul 0 1 1
read_data {data}
pair_style zero 1.0
pair_coeff * *
neighbor 0.1 bin
timestep 2.1
fix hold all setforce 0 0 0
"""


def write_data(path: str, mesh: dict[str, np.ndarray], types: int) -> None:
    """A data file of the particles and of the hinges as dihedrals."""
    x, hinges = mesh["positions"], mesh["hinges"] + 1
    box = zip("xyz", mesh["low"], mesh["high"], strict=True)
    lines = ["mesh\n", f"{len(x)} atoms", f"{len(hinges)} dihedrals", "1 atom types"]
    lines += [f"{types} dihedral types", *(f"{a} {b} {d}lo {d}hi" for d, a, b in box)]
    lines += [
        "\nMasses\n\n1 1\n\nAtoms\n",
        *(f"{i} 0 1 {a} {b} {c}" for i, (a, b, c) in enumerate(x, 1)),
    ]
    lines += [
        "\nDihedrals\n",
        *(f"{i} {types} {a} {b} {c} {d}" for i, (a, b, c, d) in enumerate(hinges, 1)),
    ]
    with open(path, "w") as file:
        file.write("\n".join(lines) + "\n")


def main(mesh_file: str, out: str, *hybrid: str) -> None:
    """Run LAMMPS for one long step after each move, and put the particle back."""
    mesh = dict(np.load(mesh_file))
    engine = open_lammps(["-log", "none"])
    rank = engine.extract_setting("world_rank")
    data = f"{mesh_file}.data"
    if rank == 0:
        write_data(data, mesh, types=2 if hybrid else 1)
    engine.commands_string(SCRIPT.format(data=data, boundary=str(mesh["boundary"])))
    if hybrid:
        engine.commands_string(
            "dihedral_style hybrid harmonic skin/bend\n"
            "dihedral_coeff 1 harmonic 1.0 1 2\ndihedral_coeff 2 skin/bend 0.5"
        )
    else:
        engine.commands_string("dihedral_style skin/bend\ndihedral_coeff 1 0.5")

    errors = []
    for number, place in zip(mesh["moved"], mesh["places"], strict=True):
        engine.command("fix motion all skin/motion euler")
        one = f"set atom {number + 1} x {{:.17g}} y {{:.17g}} z {{:.17g}}"
        engine.command(one.format(*place))
        try:
            engine.command("run 1 post no")
            errors.append("")
        except Exception as error:
            errors.append(str(error))
        engine.command("unfix motion")
        engine.command(one.format(*mesh["positions"][number]))
    if rank == 0:
        with open(out, "w") as file:
            json.dump(errors, file)
    engine.finalize()


if __name__ == "__main__":
    main(*sys.argv[1:])
