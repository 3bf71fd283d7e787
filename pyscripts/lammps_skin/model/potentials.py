"""Every potential of the model, u(x) and u'(x), with x = distance / contact length.

This is the only place in Python where a formula of the model stands. The styles of the plugin
state their formulas again in C++; tests compare them with this module.
All functions take and return arrays of one shape and are in reduced units; a potential is
multiplied by its stiffness K, and its force on a particle is ``-K u'(x) / contact length``
along the line between the two. The letters are those of the paper.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lammps_skin.arrays import Floats


def phi(x: ArrayLike) -> Floats:
    """Lennard-Jones shape with its minimum -1/12 at x = 1."""
    s = np.asarray(x, float) ** -6
    return s * s / 12 - s / 6


def phi_slope(x: ArrayLike) -> Floats:
    """Derivative of `phi`."""
    x = np.asarray(x, float)
    s = x**-6
    return (s - s * s) / x


def truncated(x: ArrayLike, Lambda: float) -> Floats:
    """Dermis-membrane: `phi`, cut at Lambda and shifted to 0 there."""
    x = np.asarray(x, float)
    return np.where(x < Lambda, phi(x) - phi(Lambda), 0.0)


def truncated_slope(x: ArrayLike, Lambda: float) -> Floats:
    """Derivative of `truncated`."""
    x = np.asarray(x, float)
    return np.where(x < Lambda, phi_slope(x), 0.0)


def dermis(x: ArrayLike, Lambda: float, a1: float, d1: float) -> Floats:
    """Dermis-dermis: attraction as in `truncated`, a soft core of stiffness a1 down to d1."""
    x = np.asarray(x, float)
    core = a1 / 2 * (x - 1) ** 2 + np.where(x < d1, phi(x + 1 - d1), phi(1.0)) - phi(Lambda)
    return np.where(x < 1, core, truncated(x, Lambda))


def dermis_slope(x: ArrayLike, Lambda: float, a1: float, d1: float) -> Floats:
    """Derivative of `dermis`."""
    x = np.asarray(x, float)
    core = a1 * (x - 1) + np.where(x < d1, phi_slope(x + 1 - d1), 0.0)
    return np.where(x < 1, core, truncated_slope(x, Lambda))


def exclusion(x: ArrayLike) -> Floats:
    """Exclusion u_ex: the repulsive part of `phi`, 0 at contact and beyond."""
    x = np.asarray(x, float)
    return np.where(x < 1, phi(x) - phi(1.0), 0.0)


def exclusion_slope(x: ArrayLike) -> Floats:
    """Derivative of `exclusion`."""
    x = np.asarray(x, float)
    return np.where(x < 1, phi_slope(x), 0.0)


def stretch(x: ArrayLike, a2: float, d2: float, scale: float = 1.0) -> Floats:
    """Membrane link: `phi` below d2, quadratic to 1, singular at x = 1 + d2.

    The quadratic branch is a2/2 ((x - d2)/d2)^2, with which the printed A0 and A1 make it
    once continuously differentiable. `scale` multiplies the spring-like part (quadratic
    branch and A0 + A1 x, not phi): 1 as printed, the contact length with direct forces.
    """
    x = np.asarray(x, float)
    spring = np.where(x > 1, _line(x, a2, d2), a2 / 2 * ((np.maximum(x, d2) - d2) / d2) ** 2)
    argument = np.where(x < d2, x / d2, np.where(x > 1, (1 + d2 - x) / d2, 1.0))
    return scale * spring + phi(argument)


def stretch_slope(x: ArrayLike, a2: float, d2: float, scale: float = 1.0) -> Floats:
    """Derivative of `stretch`."""
    x = np.asarray(x, float)
    spring = np.where(x > 1, a2 * (1 - d2) / d2**2, a2 * (np.maximum(x, d2) - d2) / d2**2)
    argument = np.where(x < d2, x / d2, np.where(x > 1, (1 + d2 - x) / d2, 1.0))
    return scale * spring + np.where(x > 1, -1, 1) * phi_slope(argument) / d2


def _line(x: Floats, a2: float, d2: float) -> Floats:
    """A0 + A1 x, the continuation of the quadratic branch beyond x = 1."""
    return -a2 * (1 - d2**2) / (2 * d2**2) + a2 * (1 - d2) / d2**2 * x


def adhesion(x: ArrayLike, lam: float) -> Floats:
    """Adhesion u_ad: 0 in contact, harmonic at first, flat at (lam - 1)^2/4 beyond lam."""
    s = np.clip(np.asarray(x, float) - 1, 0.0, lam - 1)
    return s**2 / 2 - s**4 / (4 * (lam - 1) ** 2)


def adhesion_slope(x: ArrayLike, lam: float) -> Floats:
    """Derivative of `adhesion`."""
    s = np.clip(np.asarray(x, float) - 1, 0.0, lam - 1)
    return s - s**3 / (lam - 1) ** 2


def shifted_adhesion(x: ArrayLike, lam: float) -> Floats:
    """Cell-cell adhesion: `adhesion` minus its plateau, so that it is 0 beyond lam."""
    return adhesion(x, lam) - (lam - 1) ** 2 / 4


def binding(x: ArrayLike) -> Floats:
    """Binding u_bind of stem and ND cells: 0 in contact, harmonic beyond."""
    return np.maximum(np.asarray(x, float) - 1, 0.0) ** 2 / 2


def bending(cosine: ArrayLike, form: str = "cosine") -> Floats:
    """Bending of a link from the cosine c = N1.N2 of its triangles' normals: (1 - c)^2 / 2.

    The form "diverging" is 1/(1 + c) - 1/2 for c < 0: beyond a right angle.
    """
    c = np.asarray(cosine, float)
    if form == "cosine":
        return (1 - c) ** 2 / 2
    with np.errstate(divide="ignore"):
        return np.where(c < 0, 1 / (1 + np.minimum(c, 0.0)) - 0.5, (1 - c) ** 2 / 2)


def division_spring(distance: ArrayLike, length: ArrayLike) -> Floats:
    """Division spring: harmonic around its growing natural length (both lengths, not x)."""
    return (np.asarray(distance, float) - np.asarray(length, float)) ** 2 / 2
