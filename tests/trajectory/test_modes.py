"""Attributes follow the frames in every way in which MDAnalysis can be used."""

from __future__ import annotations

import json
import pickle
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import h5py
import MDAnalysis
import numpy as np
import pytest
from lammps_skin import open_trajectory
from lammps_skin.analysis.series import CellCounts
from lammps_skin.errors import SkinError
from lammps_skin.kinds import KINDS, Kind, is_cell
from lammps_skin.trajectory.clones import clones
from lammps_skin.trajectory.store import Store
from MDAnalysis.analysis.align import AlignTraj
from MDAnalysis.analysis.base import AnalysisFromFunction
from MDAnalysis.analysis.rms import RMSD
from MDAnalysis.transformations import translate
from scipy.spatial.transform import Rotation

from tests.trajectory.conftest import FRAMES, INTERVAL

HOWS = {
    "ours": open_trajectory,
    "plain": lambda path: MDAnalysis.Universe(str(path)),
    "no guess": lambda path: MDAnalysis.Universe(path, to_guess=()),
}
NAMES = ("skin.h5", "skin.dump")


@pytest.fixture(params=NAMES)
def path(run, request) -> Path:
    return run.directory / request.param


@pytest.fixture
def universe(path):
    return open_trajectory(path)


def counts(universe) -> list[tuple[float, ...]]:
    """Time, and the number of particles of each kind, in every frame."""
    groups = [universe.select_atoms(f"type {kind.label}", updating=True) for kind in KINDS]
    return [(float(ts.time), *map(len, groups)) for ts in universe.trajectory]


def expected(run, frames: slice = slice(None)) -> list[tuple[float, ...]]:
    return [
        (frame.time, *(int((frame.kinds == kind).sum()) for kind in KINDS))
        for frame in run.frames[frames]
    ]


# ---- opening


@pytest.mark.parametrize("how", HOWS)
def test_a_universe_follows_its_frames_however_it_was_made(run, path, how):
    universe = HOWS[how](path)
    assert counts(universe) == expected(run)
    assert counts(universe.copy()) == expected(run)
    assert counts(pickle.loads(pickle.dumps(universe))) == expected(run)


def test_files_are_known_by_their_contents(run, tmp_path):
    """Other names; and other files of the same names' endings are left to MDAnalysis."""
    for name in ("moved.h5", "moved.h5md"):
        shutil.copy(run.directory / "skin.h5", tmp_path / name)
        assert counts(MDAnalysis.Universe(tmp_path / name)) == expected(run)
    other = tmp_path / "other.h5md"
    with h5py.File(other, "w") as file:
        position = file.create_group("particles/trajectory/position")
        position["value"], position["step"] = np.ones((2, 5, 3)), [0, 1]
        position["time"] = [0.0, 1.0]
        file.create_group("particles/trajectory/box").attrs["dimension"] = 3
    plain = MDAnalysis.Universe.empty(5)
    plain.load_new(str(other), convert_units=False)
    assert type(plain.trajectory).__name__ == "H5MDReader"
    assert type(plain) is MDAnalysis.Universe
    with pytest.raises(ValueError, match="valid topology format"):
        MDAnalysis.Universe(str(shutil.copy(other, tmp_path / "other.h5")))


def test_reader_of_h5md_opens_it(run):
    """Without what ours knows of the atoms; a question for it is answered in one line."""
    path = str(run.directory / "skin.h5")
    bare = MDAnalysis.Universe(path, topology_format="MINIMAL", format="H5MD", convert_units=False)
    assert type(bare.trajectory).__name__ == "H5MDReader"
    for ts, frame in zip(bare.trajectory, run.frames, strict=True):
        places = ts.positions[frame.ids - 1]
        np.testing.assert_array_equal(places, frame.positions.astype(np.float32))
    mixed = MDAnalysis.Universe(path, path, format="H5MD", convert_units=False, to_guess=())
    with pytest.raises(SkinError, match=r"types: change from frame to frame, and .*skin\.h5 does"):
        _ = mixed.atoms.types


# ---- times


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_distance_of_frames(run, universe, tmp_path):
    assert universe.trajectory.dt == pytest.approx(INTERVAL, rel=1e-12)
    assert universe.trajectory.totaltime == pytest.approx((FRAMES - 1) * INTERVAL, rel=1e-12)
    membrane = universe.select_atoms("type membrane")
    distance = universe.trajectory.dt
    membrane.write(str(tmp_path / "given.dcd"), frames="all", dt=distance)
    membrane.write(str(tmp_path / "own.xtc"), frames="all")
    with universe.trajectory.Writer(tmp_path / "writer.dcd", len(membrane)) as writer:
        for _ in universe.trajectory:
            writer.write(membrane)
    for name in ("given.dcd", "own.xtc", "writer.dcd"):
        written = MDAnalysis.Universe.empty(len(membrane)).load_new(str(tmp_path / name))
        assert written.trajectory.dt == pytest.approx(INTERVAL, rel=1e-5)
        for ts, frame in zip(written.trajectory, run.frames, strict=True):
            assert ts.time == pytest.approx(frame.time, rel=1e-5)
            places = frame.positions[frame.kinds == Kind.MEMBRANE]
            np.testing.assert_allclose(ts.positions, places, atol=1e-2)


def test_uneven_frames_are_told(run, tmp_path):
    path = tmp_path / "skin.h5"
    shutil.copy(run.directory / "skin.h5", path)
    with h5py.File(path, "r+") as file:
        file["particles/trajectory/position/time"][-1] += 2.0
    with pytest.warns(UserWarning, match=r"frames are 0\.5 to 2\.5 apart; dt = .* is the mean"):
        universe = open_trajectory(path)
    total = (FRAMES - 1) * INTERVAL + 2
    assert universe.trajectory.totaltime == pytest.approx(total)
    universe.trajectory[-1]
    assert universe.trajectory.time == pytest.approx(total)


# ---- in memory


@pytest.mark.parametrize(
    ("how", "frames"),
    [*((how, (None, None, None)) for how in HOWS),
     *(("ours", frames) for frames in ((2, None, 2), (20, 3, -5), (4, 9, None)))],
)  # fmt: skip
def test_in_memory(run, path, how, frames):
    universe = HOWS[how](path)
    universe.transfer_to_memory(*frames)
    told = expected(run, slice(*frames))
    for one in (universe, universe.copy(), pickle.loads(pickle.dumps(universe))):
        assert counts(one) == told
        one.trajectory[-1]
        assert one.trajectory.time == told[-1][0]
    step = INTERVAL * (frames[2] or 1)
    assert universe.trajectory.dt == pytest.approx(step)
    universe.trajectory[0]
    before = universe.atoms.positions[0] + np.array([1, 2, 3])
    universe.atoms[:1].translate([1, 2, 3])
    universe.trajectory[1]
    universe.trajectory[0]
    np.testing.assert_allclose(universe.atoms.positions[0], before, rtol=1e-5)
    with pytest.raises(SkinError, match="there are none of"):
        HOWS[how](path).transfer_to_memory(5, 5)


def test_boxes_in_memory(run, tmp_path):
    """Each frame keeps its own."""
    path = tmp_path / "skin.h5"
    shutil.copy(run.directory / "skin.h5", path)
    heights = 40.0 + np.arange(FRAMES)
    with h5py.File(path, "r+") as file:
        file["particles/trajectory/box/edges/value"][:, 2] = heights
    universe = open_trajectory(path)
    universe.transfer_to_memory()
    assert [ts.dimensions[2] for ts in universe.trajectory] == heights.tolist()


def test_in_memory_from_the_start(run, path):
    universe = MDAnalysis.Universe(str(path), in_memory=True)
    assert counts(universe) == expected(run)
    counted = CellCounts(universe).run().results.ta
    assert counted.tolist() == [row[Kind.TA] for row in expected(run)]


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_aligned_in_memory(run, universe):
    reference = universe.copy()
    AlignTraj(universe, reference, select="type membrane", in_memory=True).run()
    assert counts(universe) == expected(run)
    membrane = universe.select_atoms("type membrane")
    centre = reference.select_atoms("type membrane").center_of_mass()
    for _ in universe.trajectory:
        np.testing.assert_allclose(membrane.center_of_mass(), centre, atol=1e-3)


# ---- other processes, transformations


def living(group) -> tuple[int, int]:
    return len(group), int(group.ids.sum())


def test_other_processes(run, universe):
    group = universe.select_atoms("type ta", updating=True)
    found = AnalysisFromFunction(living, universe.trajectory, group).run(
        backend="multiprocessing", n_workers=2
    )
    assert [row[0] for row in found.results.timeseries] == [row[Kind.TA] for row in expected(run)]
    assert found.times.tolist() == [frame.time for frame in run.frames]
    counted = CellCounts(universe).run(backend="multiprocessing", n_workers=2).results
    assert counted.ta.tolist() == [row[Kind.TA] for row in expected(run)]


def test_transformations_can_be_added(run, universe):
    universe.trajectory.add_transformations(translate([1, 1, 1]))
    for one in (universe, universe.copy()):
        for ts, frame in zip(one.trajectory, run.frames, strict=True):
            moved = (frame.positions.astype(np.float32) + np.float32(1)).astype(np.float32)
            np.testing.assert_allclose(ts.positions[frame.ids - 1], moved, rtol=1e-6)
        assert counts(one) == expected(run)


@pytest.mark.parametrize("frames", [slice(None, None, -1), slice(3, 15, 4), [7, 2, 2, 11], [-1]])
def test_slices_and_lists_of_frames(run, universe, frames):
    cells = universe.select_atoms("type ta exhausted", updating=True)
    order = range(FRAMES)[frames] if isinstance(frames, slice) else frames
    found = [(ts.time, len(cells)) for ts in universe.trajectory[frames]]
    told = [expected(run)[n] for n in order]
    assert found == [(row[0], row[Kind.TA] + row[Kind.EXHAUSTED]) for row in told]


# ---- atoms


def test_names_masses_radii_and_clones(run, universe):
    scene = run.scene
    radii = {
        Kind.MEMBRANE: scene.membrane.radius,
        **{kind: scene.cells.radius for kind in KINDS if is_cell(kind)},
    }
    clone = clones(Store(run.driven / "skin.h5"))
    for ts, frame in zip(universe.trajectory, run.frames, strict=True):
        atoms = universe.atoms[frame.ids - 1]
        labels = [KINDS[number - 1].label for number in frame.kinds]
        assert atoms.names.tolist() == atoms.types.tolist() == labels
        np.testing.assert_array_equal(atoms.radii, [radii[n] for n in frame.kinds])
        assert (atoms.masses == 1).all() and atoms.total_mass() == len(frame.ids)
        centre = frame.positions.mean(axis=0)
        np.testing.assert_allclose(atoms.center_of_mass(), centre, rtol=1e-5)
        cells = is_cell(frame.kinds)
        np.testing.assert_array_equal(atoms.resids[cells], clone[frame.ids[cells] - 1])
        assert set(atoms.resnames[~cells]) == {"membrane"}
        assert set(atoms.resids[~cells]) == {frame.ids[~cells].min()}
        assert ts.frame == universe.trajectory.frame


def test_clones_are_those_of_the_event_log(run):
    """Every cell in a frame has the founder that its births say."""
    lines = (run.driven / "events.csv").read_text().splitlines()
    rows = [dict(zip(lines[0].split(","), line.split(","), strict=True)) for line in lines[1:]]
    founder = {int(n): int(n) for n in run.frames[0].ids}
    for row in rows:
        if row["kind"] == "birth":
            founder[int(row["id"])] = founder[int(row["parent"])]
    found = clones(Store(run.driven / "skin.h5"))
    seen = {int(n) for frame in run.frames for n in frame.ids[is_cell(frame.kinds)]}
    unseen = [n for n in seen if found[n - 1] not in founder.values()]
    assert not unseen and len(set(found[found > 0].tolist())) == 6
    assert all(found[n - 1] == founder[n] for n in seen)


def test_attributes_of_frames_cannot_be_set(universe):
    with pytest.raises(SkinError, match="types: are those of each frame and cannot be set"):
        universe.atoms.types = "C"
    merged = MDAnalysis.Merge(universe.select_atoms("type stem nd"))
    merged.atoms.types = "C"
    assert set(merged.atoms.types) == {"C"} and set(merged.atoms.names) == {"stem", "nd"}


@pytest.mark.parametrize("form", ["pdb", "gro", "xyz"])
@pytest.mark.filterwarnings("ignore::UserWarning")  # of what the format wants to know besides
def test_living_particles_can_be_written(run, universe, tmp_path, form):
    universe.trajectory[-1]
    cells = universe.select_atoms("type stem ta exhausted nd")
    cells.write(str(tmp_path / f"cells.{form}"))
    read = MDAnalysis.Universe(tmp_path / f"cells.{form}", to_guess=())
    digits = {"pdb": 1e-3, "gro": 1e-2, "xyz": 1e-4}[form]
    np.testing.assert_allclose(read.atoms.positions, cells.positions, atol=digits)
    assert [name[:4] for name in read.atoms.names] == [name[:4] for name in cells.names]
    if form != "xyz":
        np.testing.assert_array_equal(read.atoms.resids, cells.resids)


def test_rmsd_of_the_membrane(run, universe):
    """That of the best superposition, which MDAnalysis seeks with masses as weights."""
    found = RMSD(universe, select="type membrane", weights="mass").run().results.rmsd
    places = [frame.positions[frame.kinds == Kind.MEMBRANE] for frame in run.frames]
    first, *others = (one - one.mean(axis=0) for one in places)
    distances = [Rotation.align_vectors(first, other)[1] for other in others]
    np.testing.assert_allclose(found[1:, 2], np.array(distances) / len(first) ** 0.5, atol=1e-4)
    assert found[:, 1].tolist() == [frame.time for frame in run.frames]


def test_nothing_is_warned_of(run, path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        counts(MDAnalysis.Universe(str(path)))
        counts(open_trajectory(path))


def test_the_formats_are_registered_by_one_import(run):
    code = (
        "import json, sys\n"
        "from lammps_skin import open_trajectory\n"
        "import MDAnalysis\n"
        "u = MDAnalysis.Universe(sys.argv[1])\n"
        "print(json.dumps(u.select_atoms('type stem').ids.tolist()))"
    )
    command = [sys.executable, "-c", code, str(run.directory / "skin.h5")]
    ended = subprocess.run(command, capture_output=True, text=True, check=True)
    frame = run.frames[0]
    assert json.loads(ended.stdout) == frame.ids[frame.kinds == Kind.STEM].tolist()
