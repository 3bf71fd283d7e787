"""Papillae of sheets with known bumps, cells on tips, skewness."""

import numpy as np
import pytest
import scipy.stats
from lammps_skin.analysis.papillae import (
    at_least,
    blocks,
    find_papillae,
    on_tip,
    skewness,
    tip_fraction,
)
from lammps_skin.analysis.surface import height_field, smooth
from meshes import sheet

SHAPE = (100, 114)
SPACING = 0.5
BUMPS = [  # x, y, amplitude, standard deviation; the third and fourth lie across the edges
    (10.0, 12.0, 3.0, 1.5),
    (25.0, 15.0, 2.0, 2.0),
    (49.5, 30.0, 1.5, 1.2),
    (30.0, 0.3, 2.5, 1.0),
    (35.0, 38.0, 1.0, 2.0),
]
PLACES, AMPLITUDES, WIDTHS = (np.array(BUMPS)[:, part] for part in (slice(2), 2, 3))
HALF = 2 * np.sqrt(2 * np.log(2))  # full width of a Gaussian at half of its height


def bumpy(sign=1.0):
    """Height field of Gaussian bumps on a plain, and the box."""
    _, _, box = sheet(SHAPE, lambda x, y: 0 * x)

    def height(x, y):
        z = np.full(x.shape, 22.4)
        for bx, by, amplitude, width in BUMPS:
            dx, dy = x - bx, y - by
            dx, dy = dx - box[0] * np.round(dx / box[0]), dy - box[1] * np.round(dy / box[1])
            z += sign * amplitude * np.exp(-(dx**2 + dy**2) / (2 * width**2))
        return z

    positions, triangles, box = sheet(SHAPE, height)
    return height_field(positions, triangles, box, SPACING), box


def distances(box):
    away = PLACES[:, None] - PLACES
    return np.linalg.norm(away - box * np.round(away / box), axis=-1)


def test_known_bumps_are_recovered():
    height, box = bumpy()
    found = find_papillae(height, box, prominence=0.5)
    highest_first = np.argsort(-AMPLITUDES)
    np.testing.assert_allclose(found.height, AMPLITUDES[highest_first], rtol=0.05)
    np.testing.assert_allclose(found.tip[:, 2], 22.4 + AMPLITUDES[highest_first], rtol=0.005)
    away = found.tip[:, :2] - PLACES[highest_first]
    # half a step of the grid and half a link of the membrane
    assert np.abs(away - box * np.round(away / box)).max() <= SPACING
    np.testing.assert_allclose(found.width, HALF * WIDTHS[highest_first], rtol=0.05)
    apart = distances(box) + np.diag(np.full(5, np.inf))
    np.testing.assert_allclose(found.spacing, apart.min(axis=1)[highest_first], atol=SPACING)


def test_smoothing_lowers_and_widens_as_it_must():
    height, box = bumpy()
    length = 1.0
    found = find_papillae(smooth(height, box, length), box, prominence=0.5)
    wider = np.hypot(WIDTHS, length)
    expected = AMPLITUDES * (WIDTHS / wider) ** 2
    highest_first = np.argsort(-expected)
    np.testing.assert_allclose(found.height, expected[highest_first], rtol=0.03)
    np.testing.assert_allclose(found.width, HALF * wider[highest_first], rtol=0.05)


def test_prominence_is_the_threshold():
    height, box = bumpy()
    for prominence, number in [(0.9, 5), (1.2, 4), (1.7, 3), (2.2, 2), (2.7, 1), (3.2, 0)]:
        found = find_papillae(height, box, prominence)
        assert len(found.tip) == number
    assert np.isnan(find_papillae(height, box, 2.7).spacing).all()
    with pytest.raises(ValueError, match="prominence = 0"):
        find_papillae(height, box, 0)


@pytest.mark.parametrize("prominence", [1e-3, 0.5])  # the tails of dimples leave rises of 1e-4
def test_dimples_are_no_papillae(prominence):
    height, box = bumpy(sign=-1)
    assert not len(find_papillae(height, box, prominence).tip)
    assert not len(find_papillae(np.full((20, 20), 22.4), box, prominence).tip)


def test_a_side_peak_belongs_to_its_papilla():
    x = np.arange(40)
    profile = np.interp(x, [10, 20, 22, 24, 30], [0, 4, 3, 3.5, 0])
    height = np.multiply.outer(profile, np.interp(x, [10, 20, 30], [0, 1, 0]))
    box = (40.0, 60.0)
    one = find_papillae(height, box, prominence=1.0)
    assert one.height.tolist() == [4.0]
    assert one.half.tolist() == [2.0] and set(one.basin[height > 2]) == {0}
    assert one.width[0] == pytest.approx(2 * np.sqrt((height > 2).sum() * 1.5 / np.pi))
    two = find_papillae(height, box, prominence=0.5)
    assert two.height.tolist() == [4.0, 0.5]
    assert two.spacing.tolist() == [4.0, 4.0]
    beside = 6 * np.maximum(1 - np.hypot(*np.indices(height.shape) - 4.0) / 4, 0)
    both = find_papillae(height + beside, box, prominence=1.0)
    assert both.height.tolist() == [6.0, 4.0] and set(both.basin[height > 2]) == {1}


def test_moving_the_membrane_through_the_edge_moves_the_tips_along():
    height, box = bumpy()
    one = find_papillae(height, box, 0.5)
    other = find_papillae(np.roll(height, (13, 57), axis=(0, 1)), box, 0.5)
    moved = one.tip[:, :2] + np.array([13, 57]) * box / height.shape
    away = other.tip[:, :2] - moved
    np.testing.assert_allclose(away - box * np.round(away / box), 0, atol=1e-9)
    for before, after in zip(one[1:4], other[1:4], strict=True):
        np.testing.assert_allclose(after, before, rtol=1e-12)


def test_positions_on_tips():
    height, box = bumpy()
    papillae = find_papillae(height, box, 0.5)
    top = 22.4 + AMPLITUDES
    peaks = np.column_stack([PLACES, top])
    moved = peaks + np.array([3 * box[0], -box[1], 0])
    beside = peaks + np.column_stack([WIDTHS, 0 * WIDTHS, 0 * WIDTHS])
    assert on_tip(peaks, papillae, box).all()
    assert on_tip(moved, papillae, box).all()
    assert on_tip(beside, papillae, box).all()
    up, down = np.array([0, 0, 0.05]), np.array([0, 0, -0.05])
    half = peaks - np.column_stack([0 * PLACES, AMPLITUDES / 2])
    # the papillae end on a plain, to which they go down but for the overlap of two of them
    assert on_tip(half + 2 * up, papillae, box).all()
    assert not on_tip(half + 4 * down, papillae, box).any()


def test_nothing_is_on_a_tip_of_a_plain():
    _, _, box = sheet(SHAPE, lambda x, y: 0 * x)
    papillae = find_papillae(np.zeros((8, 8)), box, 0.5)
    assert not on_tip(np.array([[1.0, 2.0, 100.0]]), papillae, box).any()


def test_tip_fraction_against_dealt_cells():
    """Mean and spread of the difference, and its p-value, are those of labels that are dealt."""
    stem, others = np.arange(16) < 9, np.arange(200) < 60
    found = tip_fraction(stem, others)
    random, together = np.random.default_rng(3), np.concatenate([stem, others])
    dealt = np.array([random.permutation(together) for _ in range(20_000)])
    differences = dealt[:, :16].mean(axis=1) - dealt[:, 16:].mean(axis=1)
    assert found.fraction == 9 / 16
    assert found.expected == 0.3
    assert found.sd == pytest.approx(differences.std(), rel=0.03)
    assert found.z == (found.fraction - found.expected) / found.sd
    assert found.p_value == pytest.approx((differences >= 9 / 16 - 0.3 - 1e-9).mean(), rel=0.15)


@pytest.mark.parametrize(("stem", "others"), [(16, 18), (16, 16), (18, 16), (16, 500), (3, 4)])
def test_false_positives_of_tips(stem, others):
    """Where it does not matter who is chosen, p < 0.05 in no more than 5 % of cases."""
    random, trials = np.random.default_rng(stem + others), 500
    tips = random.random((trials, stem + others)) < 0.4
    p = [tip_fraction(one[:stem], one[stem:]).p_value for one in tips]
    assert np.mean(np.array(p) < 0.05) < 0.05 + 3 * np.sqrt(0.05 * 0.95 / trials)


@pytest.mark.filterwarnings("error")
def test_tip_fraction_at_its_limits():
    none, yes, no = np.zeros(0, bool), np.ones(4, bool), np.zeros(9, bool)
    apart = tip_fraction(yes, no)
    assert apart[:2] == (1, 0)
    assert apart.p_value == pytest.approx(1 / 715)  # ways to choose 4 of 13
    assert tip_fraction(np.zeros(4, bool), no).p_value == 1
    more = tip_fraction(yes, no[:3])
    assert more[:2] == (1, 0) and more.p_value == pytest.approx(1 / 35)
    assert np.isnan(tip_fraction(none, no)[2:]).all() and tip_fraction(none, no).expected == 0
    assert np.isnan(tip_fraction(yes, none)[1:]).all()
    one = tip_fraction(yes[:1], yes[:1])
    assert one[:3] == (1, 1, 0) and one.p_value == 1 and np.isnan(one.z)


def test_tail_of_the_hypergeometric_distribution():
    """For every number that can be found, also in a crowd."""
    for total, marked, drawn in ((1, 1, 1), (9, 0, 4), (9, 9, 4), (13, 5, 4), (2000, 300, 64)):
        for found in range(max(0, drawn + marked - total), min(drawn, marked) + 1):
            expected = scipy.stats.hypergeom.sf(found - 1, total, marked, drawn)
            assert at_least(found, drawn, marked, total) == pytest.approx(expected, rel=1e-9)


def test_skewness_has_the_sign_of_the_protuberances():
    outward, inward = (skewness(blocks(bumpy(sign)[0], 4)) for sign in (1, -1))
    assert outward.low > 0.5
    assert inward.high < -0.5
    assert outward.value == pytest.approx(-inward.value, rel=1e-9)
    assert skewness([bumpy()[0].ravel()]).value == pytest.approx(outward.value, rel=1e-9)


def test_skewness_is_that_of_all_heights():
    groups = [22.4 + np.random.default_rng(n).gamma(3, size=50 + n) for n in range(6)]
    found = skewness(groups)
    assert found.value == pytest.approx(scipy.stats.skew(np.concatenate(groups)), rel=1e-10)
    assert found.low < found.value < found.high
    narrower = skewness(groups, confidence=0.5)
    assert found.low < narrower.low < narrower.high < found.high


def test_interval_covers_the_truth_as_often_as_it_says():
    random = np.random.default_rng(1)
    truth, hits = scipy.stats.beta(2, 5).stats("s"), 0
    for _ in range(100):
        # the heights of a group are the same but for a little noise
        groups = random.beta(2, 5, (300, 1)) + random.normal(0, 1e-3, (300, 5))
        found = skewness(groups, confidence=0.8, resamples=300)
        hits += found.low < truth < found.high
    assert hits / 100 == pytest.approx(0.8, abs=3 * np.sqrt(0.8 * 0.2 / 100))


def test_interval_of_two_groups():
    # the groups drawn are the first twice, both, or the second twice
    random = np.random.default_rng(1)
    first, second = 20 + random.gamma(1, size=40), 25 - random.gamma(2, size=70)
    values = [
        scipy.stats.skew(np.concatenate(drawn)) for drawn in ([first], [second], [first, second])
    ]
    found = skewness([first, second], confidence=1.0)
    assert found == pytest.approx((values[2], min(values), max(values)), rel=1e-9)


@pytest.mark.filterwarnings("error")
def test_skewness_without_a_value():
    for flat in (np.full(9, 22.4), np.array([22.4, 22.4, np.nextafter(22.4, 23)])):
        assert np.isnan(skewness([flat, flat])).all()
    alone = skewness([np.array([0.0, 0.0, 1.0])])
    assert alone.value == pytest.approx(1 / np.sqrt(2))
    assert np.isnan([alone.low, alone.high]).all()


def test_blocks_are_the_parts_of_the_field():
    height = np.arange(60.0).reshape(6, 10)
    parts = blocks(height, 2)
    assert [len(part) for part in parts] == [15] * 4
    assert parts[1].tolist() == [5, 6, 7, 8, 9, 15, 16, 17, 18, 19, 25, 26, 27, 28, 29]
    assert sorted(np.concatenate(blocks(height, 4))) == list(range(60))
