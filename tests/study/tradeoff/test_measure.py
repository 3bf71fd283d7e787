"""Trajectories without events, their distances and orders, times, and what is kept."""

import numpy as np
import pytest
from lammps_skin.engine.engine import Motion
from lammps_skin.errors import SceneError
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.study.tradeoff.errors import distance, orders
from lammps_skin.study.tradeoff.grid import VARIATIONS, variants
from lammps_skin.study.tradeoff.measure import Measurements, _quiet
from lammps_skin.study.tradeoff.store import EndState


def euler(scene, *timesteps):
    """The reference and Euler with other timesteps."""
    more = [(f"euler-{timestep:g}", {"timestep": timestep}) for timestep in timesteps]
    return variants(scene, 1.0, "levels", more)[0][: 1 + len(more)]


def test_errors_fall_with_the_timestep(measurements, busy):
    found = euler(busy, 0.02, 0.04)
    finest = measurements.finest()
    assert finest.scene.numerics.integrator == "euler"
    assert finest.scene.numerics.timestep == 0.01 / 16
    truth = measurements.end_state(finest)
    assert distance(truth, truth, busy.box_sides) == (0, 0, 0)
    distances = {
        one.name: distance(measurements.end_state(one), truth, busy.box_sides) for one in found
    }
    with Simulation.begin(busy) as simulation:
        start = EndState(*simulation.forces()[::2], simulation.motion())
    moved = distance(start, truth, busy.box_sides)
    assert 0 < distances["reference"].rms < 1e-2 * moved.rms
    assert distances["reference"].rms < distances["euler-0.02"].rms < distances["euler-0.04"].rms
    assert all(apart.median < apart.rms < apart.largest for apart in distances.values())
    (order,) = orders(found, distances)
    assert order.names == ("reference", "euler-0.02", "euler-0.04")
    assert order.of_median == pytest.approx(1, abs=0.1)
    assert order.of_rms == pytest.approx(1, abs=0.2)


def test_trajectories_have_no_events_and_times_have(measurements, busy):
    (one,) = euler(busy)
    with Simulation.begin(busy) as simulation:
        start = simulation.forces().ids
        simulation.run(until=1.0)
        assert len(simulation.cells().ids) > 3
    reached = measurements.end_state(one)
    np.testing.assert_array_equal(reached.ids, start)
    assert reached.motion.evaluations == reached.motion.steps == 100
    measurements.time_group([one])
    timing = measurements.timing(one)
    assert timing.seconds > 0 and timing.ratio == 1 and timing.spread == 0 and not timing.problem


def test_what_was_measured_is_not_measured_again(measurements, busy, monkeypatch):
    one, other = euler(busy, 0.02)
    first = measurements.end_state(one)
    measurements.time_group([one])
    monkeypatch.setattr(Measurements, "_simulation", None)
    again = Measurements(busy, measurements.store.folder, interval=1.0)
    np.testing.assert_array_equal(again.end_state(one).positions, first.positions)
    assert again.end_state(one).motion == first.motion
    assert again.timing(one) == measurements.timing(one)
    assert again.timing_groups([one]) == []
    assert again.timing_groups([one, other]) == [[one, other]]
    longer = Measurements(busy, measurements.store.folder, interval=2.0)
    assert not longer.end_state_path(one).exists() and longer.timing_groups([one]) == [[one]]


def test_a_variant_that_fails_is_reported(measurements, busy):
    rough = busy.replace(**{"membrane.noise": 0.3})
    more = [("wild", {"timestep": 0.5, "largest_move": 0.0})]
    found, _ = variants(rough, 1.0, "levels", more)
    reference, wild = found[:2]
    measurements = Measurements(rough, measurements.store.folder, interval=1.0)
    measurements.time_group([reference, wild])
    assert "timestep" in measurements.timing(wild).problem
    assert not measurements.timing(reference).problem
    reached = measurements.end_state(wild)
    assert reached.problem
    assert np.isnan(distance(reached, measurements.end_state(reference), rough.box_sides).rms)


def test_distance_across_the_periodic_sides():
    motion = Motion(0, 0, 0, 0, 1, 0, 0)
    one = EndState(np.arange(3), np.array([[0.1, 0.2, 5], [3, 3, 5], [1, 2, 5]]), motion)
    two = EndState(np.arange(3), np.array([[9.9, 7.9, 5.1], [3, 3, 5], [1, 2, 5.1]]), motion)
    apart = distance(one, two, (10, 8, 100))
    assert apart.largest == pytest.approx(np.sqrt(0.2**2 + 0.3**2 + 0.1**2))
    assert apart.rms == pytest.approx(np.sqrt((0.2**2 + 0.3**2 + 2 * 0.1**2) / 3))
    assert apart.median == pytest.approx(0.1)


def test_from_a_run(busy, tmp_path):
    scene = busy.replace(**{"output.checkpoint_interval": 0.5})
    with Simulation.begin(scene, tmp_path / "run") as simulation:
        simulation.run(until=0.6)
        cells = len(simulation.cells().ids)
    measurements = Measurements(busy, tmp_path / "measured", tmp_path / "run", interval=1.0)
    (one,) = euler(busy)
    particles = np.prod(busy.membrane.lattice)
    assert 3 < len(measurements.end_state(one).ids) - particles <= cells

    other = busy.replace(**{"cells.stem": 4})
    with pytest.raises(SceneError, match="another scene: cells"):
        Measurements(other, tmp_path / "measured", tmp_path / "run")
    with pytest.raises(SceneError, match="neither a restart file nor a directory with one"):
        Measurements(busy, tmp_path / "measured", tmp_path)


def test_grid():
    scene = Scene.load("two-cells")
    found, left_out = variants(scene, 2.0)
    assert found[0].name == "reference" and not left_out
    assert len(found) == 3 + len(VARIATIONS)
    own = scene.replace(**{"numerics.timestep": 0.02, "output.dump_interval": 0.4})
    found, left_out = variants(own, 2.0)
    by_name = {one.name: one.scene.numerics for one in found}
    assert by_name["scene"].timestep == 0.02  # which the levels do not take over
    assert by_name["reference"].timestep == 0.01
    assert by_name["balanced"].timestep == by_name["fast"].timestep == 0.2  # for the dump
    assert any(reason.startswith("variant rkl1-1: output.dump_interval") for reason in left_out)


def test_steps_do_not_become_longer_without_output():
    """A level makes its steps fit between frames, of which measured runs have none."""
    scene = Scene.load("two-cells").replace(**{"end_time": 4.0, "output.dump_interval": 1.0})
    for one in variants(scene, 2.0, "levels")[0]:
        measured = _quiet(one.scene)
        assert measured.numerics == one.scene.numerics and not measured.output.dump_interval


def test_another_command_in_the_folder(measurements, busy):
    """The same one, that begins and ends while the first still runs: both leave their results."""
    other = Measurements(busy, measurements.store.folder, interval=1.0)
    (one,) = euler(busy)
    looks = []

    def meanwhile(*_):
        if not looks:
            looks.append(working(measurements))
            other.time_group([one])
            looks.append(working(measurements))

    measurements.time_group([one], meanwhile)
    assert looks[0] == looks[1] and len(looks[0]) == 1
    assert not measurements.timing(one).problem and not working(measurements)


def working(measurements):
    return list(measurements.store.folder.glob("run-*"))
