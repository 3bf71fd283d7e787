"""Clones, turnover and mixing on a small log written by hand."""

import csv

import numpy as np
import pytest
from lammps_skin.analysis.lineage import (
    Events,
    clone_sizes,
    founder_of,
    living,
    mixing,
    read_events,
    turnover,
)
from lammps_skin.errors import SkinError

# Founders 1, 2 and 3. 1 -> 4, 5; 4 -> 6; 6 -> 8; 2 -> 7; 3 has no child.
# As in a run, the births of one step stand after its other events.
LOG = """\
time,kind,id,parent,type,x,y,z,divisions_left,cause
10,birth,4,1,4,1.5,2.5,24.0,10,division
30,division_end,4,1,4,1,2,24,10,grown
40,birth,5,1,4,1,2,24,10,division
46.5,death,5,1,4,1,2,26,10,detached
46.5,division_end,5,1,4,1,2,26,10,partner_removed
46,birth,6,4,4,1,2,24,9,division
50,birth,7,2,4,1,2,24,10,division
60,birth,8,6,5,1,2,24,0,division
70,death,4,1,4,1,2,26,9,detached
80,death,8,6,5,1,2,26,0,detached
"""
FOUNDERS = np.array([3, 1, 2])


@pytest.fixture
def events():
    return Events.from_rows(csv.DictReader(LOG.splitlines()))


@pytest.fixture
def no_events():
    return Events.from_rows([])


def test_columns(events):
    assert events.time.tolist() == [10, 30, 40, 46, 46.5, 46.5, 50, 60, 70, 80]
    assert events.id.tolist() == [4, 4, 5, 6, 5, 5, 7, 8, 4, 8]
    assert events.position[0].tolist() == [1.5, 2.5, 24.0]
    births = events.of("birth")
    assert births.parent.tolist() == [1, 1, 4, 2, 6]
    assert births.type.tolist() == [4, 4, 4, 4, 5]
    assert births.divisions_left.tolist() == [10, 10, 9, 10, 0]
    assert events.of("division_end").cause.tolist() == ["grown", "partner_removed"]


def test_founders(events):
    ids = np.array([8, 7, 6, 5, 4, 3, 2, 1, 99, 8])
    before = ids.copy()
    assert founder_of(ids, events).tolist() == [1, 2, 1, 1, 1, 3, 2, 1, 99, 1]
    np.testing.assert_array_equal(ids, before)


def test_founders_of_long_lines():
    # 500 cells, each the child of a random earlier one
    random = np.random.default_rng(1)
    mother = {n: int(random.integers(1, n)) for n in range(11, 511)}
    rows = [
        {"time": str(random.random()), "kind": "birth", "id": str(n), "parent": str(m)}
        | dict.fromkeys(["type", "x", "y", "z", "divisions_left", "cause"], "0")
        for n, m in mother.items()
    ]

    def climb(n):
        return climb(mother[n]) if n in mother else n

    ids = np.arange(1, 511)
    found = founder_of(ids, Events.from_rows(rows))
    assert found.tolist() == [climb(n) for n in ids.tolist()]


def test_living(events):
    for time, ids in [
        (0, [1, 2, 3]),
        (10, [1, 2, 3, 4]),
        (46.2, [1, 2, 3, 4, 5, 6]),
        (46.5, [1, 2, 3, 4, 6]),
        (65, [1, 2, 3, 4, 6, 7, 8]),
        (100, [1, 2, 3, 6, 7]),
    ]:
        assert living(events, FOUNDERS, time).tolist() == ids


def test_clone_sizes(events):
    times = [100, 0, 9.9, 10, 46, 46.5, 65, 70]
    three, one, two = clone_sizes(events, FOUNDERS, times).T.tolist()
    assert one == [2, 1, 1, 2, 4, 3, 4, 3]
    assert two == [2, 1, 1, 1, 1, 1, 2, 2]
    assert three == [1] * 8


def test_clone_sizes_agree_with_the_living(events):
    for time in np.linspace(0, 90, 37):
        clones = founder_of(living(events, FOUNDERS, time), events)
        counted = [(clones == founder).sum() for founder in FOUNDERS]
        assert clone_sizes(events, FOUNDERS, [time])[0].tolist() == counted


def test_turnover(events):
    births, removals = turnover(events, FOUNDERS, [0, 40, 50, 80])
    assert births.tolist() == [[0, 1, 0], [0, 2, 0], [0, 1, 1]]
    assert removals.tolist() == [[0, 0, 0], [0, 1, 0], [0, 2, 0]]


def test_births_less_removals_is_growth(events):
    edges = [0, 15, 45, 46.25, 59, 75, 90]
    births, removals = turnover(events, FOUNDERS, edges)
    growth = np.diff(clone_sizes(events, FOUNDERS, edges), axis=0)
    np.testing.assert_array_equal(births - removals, growth)


def test_nothing_happens(no_events):
    assert founder_of(np.array([5, 6]), no_events).tolist() == [5, 6]
    assert clone_sizes(no_events, FOUNDERS, [0, 1]).tolist() == [[1, 1, 1]] * 2
    assert turnover(no_events, FOUNDERS, [0, 1]).births.tolist() == [[0, 0, 0]]
    assert living(no_events, FOUNDERS, 5.0).tolist() == [1, 2, 3]


@pytest.mark.parametrize(
    "line, message",
    [
        ("90,birth,8,1,4,1,2,24,10,division", "cell 8 is born twice"),
        ("90,birth,9,9,4,1,2,24,10,division", "cell 9 is older than its parent"),
        ("90,birth,9,10,4,1,2,24,10,division", "cell 9 is older than its parent"),
    ],
)
def test_impossible_logs(line, message):
    events = Events.from_rows(csv.DictReader((LOG + line).splitlines()))
    with pytest.raises(ValueError, match=message):
        founder_of(np.array([1]), events)


def test_an_unknown_founder_is_an_error(events):
    with pytest.raises(ValueError, match="the cell 2 has events but is not among them"):
        clone_sizes(events, np.array([1, 3]), [0.0])


BOX = (12.0, 12.0)


def square_lattice():
    """144 cells at distance 1, four neighbours each, across the edges too."""
    x, y = np.divmod(np.arange(144), 12)
    return np.column_stack([x, y, 0 * x]).astype(float)


def test_mixing_of_a_chessboard_and_of_halves():
    cells = square_lattice()
    x, y = np.divmod(np.arange(144), 12)
    expected = 1 - 2 * 72 * 71 / (144 * 143)
    assert mixing(cells, (x + y) % 2, BOX, 1.2) == pytest.approx(1 / expected)
    # two of twelve columns of bonds along x join the halves: 24 of 288 pairs
    assert mixing(cells, x // 6, BOX, 1.2) == pytest.approx(24 / 288 / expected)


def test_mixing_of_shuffled_clones_is_one():
    cells = square_lattice()
    random = np.random.default_rng(1)
    clones = np.repeat([1, 2, 7], [20, 40, 84])
    values = [mixing(cells, random.permutation(clones), BOX, 1.2) for _ in range(400)]
    assert np.mean(values) == pytest.approx(1, abs=4 * np.std(values) / 20)
    assert np.std(values) < 0.1


@pytest.mark.filterwarnings("error")
def test_mixing_without_a_value():
    cells = square_lattice()
    assert np.isnan(mixing(cells, np.ones(144, int), BOX, 1.2))
    assert np.isnan(mixing(cells, np.arange(144) % 2, BOX, 0.9))
    assert np.isnan(mixing(np.empty((0, 3)), np.empty(0, int), BOX, 1.2))
    relatives = np.array([[0, 0, 0], [0.5, 0, 0], [6, 6, 0], [6.5, 6, 0]])
    assert mixing(relatives, np.array([1, 1, 2, 2]), BOX, 1.2) == 0


def test_events_of_a_file(tmp_path, events):
    path = tmp_path / "events.csv"
    path.write_text(LOG)
    for one, other in zip(read_events(path), events, strict=True):
        np.testing.assert_array_equal(one, other)
    path.write_text(LOG.rstrip("\n"))  # the last line may go on
    assert len(read_events(path).time) == 9
    path.write_text(LOG.splitlines(keepends=True)[0])
    assert not len(read_events(path).time)


@pytest.mark.parametrize("text", ["", "time,kind\n1,birth\n", LOG + "soon,birth,9,1,4,1,2,3,0,\n"])
def test_what_is_no_event_log(tmp_path, text):
    path = tmp_path / "events.csv"
    path.write_text(text)
    with pytest.raises(SkinError, match=r"event log .*events.csv: is not the events.csv"):
        read_events(path)
    with pytest.raises(SkinError, match="No such file"):
        read_events(tmp_path / "other.csv")
