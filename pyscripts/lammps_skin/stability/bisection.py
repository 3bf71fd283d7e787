"""Bisection for the largest stable timestep."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

BESIDE = 1.5  # how far above and below the limit it is looked whether all is as it should be


class Trial(NamedTuple):
    """A run with a timestep, and what was wrong with it: nothing if it is stable."""

    timestep: float
    problem: str

    @property
    def stable(self) -> bool:
        return not self.problem


class Limit(NamedTuple):
    """What has been tried, by ascending timestep."""

    trials: tuple[Trial, ...]

    @property
    def timestep(self) -> float:
        """The longest below which all that were tried are stable; 0 if not even the shortest is."""
        stable = 0.0
        for trial in self.trials:
            if not trial.stable:
                break
            stable = trial.timestep
        return stable

    @property
    def unstable(self) -> Trial | None:
        """The shortest that is not stable."""
        return next((trial for trial in self.trials if not trial.stable), None)

    @property
    def monotone(self) -> bool:
        """Whether all that are longer than an unstable one are unstable too."""
        above = [trial for trial in self.trials if trial.timestep > self.timestep]
        return not any(trial.stable for trial in above)


def bisect(
    problem: Callable[[float], str],
    guess: float,
    shortest: float,
    longest: float,
    tolerance: float,
) -> Limit:
    """Find the limit by bisection of the logarithm, then try one more on either side.

    Parameters
    ----------
    problem : callable
        What is wrong with a run with a timestep, nothing if it is stable.
    guess : float
        Where to begin; the limit is enclosed in steps of a factor of 2 from there.
    shortest, longest : float
        Timesteps beyond which it is not looked.
    tolerance : float
        The shortest unstable timestep is at most 1 + tolerance times the longest stable one.
    """
    trials: dict[float, Trial] = {}

    def stable(timestep: float) -> bool:
        if timestep not in trials:
            trials[timestep] = Trial(timestep, problem(timestep))
        return trials[timestep].stable

    low = high = min(max(guess, shortest), longest)
    if stable(low):
        while high < longest and stable(high):
            low, high = high, min(2 * high, longest)
    else:
        while low > shortest and not stable(low):
            low, high = max(low / 2, shortest), low
    if stable(low) and not stable(high):
        while high > (1 + tolerance) * low:
            middle = math.sqrt(low * high)
            low, high = (middle, high) if stable(middle) else (low, middle)
    for beside in (low / BESIDE, high * BESIDE):
        if shortest <= beside <= longest:
            stable(beside)
    return Limit(tuple(trials[timestep] for timestep in sorted(trials)))
