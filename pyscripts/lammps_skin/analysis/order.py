"""Where cells of a kind stand: chi_H, chi_G, zeta and sigma (section 8 of the model)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lammps_skin.analysis.geometry import Box
from lammps_skin.arrays import Bools, Floats, Ints
from lammps_skin.kinds import Kind


class Order(NamedTuple):
    """Order parameters of the cells of one kind in one frame.

    Attributes
    ----------
    chi_H : float
        Excess of the mean curvature, times R_c: dimensionless.
    chi_G : float
        Excess of the Gaussian curvature, times R_c as printed in the paper: 1/length.
    zeta : float
        Excess of the height, over R_c: dimensionless.
    sigma : float
        Clustering in the plane, from 0 (evenly spread) to sqrt(2) (all at one place). Of n cells
        placed at random the mean of sigma^2 is 2/n.
    """

    chi_H: float
    chi_G: float
    zeta: float
    sigma: float


def order(
    kinds: Ints,
    positions: Floats,
    kappa_H: Floats,
    kappa_G: Floats,
    box: Box,
    cell_radius: float,
    of: Kind = Kind.STEM,
) -> Order:
    """Order parameters of the cells of one kind, against all cells.

    Parameters
    ----------
    kinds : (c,) array of int
        `Kind` of every cell, none left out: all cells are the reference.
    positions : (c, 3) array
    kappa_H, kappa_G : (c,) arrays
        Mean and Gaussian curvature of the membrane at the particle nearest to each cell, see
        `curvature.curvature` and `geometry.nearest`.
    box : (L_x, L_y)
    cell_radius : float
        R_c.
    of : Kind

    Returns
    -------
    Order
        All NaN without a cell of the kind, and of a single cell in all; sigma also of a single
        cell of the kind. Where there are no other cells the kind is its own reference: chi_H,
        chi_G and zeta are 0, up to rounding.
    """
    chosen = np.asarray(kinds) == of
    return Order(
        excess(kappa_H, chosen) * cell_radius,
        excess(kappa_G, chosen) * cell_radius,
        excess(positions[:, 2], chosen) / cell_radius,
        clustering(positions[chosen], box),
    )


def excess(values: Floats, chosen: Bools) -> float:
    """Mean of the chosen values (c,) minus the mean of all; NaN if none is chosen, and of one."""
    if not chosen.any() or len(chosen) < 2:
        return float("nan")
    return float(values[chosen].mean() - values.mean())


def clustering(positions: Floats, box: Box) -> float:
    """Length sigma of the first Fourier components in x and y of positions (c, 2 or 3).

    sigma_d = |mean of exp(2 pi i r_d/L_d)|, sigma^2 = sigma_x^2 + sigma_y^2; NaN of a single
    position or none.
    """
    if len(positions) < 2:
        return float("nan")
    sides = np.asarray(box, float)[:2]
    sigma_xy = np.abs(np.exp(2j * np.pi * positions[:, :2] / sides).mean(axis=0))
    return float(np.hypot(*sigma_xy))
