"""The trajectory in MDAnalysis is right in every frame, in whatever order they are read."""

import os
import pickle
import shutil

import MDAnalysis
import numpy as np
import pytest
from lammps_skin import open_trajectory
from lammps_skin.errors import DamagedError, SkinError
from lammps_skin.kinds import KINDS, is_cell
from lammps_skin.start import lattice
from lammps_skin.trajectory.frame import CELL_STATE
from lammps_skin.trajectory.readers import SkinParser
from lammps_skin.trajectory.writer import TrajectoryWriter

NONE = np.empty((0, 2), int)
ORDERS = {
    "forward": lambda n: range(n),
    "backward": lambda n: range(n - 1, -1, -1),
    "random": lambda n: np.random.default_rng(3).integers(0, n, 2 * n).tolist(),
}


SOURCES = {
    "converted": lambda run: run.directory / "skin.h5",
    "dump": lambda run: run.directory / "skin.dump",
    "driven": lambda run: run.driven / "skin.h5",
}


@pytest.fixture(params=SOURCES)
def universe(run, request):
    return open_trajectory(SOURCES[request.param](run))


@pytest.mark.parametrize("order", ORDERS)
def test_selections_are_right_in_every_frame(run, universe, order):
    cells = " ".join(kind.label for kind in KINDS if is_cell(kind))
    living = universe.select_atoms("alive 1", updating=True)
    any_cell = universe.select_atoms(f"alive 1 and type {cells}", updating=True)
    by_kind = {k: universe.select_atoms(f"alive 1 and type {int(k)}", updating=True) for k in KINDS}
    by_label = {k: universe.select_atoms(f"type {k.label}", updating=True) for k in KINDS}
    able = universe.select_atoms("divisions_left 1:100", updating=True)
    for n in ORDERS[order](len(run.frames)):
        universe.trajectory[n]
        particles, told = run.particles[n], run.cells[n]
        np.testing.assert_array_equal(living.ids, particles.ids)
        np.testing.assert_array_equal(any_cell.ids, told.ids)
        for kind, group in by_kind.items():
            np.testing.assert_array_equal(group.ids, particles.ids[particles.types == kind])
            assert by_label[kind] == group
        np.testing.assert_array_equal(able.ids, told.ids[told.divisions_left > 0])
        np.testing.assert_array_equal(living.positions, particles.positions.astype(np.float32))
        exact = universe.trajectory.ts.data["position"][living.ix]
        np.testing.assert_array_equal(exact, particles.positions)
        assert living.types.tolist() == [KINDS[number - 1].label for number in particles.types]
        for name in CELL_STATE:
            truth = getattr(told, name)
            np.testing.assert_array_equal(getattr(any_cell, name), truth, err_msg=name)


def test_what_does_not_live_is_nothing(run, universe):
    for n, frame in enumerate(run.frames):
        universe.trajectory[n]
        absent = universe.select_atoms("alive 0")
        assert len(absent) == len(universe.atoms) - len(frame.ids)
        assert set(absent.types) | set(absent.names) <= {"absent"}
        assert np.isnan(absent.positions).all() and np.isnan(absent.radii).all()
        assert (absent.divisions_left == -1).all() and np.isnan(absent.birth_time).all()


def test_times_box_and_bonds(run, universe):
    assert [ts.time for ts in universe.trajectory] == [frame.time for frame in run.frames]
    assert [ts.data["step"] for ts in universe.trajectory] == [f.step for f in run.frames]
    expected = np.array([*run.scene.box_sides, 90, 90, 90], np.float32)
    np.testing.assert_array_equal(universe.dimensions, expected)
    links, _ = lattice.links_and_hinges(run.scene.membrane.lattice)
    bonds = {tuple(sorted(bond)) for bond in universe.bonds.indices.tolist()}
    assert bonds == {tuple(sorted(link)) for link in links.tolist()}


OTHERS = {
    "opened": lambda universe: open_trajectory(universe.trajectory.filename),
    "copied": lambda universe: universe.copy(),
    "pickled": lambda universe: pickle.loads(pickle.dumps(universe)),
}


@pytest.mark.parametrize("way", OTHERS)
def test_two_universes_do_not_disturb_each_other(run, universe, way):
    universe.trajectory[5]
    other = OTHERS[way](universe)
    assert other.trajectory.frame == (0 if way == "opened" else 5)
    universe.trajectory[-1]
    other.trajectory[3]
    assert other.select_atoms("alive 1").ids.tolist() == run.frames[3].ids.tolist()
    assert universe.select_atoms("alive 1").ids.tolist() == run.frames[-1].ids.tolist()


def test_plain_reader_of_mdanalysis_opens_it(run):
    """Without the attributes, which are ours."""
    path = str(run.directory / "skin.h5")
    plain = MDAnalysis.Universe.empty(max(int(frame.ids.max()) for frame in run.frames))
    plain.load_new(path, format="H5MD", convert_units=False)
    assert len(plain.trajectory) == len(run.frames)
    for ts, frame in zip(plain.trajectory, run.frames, strict=True):
        places = ts.positions[frame.ids - 1]
        np.testing.assert_array_equal(places, frame.positions.astype(np.float32))


def test_the_readers_give_the_same(run):
    """Of the dump and of HDF5, all arrays in all frames."""
    universes = [open_trajectory(source(run)) for source in SOURCES.values()]
    for moments in zip(*(u.trajectory for u in universes), strict=True):
        first, *others = moments
        for other in others:
            assert first.data.keys() == other.data.keys()
            for name, values in first.data.items():
                np.testing.assert_array_equal(values, other.data[name], err_msg=name)
            np.testing.assert_array_equal(first.positions, other.positions)


def test_a_directory_is_opened_at_the_file_written_last(run, tmp_path):
    shutil.copytree(run.directory, tmp_path, dirs_exist_ok=True)
    for newer, older in (("skin.h5", "skin.dump"), ("skin.dump", "skin.h5")):
        os.utime(tmp_path / older, (1, 1))
        os.utime(tmp_path / newer, (2, 2))
        assert open_trajectory(tmp_path).trajectory.filename == str(tmp_path / newer)


def test_other_files_are_refused(tmp_path):
    (tmp_path / "skin.h5").write_text("nothing")
    with pytest.raises(DamagedError, match=r"skin\.h5: is no trajectory in HDF5"):
        open_trajectory(tmp_path / "skin.h5")
    with pytest.raises(SkinError, match=r"absent\.h5: No such file or directory"):
        open_trajectory(tmp_path / "absent.h5")


def test_a_run_goes_on_while_its_trajectory_is_opened(run, tmp_path, monkeypatch):
    """Cells are born between the looks at the atoms and at the frames."""
    shown, later = tmp_path / "a.h5", tmp_path / "b.h5"
    for path, frames in [(shown, run.frames[:1]), (later, run.frames)]:
        with TrajectoryWriter(path, run.scene, NONE, NONE) as writer:
            for frame in frames:
                writer.write(frame)
    parse = SkinParser.parse

    def slowly(self, **options):
        topology = parse(self, **options)
        if later.exists():
            later.replace(shown)
        return topology

    monkeypatch.setattr(SkinParser, "parse", slowly)
    universe = open_trajectory(shown)
    assert len(universe.trajectory) == len(run.frames)
    assert len(universe.atoms) == max(int(frame.ids.max()) for frame in run.frames)
    universe.trajectory.close()
