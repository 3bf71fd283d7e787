"""Samples of ranges of keys, and what they tell of sensitivity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.errors import SceneError, SkinError
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import near, shown, value_of

KEYS = ("method", "n", "seed", "ranges")
METHODS = ("latin", "sobol", "morris")
MOST = 100_000
ALIKE = 0.5  # correlation of the two halves of a sample of Sobol, from which on they are
LEVELS = 4  # of each key, of the trajectories of Morris


@dataclass(frozen=True)
class Sample:
    """Points within ranges of keys.

    Attributes
    ----------
    method : str
        "latin": `n` points, a Latin hypercube. "sobol": `n` (k + 2) points for indices of Sobol,
        of k keys. "morris": `n` (k + 1) points, trajectories of Morris.
    n : int
    seed : int
    ranges : dict of str to (float, float)
        Dotted keys.
    """

    method: str
    n: int
    seed: int
    ranges: Mapping[str, tuple[float, float]]

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Sample:
        """Sample of the table of a study; raises `SceneError`."""
        for key, value in given.items():
            if key not in KEYS:
                raise SceneError(
                    f"sample.{key} = {shown(value)}: unknown key; allowed: {', '.join(KEYS)}"
                    f"{near(key, KEYS)}"
                )
        method, n, seed = given.get("method"), given.get("n"), given.get("seed", 1)
        if method not in METHODS:
            raise SceneError(
                f"sample.method = {shown(method)}: must be one of {', '.join(METHODS)}"
                f"{near(method, METHODS)}"
            )
        for key, number in (("n", n), ("seed", seed)):
            if not isinstance(number, int) or isinstance(number, bool) or not 1 <= number <= MOST:
                raise SceneError(
                    f"sample.{key} = {shown(number)}: must be a whole number from 1 to {MOST:,}"
                )
        assert isinstance(n, int)
        if method == "sobol" and n & (n - 1):
            raise SceneError(f"sample.n = {n}: must be a power of 2 for the method sobol")
        ranges = dict(_ranges(given.get("ranges"), "sample.ranges"))
        if not ranges:
            raise SceneError("sample.ranges: must give at least one key its range, as [1.0, 2.0]")
        return cls(method, n, seed, ranges)

    def points(self, scene: Scene) -> list[dict[str, Any]]:
        """Keys and values of each point; whole numbers where the scene has them.

        Raises `SceneError` if a range has one value only, once rounded.
        """
        low, high = np.array(list(self.ranges.values())).T
        values = self._unit() * (high - low) + low
        rounded = [round if _is_whole(scene, key) else _seven_digits for key in self.ranges]
        for (key, ends), of in zip(self.ranges.items(), rounded, strict=True):
            if of(ends[0]) == of(ends[1]):
                raise SceneError(
                    f"sample.ranges.{key} = {shown(list(ends))}: must hold more than one value; "
                    f"all in it are rounded to {of(ends[0])}"
                )
        return [
            {key: of(value) for key, value, of in zip(self.ranges, row, rounded, strict=True)}
            for row in values.tolist()
        ]

    @property
    def number(self) -> int:
        """Number of points."""
        each = {"latin": 1, "morris": len(self.ranges) + 1, "sobol": len(self.ranges) + 2}
        return self.n * each[self.method]

    @property
    def remark(self) -> str:
        """What to mind of the sample; nothing if all is well.

        The indices of Sobol compare two halves of the sample, which must not be alike.
        """
        if self.method != "sobol" or self.n < 2:
            return ""
        unit, step = self._unit(), len(self.ranges) + 2
        halves = zip(unit[::step].T, unit[step - 1 :: step].T, strict=True)
        alike = max(abs(float(np.corrcoef(one, other)[0, 1])) for one, other in halves)
        if alike < ALIKE:
            return ""
        return (
            f"sample.n = {self.n}: the two halves of so few points are alike (correlation "
            f"{alike:.2g}), so that indices will be wrong; take more"
        )

    @property
    def _problem(self) -> dict[str, Any]:
        """As SALib names it, in the unit cube."""
        number = len(self.ranges)
        return {"num_vars": number, "names": [*self.ranges], "bounds": [[0.0, 1.0]] * number}

    def _unit(self) -> Floats:
        """Points (p, k) in the unit cube."""
        if self.method == "latin":
            from scipy.stats.qmc import LatinHypercube

            drawn: Floats = LatinHypercube(len(self.ranges), rng=self.seed).random(self.n)
            return drawn
        try:
            from SALib.sample import morris, sobol
        except ImportError:
            raise SkinError(
                f"sample.method = '{self.method}': needs SALib: pip install 'lammps-skin[study]'"
            ) from None
        if self.method == "sobol":
            return sobol.sample(
                self._problem, self.n, calc_second_order=False, seed=self.seed
            )
        return morris.sample(self._problem, self.n, num_levels=LEVELS, seed=self.seed)

    def sensitivity(self, results: Floats) -> tuple[tuple[str, ...], Floats]:
        """What the results (p,) of all points say of each key.

        Returns
        -------
        tuple of str
            Names of the columns: of Morris ``mu_star``, ``mu_star_error``, ``mu``, ``mu_error``,
            ``sigma``; of Sobol ``first``, ``first_error``, ``total``, ``total_error``. Errors are
            half widths of 95 % intervals. None of a Latin hypercube.
        (k, c) array
        """
        if self.method == "latin":
            return (), np.empty((len(self.ranges), 0))
        from SALib.analyze import morris, sobol

        if self.method == "sobol":
            names = {"first": "S1", "first_error": "S1_conf", "total": "ST",
                     "total_error": "ST_conf"}  # fmt: skip
            found = sobol.analyze(
                self._problem, results, calc_second_order=False, seed=self.seed
            )
        else:
            from scipy.stats import t

            names = {"mu_star": "mu_star", "mu_star_error": "mu_star_conf", "mu": "mu",
                     "mu_error": "mu_error", "sigma": "sigma"}  # fmt: skip
            found = morris.analyze(
                self._problem, self._unit(), results, num_levels=LEVELS, seed=self.seed
            )
            error = found["sigma"] / np.sqrt(self.n)  # of a mean of n independent effects
            found["mu_error"] = t.ppf(0.975, self.n - 1) * error
        return tuple(names), np.array([found[name] for name in names.values()], float).T


def _ranges(given: Any, prefix: str) -> list[tuple[str, tuple[float, float]]]:
    """Dotted keys and their ranges, of nested ones."""
    found: list[tuple[str, tuple[float, float]]] = []
    if not isinstance(given, Mapping):
        raise SceneError(f"{prefix} = {shown(given)}: must be a table of keys and their ranges")
    for key, value in given.items():
        if isinstance(value, Mapping):
            found += [(f"{key}.{name}", pair) for name, pair in _ranges(value, f"{prefix}.{key}")]
            continue
        good = isinstance(value, list) and len(value) == 2 and all(map(_is_number, value))
        if not good or not value[0] < value[1]:
            raise SceneError(
                f"{prefix}.{key} = {shown(value)}: must be two numbers, the least and the largest"
            )
        found.append((key, (float(value[0]), float(value[1]))))
    return found


def _is_number(value: Any) -> bool:
    """Whether it is one, so far from the largest float that ranges have a width."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e300


def _seven_digits(value: float) -> float:
    return float(f"{value:.7g}")


def _is_whole(scene: Scene, key: str) -> bool:
    try:
        value = value_of(scene, key)
    except AttributeError:
        return False
    return isinstance(value, int) and not isinstance(value, bool)
