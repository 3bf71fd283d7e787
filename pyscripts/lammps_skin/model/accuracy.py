"""The levels of `numerics.accuracy`: what each sets of the keys that are not given themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

Level = Literal["reference", "balanced", "fast"]

DEFAULT_LEVEL: Level = "balanced"

LEVELS: dict[str, dict[str, Any]] = {
    "reference": {},
    "balanced": {
        "integrator": "rkl1",
        "timestep": 0.5,
        "largest_move": 0.6,
        "pair_form": "skin",
        "event_interval": 1.0,
        "neighbor_skin": 0.5,
    },
    "fast": {
        "integrator": "rkl1",
        "timestep": 2.0,
        "largest_move": 1.2,
        "pair_form": "skin",
        "event_interval": 2.0,
        "neighbor_skin": 0.5,
    },
}

SUMMARIES: dict[Level, str] = {
    "reference": "forward Euler with a timestep of 0.01",
    "balanced": "Runge-Kutta-Legendre steps of 0.5",
    "fast": "Runge-Kutta-Legendre steps of 2",
}

TIMESTEPS = (2.0, 1.0, 0.5, 0.25, 0.2, 0.1, 0.05, 0.02, 0.01)  # of which a level takes one
MANY = 1e9  # steps: the last one more or less does not matter
RESOLUTION = 10  # steps and event steps in the fastest process, at least


def numerics(
    level: str, given: Mapping[str, Any], intervals: Sequence[float], fastest: float
) -> dict[str, Any]:
    """Keys of `numerics` that a level gives to a scene.

    Its timestep is shortened until all intervals are whole numbers of steps, if they can be, and
    there are enough of them in the fastest process. Euler, if it is given, has that of `reference`.

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
    euler = given.get("integrator") == "euler"
    longest = TIMESTEPS[-1] if euler else values["timestep"]
    values["timestep"] = fitted(longest, intervals, fastest)
    values["event_interval"] = min(values["event_interval"], fastest / RESOLUTION)
    return values


def longest_timestep(level: str, fastest: float) -> float | None:
    """The timestep of a level in a scene whose intervals all fit; None if it has none."""
    return fitted(LEVELS[level]["timestep"], [], fastest) if LEVELS[level] else None


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
