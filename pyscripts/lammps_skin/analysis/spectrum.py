"""Fluctuation spectrum of the membrane's height."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lammps_skin.analysis.geometry import Box
from lammps_skin.arrays import Floats, Ints


class Spectrum(NamedTuple):
    """Radially averaged spectrum in b bins of wave number; empty bins are left out.

    Attributes
    ----------
    q : (b,) array
        Mean wave number of the modes of a bin, 1/length.
    power : (b,) array
        Mean of |h_q|^2 over modes and frames, length^2.
    modes : (b,) array of int
        Number of modes of a bin, q and -q both counted.
    """

    q: Floats
    power: Floats
    modes: Ints


def height_spectrum(height: Floats, box: Box, width: float | None = None) -> Spectrum:
    """Spectrum of height fields over the projected plane.

    h(r) = sum over q of h_q exp(i q r), so the sum of |h_q|^2 over q > 0 is the variance of the
    height, and a wave of amplitude a has |h_q|^2 = a^2/4 at q and at -q. Times L_x L_y it is the
    spectral density, k_B T/(kappa q^4) for an elastic sheet in equilibrium. Bins end at the
    largest circle of wave numbers that the grid resolves.

    Parameters
    ----------
    height : (..., g_x, g_y) array
        Height field or fields, see `surface.height_field`: where the membrane is folded it is
        the upper side that counts, and its jumps add a tail that falls as q^-3.
    box : (L_x, L_y)
    width : float, optional
        Of the bins, 1/length; 2 pi over the longer side if not given.
    """
    lx, ly = float(box[0]), float(box[1])
    nx, ny = height.shape[-2:]
    power = np.abs(np.fft.fft2(height) / (nx * ny)) ** 2
    power = power.reshape(-1, nx, ny).mean(axis=0)
    turns_x, turns_y = np.fft.fftfreq(nx, lx / nx), np.fft.fftfreq(ny, ly / ny)
    q = 2 * np.pi * np.hypot(turns_x[:, None], turns_y)
    step = width or 2 * np.pi / max(lx, ly)
    resolved = (q > 0) & (q <= np.pi * min(nx / lx, ny / ly))
    number = np.round(q[resolved] / step).astype(np.int64)
    modes = np.bincount(number)
    filled = modes > 0
    modes = modes[filled]
    mean_q = np.bincount(number, weights=q[resolved])[filled] / modes
    mean_power = np.bincount(number, weights=power[resolved])[filled] / modes
    return Spectrum(mean_q, mean_power, modes)
