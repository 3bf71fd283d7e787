"""The analyses of a trajectory against the pure functions, applied to what LAMMPS holds."""

import numpy as np
import pytest
from lammps_skin.analysis.coverage import coverage
from lammps_skin.analysis.curvature import curvature
from lammps_skin.analysis.geometry import nearest
from lammps_skin.analysis.lineage import founder_of, mixing, read_events
from lammps_skin.analysis.observables import COLUMNS, Observables
from lammps_skin.analysis.order import order
from lammps_skin.analysis.papillae import (
    TipFraction,
    blocks,
    find_papillae,
    on_tip,
    skewness,
    tip_fraction,
)
from lammps_skin.analysis.series import (
    CellCounts,
    CloneMixing,
    Coverage,
    HeightSkewness,
    HeightSpectrum,
    MembraneCurvature,
    OrderParameters,
    PapillaShapes,
    TipOccupancy,
)
from lammps_skin.analysis.spectrum import height_spectrum
from lammps_skin.analysis.surface import height_field, smooth
from lammps_skin.errors import SkinError
from lammps_skin.kinds import Kind
from lammps_skin.start import lattice
from lammps_skin.trajectory.universe import open_trajectory

R_C, REACH = 1.4, 1.2 * 2.4


@pytest.fixture(scope="module")
def universe(run):
    return open_trajectory(run.directory)


@pytest.fixture(scope="module")
def events(run):
    return read_events(run.directory / "events.csv")


@pytest.fixture(scope="module")
def moments(run):
    return moments_of(run)


def moments_of(run):
    """Membrane, its curvature, its height field; kinds, positions, curvature of cells."""
    triangles, box = lattice.triangles(run.scene.membrane.lattice), run.scene.box_sides[:2]
    found = []
    for particles, cells in zip(run.particles, run.cells, strict=True):
        membrane = particles.positions[particles.types == Kind.MEMBRANE]
        bent = curvature(membrane, triangles, box)
        height = height_field(membrane, triangles, box, 0.5)
        below, _ = nearest(cells.positions, membrane, box)
        found.append((membrane, bent, height, cells, below, box))
    return found


def test_the_run_has_what_is_to_be_seen(run, events):
    assert len(events.of("birth").id) > 50 and len(events.of("death").id) > 5
    assert {int(kind) for kind in run.cells[-1].types} == {3, 4, 5, 6}


def test_curvature(run, universe, moments):
    found = MembraneCurvature(universe).run().results
    assert found.mean.shape == found.gaussian.shape == found.area.shape == (9, 40 * 46)
    np.testing.assert_allclose(found.time, np.arange(9) * 2.0)
    for n, (_, bent, *_) in enumerate(moments):
        np.testing.assert_allclose(found.mean[n], bent.mean, rtol=1e-9, atol=1e-11)
        np.testing.assert_allclose(found.gaussian[n], bent.gaussian, rtol=1e-9, atol=1e-11)
        np.testing.assert_allclose(found.area[n], bent.area, rtol=1e-11)
        assert abs((found.area[n] * found.gaussian[n]).sum()) < 1e-10


@pytest.mark.parametrize("of", [Kind.STEM, Kind.ND])
def test_order_parameters(universe, moments, of):
    found = OrderParameters(universe, of).run().results
    for n, (_, bent, _, cells, below, box) in enumerate(moments):
        expected = order(
            cells.types, cells.positions, bent.mean[below], bent.gaussian[below], box, R_C, of
        )
        for name, value in expected._asdict().items():
            assert found[name][n] == pytest.approx(value, rel=1e-9, abs=1e-11), (n, name)


def test_coverage_and_counts(universe, moments):
    covered = Coverage(universe).run().results.fraction
    counts = CellCounts(universe).run().results
    for n, (membrane, _, _, cells, _, box) in enumerate(moments):
        assert covered[n] == coverage(membrane, cells.positions, box, REACH)
        for kind in (Kind.STEM, Kind.TA, Kind.EXHAUSTED, Kind.ND):
            assert counts[kind.label][n] == (cells.types == kind).sum()
    assert counts.ta[-1] > 10 > counts.ta[0]


def test_spectrum(universe, moments):
    found = HeightSpectrum(universe).run().results
    for n, (_, _, height, *_, box) in enumerate(moments):
        expected = height_spectrum(height, box)
        np.testing.assert_allclose(found.q[n], expected.q)
        np.testing.assert_allclose(found.power[n], expected.power, rtol=1e-9, atol=1e-25)
        np.testing.assert_array_equal(found.modes[n], expected.modes)


@pytest.mark.parametrize(("which", "number"), [("run", None), ("run_with_papillae", 2)])
def test_papillae_skewness_and_tips(request, which, number):
    """Of a membrane that is almost flat, and of one with two papillae in all frames."""
    run = request.getfixturevalue(which)
    universe, moments = open_trajectory(run.directory), moments_of(run)
    shapes, skew = PapillaShapes(universe).run().results, HeightSkewness(universe).run().results
    tips = TipOccupancy(universe).run().results
    for n, (membrane, _, height, cells, below, box) in enumerate(moments):
        expected = find_papillae(smooth(height, box, R_C / 2), box, R_C / 2)
        assert shapes.number[n] == len(expected.height)
        for name in ("height", "width", "spacing"):
            values = getattr(expected, name)
            mean = values.mean() if len(values) else np.nan
            assert shapes[name][n] == pytest.approx(mean, rel=1e-9, nan_ok=True)
        value = skewness(blocks(height, 2), resamples=500)
        np.testing.assert_allclose([skew[k][n] for k in value._fields], value, rtol=1e-9)
        there = on_tip(membrane[below], expected, box)
        null = tip_fraction(there[cells.types == 3], there[np.isin(cells.types, [4, 5])])
        if not len(expected.height):
            null = TipFraction(*[np.nan] * 5)
        np.testing.assert_allclose([tips[k][n] for k in null._fields], null, rtol=1e-12)
        if number:
            assert shapes.number[n] == number and shapes.height[n] > 2
            assert 0 < null.fraction < 1
    if number:
        assert shapes.height[0] > 3.5 and 0 < tips.expected[-1] < 1 and 0 < tips.p_value[-1] <= 1


def test_mixing(universe, moments, events):
    found = CloneMixing(universe, events).run().results.mixing
    for n, (*_, cells, _, box) in enumerate(moments):
        clones = founder_of(cells.ids, events)
        expected = mixing(cells.positions, clones, box, 1.2 * 2 * R_C)
        assert found[n] == pytest.approx(expected, nan_ok=True)
    assert 0 < found[-1] < 1


def test_the_table_has_it_all(universe, events):
    found = Observables(universe, events).run().results.table
    assert found.dtype.names == COLUMNS and found.shape == (9,)
    counts, order_nd = (
        kind.run().results for kind in (CellCounts(universe), OrderParameters(universe, Kind.ND))
    )
    shapes, tips = PapillaShapes(universe).run().results, TipOccupancy(universe).run().results
    same = {
        "time": counts.time, "ta": counts.ta, "nd": counts.nd, "papillae": shapes.number,
        "papilla_spacing": shapes.spacing, "stem_on_tips": tips.fraction,
        "stem_tips_p": tips.p_value, "chi_H_nd": order_nd.chi_H, "sigma_nd": order_nd.sigma,
        "coverage": Coverage(universe).run().results.fraction,
        "skewness_low": HeightSkewness(universe).run().results.low,
    }  # fmt: skip
    for name, values in same.items():
        np.testing.assert_allclose(found[name], values, rtol=1e-12, err_msg=name)
    cells = sum(found[name] for name in ("stem", "ta", "exhausted", "nd"))
    unexplained = np.abs(cells - (5 + found["births"] - found["deaths"]))
    # logged with times up to the frame's, but carried out on the event step after it
    late = [((events.time > t - 0.2) & (events.time <= t)).sum() for t in found["time"]]
    assert (unexplained <= late).all() and min(late) == 0
    assert found["births"].tolist() == [(events.of("birth").time <= t).sum() for t in found["time"]]
    without = Observables(universe).run().results.table
    assert np.isnan(without["births"]).all() and np.isnan(without["deaths"]).all()


def test_some_of_the_frames(universe):
    whole = Observables(universe).run().results
    some = Observables(universe).run(start=3, stop=8, step=2).results
    for name in ("time", "zeta", "coverage"):
        np.testing.assert_array_equal(some[name], whole[name][3:8:2])


def test_other_universes_are_refused():
    import MDAnalysis

    universe = MDAnalysis.Universe.empty(3, trajectory=True)
    with pytest.raises(SkinError, match="open_trajectory"):
        Coverage(universe)
