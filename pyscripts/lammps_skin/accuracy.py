"""The levels of `numerics.accuracy`: what each sets of the keys that are not given themselves."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal

Level = Literal["reference", "balanced", "fast"]

DEFAULT_LEVEL: Level = "balanced"

LEVELS: dict[str, dict[str, Any]] = {
    "reference": {},
    "balanced": {
        "integrator": "rkl1",
        "stages": 5,
        "timestep": 0.25,
        "stiffness_limit": 100.0,
        "largest_move": 0.6,
        "pair_form": "skin",
        "event_interval": 0.5,
        "neighbor_skin": 0.5,
    },
    "fast": {
        "integrator": "rkl1",
        "stages": 13,
        "timestep": 2.0,
        "stiffness_limit": 80.0,
        "largest_move": 1.2,
        "pair_form": "skin",
        "event_interval": 2.0,
        "neighbor_skin": 0.5,
    },
}

SUMMARIES: dict[Level, str] = {
    "reference": "forward Euler with a timestep of 0.01",
    "balanced": "Runge-Kutta-Legendre steps of 0.25; the stiffest membrane particles move slower",
    "fast": "Runge-Kutta-Legendre steps of 2",
}

TIMESTEPS = (2.0, 1.0, 0.5, 0.25, 0.2, 0.1, 0.05, 0.02, 0.01)  # of which a level takes one
MOST_TIMESTEPS = 100  # of a level, for which stages are found
MANY = 1e9  # steps: the last one more or less does not matter
RESOLUTION = 10  # steps and event steps in the fastest process, at least


def numerics(
    level: str, given: Mapping[str, Any], intervals: Sequence[float], fastest: float
) -> dict[str, Any]:
    """Keys of `numerics` that a level gives to a scene.

    Its timestep is shortened until all intervals are whole numbers of steps, and there are enough
    of them in the fastest process. For the same stability with another timestep, also one that is
    given, s^2 + s of the stages is in proportion to it; rkl2 needs (s^2 + s - 2) / 2 instead, and
    Euler, with one stage, the shorter timestep.

    Parameters
    ----------
    level : str
        One of `LEVELS`.
    given : mapping
        Keys of `numerics` that the scene gives itself.
    intervals : sequence of float
        Times at which something happens: the end, output.
    fastest : float
        Duration of the fastest process, such as a cell cycle.
    """
    values = dict(LEVELS[level])
    if not values:
        return values
    longest, stages = values["timestep"], values["stages"]
    integrator = given.get("integrator", values["integrator"])
    limit = stages**2 + stages  # timestep times the largest eigenvalue, at the level's own step
    if integrator == "euler":
        longest, limit = 2 * longest / limit, 2
    values["timestep"] = _timestep(longest, intervals, fastest / RESOLUTION)
    values["event_interval"] = min(values["event_interval"], fastest / RESOLUTION)
    timestep = given.get("timestep", values["timestep"])
    if isinstance(timestep, (int, float)) and 0 < timestep < MOST_TIMESTEPS * longest:
        stable = limit * timestep / longest
        if integrator == "rkl2":
            stable = 2 * stable + 2
        values["stages"] = max(3, math.ceil((math.sqrt(1 + 4 * stable) - 1) / 2))
    return values


def reach(integrator: str, stages: int) -> float:
    """Timestep times largest eigenvalue up to which a step is stable, docs/fix_skin_motion.md.

    On the negative real axis: 2 for forward Euler, s^2 + s and (s^2 + s - 2) / 2 for the
    Runge-Kutta-Legendre methods of order 1 and 2 with s stages.
    """
    s = stages
    return {"euler": 2.0, "rkl1": s * s + s, "rkl2": (s * s + s - 2) / 2}[integrator]


def _timestep(longest: float, intervals: Sequence[float], short: float) -> float:
    """The longest of `TIMESTEPS` that fits, or the shortest of them."""
    for timestep in TIMESTEPS:
        whole = all(_is_whole(time / timestep) for time in intervals)
        if timestep <= min(longest, short, *intervals) and whole:
            return timestep
    return TIMESTEPS[-1]


def _is_whole(steps: float) -> bool:
    return steps > MANY or abs(steps - round(steps)) < 1e-6
