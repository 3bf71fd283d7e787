"""The continuum equation beside the fields of a run: its terms, its growth rates, its solution."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lammps_skin.arrays import Bools, Floats
from lammps_skin.errors import SkinError
from lammps_skin.study.continuum.equation import Continuum, wave_vectors
from lammps_skin.study.ranges import Window


class Fields(NamedTuple):
    """Height and pull of a run, on a grid, both smoothed.

    Attributes
    ----------
    time : (f,) array
    height, pull : (f, g_x, g_y) arrays
        Length; force per length, as `analysis.pressure.LateralPressure` gives them.
    sides : (2,) sequence
        Of the box.
    """

    time: Floats
    height: Floats
    pull: Floats
    sides: Sequence[float]

    def within(self, window: Window) -> Fields:
        """The frames of a window of time; raises `SkinError` if there are less than two."""
        inside = (self.time >= window.start) & (self.time <= window.end)
        if inside.sum() < 2:
            raise SkinError(f"window {window}: has {inside.sum()} frames, needs at least 2")
        return Fields(self.time[inside], self.height[inside], self.pull[inside], self.sides)

    def coarse(self, spacing: float) -> Fields:
        """On a grid with nodes so far apart, to the next even number, without shorter waves."""
        nodes = [2 * max(round(side / spacing / 2), 1) for side in self.sides]
        if any(few > many for few, many in zip(nodes, self.height.shape[1:], strict=True)):
            raise SkinError(f"spacing = {spacing:g}: is finer than the grid of the fields")
        height, pull = (_truncated(field, nodes) for field in (self.height, self.pull))
        return Fields(self.time, height, pull, self.sides)

    def pull_at(self, time: float) -> Floats:
        """Between frames linearly, before and after them that of the first and the last."""
        place = float(np.interp(time, self.time, np.arange(len(self.time))))
        first = min(int(place), len(self.time) - 2)
        share = place - first
        return np.asarray((1 - share) * self.pull[first] + share * self.pull[first + 1], float)


class Coefficients(NamedTuple):
    """Of what a run shows: tau dh/dt + R h = first x (-div(K grad h)) + second x (-laplace(K)).

    The equation of the continuum has first = 1, second = R_c. `explained` is the share of the
    mean square of the left side.
    """

    first: float
    second: float
    explained: float


def coefficients(
    fields: Fields, continuum: Continuum, interval: float, band: tuple[float, float],
    earlier: int = 0,
) -> Coefficients:  # fmt: skip
    """Least squares over the waves of a band and over all frames, or with instruments.

    Noise of the terms makes the coefficients of least squares too small. With `earlier` the terms
    of an interval before are instruments: their noise is another, so that what they have in common
    with the terms of now is no noise. Those of the interval just before share a frame, so two
    intervals are the least that is of use.

    Parameters
    ----------
    fields : Fields
    continuum : Continuum
        Its lever does not count.
    interval : float
        Time over which changes and means are taken, a multiple of that between frames.
    band : (float, float)
        Wave numbers, 1/length.
    earlier : int
        How many intervals the instruments lie before; 0 for least squares.
    """
    step = max(round(interval / (fields.time[1] - fields.time[0])), 1)
    if step * (1 + earlier) >= len(fields.time):
        raise SkinError(f"interval = {interval:g}: is too long for the {len(fields.time)} frames")
    chosen = _band(fields, band)
    terms = [
        continuum.terms(height, pull, fields.sides)
        for height, pull in zip(fields.height, fields.pull, strict=True)
    ]
    weights = np.full(step + 1, 1 / step)
    weights[[0, -1]] /= 2
    rows: list[Floats] = []
    for n in range(0, len(terms) - step, step):
        growing, lifting, resisting = (
            sum(weight * term[part] for weight, term in zip(weights, terms[n:], strict=False))
            for part in range(3)
        )
        change = (fields.height[n + step] - fields.height[n]) / (
            fields.time[n + step] - fields.time[n]
        )
        left = continuum.drag * change + resisting
        rows += [np.array([_waves(field, chosen) for field in (left, growing, lifting)])]
    left, *right = np.concatenate(rows[earlier:], axis=1)
    _, *before = np.concatenate(rows[: len(rows) - earlier], axis=1)
    found = np.linalg.solve(np.array(before) @ np.array(right).T, np.array(before) @ left)
    rest = left - found @ np.array(right)
    return Coefficients(float(found[0]), float(found[1]), 1 - float(rest @ rest / (left @ left)))


def growth(
    fields: Fields, quiet: Window, window: Window, bands: Sequence[tuple[float, float]]
) -> Floats:
    """Rates (b,) at which the amplitudes of the waves of bands grow in a window, 1/time.

    Half the slope of the logarithm of the power, less the power of a quiet window, in which the
    membrane lies on the bumps of its dermis.
    """
    found = []
    before, during = fields.within(quiet), fields.within(window)
    for band in bands:
        powers = [
            np.array(
                [np.mean(np.square(_waves(height, _band(part, band)))) for height in part.height]
            )
            for part in (before, during)
        ]
        above = powers[1] - powers[0].mean()
        grown = above > 0
        slope = (
            np.polyfit(during.time[grown], np.log(above[grown]), 1)[0]
            if grown.sum() > 1
            else np.nan
        )
        found.append(slope / 2)
    return np.array(found)


def likeness(one: Floats, other: Floats) -> float:
    """Correlation of two fields over the plane."""
    return float(np.corrcoef(one.ravel(), other.ravel())[0, 1])


def skewness(field: Floats) -> float:
    """Third moment of a field over the plane, over the cube of its standard deviation."""
    away = field - field.mean()
    return float(np.mean(away**3) / np.mean(away**2) ** 1.5)


def _band(fields: Fields, band: tuple[float, float]) -> Bools:
    waves = wave_vectors(fields.height.shape[1:], fields.sides)
    k = np.sqrt(sum(component**2 for component in waves))
    return np.asarray((k > 0) & (k >= band[0]) & (k < band[1]))


def _waves(field: Floats, chosen: Bools) -> Floats:
    transformed = np.fft.fft2(field)[chosen] / field.size
    return np.concatenate([transformed.real, transformed.imag])


def _truncated(fields: Floats, nodes: Sequence[int]) -> Floats:
    """Fields (f, g_x, g_y) on fewer nodes: their waves that these resolve."""
    transformed = np.fft.fft2(fields) / fields[0].size
    for axis, number in ((1, nodes[0]), (2, nodes[1])):
        half = number // 2
        kept = np.r_[0:half, fields.shape[axis] - half : fields.shape[axis]]
        transformed = np.take(transformed, kept, axis)
        highest: list[slice | int] = [slice(None)] * 3
        highest[axis] = half
        transformed[tuple(highest)] = 0
    return np.asarray(np.fft.ifft2(transformed * nodes[0] * nodes[1]).real, float)
