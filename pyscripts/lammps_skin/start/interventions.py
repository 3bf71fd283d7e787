"""What a built directory says of the interventions of a scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from lammps_skin.model.changes import Change
from lammps_skin.model.interventions import Intervention, last_event_step
from lammps_skin.model.scene import Scene
from lammps_skin.start.configuration import Configuration


def arguments(scene: Scene, configuration: Configuration) -> Iterator[str]:
    """Arguments of fix skin/cells, one line for each intervention.

    Parameters
    ----------
    scene : Scene
    configuration : Configuration
        State with which the run begins. What was due on event steps up to its time has been done
        in the run that it is of, whose event steps may be others than those of the scene.
    """
    if scene.interventions and configuration.time:
        run = configuration.origin.scene if configuration.origin else scene
        yield f"intervened {last_event_step(run.numerics, configuration.time)!r}"
    for one in scene.interventions:
        yield " ".join(["intervene", one.name, *_times(one), *_action(one)])


def _times(one: Intervention) -> Iterator[str]:
    yield f"at {one.first!r}"
    if one.every:
        yield f"every {one.every!r}"
    if one.until:
        yield f"until {one.until!r}"


def _action(one: Intervention) -> Iterator[str]:
    if one.remove:
        yield f"remove {','.join(one.remove)}"
    elif one.convert:
        yield f"convert {','.join(one.convert)} {one.to}"
    elif one.add:
        yield f"add {one.add}"
    else:
        yield "change"
    for place in one.places or ():
        yield " ".join([*map(repr, place), *(["nearest"] if len(place) == 2 else [])])
    if one.fraction < 1:
        yield f"fraction {one.fraction!r}"
    for shape, values in (one.within.model_dump(exclude_none=True) if one.within else {}).items():
        yield f"{shape} {' '.join(map(repr, values))}"


def changes_script(changes: Sequence[Change]) -> Iterator[str]:
    """Lines of interventions.in, which skin.in reads before its last run."""
    yield "# Coefficients that change in the course of the run. Those that are due already when it"
    yield "# begins, as they are after a restart, change at once."
    for change in changes:
        yield f"\n# {change.name}, at t = {change.time!r}\n"
        at = f"step + ceil(({change.time!r} - time)/v_timestep - 1.0e-6)"
        yield f'variable        change_step equal "{at}"'
        yield "variable        there equal ${change_step}"
        yield 'if "${there} > $(step) && ${there} < ${last_step}" then "run ${there} upto"'
        if change.commands:
            commands = " &\n".join(f'  "{command}"' for command in change.commands)
            yield f'if "${{there}} <= $(step)" then &\n{commands}'
