"""The continuum equation of the membrane's height, linear in the height, and its solutions.

tau dh/dt = -div(K grad h) - R_c laplace(K) - R h

K is the pull of the cells, R the operator that multiplies a wave of wave number k by R(k). Along x
alone it is the equation of the paper. The grids are periodic, of one or two dimensions, and
derivatives are those of the trigonometric interpolation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from lammps_skin.arrays import Floats
from lammps_skin.errors import SkinError

Pull = Floats | Callable[[float], Floats]


@dataclass(frozen=True)
class Continuum:
    """The equation with its numbers.

    Attributes
    ----------
    drag : float
        tau: force per area over velocity.
    lever : float
        R_c: height of the cells' centres above the membrane, length.
    restoring : callable
        R(k), force per area over height, of an array of wave numbers.
    """

    drag: float
    lever: float
    restoring: Callable[[Floats], Floats]

    def growth(self, wave_numbers: Floats, pull: float) -> Floats:
        """Rates (k,) at which waves grow under a pull that is the same everywhere, 1/time."""
        k = np.asarray(wave_numbers, float)
        return (pull * k**2 - self.restoring(k)) / self.drag

    def rate(self, height: Floats, pull: Floats, sides: Sequence[float]) -> Floats:
        """dh/dt on the grid of the height.

        Parameters
        ----------
        height, pull : (g,) or (g_x, g_y) arrays
            Length; force per length.
        sides : (1,) or (2,) sequence
            Of the periodic box, length.
        """
        growing, lifting, resisting = self.terms(height, pull, sides)
        return (growing + self.lever * lifting - resisting) / self.drag

    def terms(
        self, height: Floats, pull: Floats, sides: Sequence[float]
    ) -> tuple[Floats, Floats, Floats]:
        """-div(K grad h), -laplace(K) and R h on the grid: force per area, but without R_c."""
        waves = wave_vectors(height.shape, sides)
        square = sum(k**2 for k in waves)
        transformed = np.fft.fftn(height)
        flow = [_real(1j * k * np.fft.fftn(pull * _real(1j * k * transformed))) for k in waves]
        lifting = _real(square * np.fft.fftn(pull))
        resisting = _real(self.restoring(np.sqrt(square)) * transformed)
        return -sum(flow[1:], flow[0]), lifting, resisting

    def solve(self, height: Floats, pull: Pull, sides: Sequence[float], times: Floats) -> Floats:
        """Heights (t, ...) at ascending times, of which the first is that of the height given.

        Parameters
        ----------
        height : (g,) or (g_x, g_y) array
        pull : array like the height, or callable
            In the course of time if callable, of the time.
        sides : (1,) or (2,) sequence
        times : (t,) array

        Raises
        ------
        SkinError
            If the solution grows beyond all bounds.
        """
        shape = height.shape

        def rate(time: float, flat: Floats) -> Floats:
            now = pull(time) if callable(pull) else pull
            return self.rate(flat.reshape(shape), now, sides).ravel()

        found = solve_ivp(
            rate, (times[0], times[-1]), height.ravel(), t_eval=times, rtol=1e-6, atol=1e-8
        )
        if not found.success:
            raise SkinError(f"continuum: not solved beyond t = {found.t[-1]:g}: {found.message}")
        return np.asarray(found.y.T.reshape(len(times), *shape), float)


def wave_vectors(shape: Sequence[int], sides: Sequence[float]) -> list[Floats]:
    """Components of the wave vectors of a grid, one array for each dimension, to be broadcast.

    The highest wave of an even number of points counts as constant, so that derivatives are real.
    """
    found = []
    for axis, (points, side) in enumerate(zip(shape, sides, strict=True)):
        k = np.asarray(2 * np.pi * np.fft.fftfreq(points, side / points), float)
        if points % 2 == 0:
            k[points // 2] = 0.0
        found.append(k.reshape([-1 if n == axis else 1 for n in range(len(shape))]))
    return found


def _real(transformed: Any) -> Floats:
    return np.asarray(np.fft.ifftn(transformed).real, float)
