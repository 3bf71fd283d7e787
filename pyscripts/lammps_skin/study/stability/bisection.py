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

    If the one below is not stable, the search goes on from there.

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

    below = min(max(guess, shortest), longest)
    while True:
        low, high = _enclose(stable, below, shortest, longest)
        while stable(low) and high > (1 + tolerance) * low and not stable(high):
            middle = math.sqrt(low * high)
            low, high = (middle, high) if stable(middle) else (low, middle)
        if high * BESIDE <= longest:
            stable(high * BESIDE)
        below = low / BESIDE
        if not stable(low) or below < shortest or stable(below):
            break  # else there is an unstable one below: the limit is further down
    return Limit(tuple(trials[timestep] for timestep in sorted(trials)))


def _enclose(
    stable: Callable[[float], bool], begin: float, shortest: float, longest: float
) -> tuple[float, float]:
    """A stable timestep and an unstable one in steps of a factor of 2, where there are such."""
    low = high = begin
    if stable(begin):
        while high < longest and stable(high):
            low, high = high, min(2 * high, longest)
    else:
        while low > shortest and not stable(low):
            low, high = max(low / 2, shortest), low
    return low, high
