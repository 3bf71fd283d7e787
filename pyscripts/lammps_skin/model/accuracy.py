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
        "integrator": "rkl2",
        "stages": 13,
        "timestep": 1.0,
        "largest_move": 0.6,
        "pair_form": "skin",
        "event_interval": 1.0,
        "neighbor_skin": 0.5,
    },
    "fast": {
        "integrator": "rkl1",
        "stages": 13,
        "timestep": 2.0,
        "largest_move": 1.2,
        "pair_form": "skin",
        "event_interval": 2.0,
        "neighbor_skin": 0.5,
    },
}

SUMMARIES: dict[Level, str] = {
    "reference": "forward Euler with a timestep of 0.01",
    "balanced": "Runge-Kutta-Legendre steps of 1 and of second order",
    "fast": "Runge-Kutta-Legendre steps of 2 and of first order",
}

TIMESTEPS = (2.0, 1.0, 0.5, 0.25, 0.2, 0.1, 0.05, 0.02, 0.01)  # of which a level takes one
MOST_TIMESTEPS = 100  # of a level, for which stages are found
MANY = 1e9  # steps: the last one more or less does not matter
RESOLUTION = 10  # steps and event steps in the fastest process, at least


def numerics(
    level: str, given: Mapping[str, Any], intervals: Sequence[float], fastest: float
) -> dict[str, Any]:
    """Keys of `numerics` that a level gives to a scene.

    Its timestep is shortened until all intervals are whole numbers of steps, if they can be, and
    there are enough of them in the fastest process. For the same stability with another timestep,
    also one that is given, `stability_limit` of the stages is in proportion to it; Euler, with one
    stage, needs the shorter timestep.

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
    integrator = given.get("integrator", values["integrator"])
    longest, limit = _longest(level, integrator)
    values["timestep"] = fitted(longest, intervals, fastest)
    values["event_interval"] = min(values["event_interval"], fastest / RESOLUTION)
    timestep = given.get("timestep", values["timestep"])
    if isinstance(timestep, (int, float)) and 0 < timestep < MOST_TIMESTEPS * longest:
        stable = limit * timestep / longest
        if integrator == "rkl2":
            stable = 2 * stable + 2
        values["stages"] = max(3, math.ceil((math.sqrt(1 + 4 * stable) - 1) / 2))
    return values


def longest_timestep(level: str, integrator: str, fastest: float) -> float | None:
    """The timestep of a level in a scene whose intervals all fit; None if it has none."""
    return fitted(_longest(level, integrator)[0], [], fastest) if LEVELS[level] else None


def _longest(level: str, integrator: str) -> tuple[float, float]:
    """Timestep of a level, and that times the largest eigenvalue of which it is stable."""
    values = LEVELS[level]
    longest, limit = values["timestep"], stability_limit(values["integrator"], values["stages"])
    return (2 * longest / limit, 2) if integrator == "euler" else (longest, limit)


def stability_limit(integrator: str, stages: int) -> float:
    """Timestep times largest eigenvalue up to which a step is stable, docs/fix_skin_motion.md.

    On the negative real axis: 2 for forward Euler, s^2 + s and (s^2 + s - 2) / 2 for the
    Runge-Kutta-Legendre methods of order 1 and 2 with s stages.
    """
    s = stages
    return {"euler": 2.0, "rkl1": s * s + s, "rkl2": (s * s + s - 2) / 2}[integrator]


def fitted(longest: float, intervals: Sequence[float], fastest: float) -> float:
    """The longest of `TIMESTEPS` that fits all intervals, but for those that none of them fits."""
    shortest = min(longest, fastest / RESOLUTION, *intervals)
    fitting = [time for time in intervals if fits(time, TIMESTEPS[-1])]
    for timestep in TIMESTEPS:
        if timestep <= shortest and all(fits(time, timestep) for time in fitting):
            return timestep
    return TIMESTEPS[-1]


def fits(time: float, timestep: float) -> bool:
    """Whether a time is a whole number of steps, or so many that it does not matter."""
    steps = time / timestep
    return steps > MANY or (steps > 0.5 and abs(steps - round(steps)) < 1e-6)
