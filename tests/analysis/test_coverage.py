"""Covered membrane and counts of cells."""

import numpy as np
import pytest
from lammps_skin.analysis.coverage import count_by_kind, coverage, covered
from lammps_skin.kinds import Kind
from meshes import sheet

CONTACT, LAMBDA = 2.4, 1.2
REACH = LAMBDA * CONTACT
DISC = CONTACT * np.sqrt(LAMBDA**2 - 1)


def flat_sheet():
    positions, _, box = sheet((48, 52), lambda x, y: 0 * x + 20.0)
    return positions, box


def test_no_cells_cover_nothing():
    membrane, box = flat_sheet()
    assert not covered(membrane, np.empty((0, 3)), box, REACH).any()


@pytest.mark.parametrize("place", [(12.0, 11.0), (0.0, 0.0), (23.9, 22.4)])
def test_one_cell_covers_a_disc_through_the_edges(place):
    membrane, box = flat_sheet()
    mask = covered(membrane, np.array([[*place, 20 + CONTACT]]), box, REACH)
    away = membrane[:, :2] - place
    away -= box * np.round(away / box)
    np.testing.assert_array_equal(mask, np.hypot(*away.T) <= DISC)
    # about pi DISC^2 of the box, to the width of the rim that particles resolve
    assert mask.mean() * np.prod(box) == pytest.approx(np.pi * DISC**2, rel=0.1)


def test_a_cell_covers_what_is_exactly_within_reach_beyond_an_edge():
    membrane, box = flat_sheet()
    particle, cell = membrane[:1], membrane[:1] + np.array([box[0] - REACH, 0, 0])
    assert covered(particle, cell, box, box[0] - cell[0, 0] + particle[0, 0]).all()
    assert not covered(particle, cell, box, REACH - 1e-6).any()


def test_cells_that_share_membrane_count_it_once():
    membrane, box = flat_sheet()
    cell = np.array([[5.0, 5.0, 20 + CONTACT]])
    one = coverage(membrane, cell, box, REACH)
    assert coverage(membrane, np.repeat(cell, 3, axis=0), box, REACH) == one
    assert coverage(
        membrane, np.vstack([cell, cell + np.array([12, 12, 0])]), box, REACH
    ) == pytest.approx(2 * one, rel=0.1)


def test_packed_monolayer_covers_everything_and_a_lifted_one_nothing():
    membrane, box = flat_sheet()
    x, y = np.divmod(np.arange(121), 11)
    cells = np.column_stack([x * box[0] / 11, y * box[1] / 11, 0 * x + 20 + CONTACT])
    assert coverage(membrane, cells, box, REACH) == 1
    lifted = cells + np.array([0, 0, REACH - CONTACT + 0.01])
    assert coverage(membrane, lifted, box, REACH) == 0


def test_by_area():
    membrane, box = flat_sheet()
    cells = np.array([[12.0, 11.0, 20 + CONTACT]])
    mask = covered(membrane, cells, box, REACH)
    area = np.where(mask, 3.0, 1.0)
    fraction = 3 * mask.sum() / (3 * mask.sum() + (~mask).sum())
    assert coverage(membrane, cells, box, REACH, area) == pytest.approx(fraction)
    assert coverage(membrane, cells, box, REACH) == mask.mean()


def test_counts():
    kinds = [Kind.STEM, Kind.TA, Kind.TA, Kind.MEMBRANE, Kind.DERMAL, Kind.EXHAUSTED, Kind.TA]
    expected = {Kind.STEM: 1, Kind.TA: 3, Kind.EXHAUSTED: 1, Kind.ND: 0}
    assert count_by_kind(np.array(kinds), [*expected]) == expected
    assert count_by_kind([], [*expected]) == dict.fromkeys(expected, 0)
    assert count_by_kind(kinds, [Kind.MEMBRANE]) == {Kind.MEMBRANE: 1}
