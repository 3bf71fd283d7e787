"""Tables of ensembles that nobody ran: courses in time that are known, and a spread over seeds."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping

import numpy as np
from lammps_skin.arrays import Floats
from lammps_skin.study.claims.catalogue import ND, STEM
from lammps_skin.study.claims.tables import Ensemble

TIMES = np.arange(0.0, 1001.0, 25.0)
Change = Callable[[str, Floats, Floats], Floats | float]  # of scene, times and values


def ramp(start: float, end: float) -> Floats:
    """From 0 before the start to 1 after the end."""
    return np.clip((TIMES - start) / (end - start), 0.0, 1.0)


SIGMA = {"ring": 0.35, "random": 0.2, "nd-d": 0.5}
SIGMA_ND = {"nd-a": 0.6, "nd-b": 1.3, "nd-c": 0.6, "nd-d": 1.4}


def ideal(scene: str) -> dict[str, Floats]:
    """Courses with which every claim holds."""
    one, zeta = np.ones_like(TIMES), 0.5 * ramp(300, 500)
    found = {
        "coverage": np.clip(TIMES / 300, 0.05, 0.99), "stem": 16 * one,
        "height_std": 0.1 + 1.1 * ramp(200, 400),
        "papillae": 30 * ramp(200, 300), "papilla_height": 2 * ramp(200, 600),
        "skewness": ramp(200, 300),
        "stem_on_tips": 0.8 * one, "stem_tips_expected": 0.5 * one,
        "chi_H": 0.3 * ramp(250, 350), "chi_G": 0.2 * ramp(250, 350), "zeta": zeta,
        "sigma": SIGMA.get(scene, 0.25) * one,
    }  # fmt: skip
    if scene == "cluster":
        found["sigma"] = 1.3 - 0.6 * ramp(0, 300)
    if scene in ND:
        found |= {
            "nd_on_tips": 0.8 * one, "nd_tips_expected": 0.5 * one,
            "chi_H_nd": 0.3 * ramp(250, 350), "chi_G_nd": 0.2 * ramp(250, 350),
            "zeta_nd": zeta - 0.25 * ramp(250, 300) + 0.6 * ramp(600, 900),
            "sigma_nd": SIGMA_ND[scene] * one,
        }  # fmt: skip
    return found


def ensemble(
    scene: str,
    changes: Mapping[str, Change] | None = None,
    spread: float = 0.02,
    seeds: int = 8,
    random: np.random.Generator | None = None,
) -> Ensemble:
    """The ideal courses with changes; all but the numbers of stem cells vary.

    Seeds, and again frames, differ by `spread` times the largest value of the ideal course; of
    coverage, which is close to 1, by a tenth of that, and of ND cells' heights as of stem cells'.
    """
    random = random or np.random.default_rng(1)
    courses, changes = ideal(scene), changes or {}
    scale = {column: np.abs(course).max() for column, course in courses.items()}
    scale |= {"stem": 0.0, "coverage": 0.1, "zeta_nd": scale["zeta"]}
    courses |= {
        column: change(scene, TIMES, courses[column]) + 0 * TIMES
        for column, change in changes.items() if column in courses
    }  # fmt: skip
    shape = seeds, len(TIMES)
    table = np.zeros(shape, [(name, float) for name in ("seed", "time", *courses)])
    table["seed"], table["time"] = np.arange(1, seeds + 1)[:, None], TIMES
    for column, course in courses.items():
        noise = random.normal(size=(seeds, 1)) + random.normal(size=shape)
        table[column] = course + spread * scale[column] * noise
    for column in ("coverage", "height_std"):
        table[column] = np.clip(table[column], 0.001, 0.999 if column == "coverage" else None)
    return Ensemble(scene, table.ravel())


def ensembles(
    changes: Mapping[str, Change] | None = None,
    spread: float = 0.02,
    seeds: int = 8,
    random: np.random.Generator | None = None,
    only: Collection[str] = (*STEM, *ND),
) -> dict[str, Ensemble]:
    """Of all scenes, or of some."""
    random = random or np.random.default_rng(1)
    return {
        scene: ensemble(scene, changes, spread, seeds, random)
        for scene in (*STEM, *ND) if scene in only
    }  # fmt: skip
