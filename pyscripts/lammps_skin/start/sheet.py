"""The membrane at the start: flat, or at heights that a file or an array gives."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.errors import SceneError
from lammps_skin.model.scene import Scene
from lammps_skin.start import lattice

MOST_HEIGHTS = 100_000_000  # entries of an array, pixels of an image
PNG = b"\x89PNG\r\n\x1a\n"


def membrane_at_start(scene: Scene, heights: Floats | None = None) -> Floats:
    """Positions (n, 3) of the membrane particles of a scene, without noise.

    Parameters
    ----------
    scene : Scene
    heights : (rows, columns) array, optional
        Added to `membrane.height`; those of `membrane.heights` if not given. They are spread
        evenly over the box, row 0 at y = 0 and column 0 at x = 0, and continued periodically.

    Raises
    ------
    SceneError
        If the heights are no such array, if a link would be longer than it can be, if the
        membrane would fold by more than a right angle, or come too near to the wall or the top.
    """
    flat = lattice.positions(scene.membrane.lattice, scene.spacing, scene.membrane_height)
    name, path = "heights", scene.membrane.heights
    if heights is None:
        if path is None:
            return flat
        name, heights = f"membrane.heights = {path!r}", read_heights(Path(path))
    values = _checked(name, heights) * scene.membrane.heights_scale
    flat[:, 2] += _interpolated(values, flat[:, :2], scene)
    _check_room(name, scene, flat)
    _check_shape(name, scene, flat)
    return flat


def places_above(scene: Scene, membrane: Floats, places: Floats) -> Floats:
    """Centres (c, 3) of cells at places (c, 2): the contact length above the membrane.

    On one that is not flat, each is as high as one that comes down on it: the nearest particle of
    the membrane is at the contact length, and no other one is nearer.
    """
    if not np.ptp(membrane[:, 2]):
        return np.column_stack([places, np.full(len(places), membrane[0, 2] + scene.contact)])
    from scipy.spatial import cKDTree

    sides = np.array(scene.box_sides[:2])
    tree = cKDTree(membrane[:, :2] % sides, boxsize=sides)
    heights = []
    for place, near in zip(places, tree.query_ball_point(places, scene.contact), strict=True):
        delta = membrane[near, :2] - place
        delta -= np.round(delta / sides) * sides
        rise = np.sqrt(np.maximum(scene.contact**2 - (delta**2).sum(axis=1), 0.0))
        heights.append((membrane[near, 2] + rise).max())
    return np.column_stack([places, heights])


def read_heights(path: Path) -> Floats:
    """Heights of a file: a numpy array (.npy), or a PNG in shades of grey, from 0 to 1.

    The top row of an image is that of the largest y, as on a map of the membrane. Raises
    `SceneError` for what is neither.
    """
    what = f"membrane.heights = {str(path)!r}"
    if not path.is_file():
        raise SceneError(f"{what}: there is no such file")
    try:
        with path.open("rb") as file:
            is_image = file.read(len(PNG)) == PNG
        return _image(path) if is_image else np.load(path, mmap_mode="r", allow_pickle=False)
    except OSError as error:
        reason = error.strerror or "is damaged"
    except (ValueError, SyntaxError, EOFError, MemoryError, OverflowError):
        reason = "is damaged" if is_image else "is neither a numpy array (.npy) nor a PNG"
    raise SceneError(f"{what}: {reason}")


def _image(path: Path) -> Floats:
    from matplotlib.image import imread

    shades = imread(path, format="png")
    if shades.ndim == 3:
        colours = shades[..., :3] if shades.shape[2] > 2 else shades[..., :1]
        if np.ptp(colours, axis=2).max(initial=0.0) > 0:
            raise SceneError(f"membrane.heights = {str(path)!r}: is in colour, must be in grey")
        shades = colours[..., 0]
    return np.asarray(shades[::-1], float)


def _checked(name: str, heights: Any) -> Floats:
    """The heights as an array (rows, columns) of finite numbers."""
    try:
        values = np.asarray(heights)
    except ValueError:
        values = np.empty(0, object)
    if values.dtype.kind not in "iuf":
        raise SceneError(f"{name}: must be an array of numbers")
    if values.ndim != 2 or not 0 < values.size <= MOST_HEIGHTS:
        raise SceneError(
            f"{name}: has shape {values.shape}, must be (rows, columns), at most "
            f"{MOST_HEIGHTS:,} numbers"
        )
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        row, column = bad[0]
        raise SceneError(f"{name}: entry {row}, {column} is {values[row, column]}, must be finite")
    return values.astype(float)


def _interpolated(values: Floats, places: Floats, scene: Scene) -> Floats:
    """Heights (n,) at places (n, 2): a cubic spline through the values, periodic in x and y."""
    from scipy.ndimage import map_coordinates

    per_length = np.array(values.shape[::-1]) / scene.box_sides[:2]
    column, row = (places * per_length).T
    return np.asarray(map_coordinates(values, [row, column], order=3, mode="grid-wrap"))


def _check_room(name: str, scene: Scene, membrane: Floats) -> None:
    """The membrane is not as low as the wall, with room for a sphere between, nor near the top."""
    low, high = membrane[:, 2].min(), membrane[:, 2].max()
    least = scene.membrane.radius + 2 * scene.dermis.radius * scene.dermis.present
    most = scene.box_height - 4 * scene.contact
    if not low >= least:
        raise SceneError(
            f"{name}: the membrane would come down to {low:.4g}, must stay above {least:.4g}, "
            f"{'R_m + 2 R_d' if scene.dermis.present else 'R_m'}; raise membrane.height"
        )
    if not high <= most:
        raise SceneError(
            f"{name}: the membrane would come up to {high:.4g}, must stay below {most:.4g}, which "
            "leaves room for cells; raise box_height"
        )


def _check_shape(name: str, scene: Scene, membrane: Floats) -> None:
    """No link is longer than it can be, and no two triangles at a link fold by a right angle."""
    links, hinges = lattice.links_and_hinges(scene.membrane.lattice)
    sides = np.array([*scene.box_sides[:2], np.inf])

    def between(start: Any, end: Any) -> Floats:
        delta = membrane[end] - membrane[start]
        delta[:, :2] -= np.round(delta[:, :2] / sides[:2]) * sides[:2]
        return np.asarray(delta)

    lengths = np.linalg.norm(between(*links.T), axis=1)
    longest = 2 * scene.membrane.radius * (1 + scene.membrane.spacing_ratio)
    if not lengths.max() < longest:
        x, y, _ = membrane[links[lengths.argmax(), 0]]
        raise SceneError(
            f"{name}: a link at x, y = {x:.4g}, {y:.4g} would be {lengths.max():.4g} long, must be "
            f"below {longest:g}, at which it breaks; make the slope less"
        )
    left, i, j, right = hinges.T
    one = np.cross(between(left, i), between(left, j))
    other = np.cross(between(right, j), between(right, i))
    folded = (one * other).sum(axis=1) <= 0
    if folded.any():
        x, y, _ = membrane[i[folded][0]]
        raise SceneError(
            f"{name}: the membrane would fold by more than a right angle at x, y = {x:.4g}, "
            f"{y:.4g}; make it smoother"
        )
