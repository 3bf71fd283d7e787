"""Colours of clones: alike ones are far apart."""

from __future__ import annotations

import numpy as np
from lammps_skin.analysis.geometry import minimum_image
from lammps_skin.figures.clone_colours import PALETTE, apart, clone_colours
from lammps_skin.figures.moments import read_moments
from lammps_skin.kinds import is_cell


def test_neighbours_differ_also_through_the_sides() -> None:
    """Of 100 clones on a lattice, equal colours are never nearer than two spacings."""
    places = np.array([(x, y) for x in range(10) for y in range(10)], float)
    numbers = apart(places, (10.0, 10.0))
    off = np.linalg.norm(minimum_image(places[:, None] - places, (10.0, 10.0)), axis=-1)
    alike = (numbers[:, None] == numbers) & (off > 0)
    assert len(set(numbers.tolist())) == len(PALETTE)
    assert off[alike].min() >= 2.0
    assert (apart(places[:1], (10.0, 10.0)), len(apart(places[:0], (10.0, 10.0)))) == (0, 0)


def test_colours_are_those_of_founders_at_all_times(run) -> None:
    """One that is not in the first frame has the colour of its id."""
    first, last = read_moments(run, [0.0, None])
    numbers = clone_colours(first.ids[is_cell(first.kinds)], first.frames)
    assert len(set(numbers.tolist())) == len(numbers)
    founders = last.founders[is_cell(last.kinds)]
    known = dict(zip(first.ids[is_cell(first.kinds)].tolist(), numbers.tolist(), strict=True))
    expected = [known[one] for one in founders.tolist()]
    assert clone_colours(founders, last.frames).tolist() == expected
    assert clone_colours(np.array([10**6 + 3]), last.frames) == [3]
