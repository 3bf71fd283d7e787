"""Energies over time from a log: of a real run, and of a log written by hand."""

import numpy as np
import pytest
from lammps_skin.analysis.energies import read_energies
from lammps_skin.errors import SkinError

LOG = """\
thermo_style    custom step time atoms c_stretch f_wall f_cells[2] f_cells[4]
   Step          Time         Atoms      c_stretch f_wall f_cells[2]     f_cells[4]
         0  0      100  1.0 -2.5 0.25 16
       100  1      100  2.0 -1.5 1e-3 16
Loop time of 0.31 on 1 procs for 100 steps with 14358 atoms
       500 9 9 9 9 9 9
   Step          Time         Atoms      c_stretch f_wall f_cells[2]     f_cells[4]
       100  1      100  2.5 -1.5 1e-3 16
WARNING: something with as many words (file.cpp:1)
       200  2      101  4.0 -0.5 nan 16
       300  3      101  4.0 -0.5 0.0 1"""


def test_all_steps_once_as_they_were_last(tmp_path):
    path = tmp_path / "log.lammps"
    path.write_text(LOG)
    found = read_energies(path)
    assert list(found) == ["time", "stretch", "wall", "binding", "total"]
    assert found["time"].tolist() == [0, 1, 2]
    assert found["stretch"].tolist() == [1.0, 2.5, 4.0]
    np.testing.assert_allclose(found["total"], [-1.25, 1.001, np.nan])


def test_of_a_run(run):
    found = read_energies(run.directory / "log.lammps")
    for n, energies in enumerate(run.energies):
        (row,) = np.flatnonzero(found["time"] == 2.0 * n)
        for name, value in energies.items():
            logged = found[name][row] if name in found else 0.0  # of a term that is absent
            assert logged == pytest.approx(value, rel=1e-9), name
        assert found["total"][row] == pytest.approx(sum(energies.values()), rel=1e-8)


def test_what_is_no_log(tmp_path):
    with pytest.raises(SkinError, match=r"log .*log.lammps: No such file"):
        read_energies(tmp_path / "log.lammps")
    path = tmp_path / "empty"
    path.write_text("nothing\n")
    with pytest.raises(SkinError, match="holds no thermo output"):
        read_energies(path)
