"""Colours of kinds, as people with colour blindness and printers without colours see them."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from lammps_skin.kinds import Kind

CELLS_AND_MEMBRANE = (Kind.MEMBRANE, Kind.STEM, Kind.TA, Kind.EXHAUSTED, Kind.ND)
# Machado, Oliveira and Fernandes (2009), of linear red, green and blue: nothing is left of a cone
BLINDNESS = {
    "none": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}  # fmt: skip
TO_XYZ = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]


def lab(colour, blindness="none"):
    """Lightness, red to green and yellow to blue of a colour (CIELAB, D65)."""
    colour = np.asarray(colour)
    linear = np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)
    seen = np.clip(np.asarray(BLINDNESS[blindness]) @ linear, 0, 1)
    x, y, z = np.cbrt(np.asarray(TO_XYZ) @ seen / [0.9505, 1.0, 1.089])
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def test_lightness_of_known_colours():
    assert lab((1, 1, 1)) == pytest.approx([100, 0, 0], abs=0.1)
    assert lab((1, 0, 0)) == pytest.approx([53.2, 80.1, 67.2], abs=0.2)


@pytest.mark.parametrize("pair", [*combinations(CELLS_AND_MEMBRANE, 2)], ids=str)
def test_kinds_are_told_apart(pair):
    """A difference of 2 can just be seen; lightness alone is what is left in grey."""
    for blindness in BLINDNESS:
        difference = np.subtract(*[lab(kind.colour, blindness) for kind in pair])
        assert np.linalg.norm(difference) > 15, blindness
    assert abs(lab(pair[0].colour)[0] - lab(pair[1].colour)[0]) > 10
