"""The choices of numerics that are compared, each a variant of one scene."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from lammps_skin.errors import SceneError
from lammps_skin.model.accuracy import LEVELS
from lammps_skin.model.scene import Scene

Grid = Literal["levels", "full"]

REFERENCE = "reference"
OWN = "scene"  # the variant with the numerics that the scene gives itself
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,39}")

# variations of single keys of the reference or of another level, or of a timestep, for which the
# level chooses the stages
VARIATIONS: dict[str, dict[str, Any]] = {
    "euler-0.02": {"timestep": 0.02},
    "euler-0.005": {"timestep": 0.005},
    "rkl1-1": {"accuracy": "balanced", "timestep": 1.0},
    "rkl1-0.25": {"accuracy": "balanced", "timestep": 0.25},
    "rkl1-0.25-limit": {"accuracy": "balanced", "timestep": 0.25, "stiffness_limit": 100.0},
    "rkl2-1": {"accuracy": "balanced", "integrator": "rkl2", "timestep": 1.0},
    "rkl2-0.5": {"accuracy": "balanced", "integrator": "rkl2"},
    "rkl2-0.25": {"accuracy": "balanced", "integrator": "rkl2", "timestep": 0.25},
    "rkl2-0.1": {"accuracy": "balanced", "integrator": "rkl2", "timestep": 0.1},
    "balanced-8": {"accuracy": "balanced", "stages": 8},
    "table-linear": {"pair_form": "table", "table_style": "linear"},
    "table-spline": {"pair_form": "table", "table_style": "spline"},
    "events-1": {"event_interval": 1.0},
    "balanced-analytic": {"accuracy": "balanced", "pair_form": "analytic"},
    "balanced-skin-0.25": {"accuracy": "balanced", "neighbor_skin": 0.25},
    "balanced-skin-1": {"accuracy": "balanced", "neighbor_skin": 1.0},
}


@dataclass(frozen=True)
class Variant:
    """A scene with one choice of numerics.

    Attributes
    ----------
    name : str
    scene : Scene
        With these numerics, and none of those that the scene has given itself.
    keys : mapping
        What is given of `numerics`.
    chosen : bool
        A level or a variant of the user, not a variation of the full grid.
    """

    name: str
    scene: Scene
    keys: Mapping[str, Any] = field(hash=False)
    chosen: bool = True

    @property
    def words(self) -> str:
        """The keys as text."""
        return ", ".join(f"{key}={value}" for key, value in self.keys.items())

    @property
    def family(self) -> tuple[Any, ...]:
        """The same for variants that differ in timestep, stages and neighbor builds alone."""
        numerics = self.scene.numerics
        table = numerics.pair_form == "table"
        return (
            numerics.integrator, numerics.stiffness_limit, numerics.largest_move,
            numerics.pair_form, *([numerics.table_style, numerics.table_points] if table else []),
        )  # fmt: skip


def variant(scene: Scene, name: str, keys: Mapping[str, Any], chosen: bool = True) -> Variant:
    """The scene with other numerics; raises `SceneError` naming the variant, key and value."""
    try:
        return Variant(name, Scene.from_dict({**scene.given(), "numerics": keys}), keys, chosen)
    except SceneError as error:
        raise SceneError(f"variant {name}: {error}") from None


def variants(
    scene: Scene,
    interval: float,
    grid: Grid = "full",
    more: Iterable[tuple[str, Mapping[str, Any]]] = (),
) -> tuple[list[Variant], list[str]]:
    """The reference, the other levels, what the scene gives itself, more, and variations.

    Parameters
    ----------
    scene : Scene
    interval : float
        Length of the runs, in which timesteps have to fit.
    grid : str
        With the variations (`full`) or without (`levels`).
    more : iterable of (str, mapping)
        Names and keys.

    Returns
    -------
    found : list of Variant
    left_out : list of str
        Why the scene cannot have some of the levels and variations.

    Raises
    ------
    SceneError
        If it cannot have the reference, what it gives itself, or more; for unfit names.
    """
    own = scene.given().get("numerics", {})
    wanted: dict[str, Mapping[str, Any]] = {REFERENCE: {"accuracy": REFERENCE}}
    ready = {level: {"accuracy": level} for level in LEVELS if level != REFERENCE}
    if own and own not in (*wanted.values(), *ready.values()):
        wanted[OWN] = own
    variations = {
        name: {"accuracy": REFERENCE, **keys}
        for name, keys in (VARIATIONS.items() if grid == "full" else ())
    }
    for name, keys in more:
        if not NAME.fullmatch(name):
            raise SceneError(
                f"variant {name!r}: the name must be up to 40 letters, digits, '.', '_', '-', not "
                "one of the last three at first"
            )
        if name in wanted or name in ready or name in variations:
            raise SceneError(f"variant {name}: there is one of this name already")
        wanted[name] = {"accuracy": REFERENCE, **keys}
    found = [_fitting(scene, name, keys, interval) for name, keys in wanted.items()]
    left_out = []
    for name, keys in {**ready, **variations}.items():
        try:
            found.append(_fitting(scene, name, keys, interval, name in ready))
        except SceneError as error:
            left_out.append(str(error))
    return found, left_out


def _fitting(
    scene: Scene, name: str, keys: Mapping[str, Any], interval: float, chosen: bool = True
) -> Variant:
    """A variant whose timestep divides the interval."""
    found = variant(scene, name, keys, chosen)
    timestep = found.scene.numerics.timestep
    steps = interval / timestep
    if round(steps) < 1 or abs(steps - round(steps)) > 1e-6 * steps:
        raise SceneError(
            f"variant {name}: numerics.timestep = {timestep:g}: must divide the interval, "
            f"{interval:g}"
        )
    return found
