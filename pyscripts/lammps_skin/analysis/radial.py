"""How particles of some kinds lie around those of others, in the plane of the tissue."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from lammps_skin.arrays import Floats
from lammps_skin.errors import SkinError

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of packages that MDAnalysis imports
    from MDAnalysis.analysis.base import AnalysisBase
    from MDAnalysis.analysis.results import ResultsGroup


def pairs_within(first: Floats, second: Floats, box: Floats, distances: Floats) -> Floats:
    """Number of ordered pairs (d,) at most so far apart in a periodic plane.

    Parameters
    ----------
    first, second : (n, 2), (m, 2) arrays
        Positions, wrapped or not. A particle in both is a pair with itself, at distance 0.
    box : (2,) array
    distances : (d,) array
        Up to half the shorter side of the box.
    """
    if not len(first) or not len(second):
        return np.zeros(len(distances))
    one, other = (cKDTree(places % box % box, boxsize=box) for places in (first, second))
    return np.asarray(one.count_neighbors(other, distances), float)


class InPlaneRDF(AnalysisBase):  # type: ignore[misc]
    """Radial distribution function in the plane, periodic, as a mean over frames.

    It is the density of the second group at a distance from a particle of the first, over its
    mean density in the box: 1 where particles do not know of each other. Heights do not count.
    Particles that do not exist in a frame are left out. Runs on any backend.

    Parameters
    ----------
    first, second : AtomGroup
        With ``updating=True``, if the groups are to follow births, removals and changes of kind.
        The second is the first if not given.
    bins : int
    furthest : float, optional
        Distance up to which; half the shorter side of the box if not given.
    **options
        Of `AnalysisBase`.

    Attributes
    ----------
    results.edges : (bins + 1,) array
    results.bins : (bins,) array
        Middles of the bins.
    results.counts : (bins,) array
        Ordered pairs, over all frames.
    results.rdf : (bins,) array
        NaN where no frame has a pair.

    Raises
    ------
    SkinError
        For distances beyond half the box, and for a box that has none.

    Examples
    --------
    >>> universe = open_trajectory("runs/one-stem")
    >>> stem, ta = (universe.select_atoms(f"type {k}", updating=True) for k in ("stem", "ta"))
    >>> found = InPlaneRDF(stem, ta).run(start=-5).results
    """

    _analysis_algorithm_is_parallelizable = True

    @classmethod
    def get_supported_backends(cls) -> tuple[str, ...]:
        """Where frames may be analysed."""
        return "serial", "multiprocessing", "dask"

    def __init__(
        self, first: Any, second: Any = None, bins: int = 75, furthest: float | None = None,
        **options: Any,
    ) -> None:  # fmt: skip
        super().__init__(first.universe.trajectory, **options)
        self._first, self._second = first, first if second is None else second
        box = first.universe.dimensions
        half = 0.0 if box is None else float(min(box[:2])) / 2
        if bins < 1:
            raise SkinError(f"bins = {bins}: must be 1 or more")
        if not 0 < (half if furthest is None else furthest) <= half:
            raise SkinError(
                f"furthest = {furthest}: must be above 0 and at most half the shorter side of the "
                f"box, {half:g}"
            )
        self._edges = np.linspace(0, half if furthest is None else furthest, bins + 1)

    def _get_aggregator(self) -> ResultsGroup:
        return ResultsGroup(dict.fromkeys(("counts", "pair_density"), ResultsGroup.ndarray_sum))

    def _prepare(self) -> None:
        self.results.counts = np.zeros(len(self._edges) - 1)
        self.results.pair_density = np.zeros(())

    def _single_frame(self) -> None:
        box = np.array(self._ts.dimensions[:2], float)
        groups = [group[_present(group)] for group in (self._first, self._second)]
        first, second = (group.positions[:, :2].astype(float) for group in groups)
        self.results.counts += np.diff(pairs_within(first, second, box, self._edges))
        shared = len(np.intersect1d(*(group.ix for group in groups)))
        self.results.pair_density += (len(first) * len(second) - shared) / box.prod()

    def _conclude(self) -> None:
        self.results.edges = self._edges
        self.results.bins = (self._edges[1:] + self._edges[:-1]) / 2
        shells = np.pi * np.diff(self._edges**2)
        expected = self.results.pair_density * shells
        with np.errstate(invalid="ignore"):
            self.results.rdf = self.results.counts / np.where(expected > 0, expected, np.nan)


def _present(group: Any) -> Any:
    """Which atoms have a place in the frame."""
    return np.isfinite(group.positions).all(axis=1)
