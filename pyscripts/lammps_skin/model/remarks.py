"""What there is to say of a scene before it is run: of its timestep, and what does not fit it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lammps_skin.model.accuracy import fits, longest_timestep
from lammps_skin.model.changes import changes
from lammps_skin.model.interventions import last_event_step, place
from lammps_skin.model.scene import Scene
from lammps_skin.model.stiffness import warning


def remarks(scene: Scene) -> Iterator[str]:
    """Lines: a timestep that is shorter for an interval, times that are no whole number of steps,
    a timestep that cannot be stable, and interventions that do not happen or change nothing."""
    numerics = scene.numerics
    timestep = numerics.timestep
    cycle = min(stage.shortest_cycle for stage in scene.stages)
    longest = longest_timestep(numerics.accuracy, cycle)
    given = "timestep" in scene.given().get("numerics", {})
    if longest and timestep < longest and not given and numerics.integrator != "euler":
        keys = [f"{key} = {time:g}" for key, time in _times(scene) if not fits(time, longest)]
        yield (
            f"numerics.timestep = {timestep:g} instead of {longest:g}, which does not fit "
            f"{' and '.join(keys)}: {longest / timestep:.3g} times as many steps; multiples of "
            f"{longest:g} fit"
        )
    for key, time in _times(scene):
        if not fits(time, timestep):
            steps = round(time / timestep) if key == "end_time" else math.ceil(time / timestep)
            yield (
                f"{key} = {time:g}: is no whole number of steps of {timestep:g}, and becomes "
                f"{max(steps, 1) * timestep:.9g}"
            )
    if unstable := warning(scene):
        yield unstable
    yield from _of_interventions(scene)


def _of_interventions(scene: Scene) -> Iterator[str]:
    """Those that do not happen or change nothing, and those of keys that are set a little later."""
    timestep = scene.numerics.timestep
    handled = last_event_step(scene.numerics, scene.begins)
    idle = {change.name for change in changes(scene) if not change.commands}
    for one in scene.interventions:
        said = f"{place(one)}.{'at' if one.at else 'every'} = {one.first:g}"
        if one.name in idle:
            yield f"{place(one)}.set: changes nothing, for the scene has nothing that it concerns"
        if one.first >= scene.end_time:
            yield f"{said}: is not before end_time = {scene.end_time:g}, and does not happen"
        elif (one.until or math.inf if one.every else one.first) <= (
            scene.begins if one.set else handled
        ):
            then = "its values hold from the start" if one.set else "it is not done again"
            yield f"{said}: is not after start.time = {scene.begins:g}, and {then}"
        elif one.set and not fits(one.first, timestep):
            later = math.ceil(one.first / timestep) * timestep
            yield f"{said}: is no whole number of steps of {timestep:g}, and becomes {later:.9g}"


def _times(scene: Scene) -> Iterator[tuple[str, float]]:
    """The end and the intervals of output, by key; not those that are never."""
    yield "end_time", scene.end_time
    for key, interval in scene.output.model_dump().items():
        if interval:
            yield f"output.{key}", interval
