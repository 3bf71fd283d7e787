"""The levels of `numerics.accuracy`: what each sets of the keys that are not given themselves."""

from __future__ import annotations

from typing import Any, Literal

Level = Literal["reference", "balanced", "fast"]

DEFAULT_LEVEL: Level = "balanced"

LEVELS: dict[str, dict[str, Any]] = {
    "reference": {},
    "balanced": {
        "integrator": "rkl1",
        "stages": 7,
        "timestep": 0.5,
        "stiffness_limit": 100.0,
        "largest_move": 0.6,
        "event_interval": 0.5,
        "neighbor_skin": 0.35,
    },
    "fast": {
        "integrator": "rkl1",
        "stages": 9,
        "timestep": 1.0,
        "stiffness_limit": 80.0,
        "largest_move": 0.8,
        "event_interval": 1.0,
        "neighbor_skin": 0.5,
    },
}

SUMMARIES: dict[Level, str] = {
    "reference": "forward Euler with a timestep of 0.01",
    "balanced": "Runge-Kutta-Legendre steps of 0.5; the stiffest membrane particles move slower",
    "fast": "Runge-Kutta-Legendre steps of 1",
}
