"""Where the viewer stands, and where rays towards the viewer cross the sides of a box."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lammps_skin.arrays import Floats, Ints

MARGIN = 0.02  # of the picture, on every side
PARALLEL = 1e-9  # a ray whose direction has so little of that of an axis does not cross its sides


@dataclass(frozen=True)
class Camera:
    """A parallel projection to a picture of (height, width) pixels.

    Attributes
    ----------
    axes : (3, 3) array
        Unit vectors in rows: right, up, towards the viewer.
    origin : (2,) array
        Right and up of the middle of the lower left pixel, length.
    scale : float
        Pixels per length.
    shape : (height, width)
    """

    axes: Floats
    origin: Floats
    scale: float
    shape: tuple[int, int]

    @classmethod
    def looking(cls, axes: Floats, points: Floats, width: int, zoom: float = 1.0) -> Camera:
        """Camera whose picture is filled by points (n, 3), or by the middle of them with a zoom."""
        seen = points @ axes[:2].T
        low, high = seen.min(axis=0), seen.max(axis=0)
        side, margin = high - low, MARGIN * (high - low).max()
        scale = width / (side[0] + 2 * margin)
        height = int(np.ceil((side[1] + 2 * margin) * scale))
        half = np.array([width, height]) / (2 * zoom * scale)
        return cls(axes, (low + high) / 2 - half, zoom * scale, (height, width))

    def finer(self, times: int) -> Camera:
        """The same camera with so many pixels along each one of its picture."""
        origin = self.origin - (times - 1) / 2 / (times * self.scale)
        height, width = self.shape
        shape = times * height, times * width
        return replace(self, origin=origin, scale=times * self.scale, shape=shape)

    def project(self, points: Floats) -> Floats:
        """Column, row from below, and nearness of points (..., 3), in pixels."""
        seen = points @ self.axes.T
        seen[..., :2] -= self.origin
        return np.asarray(seen * self.scale)


def axes_of(azimuth: float, elevation: float) -> Floats:
    """Axes of a camera that stands at an azimuth from x and above the plane, in degrees."""
    a, e = np.deg2rad([azimuth, elevation])
    toward = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return np.stack([right, np.cross(toward, right), toward])


class Sides:
    """The sides x = 0, x = L_x, y = 0, y = L_y of a box that cut off what is outside.

    Parameters
    ----------
    camera : Camera
    lengths : (L_x, L_y)
    """

    def __init__(self, camera: Camera, lengths: Sequence[float]) -> None:
        self.camera = camera
        self.lengths = np.asarray(lengths, float)[:2]

    def limits(self, columns: Floats | Ints, rows: Floats | Ints) -> tuple[Floats, Floats]:
        """Nearness at which the rays of pixels enter the box from behind and leave it in front.

        The first is the larger one where a ray misses the box.
        """
        (far_x, near_x), (far_y, near_y) = self._of_axes(columns, rows)
        return np.maximum(far_x, far_y), np.minimum(near_x, near_y)

    def _of_axes(self, columns: Floats | Ints, rows: Floats | Ints) -> list[tuple[Floats, Floats]]:
        scale, axes = self.camera.scale, self.camera.axes
        right, up = columns / scale + self.camera.origin[0], rows / scale + self.camera.origin[1]
        limits = []
        for axis, length in enumerate(self.lengths):
            place = right * axes[0, axis] + up * axes[1, axis]  # at nearness 0
            toward = axes[2, axis] / scale
            if abs(axes[2, axis]) < PARALLEL:
                inside = (place >= 0) & (place <= length)
                limits.append(
                    (np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf))
                )
                continue
            ends = -place / toward, (length - place) / toward
            limits.append(ends if toward > 0 else ends[::-1])
        return limits
